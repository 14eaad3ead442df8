// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The controller of SEE++ (Border & Gammell, IJRR 2024; [1], AgriSEE): merge a view, propose views for the frontiers,
/// choose one of them; look at a frontier again or give it up. World frame, metres.
///
/// ```
/// Explorer explorer(Parameters::paper());
/// explorer.observe(points, sensor_position);                       // a first view, chosen by the caller
/// while (auto view = explorer.next_view(sensor_position, reachable))
///   explorer.observe(points_from(*view), sensor_position = ...);   // wherever the sensor really went
/// explorer.stop_reason();                                          // why there is no further view
/// ```
/// It knows nothing of the robot: `reachable` says which proposals can be reached. It ends on every input, at the
/// latest after `max_views` views. Cost per step: one frame for each new frontier, and tau^2 lines of sight.
#pragma once

#include <agrisee/core/stop_reason.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/see/selector.hpp>

#include <unordered_map>

namespace agrisee::see {

/// Chooses the next view, again and again, until nothing is left to see.
class Explorer {
 public:
  /// @param parameters of SEE++
  /// @param threads the results do not depend on it
  /// @throws FieldError if a parameter is out of its range
  explicit Explorer(const Parameters& parameters, int threads = 1)
      : parameters_(parameters),
        threads_(threads),
        map_(parameters),
        near_(static_cast<float>(2.0 * parameters.upsilon)) {}

  /// Merge the points of a view, and decide what becomes of the frontier that the view was taken for.
  /// @param cloud points of the view, any cloud type (m, world); may be empty
  /// @param sensor position of the sensor (m, world)
  /// @return indices of the points that were kept, ascending
  /// @throws InputError if `sensor` is not finite
  template <typename C>
  Indices observe(const C& cloud, const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Explorer::observe: the sensor's position is not finite");
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

  /// Remove all points but `kept` (indices of cloud(), ascending). For filters that run between views.
  /// @throws InputError if an index is out of range
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
    near_ = HashGrid<float>(static_cast<float>(2.0 * parameters_.upsilon));
    bounds_ = Aabb();
    sum_.setZero();
    index_points(0);
  }

  /// Views to try, best first; empty if there are none, see stop_reason(). There are at most max_updates + 1 of them.
  /// If none can be reached, refuse() them and call again.
  ///
  /// If the last view did not cover its frontier, a second view of that frontier comes first. The others are those of
  /// the updated frontiers in the order of rank(). Views that see fewer than `min_gain` frontiers are left out.
  /// @param sensor present position of the sensor (m, world)
  /// @throws InputError if `sensor` is not finite
  std::vector<ViewProposal> next_views(const Eigen::Vector3d& sensor) {
    check_input(sensor.allFinite(), "see::Explorer::next_views: the sensor's position is not finite");
    propose_new();
    while (true) {
      std::vector<Index> open = nearest_open(sensor);
      if (views_taken() >= parameters_.max_views || open.empty()) {
        stop_reason_ = why_stop();
        return {};
      }
      std::vector<ViewProposal> out = ranked(open, sensor);
      if (!out.empty()) return out;
      for (Index i : open) candidates_.at(i).state = State::low_gain;
    }
  }

  /// This view is taken next: the next observe() gets its points.
  void take(const ViewProposal& view) { target_ = view.frontier; }

  /// This view cannot be reached. It is turned towards where its frontier was first seen from, in max_pulls steps, one
  /// per call, and then dropped. A second view of a frontier is not turned: it is replaced by the view from where the
  /// frontier was first seen if `return_to_first_view` is set and that was not tried before, and dropped otherwise.
  void refuse(const ViewProposal& view) {
    if (target_ == view.frontier) target_.reset();
    const auto found = candidates_.find(view.frontier);
    if (found == candidates_.end()) return;
    Candidate& c = found->second;
    if (retry_ == view.frontier) {
      if (!look_from_first(c)) drop(c);
    } else if (c.pulls < parameters_.max_pulls) {
      const double share = double(++c.pulls) / double(parameters_.max_pulls + 1);
      c.view =
          view_of(c.frame.point, view.frontier, between(c.side, first_side(c.frame), share), parameters_.view_distance);
    } else {
      drop(c);
    }
  }

  /// Take the best view that can be reached.
  /// @param sensor present position of the sensor (m, world)
  /// @param reachable bool(const ViewProposal&), called for the views in order of preference
  /// @return empty if no view is left, see stop_reason()
  /// @throws InputError if `sensor` is not finite
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

  /// Why next_views() last returned no view; not_stopped before that.
  StopReason stop_reason() const { return stop_reason_; }
  /// Number of views observed so far.
  int views_taken() const { return static_cast<int>(sensors_.size()); }
  /// The merged points with their views, densities and classes.
  const DensityMap<float>& map() const { return map_; }
  const Cloud& cloud() const { return map_.cloud(); }           ///< the points merged so far
  const Parameters& parameters() const { return parameters_; }  ///< those it was made with
  /// Indices of the points that were given up as frontiers, ascending. They count as outliers from then on.
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
    Eigen::Vector3d side = Eigen::Vector3d::UnitZ();  // unit, from the point to the view before it was turned
    int shifts = 0, pulls = 0;                        // how often the view was shifted and turned
    bool from_first = false;                          // whether the view from where the point was first seen was tried
    State state = State::open;
  };

  /// Update bounds, sum and searches with the points from index `begin` on.
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
    if (!search_) search_.emplace(cloud(), static_cast<float>(0.5 * parameters_.radius));
  }

  const Eigen::Vector3d& first_sensor(Index i) const {
    return sensors_[static_cast<std::size_t>(cloud().views[static_cast<std::size_t>(i)])];
  }
  Eigen::Vector3d first_side(const Frontier& f) const {
    const Eigen::Vector3d d = first_sensor(f.index) - f.point;
    return d.norm() > 0.0 ? Eigen::Vector3d(d.normalized()) : f.normal;
  }
  std::optional<Frontier> frame(Index i) const {
    return frontier_frame(cloud(), *search_, near_, i, first_sensor(i), parameters_);
  }

  /// Frames and views for the frontiers that do not have any yet. Frontiers without a frame are given up.
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
      c.view = propose(c.frame, parameters_.view_distance);
      candidates_.emplace(added[j], c);
    }
  }

  bool valid(const Frontier& f) const {
    return !parameters_.outward_normals_only || points_outward(f, sum_ / static_cast<double>(map_.size()));
  }

  /// Open frontiers whose views are nearest to the sensor, nearest first, at most max_updates of them.
  std::vector<Index> nearest_open(const Eigen::Vector3d& sensor) const {
    std::vector<std::pair<double, Index>> open;
    for (const auto& [i, c] : candidates_)
      if (c.state == State::open && valid(c.frame)) open.emplace_back((c.view.position - sensor).norm(), i);
    const auto n =
        static_cast<std::ptrdiff_t>(std::min(open.size(), static_cast<std::size_t>(parameters_.max_updates)));
    std::partial_sort(open.begin(), open.begin() + n, open.end());
    std::vector<Index> out;
    for (std::ptrdiff_t j = 0; j < n; ++j) out.push_back(open[static_cast<std::size_t>(j)].second);
    return out;
  }

  /// Update the views of the frontiers `open` and return those that see enough, best first.
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
    const VisibilityGraph graph = visibility_graph<float>(near_, views, frontiers, parameters_, bounds_, threads_);
    const std::vector<std::size_t> order = rank(views, graph, sensor, parameters_.least_move);
    std::vector<ViewProposal> out;
    if (retry_) out.push_back(candidates_.at(*retry_).view);
    for (std::size_t j : order)
      if (views[j].frontier != retry_ && views[j].visible >= parameters_.min_gain) out.push_back(views[j]);
    return out;
  }

  /// Compute a frontier's frame from the present points and, unless its view was turned or shifted, a new view.
  void refresh(Candidate& c) const {
    const std::optional<Frontier> now = frame(c.frame.index);
    if (!now) return;
    c.frame = *now;
    if (c.pulls > 0 || retry_ == c.frame.index) return;
    c.view = propose_visible(cloud(), near_, c.frame, parameters_, bounds_);
    c.side = side_of(c.view, c.frame.point);
  }

  /// Decide what becomes of the frontier that the last view was for: covered, looked at again or given up. The points
  /// from index `first_new` on are those that the view added.
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
      if ((p - c.frame.point).norm() > parameters_.radius) continue;
      added += p;
      n += 1.0;
    }
    if (n > 0.0 && c.shifts < parameters_.max_shifts && !c.from_first &&
        (c.frame.point - added / n).norm() >= parameters_.upsilon) {
      ViewProposal last;
      last.position = sensors_.back();
      c.view = shift_view(last, c.frame, added / n, std::ldexp(1.0, c.shifts++), parameters_.view_distance);
      retry_ = t;
    } else if (!look_from_first(c)) {
      give_up(t);
    }
  }

  bool look_from_first(Candidate& c) {
    if (!parameters_.return_to_first_view || c.from_first) return false;
    c.from_first = true;
    c.view = view_of(c.frame.point, c.frame.index, first_side(c.frame), parameters_.view_distance);
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
    near_.visit(cloud().points[static_cast<std::size_t>(t)], static_cast<float>(parameters_.give_up_radius),
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

  Parameters parameters_;
  int threads_;
  DensityMap<float> map_;
  HashGrid<float> near_;                             // search over the points, in cells of 2 upsilon
  std::optional<Grid<float>> search_;                // search over the points, built when needed
  Aabb bounds_;                                      // of all points
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();    // of all points
  std::vector<Eigen::Vector3d> sensors_;             // position of each view
  std::unordered_map<Index, Candidate> candidates_;  // by index of the point; the results do not depend on their order
  std::vector<char> given_up_;                       // per point
  std::optional<Index> target_;                      // the frontier that the present view was taken for
  std::optional<Index> retry_;                       // the frontier that the next view should look at again
  StopReason stop_reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::see
