// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/reachability.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include <algorithm>

namespace agrisee::plan {

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

Reach reach_of(const Workcell& workcell) {
  const arm::Mount mount = mount_of(workcell);
  mount.check();
  const double nearest = workcell.sensor.range_min, farthest = workcell.sensor.range_max;
  return [mount, nearest, farthest](const ViewRequest& request, const Joints& current) -> std::optional<ReachableView> {
    arm::ReachParameters parameters;
    parameters.distance_min = std::max(request.distance_min, nearest);
    parameters.distance_max = std::min(request.distance_max, farthest);
    if (parameters.distance_min > parameters.distance_max) return std::nullopt;
    parameters.distance = std::clamp(request.distance, parameters.distance_min, parameters.distance_max);
    const auto reached = arm::reach(mount, current, request.target, request.direction, parameters);
    if (!reached) return std::nullopt;
    ReachableView view;
    view.world_T_optical = reached->world_T_optical;
    view.target = request.target;
    view.joints = reached->joints;
    view.move_time = reached->move_time;
    return view;
  };
}

}  // namespace agrisee::plan
