// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// SEE++ (Border & Gammell, IJRR 2024; [1], 3.2.1): merge a view, propose a view for each frontier, choose one of
/// them, and look at a frontier again or give it up. World frame, metres.
///
/// ```
/// Explorer explorer(Parameters::published());
/// explorer.observe(points, sensor_position);                       // a first view, chosen by the caller
/// while (auto view = explorer.next_view(sensor_position, reachable))
///   explorer.observe(points_from(*view), sensor_position = ...);   // wherever the sensor really went
/// explorer.stop_reason();                                          // why there is no further view
/// ```
/// It does not know the robot: `reachable` says which proposals can be reached. It ends after at most `max_views`
/// views. Cost per step: one frame for each new frontier and each of the tau nearest, and tau^2 lines of sight.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/core/stop_reason.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/see/candidates.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/see/selector.hpp>
#include <agrisee/see/view_controller.hpp>

namespace agrisee::see {

/// Chooses the next view, again and again, until nothing is left to see.
class Explorer {
 public:
  /// @param parameters of SEE++
  /// @param threads the results do not depend on it
  /// @throws FieldError if a parameter is out of its range
  explicit Explorer(const Parameters& parameters, int threads = 1)
      : parameters_(parameters), threads_(threads), map_(parameters), occluders_(parameters.upsilon) {}

  /// Merge the points of a view.
  /// @param cloud points of the view, any cloud type (m, world); may be empty
  /// @param sensor position of the sensor (m, world)
  /// @return indices of the points that were kept, ascending
  /// @throws InputError if `sensor` is not finite
  template <typename C>
  Indices observe(const C& cloud, const Eigen::Vector3d& sensor) {
    return observe(cloud, cloud, sensor);
  }

  /// The same for a caller that merges views itself.
  /// @param cloud points of the view that are to be kept, any cloud type (m, world)
  /// @param observation all points of the view (m, world)
  template <typename C, typename O>
  Indices observe(const C& cloud, const O& observation, const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Explorer::observe: the sensor's position is not finite");
    const std::size_t before = map_.size();
    const Indices kept = map_.insert(cloud, views_taken(), threads_);
    sensors_.push_back(sensor);
    seen_ = Observation(observation, sensor);
    states_.resize(map_.size());
    unreachable_.resize(map_.size(), 0);
    index_points(before);
    observed_ = true;
    return kept;
  }

  /// Remove all points but `kept` (indices of cloud(), ascending). For filters that run between views.
  /// @throws InputError if an index is out of range
  void keep(const Indices& kept) {
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

  /// The view to take next; empty if there is none, see stop_reason(). If it cannot be reached, move_view() or refuse()
  /// it and call again. The first call after a view updates the frontiers and the views nearest to the sensor.
  /// @param sensor present position of the sensor (m, world)
  /// @throws InputError if `sensor` is not finite
  std::optional<ViewProposal> next_view(const Eigen::Vector3d& sensor) {
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

  /// Take the best view that can be reached, and refuse the better ones.
  /// @param sensor present position of the sensor (m, world)
  /// @param reachable bool(const ViewProposal&)
  /// @return empty if no view is left, see stop_reason()
  /// @throws InputError if `sensor` is not finite
  template <typename Reachable>
  std::optional<ViewProposal> next_view(const Eigen::Vector3d& sensor, Reachable&& reachable) {
    while (const auto view = next_view(sensor)) {
      if (reachable(*view)) {
        take(*view);
        return view;
      }
      refuse(*view);
    }
    return std::nullopt;
  }

  /// This view is taken next: the next observe() gets its points.
  void take(const ViewProposal& view) { target_ = view.frontier; }

  /// Whether the line of sight from a view's frontier to a position (m, world) is free.
  bool sees(const ViewProposal& view, const Eigen::Vector3d& position) const {
    const auto found = candidates_.find(view.frontier);
    if (found == candidates_.end()) return false;
    const Frontier& f = found->second.frame;
    const double depth = surface_depth<float>(occluders_, f, parameters_.upsilon);
    return is_visible<float>(occluders_, f.point, depth, position, parameters_, occluders_.bounds());
  }

  /// The sensor will look at the view's frontier from another position (m, world), because it cannot reach the view's.
  void move_view(const ViewProposal& view, const Eigen::Vector3d& position) {
    const auto found = candidates_.find(view.frontier);
    if (found == candidates_.end()) return;
    ViewProposal& v = found->second.view;
    v.position = position;
    v.direction = -side_of(v, found->second.frame.point);
  }

  /// This view cannot be reached: its frontier is given up.
  void refuse(const ViewProposal& view) {
    if (target_ == view.frontier) target_.reset();
    if (candidates_.find(view.frontier) == candidates_.end()) return;
    give_up(view.frontier);
    unreachable_[static_cast<std::size_t>(view.frontier)] = 1;
  }

  /// Why next_view() last returned no view; not_stopped before that.
  StopReason stop_reason() const { return stop_reason_; }
  /// Number of views observed so far.
  int views_taken() const { return static_cast<int>(sensors_.size()); }
  /// The merged points with their views, densities and classes.
  const DensityMap<float>& map() const { return map_; }
  const Cloud& cloud() const { return map_.cloud(); }           ///< the points merged so far
  const Parameters& parameters() const { return parameters_; }  ///< those it was made with
  /// The frontiers as of the last next_view(), by ascending index, with their frames.
  std::vector<Frontier> frontiers() const {
    std::vector<Frontier> out;
    for (const auto& [i, c] : candidates_) out.push_back(c.frame);
    return out;
  }

 private:
  /// Update sum and searches with the points from index `begin` on.
  void index_points(std::size_t begin) {
    for (std::size_t i = begin; i < map_.size(); ++i) {
      const Eigen::Vector3f& p = cloud().points[i];
      sum_ += p.cast<double>();
      occluders_.insert(p);
    }
    search_.reset();
  }

  const Grid<float>& search() {
    if (!search_) search_.emplace(cloud(), static_cast<float>(0.5 * parameters_.radius));
    return *search_;
  }

  const Eigen::Vector3d& first_sensor(Index i) const {
    return sensors_[static_cast<std::size_t>(cloud().views[static_cast<std::size_t>(i)])];
  }

  /// Frames and views for the points that became frontiers; points that are no longer frontiers are dropped.
  void update_frontiers() {
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

  /// Frames of points; empty where there is none.
  std::vector<std::optional<Frontier>> frames_of(const Indices& points) {
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

  /// Decide what to do with the frontier of the last view, if it is still a frontier.
  void control() {
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

  /// Let the controller change a candidate's view. A change that leaves it nearer than min_move to where the sensor was
  /// would show the same again: it counts as one that did not help. That is so where the offset o is along the normal,
  /// for then an adjustment moves nothing, and mostly after a switch.
  /// @return false if nothing helps
  bool look_elsewhere(Candidate& c) {
    const Index i = c.frame.index;
    ControllerState& state = states_[static_cast<std::size_t>(i)];
    while (control_view(c.frame, seen_.centroid(), first_sensor(i), parameters_.view_distance, state, c.view) !=
           ControllerAction::nothing_helps)
      if (!near_any(sensors_, c.view.position, parameters_.min_move)) return true;
    return false;
  }

  /// Renew the frames of the views nearest to the sensor, move those views that do not see their frontiers, give up
  /// those frontiers that cannot be seen at all, and update the graph for the views nearest to the sensor.
  void update_views(const Eigen::Vector3d& sensor) {
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

  /// Estimate the frames of candidates anew, as the points around them are now. Views go with the normals, except for
  /// those that the controller has moved. SEE++ estimates a frame once, when the point becomes a frontier. Then few
  /// points beyond the edge are known, and the normal leans towards what had been seen.
  void renew(const std::vector<Candidate*>& candidates) {
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

  bool valid(const Frontier& f) const {
    return !parameters_.outward_normals_only || points_outward(f, sum_ / static_cast<double>(map_.size()));
  }

  /// The views of the valid frontiers, in the order of these.
  std::vector<Place> places() {
    std::vector<Place> out;
    out.reserve(candidates_.size());
    for (auto& [i, c] : candidates_)
      if (valid(c.frame)) out.push_back({c.view.position, &c});
    return out;
  }

  /// The views of the valid frontiers that are no nearer than min_move to where the sensor was; if there are none, all.
  std::vector<Place> new_places() {
    const std::vector<Place> all = places();
    std::vector<Place> out;
    for (const Place& p : all)
      if (!near_any(sensors_, p.position, parameters_.min_move)) out.push_back(p);
    return out.empty() ? all : out;
  }

  /// The frontier whose view is selected; empty if there is none. A view that the controller has just changed comes
  /// first if `adjusted_first` is set: SEE++ lets it compete, but then the sensor creeps, because with tau views in its
  /// neighborhood a nearer one is always found.
  std::optional<Index> choose(const Eigen::Vector3d& sensor) {
    const auto changed = changed_ ? candidates_.find(*changed_) : candidates_.end();
    if (changed != candidates_.end() && valid(changed->second.frame)) return changed_;
    const std::vector<Place> all = new_places();
    std::vector<ViewOption> options;
    for (const Place& p : all) options.push_back({p.candidate->node, (p.position - sensor).norm()});
    const auto chosen = select_view(options, graph_);
    return chosen ? std::optional(all[*chosen].candidate->frame.index) : std::nullopt;
  }

  void remove(Candidates::iterator c) {
    graph_.remove(c->second.node);
    candidates_.erase(c);
  }
  void give_up(Index i) {
    remove(candidates_.find(i));
    map_.give_up(i);
  }

  std::nullopt_t stop(StopReason reason) {
    stop_reason_ = reason;
    return std::nullopt;
  }
  StopReason why_stop() const {
    if (map_.size() == 0) return StopReason::nothing_seen;
    const bool refused = std::find(unreachable_.begin(), unreachable_.end(), 1) != unreachable_.end();
    return refused ? StopReason::no_reachable_view : StopReason::no_frontier;
  }

  Parameters parameters_;
  int threads_;
  DensityMap<float> map_;
  Occluders occluders_;                            // the points, for lines of sight
  std::optional<Grid<float>> search_;              // the points, for frames; made when needed
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();  // of all points
  std::vector<Eigen::Vector3d> sensors_;           // position of each view
  Observation seen_;                               // the last view
  Candidates candidates_;
  VisibilityGraph graph_;
  std::vector<ControllerState> states_;  // per point
  std::vector<char> unreachable_;        // per point: whether it was given up because its view cannot be reached
  std::optional<Index> target_;          // the frontier that the present view was taken for
  std::optional<Index> changed_;         // the frontier whose view comes next because the controller changed it
  bool observed_ = false;                // whether a view was merged since the last next_view()
  int step_ = 0;                         // number of views that next_view() has dealt with
  StopReason stop_reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::see
