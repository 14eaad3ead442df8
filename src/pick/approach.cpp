// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/pick/approach.hpp>

namespace agrisee::pick {

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

}  // namespace agrisee::pick
