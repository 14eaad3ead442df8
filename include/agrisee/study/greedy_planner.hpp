// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A planner that knows the truth, for studies: how well the rest of the pipeline does when the choice of views costs
/// it nothing. It looks at nothing that a scan sees. World frame, metres, radians.
#pragma once

#include <agrisee/study/greedy.hpp>

#include <memory>

namespace agrisee::study {

/// The views of greedy_order as a planner: first the most frontal one, then always the one that covers most of what is
/// left. A view counts as taken when the planner is told of one (`observe`) after it named it; until then, or until it
/// is refused, `next` names it again. Views that were taken without being named change nothing.
class GreedyPlanner : public plan::Planner {
 public:
  /// @param observed  what is seen from where; shared, so that many planners can use one
  /// @param samples   those that `observed` speaks of
  /// @param volume    scan volume (m, world); the first view is the one that looks at its centre most frontally
  /// @param eye       the arm's base (m, world), from which frontal is reckoned, level
  /// @param radius    a sample is covered when one within this distance (m) is seen
  /// @throws InputError when either pointer is null, or when there are views and flags and samples differ in number;
  /// ParameterError for a radius that is not positive
  GreedyPlanner(std::shared_ptr<const Observability> observed, std::shared_ptr<const Samples> samples,
                const Aabb& volume, const Eigen::Vector3d& eye, double radius = 0.005)
      : observed_((check_input(observed && samples, "greedy planner: it needs to know what is seen from where"),
                   std::move(observed))),
        cover_(*observed_, *samples, radius),
        target_(volume.center()),
        forward_(plan::frontal_direction(volume, eye)) {}

  void observe(const plan::Progress&) override {
    if (!named_) return;
    cover_.take(*named_);
    named_.reset();
    begun_ = true;
  }

  /// The view's gain is the number of samples that it newly covers. Its joints are those with which it was found to be
  /// within reach, or, where that is the shorter move, those that `reach` answers now for the very same sensor pose.
  std::optional<plan::ReachableView> next(const plan::Progress&, const Joints& current,
                                          const plan::Reach& reach) override {
    if (!named_) named_ = begun_ ? cover_.best() : first();
    if (!named_) return std::nullopt;
    plan::ReachableView view = from_here(observed_->views[*named_], current, reach);
    view.gain = static_cast<double>(cover_.gain(*named_));
    return view;
  }

  /// The view last named is dropped for good.
  void refused() override {
    if (named_) cover_.drop(*named_);
    named_.reset();
  }

  /// `no_frontier` when everything that can be observed is covered; `no_reachable_view` when there is no view at all,
  /// or what is left shows in refused ones alone.
  StopReason stop_reason() const override {
    return cover_.all() > 0 && cover_.left() == 0 ? StopReason::no_frontier : StopReason::no_reachable_view;
  }

 private:
  std::optional<std::size_t> first() const {
    const Flags& dropped = cover_.dropped();
    if (std::all_of(dropped.begin(), dropped.end(), [](std::uint8_t d) { return d != 0; })) return std::nullopt;
    return most_frontal(*observed_, target_, forward_, dropped);
  }

  static plan::ReachableView from_here(plan::ReachableView view, const Joints& current, const plan::Reach& reach) {
    if (!view.joints) return view;  // no arm: nothing to be shorter
    view.move_time = arm::move_time(current, *view.joints);
    if (!reach) return view;
    const Pose& pose = view.world_T_optical;
    plan::ViewRequest request;
    request.target = view.target;
    request.direction = pose.linear().col(2);
    request.distance = request.distance_min = request.distance_max = (view.target - pose.translation()).norm();
    if (!(request.distance > 0.0)) return view;
    const auto again = reach(request, current);
    if (!again || !again->joints) return view;
    const double time = arm::move_time(current, *again->joints);
    // The pose stays as stored, to the last digit, so that a scan's views are those of greedy_order.
    const double apart = (again->world_T_optical.matrix() - pose.matrix()).cwiseAbs().maxCoeff();
    if (time < view.move_time && apart <= 1e-9) view.joints = again->joints, view.move_time = time;
    return view;
  }

  std::shared_ptr<const Observability> observed_;
  GreedyCover cover_;
  Eigen::Vector3d target_, forward_;
  std::optional<std::size_t> named_;  // by next, and neither taken nor refused
  bool begun_ = false;                // a named view has been taken
};

/// A planner that knows what the arm of a workcell can observe of the samples of a scene's fruit; it may outlive all of
/// them. Cost: about a second, see limit.hpp.
/// @throws ParameterError for unusable parameters or an unsound mounting
inline std::unique_ptr<GreedyPlanner> make_greedy_planner(const TracedScene& scene, const Samples& samples,
                                                          const Workcell& cell, const LimitParameters& params = {},
                                                          int threads = 1) {
  auto observed = std::make_shared<const Observability>(observable(scene, samples, cell, params, threads));
  return std::make_unique<GreedyPlanner>(std::move(observed), std::make_shared<const Samples>(samples),
                                         cell.scan_volume, cell.world_T_base.translation(), params.cover_radius);
}

}  // namespace agrisee::study
