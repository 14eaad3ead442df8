// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/reachability.hpp>
#include <agrisee/core/rigid_pose.hpp>
#include <agrisee/geometry/angle.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace agrisee::plan {
namespace {

/// @throws InputError for an answer that is not the view requested
void check_answer(const ViewRequest& request, const ReachableView& view) {
  constexpr double kOff = 0.1, kFarther = 0.02, kTurned = deg(15);  // m, m, rad
  check_input(is_rigid(view.world_T_optical), "reach: world_T_optical of its answer is not a rigid pose");
  const Eigen::Vector3d target = view.world_T_optical.inverse(Eigen::Isometry) * request.target;
  if (!(target.z() > 0.0) || !(target.head<2>().norm() <= kOff))
    throw InputError(
        "reach: the view of its answer does not look at the requested target: in the optical frame (z "
        "forward) the target is at " +
        metres(target.x()) + ", " + metres(target.y()) + ", " + metres(target.z()) +
        ". Is world_T_optical set, and the pose of the optical frame?");
  const double distance = target.norm();
  if (!(distance >= request.distance_min - kFarther && distance <= request.distance_max + kFarther))
    throw InputError("reach: the view of its answer is " + metres(distance) +
                     " from the target, but distance_min and distance_max of the request are " +
                     metres(request.distance_min) + " and " + metres(request.distance_max));
  const Eigen::Vector3d sight = (request.target - view.world_T_optical.translation()) / distance;
  const double turned = angle_between(sight, request.direction);
  if (!(turned <= kTurned))
    throw InputError("reach: the view of its answer sees the target from " + number_text(turned / deg(1), 3) +
                     " degrees beside the requested direction");
  check_input(!view.joints || view.joints->allFinite(), "reach: the joints of its answer are not finite");
  check_input(std::isfinite(view.move_time) && view.move_time >= 0.0,
              "reach: move_time of its answer is negative or not finite");
}

}  // namespace

arm::Mount mount_of(const Workcell& workcell) {
  arm::Mount mount;
  mount.model = workcell.arm;
  mount.world_T_base = workcell.world_T_base;
  mount.tool0_T_optical = workcell.tool0_T_optical;
  mount.keep_out = workcell.keep_out;
  mount.sensor.radius = workcell.sensor.housing_radius;
  mount.sensor.depth = workcell.sensor.housing_depth;
  return mount;
}

std::optional<ViewRequest> within_range(ViewRequest request, const sensor::DepthCamera& camera) {
  request.distance_min = std::max(request.distance_min, camera.range_min);
  request.distance_max = std::min(request.distance_max, camera.range_max);
  if (request.distance_min > request.distance_max) return std::nullopt;
  request.distance = std::clamp(request.distance, request.distance_min, request.distance_max);
  return request;
}

Reach reach_of(const Workcell& workcell) {
  const arm::Mount mount = mount_of(workcell);
  mount.check();
  const sensor::DepthCamera camera = workcell.sensor;
  return [mount, camera](const ViewRequest& asked, const Joints& current) -> std::optional<ReachableView> {
    const auto request = within_range(asked, camera);
    if (!request) return std::nullopt;
    arm::ReachParameters parameters;
    parameters.distance_min = request->distance_min;
    parameters.distance_max = request->distance_max;
    parameters.distance = request->distance;
    const auto reached = arm::reach(mount, current, request->target, request->direction, parameters);
    if (!reached) return std::nullopt;
    ReachableView view;
    view.world_T_optical = reached->world_T_optical;
    view.target = request->target;
    view.joints = reached->joints;
    view.move_time = reached->move_time;
    return view;
  };
}

Reach checked(Reach reach, const sensor::DepthCamera& camera) {
  return [reach = std::move(reach), camera](const ViewRequest& asked, const Joints& current) {
    const auto request = within_range(asked, camera);
    const std::optional<ReachableView> view = request ? reach(*request, current) : std::nullopt;
    if (view) check_answer(*request, *view);
    return view;
  };
}

}  // namespace agrisee::plan
