// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The default planner: of the views that the arm can take, the one expected to show the most new fruit surface for its time.
///
/// Candidates look at the truss from directions spread over the sphere; those within reach are kept. Each is scored by
/// ExpectedSurface::gain over the time of dwelling and moving; around the best the search is repeated more finely. The scan
/// ends when the best view promises less than `min_gain` of the fruit surface known so far. Metres, seconds, world.
#pragma once

#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/expected_surface.hpp>


namespace agrisee::plan {

/// Parameters of GainPlanner.
struct GainPlannerParameters {
  int directions = 180;            ///< candidate directions over the whole sphere
  double distance = 0.38;          ///< preferred distance from the target (m)
  double distance_min = 0.27;      ///< nearest (m)
  double distance_max = 0.55;      ///< farthest (m)
  double dwell = 1.5;              ///< time that a view costs beside the move (s): settling, exposure, computing
  double min_gain = 0.003;         ///< stop when the best view promises less than this share of the known fruit surface
  ExpectedSurfaceParameters expected;

  /// @throws ParameterError
  void check() const {
    check_parameter(directions >= 1 && directions <= 100000, "planner.directions", "in [1, 100000]", directions);
    check_parameter(distance_min > 0, "planner.distance_min", "positive", distance_min);
    check_parameter(distance >= distance_min, "planner.distance", ">= distance_min", distance);
    check_parameter(distance_max >= distance, "planner.distance_max", ">= distance", distance_max);
    check_parameter(dwell > 0, "planner.dwell", "positive", dwell);
    check_parameter(min_gain >= 0, "planner.min_gain", ">= 0", min_gain);
    expected.check();
  }
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("directions", p.directions);
    f("distance", p.distance);
    f("distance_min", p.distance_min);
    f("distance_max", p.distance_max);
    f("dwell", p.dwell);
    f("min_gain", p.min_gain);
    f("expected", p.expected);
  }
};

/// See the file's head.
class GainPlanner : public Planner {
 public:
  /// @param eye the arm's base in world, from which the truss is first looked at
  /// @throws ParameterError
  GainPlanner(const sensor::L515& sensor, const Aabb& volume, const Eigen::Vector3d& eye, const SplitParameters& split,
              const FreeSpaceParameters& free_space, const GainPlannerParameters& parameters = {})
      : parameters_(parameters), split_(split), free_space_(free_space), volume_(volume), eye_(eye),
        model_(sensor, volume, parameters.expected) {
    parameters_.check();
  }

  void observe(const Progress& progress) override {
    model_.update(progress, split_, free_space_);
    refused_.clear();
    refused_first_ = 0;
  }

  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override {
    const auto taken = static_cast<int>(progress.views.size());
    if (progress.cloud.empty()) {
      // Nothing seen so far: a few more tries near the front, then that is the answer.
      if (taken >= 4) return stop(StopReason::nothing_seen);
      auto view = first_view(volume_, eye_, current, reach, request(Eigen::Vector3d::UnitY()), refused_first_ + 12 * taken);
      if (!view && taken > 0) return stop(StopReason::nothing_seen);
      if (!view) return stop(StopReason::no_reachable_view);
      return view;
    }
    if (candidates_.empty() || (center_ - model_.center()).norm() > 0.02) {
      center_ = model_.center();
      candidates_.clear();
      for (const Eigen::Vector3d& d : spread_directions(parameters_.directions))
        if (auto view = reach(request(d), current)) candidates_.push_back({d, *view});
    }
    std::vector<Scored> scored;
    for (const Candidate& c : candidates_) consider(scored, c.direction, c.view, current);
    if (scored.empty()) return stop(StopReason::no_reachable_view);
    const auto better = [](const Scored& a, const Scored& b) { return a.score > b.score; };
    std::stable_sort(scored.begin(), scored.end(), better);
    // More finely around the best.
    const std::size_t seeds = std::min<std::size_t>(4, scored.size());
    const double step = 0.5 * std::sqrt(4.0 * kPi / parameters_.directions);
    for (std::size_t i = 0; i < seeds; ++i) {
      const Eigen::Vector3d d = scored[i].direction;
      const Eigen::Vector3d a = any_orthogonal<double>(d), b = d.cross(a);
      for (int k = 0; k < 6; ++k) {
        const double angle = kPi / 3.0 * k;
        const Eigen::Vector3d nearby = (d + step * (std::cos(angle) * a + std::sin(angle) * b)).normalized();
        if (const auto view = reach(request(nearby), current)) consider(scored, nearby, *view, current);
      }
    }
    std::stable_sort(scored.begin(), scored.end(), better);
    const double least = parameters_.min_gain * std::max(model_.area(), 1e-6);
    double best_gain = 0.0;
    for (const Scored& s : scored) {
      best_gain = std::max(best_gain, s.view.gain);
      if (s.view.gain < least) continue;
      // From where the arm stands now, the way there may be another.
      auto view = reach(request(s.direction), current);
      if (!view) continue;
      view->gain = s.view.gain;
      last_ = s.direction;
      return view;
    }
    return stop(best_gain > 0.0 ? StopReason::low_gain : StopReason::no_frontier);
  }

  void refused() override {
    if (last_) refused_.push_back(*last_);
    ++refused_first_;
  }

  StopReason stop_reason() const override { return reason_; }

  /// The planner's model of the truss.
  const ExpectedSurface& model() const { return model_; }

 private:
  struct Candidate {
    Eigen::Vector3d direction;
    ReachableView view;
  };
  struct Scored {
    Eigen::Vector3d direction;
    ReachableView view;
    double score;
  };

  ViewRequest request(const Eigen::Vector3d& direction) const {
    return {center_, direction, parameters_.distance, parameters_.distance_min, parameters_.distance_max};
  }

  void consider(std::vector<Scored>& scored, const Eigen::Vector3d& direction, ReachableView view, const Joints& current) const {
    for (const Eigen::Vector3d& r : refused_)
      if (r.dot(direction) > 0.9999) return;
    view.gain = model_.gain(view.world_T_optical);
    const double move = view.joints ? (*view.joints - current).cwiseAbs().maxCoeff() / kPi : 0.0;
    scored.push_back({direction, view, view.gain / (parameters_.dwell + move)});
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
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> refused_;
  std::optional<Eigen::Vector3d> last_;
  int refused_first_ = 0;
  StopReason reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::plan
