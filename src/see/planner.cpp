// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/see/planner.hpp>
#include <agrisee/see/selector.hpp>

#include <algorithm>
#include <utility>

namespace agrisee::see {

void Explorer::keep(const Indices& kept) {
  std::vector<Index> renumbered(map_.size(), -1);
  map_.keep(kept, threads_);
  for (std::size_t j = 0; j < kept.size(); ++j) {
    const auto i = static_cast<std::size_t>(kept[j]);
    renumbered[i] = static_cast<Index>(j);
    states_[j] = states_[i];
    unreachable_[j] = unreachable_[i];
  }
  states_.resize(kept.size());
  unreachable_.resize(kept.size());
  Candidates candidates;
  for (auto& [i, c] : candidates_) {
    const Index j = renumbered[static_cast<std::size_t>(i)];
    if (j < 0) {
      graph_.remove(c.node);
      continue;
    }
    c.frame.index = c.view.frontier = j;
    c.depth_step = -1;
    candidates.emplace(j, c);
  }
  candidates_.swap(candidates);
  if (target_) target_ = renumbered[static_cast<std::size_t>(*target_)];
  if (target_ && *target_ < 0) target_.reset();
  changed_.reset();
  occluders_ = Occluders(parameters_.upsilon);
  sum_.setZero();
  index_points(0);
}

std::optional<ViewProposal> Explorer::next_view(const Eigen::Vector3d& sensor) {
  check_input(sensor.allFinite(), "see::Explorer::next_view: the sensor's position is not finite");
  if (observed_) {
    observed_ = false;
    ++step_;
    update_frontiers();
    control();
  }
  if (views_taken() >= parameters_.max_views) return stop(StopReason::max_views);
  auto chosen = choose(sensor);
  if (chosen && candidates_.at(*chosen).step != step_) {
    update_views(sensor);
    chosen = choose(sensor);
  }
  if (!chosen) return stop(why_stop());
  Candidate& c = candidates_.at(*chosen);
  c.view.visible = graph_.out_degree(c.node) + 1;
  return c.view;
}

bool Explorer::sees(const ViewProposal& view, const Eigen::Vector3d& position) const {
  const auto found = candidates_.find(view.frontier);
  if (found == candidates_.end()) return false;
  const Frontier& f = found->second.frame;
  const double depth = surface_depth<float>(occluders_, f, parameters_.upsilon);
  return is_visible<float>(occluders_, f.point, depth, position, parameters_, occluders_.bounds());
}

void Explorer::move_view(const ViewProposal& view, const Eigen::Vector3d& position) {
  const auto found = candidates_.find(view.frontier);
  if (found == candidates_.end()) return;
  ViewProposal& v = found->second.view;
  v.position = position;
  v.direction = -side_of(v, found->second.frame.point);
}

void Explorer::refuse(const ViewProposal& view) {
  if (target_ == view.frontier) target_.reset();
  if (candidates_.find(view.frontier) == candidates_.end()) return;
  give_up(view.frontier);
  unreachable_[static_cast<std::size_t>(view.frontier)] = 1;
}

std::vector<Frontier> Explorer::frontiers() const {
  std::vector<Frontier> out;
  for (const auto& [i, c] : candidates_) out.push_back(c.frame);
  return out;
}

void Explorer::index_points(std::size_t begin) {
  for (std::size_t i = begin; i < map_.size(); ++i) {
    const Eigen::Vector3f& p = cloud().points[i];
    sum_ += p.cast<double>();
    occluders_.insert(p);
  }
  search_.reset();
}

const Grid<float>& Explorer::search() {
  if (!search_) search_.emplace(cloud(), static_cast<float>(0.5 * parameters_.radius));
  return *search_;
}

const Eigen::Vector3d& Explorer::first_sensor(Index i) const {
  return sensors_[static_cast<std::size_t>(cloud().views[static_cast<std::size_t>(i)])];
}

void Explorer::update_frontiers() {
  Indices added;
  for (std::size_t i = 0; i < map_.size(); ++i) {
    const auto index = static_cast<Index>(i);
    const bool is = map_.class_of(index) == PointClass::frontier;
    const auto found = candidates_.find(index);
    if (is && found == candidates_.end()) added.push_back(index);
    if (!is && found != candidates_.end()) remove(found);
  }
  if (added.empty()) return;
  const std::vector<std::optional<Frontier>> frames = frames_of(added);
  for (std::size_t j = 0; j < added.size(); ++j) {
    unreachable_[static_cast<std::size_t>(added[j])] = 0;
    if (!frames[j]) {
      map_.give_up(added[j]);
      continue;
    }
    Candidate c;
    c.frame = *frames[j];
    c.view = propose(c.frame, parameters_.view_distance);
    c.node = graph_.add();
    c.frame_step = step_;
    candidates_.emplace(added[j], c);
  }
}

std::vector<std::optional<Frontier>> Explorer::frames_of(const Indices& points) {
  const Grid<float>& grid = search();
  std::vector<std::optional<Frontier>> frames(points.size());
  parallel_chunks(points.size(), threads_, 16, [&](std::size_t begin, std::size_t end) {
    FrameScratch<float> scratch;
    for (std::size_t j = begin; j < end; ++j) {
      const int density = map_.counts()[static_cast<std::size_t>(points[j])];
      frames[j] =
          frontier_frame(cloud(), grid, points[j], first_sensor(points[j]), seen_, parameters_, scratch, density);
    }
  });
  return frames;
}

void Explorer::control() {
  changed_.reset();
  if (!target_) return;
  const Index t = *target_;
  target_.reset();
  const auto found = candidates_.find(t);
  if (found == candidates_.end()) return;
  Candidate& c = found->second;
  const bool showed_something = seen_.size() > 0 && map_.near_added() > 0;
  if (!showed_something || !look_elsewhere(c)) return give_up(t);
  c.moved = true;
  if (parameters_.adjusted_first) changed_ = t;
}

bool Explorer::look_elsewhere(Candidate& c) {
  const Index i = c.frame.index;
  ControllerState& state = states_[static_cast<std::size_t>(i)];
  while (control_view(c.frame, seen_.centroid(), first_sensor(i), parameters_.view_distance, state, c.view) !=
         ControllerAction::nothing_helps)
    if (!near_any(sensors_, c.view.position, parameters_.min_move)) return true;
  return false;
}

void Explorer::update_views(const Eigen::Vector3d& sensor) {
  const auto most = static_cast<std::size_t>(parameters_.max_updates);
  const std::vector<Candidate*> updated = nearest_views(new_places(), sensor, most);
  if (parameters_.renew_frames) renew(updated);
  std::vector<char> seen(updated.size(), 1);
  parallel_for(
      updated.size(), threads_,
      [&](std::size_t j) {
        Candidate& c = *updated[j];
        measure_depth(c, occluders_, parameters_, step_);
        if (sees_own(c, occluders_, parameters_)) return;
        c.view = propose_around(occluders_.sparse(), c.frame, c.depth, first_sensor(c.frame.index), parameters_);
        seen[j] = sees_own(c, occluders_, parameters_);
      },
      1);
  for (std::size_t j = 0; j < updated.size(); ++j)
    if (!seen[j]) give_up(updated[j]->frame.index);
  const std::vector<Candidate*> near = nearest_views(new_places(), sensor, most);
  std::vector<Indices> arcs = arcs_from(near, places(), occluders_, parameters_, step_, threads_);
  for (std::size_t j = 0; j < near.size(); ++j) {
    graph_.connect(near[j]->node, std::move(arcs[j]));
    near[j]->step = step_;
  }
}

void Explorer::renew(const std::vector<Candidate*>& candidates) {
  Indices points;
  for (const Candidate* c : candidates)
    if (c->frame_step != step_) points.push_back(c->frame.index);
  const std::vector<std::optional<Frontier>> frames = frames_of(points);
  for (std::size_t j = 0; j < points.size(); ++j) {
    Candidate& c = candidates_.at(points[j]);
    c.frame_step = step_;
    if (!frames[j]) continue;
    c.frame = *frames[j];
    c.depth_step = -1;
    if (!c.moved) c.view = propose(c.frame, parameters_.view_distance);
  }
}

bool Explorer::valid(const Frontier& f) const {
  return !parameters_.outward_normals_only || points_outward(f, sum_ / static_cast<double>(map_.size()));
}

std::vector<Place> Explorer::places() {
  std::vector<Place> out;
  out.reserve(candidates_.size());
  for (auto& [i, c] : candidates_)
    if (valid(c.frame)) out.push_back({c.view.position, &c});
  return out;
}

std::vector<Place> Explorer::new_places() {
  const std::vector<Place> all = places();
  std::vector<Place> out;
  for (const Place& p : all)
    if (!near_any(sensors_, p.position, parameters_.min_move)) out.push_back(p);
  return out.empty() ? all : out;
}

std::optional<Index> Explorer::choose(const Eigen::Vector3d& sensor) {
  const auto changed = changed_ ? candidates_.find(*changed_) : candidates_.end();
  if (changed != candidates_.end() && valid(changed->second.frame)) return changed_;
  const std::vector<Place> all = new_places();
  std::vector<ViewOption> options;
  for (const Place& p : all) options.push_back({p.candidate->node, (p.position - sensor).norm()});
  const auto chosen = select_view(options, graph_);
  return chosen ? std::optional(all[*chosen].candidate->frame.index) : std::nullopt;
}

void Explorer::remove(Candidates::iterator c) {
  graph_.remove(c->second.node);
  candidates_.erase(c);
}

void Explorer::give_up(Index i) {
  remove(candidates_.find(i));
  map_.give_up(i);
}

std::nullopt_t Explorer::stop(StopReason reason) {
  stop_reason_ = reason;
  return std::nullopt;
}

StopReason Explorer::why_stop() const {
  if (map_.size() == 0) return StopReason::nothing_seen;
  const bool refused = std::find(unreachable_.begin(), unreachable_.end(), 1) != unreachable_.end();
  return refused ? StopReason::no_reachable_view : StopReason::no_frontier;
}

}  // namespace agrisee::see
