// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/angle.hpp>
#include <agrisee/pick/approach.hpp>

#include <string>
#include <utility>

namespace agrisee::pick {
namespace {

/// @throws InputError for an answer that is none to the request
void check_answer(const ApproachRequest& request, const ApproachAnswer& answer) {
  constexpr double kOff = 0.002, kTurned = deg(1);  // m, rad
  if (!answer.reached) {
    check_input(answer.reason != PickingReason::reachable,
                "approach: its answer is not `reached`, but has the reason reachable");
    return;
  }
  if (answer.reason != PickingReason::reachable)
    throw InputError("approach: its answer is `reached`, but has the reason " + std::string(to_string(answer.reason)) +
                     " instead of reachable");
  const Pose& pose = answer.reached->world_T_pre_grasp;
  check_input(is_rigid(pose), "approach: world_T_pre_grasp of its answer is not a rigid pose");
  const double off = (pose.translation() - request.start).norm();
  if (!(off <= kOff))
    throw InputError("approach: the origin of world_T_pre_grasp of its answer is " + metres(off) +
                     " from the start of the request. Is it the pose of the gripping point, in world and in metres?");
  const double turned = angle_between(pose.linear().col(2), request.direction);
  if (!(turned <= kTurned))
    throw InputError("approach: the z axis of world_T_pre_grasp of its answer is " + number_text(turned / deg(1), 3) +
                     " degrees beside the direction of the request");
  check_input(!answer.reached->joints || answer.reached->joints->allFinite(),
              "approach: the joints of its answer are not finite");
}

}  // namespace

double surface_distance(const OrientedEllipsoid& ellipsoid, const Eigen::Vector3d& direction) {
  return 1.0 / (ellipsoid.axes.transpose() * direction).cwiseQuotient(ellipsoid.radii).norm();
}

Capsule swept_gripper(const OrientedEllipsoid& fruit, const Eigen::Vector3d& direction,
                      const PickingParameters& parameters) {
  const double surface = surface_distance(fruit, direction);
  return {fruit.center - (surface + parameters.stand_off + parameters.tool_length) * direction, fruit.center,
          parameters.gripper_radius};
}

Capsule short_of_center(const Capsule& swept) {
  const Eigen::Vector3d along = swept.b - swept.a;
  const double length = along.norm();
  if (!(length > swept.radius)) return {swept.a, swept.a, swept.radius};
  return {swept.a, swept.b - swept.radius / length * along, swept.radius};
}

bool meets(const Capsule& capsule, const OrientedEllipsoid& ellipsoid) {
  const double apart = segment_distance(capsule.a, capsule.b, ellipsoid.center, ellipsoid.center);
  if (apart >= capsule.radius + ellipsoid.radii.maxCoeff()) return false;
  if (apart < capsule.radius + ellipsoid.radii.minCoeff() - kTouch) return true;
  return distance(ellipsoid, capsule.a, capsule.b) < touching_distance(capsule.radius);
}

ReachApproach checked(ReachApproach approach) {
  if (!approach) return approach;
  return [approach = std::move(approach)](const ApproachRequest& request, const Joints& current) {
    ApproachAnswer answer = approach(request, current);
    check_answer(request, answer);
    return answer;
  };
}

}  // namespace agrisee::pick
