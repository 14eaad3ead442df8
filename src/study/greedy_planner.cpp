// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/plan/directions.hpp>
#include <agrisee/study/greedy_planner.hpp>

#include <algorithm>
#include <utility>

namespace agrisee::study {
namespace {

/// A stored view as the arm takes it from its present joints: with other joints for the same pose if `reach` knows any
/// that are nearer.
plan::ReachableView from_here(plan::ReachableView view, const Joints& current, const plan::Reach& reach,
                              const arm::JointLimits& limits) {
  if (!view.joints) return view;  // without an arm no move is shorter
  view.move_time = arm::move_time(current, *view.joints, limits);
  if (!reach) return view;
  const Pose& pose = view.world_T_optical;
  plan::ViewRequest request;
  request.target = view.target;
  request.direction = pose.linear().col(2);
  request.distance = request.distance_min = request.distance_max = (view.target - pose.translation()).norm();
  if (!(request.distance > 0.0)) return view;
  const auto again = reach(request, current);
  if (!again || !again->joints) return view;
  const double time = arm::move_time(current, *again->joints, limits);
  // The stored pose is kept to the last bit, so that a scan takes exactly the views of greedy_order().
  const double difference = (again->world_T_optical.matrix() - pose.matrix()).cwiseAbs().maxCoeff();
  if (time < view.move_time && difference <= 1e-9) view.joints = again->joints, view.move_time = time;
  return view;
}

}  // namespace

GreedyPlanner::GreedyPlanner(std::shared_ptr<const Observability> observed, std::shared_ptr<const Samples> samples,
                             const Aabb& volume, const Eigen::Vector3d& robot, const arm::JointLimits& limits,
                             double radius)
    : observed_((check_input(observed && samples, "greedy planner: it needs observability and samples"),
                 std::move(observed))),
      cover_(*observed_, *samples, radius),
      target_(volume.center()),
      forward_(plan::frontal_direction(volume, robot)),
      limits_(limits) {
  limits_.check();
}

void GreedyPlanner::observe(const plan::Progress&) {
  if (!asked_for_) return;
  cover_.take(*asked_for_);
  asked_for_.reset();
  begun_ = true;
}

std::optional<plan::ReachableView> GreedyPlanner::next(const plan::Progress&, const Joints& current,
                                                       const plan::Reach& reach) {
  if (!asked_for_) asked_for_ = begun_ ? cover_.best() : first();
  if (!asked_for_) return std::nullopt;
  plan::ReachableView view = from_here(observed_->views[*asked_for_], current, reach, limits_);
  view.gain = static_cast<double>(cover_.gain(*asked_for_));
  return view;
}

void GreedyPlanner::refused() {
  if (asked_for_) cover_.drop(*asked_for_);
  asked_for_.reset();
}

StopReason GreedyPlanner::stop_reason() const {
  return cover_.all() > 0 && cover_.left() == 0 ? StopReason::no_frontier : StopReason::no_reachable_view;
}

std::optional<std::size_t> GreedyPlanner::first() const {
  const Flags& dropped = cover_.dropped();
  if (std::all_of(dropped.begin(), dropped.end(), [](std::uint8_t d) { return d != 0; })) return std::nullopt;
  return most_frontal(*observed_, target_, forward_, dropped);
}

std::unique_ptr<GreedyPlanner> make_greedy_planner(const TracedScene& scene, const Samples& samples,
                                                   const Workcell& cell, const LimitParameters& parameters,
                                                   int threads) {
  auto observed = std::make_shared<const Observability>(observable(scene, samples, cell, parameters, threads));
  return std::make_unique<GreedyPlanner>(std::move(observed), std::make_shared<const Samples>(samples),
                                         cell.scan_volume, cell.world_T_base.translation(), cell.arm.limits,
                                         parameters.cover_radius);
}

}  // namespace agrisee::study
