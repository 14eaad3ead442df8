// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// SEE++'s controller (Border & Gammell, IJRR 2024; paper, AgriSEE): observe, propose, look again or give up. World
/// frame, m.
///
/// ```
/// Planner planner(Parameters::paper());
/// planner.observe(points, sensor_position);                       // a first view, chosen by the caller
/// while (auto view = planner.next_view(sensor_position, reachable))
///   planner.observe(points_from(*view), sensor_position = ...);   // wherever the sensor really went
/// planner.stop_reason();                                          // why there is none
/// ```
/// It knows nothing of the robot: `reachable` says which proposals can be reached. It ends on every input, at the
/// latest with the view budget. A step costs one frame for each new frontier, and tau^2 sight lines.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/result.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/see/selector.hpp>

#include <unordered_map>

namespace agrisee::see {

/// Plans view by view.
class Planner {
 public:
  /// @param params see their struct  @param threads results do not depend on it
  /// @throws ParameterError as Parameters::check()
  explicit Planner(const Parameters& params, int threads = 1)
      : params_(params), threads_(threads), map_(params), near_(static_cast<float>(2.0 * params.upsilon)) {}

  /// Merge what a view saw (any cloud, world; none is allowed) and judge the view last taken by it.
  /// @param cloud points of the view (m, world)  @param sensor position of the sensor (m)
  /// @return indices of the points that were kept
  /// @throws InputError when `sensor` is not finite
  template <typename C>
  Indices observe(const C& cloud, const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Planner::observe: the sensor's position is not finite");
    const std::size_t before = map_.size();
    const Indices kept = map_.insert(cloud, views_taken(), threads_);
    sensors_.push_back(sensor);
    given_up_.resize(map_.size(), 0);
    index_points(before);
    for (auto c = candidates_.begin(); c != candidates_.end();)
      c = map_.class_of(c->first) == PointClass::frontier ? std::next(c) : candidates_.erase(c);
    judge(before);
    return kept;
  }

  /// Forget all points but `kept` (ascending indices of cloud()), for filters that run between views.
  /// @throws InputError when an index is out of range
  void keep(const Indices& kept) {
    const std::size_t before = map_.size();
    map_.keep(kept, threads_);
    std::vector<Index> renumbered(before, -1);
    std::vector<char> given_up(kept.size(), 0);
    for (std::size_t j = 0; j < kept.size(); ++j) {
      renumbered[static_cast<std::size_t>(kept[j])] = static_cast<Index>(j);
      given_up[j] = given_up_[static_cast<std::size_t>(kept[j])];
    }
    given_up_.swap(given_up);
    std::unordered_map<Index, Candidate> candidates;
    for (auto& [i, c] : candidates_) {
      const Index j = renumbered[static_cast<std::size_t>(i)];
      if (j < 0 || map_.class_of(j) != PointClass::frontier) continue;
      c.frame.index = c.view.frontier = j;
      candidates.emplace(j, c);
    }
    candidates_.swap(candidates);
    const auto renumber = [&](std::optional<Index>& i) {
      if (i) i = renumbered[static_cast<std::size_t>(*i)];
      if (i && *i < 0) i.reset();
    };
    renumber(target_);
    renumber(retry_);
    if (retry_ && candidates_.find(*retry_) == candidates_.end()) retry_.reset();
    near_ = HashGrid<float>(static_cast<float>(2.0 * params_.upsilon));
    bounds_ = Aabb();
    sum_.setZero();
    index_points(0);
  }

  /// Views to try, best first; empty when there is none, see stop_reason(). At most max_updates + 1 of them: when none
  /// of them can be reached, refuse() them and ask again.
  ///
  /// A frontier that the last view was for and did not cover comes first. The rest are the updated frontiers' in the
  /// order of rank(), those that see fewer than `min_gain` left out.
  /// @param sensor present position of the sensor (m)
  std::vector<ViewProposal> next_views(const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Planner::next_views: the sensor's position is not finite");
    propose_new();
    while (true) {
      std::vector<Index> open = nearest_open(sensor);
      if (views_taken() >= params_.max_views || open.empty()) {
        stop_reason_ = why_stop();
        return {};
      }
      std::vector<ViewProposal> out = ranked(open, sensor);
      if (!out.empty()) return out;
      for (Index i : open) candidates_.at(i).state = State::low_gain;
    }
  }

  /// The sensor goes for this proposal: the next observe() judges it.
  void take(const ViewProposal& view) { target_ = view.frontier; }

  /// This proposal cannot be reached. It is turned step by step towards where its frontier was first seen from, then
  /// dropped; a second look at a frontier is dropped at once, or replaced by the one from where it was first seen.
  void refuse(const ViewProposal& view) {
    if (target_ == view.frontier) target_.reset();
    const auto found = candidates_.find(view.frontier);
    if (found == candidates_.end()) return;
    Candidate& c = found->second;
    if (retry_ == view.frontier) {
      if (!look_from_first(c)) drop(c);
    } else if (c.pulls < params_.max_pulls) {
      const double share = double(++c.pulls) / double(params_.max_pulls + 1);
      c.view =
          view_of(c.frame.point, view.frontier, between(c.side, first_side(c.frame), share), params_.view_distance);
    } else {
      drop(c);
    }
  }

  /// The best view that can be reached, taken; none when there is none, see stop_reason().
  /// @param sensor its position (m)  @param reachable bool(const ViewProposal&), asked in order of preference
  template <typename Reachable>
  std::optional<ViewProposal> next_view(const Eigen::Vector3d& sensor, Reachable&& reachable) {
    while (true) {
      const std::vector<ViewProposal> views = next_views(sensor);
      if (views.empty()) return std::nullopt;
      for (const ViewProposal& view : views) {
        if (reachable(view)) {
          take(view);
          return view;
        }
        refuse(view);
      }
    }
  }

  /// Why next_views() last returned nothing; not_stopped before that.
  StopReason stop_reason() const { return stop_reason_; }
  /// Views observed so far.
  int views_taken() const { return static_cast<int>(sensors_.size()); }
  /// The merged points, their views, densities and classes.
  const DensityMap<float>& map() const { return map_; }
  const Cloud& cloud() const { return map_.cloud(); }       ///< the points merged so far
  const Parameters& parameters() const { return params_; }  ///< as given
  /// Frontiers that have been given up: they count as outliers from then on. Ascending.
  Indices given_up() const {
    Indices out;
    for (std::size_t i = 0; i < given_up_.size(); ++i)
      if (given_up_[i]) out.push_back(static_cast<Index>(i));
    return out;
  }

 private:
  enum class State : std::uint8_t { open, refused, low_gain };
  struct Candidate {
    Frontier frame;
    ViewProposal view;
    Eigen::Vector3d side = Eigen::Vector3d::UnitZ();  // of the view before it was pulled
    int shifts = 0, pulls = 0;
    bool from_first = false;  // the view from where the point was first seen has been tried
    State state = State::open;
  };

  /// Bring bounds, mean and searches up to date with the points from `begin` on.
  void index_points(std::size_t begin) {
    for (std::size_t i = begin; i < map_.size(); ++i) {
      const Eigen::Vector3d p = cloud().points[i].cast<double>();
      bounds_.extend(p);
      sum_ += p;
      near_.insert(cloud().points[i]);
    }
    search_.reset();
  }

  void build_search() {
    if (!search_) search_.emplace(cloud(), static_cast<float>(0.5 * params_.radius));
  }

  const Eigen::Vector3d& first_sensor(Index i) const {
    return sensors_[static_cast<std::size_t>(cloud().views[static_cast<std::size_t>(i)])];
  }
  Eigen::Vector3d first_side(const Frontier& f) const {
    const Eigen::Vector3d d = first_sensor(f.index) - f.point;
    return d.norm() > 0.0 ? Eigen::Vector3d(d.normalized()) : f.normal;
  }
  std::optional<Frontier> frame(Index i) const {
    return frontier_frame(cloud(), *search_, near_, i, first_sensor(i), params_);
  }

  /// Frames and views for the frontiers that have none.
  void propose_new() {
    Indices added;
    for (Index i : map_.of_class(PointClass::frontier))
      if (!given_up_[static_cast<std::size_t>(i)] && candidates_.find(i) == candidates_.end()) added.push_back(i);
    if (added.empty()) return;
    build_search();
    std::vector<std::optional<Frontier>> frames(added.size());
    parallel_for(
        added.size(), threads_, [&](std::size_t j) { frames[j] = frame(added[j]); }, 16);
    for (std::size_t j = 0; j < added.size(); ++j) {
      if (!frames[j]) {
        given_up_[static_cast<std::size_t>(added[j])] = 1;
        continue;
      }
      Candidate c;
      c.frame = *frames[j];
      c.side = c.frame.normal;
      c.view = propose(c.frame, params_.view_distance);
      candidates_.emplace(added[j], c);
    }
  }

  bool valid(const Frontier& f) const {
    return !params_.outward_normals_only || points_outward(f, sum_ / static_cast<double>(map_.size()));
  }

  /// The max_updates open frontiers whose views are nearest to the sensor, nearest first.
  std::vector<Index> nearest_open(const Eigen::Vector3d& sensor) const {
    std::vector<std::pair<double, Index>> open;
    for (const auto& [i, c] : candidates_)
      if (c.state == State::open && valid(c.frame)) open.emplace_back((c.view.position - sensor).norm(), i);
    const auto n = static_cast<std::ptrdiff_t>(std::min(open.size(), static_cast<std::size_t>(params_.max_updates)));
    std::partial_sort(open.begin(), open.begin() + n, open.end());
    std::vector<Index> out;
    for (std::ptrdiff_t j = 0; j < n; ++j) out.push_back(open[static_cast<std::size_t>(j)].second);
    return out;
  }

  /// Update the views of the frontiers `open` and return those worth taking, best first.
  std::vector<ViewProposal> ranked(const std::vector<Index>& open, const Eigen::Vector3d& sensor) {
    build_search();
    std::vector<Candidate*> candidates;
    for (Index i : open) candidates.push_back(&candidates_.at(i));
    parallel_for(
        open.size(), threads_, [&](std::size_t j) { refresh(*candidates[j]); }, 1);
    std::vector<ViewProposal> views;
    std::vector<Frontier> frontiers;
    for (const Candidate* c : candidates) {
      views.push_back(c->view);
      frontiers.push_back(c->frame);
    }
    const VisibilityGraph graph = visibility_graph<float>(near_, views, frontiers, params_, bounds_, threads_);
    const std::vector<std::size_t> order = rank(views, graph, sensor, params_.least_move);
    std::vector<ViewProposal> out;
    if (retry_) out.push_back(candidates_.at(*retry_).view);
    for (std::size_t j : order)
      if (views[j].frontier != retry_ && views[j].visible >= params_.min_gain) out.push_back(views[j]);
    return out;
  }

  /// The frame from the points as they are now, and the view that follows from it unless one was prescribed.
  void refresh(Candidate& c) const {
    const std::optional<Frontier> now = frame(c.frame.index);
    if (!now) return;
    c.frame = *now;
    if (c.pulls > 0 || retry_ == c.frame.index) return;
    c.view = propose_visible(cloud(), near_, c.frame, params_, bounds_);
    c.side = side_of(c.view, c.frame.point);
  }

  /// What becomes of the frontier that the last view was for; the points from `first_new` on are what that view added.
  void judge(std::size_t first_new) {
    retry_.reset();
    if (!target_) return;
    const Index t = *target_;
    target_.reset();
    const auto found = candidates_.find(t);
    if (found == candidates_.end()) return;  // covered
    Candidate& c = found->second;
    Eigen::Vector3d added = Eigen::Vector3d::Zero();
    double n = 0.0;
    for (std::size_t i = first_new; i < map_.size(); ++i) {
      const Eigen::Vector3d p = cloud().points[i].cast<double>();
      if ((p - c.frame.point).norm() > params_.radius) continue;
      added += p;
      n += 1.0;
    }
    if (n > 0.0 && c.shifts < params_.max_shifts && !c.from_first &&
        (c.frame.point - added / n).norm() >= params_.upsilon) {
      ViewProposal last;
      last.position = sensors_.back();
      c.view = shift_view(last, c.frame, added / n, std::ldexp(1.0, c.shifts++), params_.view_distance);
      retry_ = t;
    } else if (!look_from_first(c)) {
      give_up(t);
    }
  }

  bool look_from_first(Candidate& c) {
    if (!params_.return_to_first_view || c.from_first) return false;
    c.from_first = true;
    c.view = view_of(c.frame.point, c.frame.index, first_side(c.frame), params_.view_distance);
    retry_ = c.frame.index;
    return true;
  }

  void drop(Candidate& c) {
    c.state = State::refused;
    if (retry_ == c.frame.index) retry_.reset();
  }

  void give_up(Index t) {
    const auto set = [&](Index i) {
      given_up_[static_cast<std::size_t>(i)] = 1;
      candidates_.erase(i);
    };
    near_.visit(cloud().points[static_cast<std::size_t>(t)], static_cast<float>(params_.give_up_radius),
                [&](Index i, float) {
                  if (map_.class_of(i) == PointClass::frontier) set(i);
                });
    set(t);
  }

  StopReason why_stop() const {
    if (map_.size() == 0) return StopReason::nothing_seen;
    bool any = false, refused = false, low = false;
    for (const auto& [i, c] : candidates_) {
      if (!valid(c.frame)) continue;
      any = any || c.state == State::open;
      refused = refused || c.state == State::refused;
      low = low || c.state == State::low_gain;
    }
    if (any) return StopReason::max_views;
    return refused ? StopReason::no_reachable_view : low ? StopReason::low_gain : StopReason::no_frontier;
  }

  Parameters params_;
  int threads_;
  DensityMap<float> map_;
  HashGrid<float> near_;               // the same points in cells of 2 upsilon
  std::optional<Grid<float>> search_;  // the same points, built when needed
  Aabb bounds_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();    // of all points
  std::vector<Eigen::Vector3d> sensors_;             // position of each view
  std::unordered_map<Index, Candidate> candidates_;  // by point; only ever visited in ways that depend on no order
  std::vector<char> given_up_;
  std::optional<Index> target_;  // the frontier that the sensor has gone to see
  std::optional<Index> retry_;   // the frontier to look at again first
  StopReason stop_reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::see
