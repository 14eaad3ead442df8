// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The default planner: of the views that the arm can take, the one expected to show the most new fruit surface for its
/// time.
///
/// Candidates look at the truss from directions spread over the sphere, each at a place of its own among the bodies and
/// from a distance of its own; those within reach are kept. Each is scored by ExpectedSurface::gain over the time of
/// dwelling and moving. The best are asked for anew from where the arm stands, and searched around more finely. The
/// scan ends when the best view promises less than `min_gain` of the fruit surface known so far. Metres, seconds,
/// world.
#pragma once

#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/expected_surface.hpp>

#include <numeric>

namespace agrisee::plan {

/// See the file's head.
class GainPlanner : public Planner {
 public:
  /// @param sensor intrinsics and range
  /// @param volume to be scanned (world)
  /// @param eye the arm's base in world, from which the truss is first looked at
  /// @param split see its struct
  /// @param free_space see its struct
  /// @param parameters see its struct
  /// @throws ParameterError
  GainPlanner(const sensor::L515& sensor, const Aabb& volume, const Eigen::Vector3d& eye, const SplitParameters& split,
              const FreeSpaceParameters& free_space, const GainPlannerParameters& parameters = {})
      : parameters_(parameters),
        split_(split),
        free_space_(free_space),
        volume_(volume),
        eye_(eye),
        model_(sensor, volume, parameters.expected) {
    parameters_.check();
  }

  void observe(const Progress& progress) override {
    model_.update(progress, split_, free_space_);
    ranked_.clear();
    refused_.clear();
    refused_first_ = 0;
  }

  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override {
    const auto taken = static_cast<int>(progress.views.size());
    if (progress.cloud.empty()) {
      // Nothing seen so far: a few more tries near the front, then that is the answer.
      if (taken >= 4) return stop(StopReason::nothing_seen);
      auto view =
          first_view(volume_, eye_, current, reach, request(Eigen::Vector3d::UnitY()), refused_first_ + 12 * taken);
      if (!view && taken > 0) return stop(StopReason::nothing_seen);
      if (!view) return stop(StopReason::no_reachable_view);
      return view;
    }
    const Aabb& extent = model_.extent();
    if (candidates_.empty() || (extent_.min - extent.min).norm() > 0.02 || (extent_.max - extent.max).norm() > 0.02) {
      std::vector<Candidate> candidates;  // all of them or none, should this be cancelled
      const std::vector<Eigen::Vector3d> directions = spread_directions(parameters_.candidates);
      for (std::size_t i = 0; i < directions.size(); ++i) {
        throw_if_cancelled();
        const ViewRequest wish = candidate(static_cast<double>(i), directions[i], extent);
        if (auto view = reach(wish, current)) candidates.push_back({wish, std::move(*view)});
      }
      extent_ = extent;
      candidates_ = std::move(candidates);
    }
    if (ranked_.empty()) {
      const auto completeness = completeness_;
      try {
        if (const auto reason = rank(current, reach)) return stop(*reason);
      } catch (...) {  // half a ranking is none
        ranked_.clear();
        completeness_ = completeness;
        throw;
      }
    } else {  // a view was refused: the others have not changed
      const auto refused = [&](const Scored& s) { return was_refused(s.request); };
      ranked_.erase(std::remove_if(ranked_.begin(), ranked_.end(), refused), ranked_.end());
      for (Scored& s : ranked_) s.score = s.view.gain / (parameters_.dwell + way(s.view, current));
      sort_ranked();
      if (ranked_.empty()) return stop(StopReason::no_reachable_view);
    }
    Scored& chosen = ranked_[nearest_of_next(ranked_, current, least_gain())];
    // From where the arm stands now, the way there may be another.
    if (const auto view = reach(chosen.request, current)) rate(chosen, *view, current);
    last_ = chosen.request;
    return chosen.view;
  }

  void refused() override {
    if (last_) refused_.push_back(*last_);
    ++refused_first_;
  }

  StopReason stop_reason() const override { return reason_; }

  std::optional<Completeness> completeness() const override { return completeness_; }

  std::vector<ReachableView> candidates() const override {
    std::vector<ReachableView> views;
    views.reserve(ranked_.size());
    for (const Scored& s : ranked_) views.push_back(s.view);
    return views;
  }

  /// The planner's model of the truss.
  const ExpectedSurface& model() const { return model_; }

 private:
  static constexpr std::size_t kRefined = 8;

  struct Candidate {
    ViewRequest request;
    ReachableView view;
  };
  struct Scored {
    ViewRequest request;
    ReachableView view;
    std::vector<std::uint32_t> shown;
    double score = 0.0;
  };

  ViewRequest request(const Eigen::Vector3d& direction) const {
    return {model_.center(), direction, parameters_.distance, parameters_.distance_min, parameters_.distance_max};
  }

  /// The i-th wish: its place and distance follow a low-discrepancy sequence (Roberts' R4, powers of 1 / 1.1673).
  ViewRequest candidate(double i, const Eigen::Vector3d& direction, const Aabb& extent) const {
    const auto part = [](double x) { return x - std::floor(x); };
    const Eigen::Vector3d where(part(i * 0.8566748838545029), part(i * 0.7338918566271260),
                                part(i * 0.6287067210378087));
    ViewRequest wish = request(direction);
    wish.target += parameters_.spread * (where.array() - 0.5).matrix().cwiseProduct(extent.size());
    wish.distance = wish.distance_min + part(i * 0.5385972572236101) * (wish.distance_max - wish.distance_min);
    return wish;
  }

  bool was_refused(const ViewRequest& wish) const {
    return std::any_of(refused_.begin(), refused_.end(), [&](const ViewRequest& r) {
      return r.direction.dot(wish.direction) > 0.9999 && (r.target - wish.target).norm() < 0.01 &&
             std::abs(r.distance - wish.distance) < 0.01;
    });
  }

  /// The least gain (m2) that is worth a view.
  double least_gain() const { return parameters_.min_gain * std::max(model_.area(), 1e-6); }

  void sort_ranked() {
    std::stable_sort(ranked_.begin(), ranked_.end(),
                     [](const Scored& a, const Scored& b) { return a.score > b.score; });
  }

  /// Fill `ranked_` with the views worth taking, best first; why there is none otherwise.
  std::optional<StopReason> rank(const Joints& current, const Reach& reach) {
    for (const Candidate& c : candidates_) consider(c.request, c.view, current);
    std::vector<char> can_be_seen(model_.areas().size(), 0);
    for (const Scored& s : ranked_)
      for (std::uint32_t i : s.shown) can_be_seen[i] = 1;
    completeness_ = model_.completeness(can_be_seen);
    if (ranked_.empty()) return StopReason::no_reachable_view;
    // The best, by the shortest way from where the arm stands now, and more finely around them.
    sort_ranked();
    const double step = 0.5 * std::sqrt(4.0 * kPi / parameters_.candidates);
    for (std::size_t i = 0, n = std::min(kRefined, ranked_.size()); i < n; ++i) {
      throw_if_cancelled();
      const ViewRequest around = ranked_[i].request;
      if (const auto view = reach(around, current)) rate(ranked_[i], *view, current);
      const Eigen::Vector3d a = any_orthogonal<double>(around.direction), b = around.direction.cross(a);
      for (int k = 0; k < 6; ++k) {
        const double angle = kPi / 3.0 * k;
        ViewRequest wish = around;
        wish.direction = (around.direction + step * (std::cos(angle) * a + std::sin(angle) * b)).normalized();
        if (const auto view = reach(wish, current)) consider(wish, *view, current);
      }
    }
    const auto shows = [](const Scored& s) { return s.view.gain > 0.0; };
    const bool any = std::any_of(ranked_.begin(), ranked_.end(), shows);
    const auto poor = [least = least_gain()](const Scored& s) { return s.view.gain < least; };
    ranked_.erase(std::remove_if(ranked_.begin(), ranked_.end(), poor), ranked_.end());
    sort_ranked();
    if (ranked_.empty()) return any ? StopReason::low_gain : StopReason::no_frontier;
    return std::nullopt;
  }

  void rate(Scored& s, const ReachableView& view, const Joints& current) const {
    s.view = view;
    s.shown = model_.shown(view.world_T_optical);
    s.view.gain = 0.0;
    for (std::uint32_t i : s.shown) s.view.gain += double(model_.areas()[i]);
    s.score = s.view.gain / (parameters_.dwell + way(view, current));
  }

  void consider(const ViewRequest& wish, const ReachableView& view, const Joints& current) {
    throw_if_cancelled();
    if (was_refused(wish)) return;
    ranked_.emplace_back();
    ranked_.back().request = wish;
    rate(ranked_.back(), view, current);
  }

  /// Joint-space way to a view, in half turns; 0 where the caller moves without telling.
  static double way(const ReachableView& view, const Joints& from) {
    return view.joints ? (*view.joints - from).norm() / kPi : 0.0;
  }

  /// The views that would be chosen next, one after the other as far as the model knows; the one that the shortest way
  /// through all of them begins with.
  std::size_t nearest_of_next(const std::vector<Scored>& scored, const Joints& current, double least) const {
    std::vector<std::size_t> next{0};
    std::vector<float> areas = model_.areas();
    while (static_cast<int>(next.size()) < parameters_.lookahead) {
      for (std::uint32_t i : scored[next.back()].shown) areas[i] = 0.0f;
      const Joints from = scored[next.back()].view.joints.value_or(current);
      double best = 0.0;
      std::size_t choice = scored.size();
      for (std::size_t c = 0; c < scored.size(); ++c) {
        double gain = 0.0;
        for (std::uint32_t i : scored[c].shown) gain += double(areas[i]);
        const double score = gain / (parameters_.dwell + way(scored[c].view, from));
        if (gain >= least && score > best) best = score, choice = c;
      }
      if (choice == scored.size()) break;
      next.push_back(choice);
    }
    // By score first: of equal ways the best view begins.
    double shortest = std::numeric_limits<double>::infinity();
    std::size_t first = next.front();
    for (std::size_t k = 0; k < next.size(); ++k) {
      if (scored[next[k]].score < parameters_.patience * scored.front().score) continue;
      std::vector<std::size_t> rest = next;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      const double begun = way(scored[next[k]].view, current);
      const double length = begun + shortest_way(scored, next[k], rest, current, shortest - begun);
      if (length < shortest - 1e-12) shortest = length, first = next[k];
    }
    return first;
  }

  /// Length of the shortest way from view `at` through all of `rest`, or infinity where it is not below `bound`.
  static double shortest_way(const std::vector<Scored>& scored, std::size_t at, std::vector<std::size_t>& rest,
                             const Joints& current, double bound) {
    if (!(bound > 0.0)) return std::numeric_limits<double>::infinity();
    if (rest.empty()) return 0.0;
    double shortest = bound;
    for (std::size_t k = 0; k < rest.size(); ++k) {
      std::swap(rest[k], rest.back());
      const std::size_t then = rest.back();
      rest.pop_back();
      const double step = way(scored[then].view, scored[at].view.joints.value_or(current));
      shortest = std::min(shortest, step + shortest_way(scored, then, rest, current, shortest - step));
      rest.push_back(then);
      std::swap(rest[k], rest.back());
    }
    return shortest < bound ? shortest : std::numeric_limits<double>::infinity();
  }

  std::optional<ReachableView> stop(StopReason reason) {
    reason_ = reason;
    return std::nullopt;
  }

  GainPlannerParameters parameters_;
  SplitParameters split_;
  FreeSpaceParameters free_space_;
  Aabb volume_;
  Eigen::Vector3d eye_;
  ExpectedSurface model_;
  std::vector<Candidate> candidates_;
  Aabb extent_;                 // of the bodies when the candidates were made
  std::vector<Scored> ranked_;  // views worth taking after the last frame, best first; empty before they are looked at
  std::vector<ViewRequest> refused_;
  std::optional<ViewRequest> last_;
  std::optional<Completeness> completeness_;
  int refused_first_ = 0;
  StopReason reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::plan
