// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/mount.hpp>

namespace agrisee::arm {

void Mount::check() const {
  if (!is_rigid(world_T_base)) throw ParameterError("world_T_base must be a finite rigid pose");
  if (!is_rigid(tool0_T_optical)) throw ParameterError("tool0_T_optical must be a finite rigid pose");
  model.check();
  check_parameter(sensor.radius > 0.0 && std::isfinite(sensor.radius), "sensor.housing_radius", "positive",
                  sensor.radius);
  check_parameter(sensor.depth > 0.0 && std::isfinite(sensor.depth), "sensor.housing_depth", "positive", sensor.depth);
  for (const KeepOut& space : keep_out) space.check();
}

OrientedCylinder housing(const SensorBody& sensor, const Pose& world_T_optical) {
  const Eigen::Vector3d axis = world_T_optical.linear().col(2);
  return {world_T_optical.translation() - 0.5 * sensor.depth * axis, axis, sensor.radius, sensor.depth};
}

}  // namespace agrisee::arm
