// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/mount.hpp>

#include <algorithm>
#include <cmath>

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

bool on_last_axis(const Pose& tool0_T_frame) {
  const Eigen::Vector3d offset = tool0_T_frame.translation(), ahead = tool0_T_frame.linear().col(2);
  return std::max({std::abs(offset.x()), std::abs(offset.y()), std::abs(ahead.x()), std::abs(ahead.y())}) < 1e-9;
}

OrientedCylinder housing(const SensorBody& sensor, const Pose& world_T_optical) {
  const Eigen::Vector3d axis = world_T_optical.linear().col(2);
  return {world_T_optical.translation() - 0.5 * sensor.depth * axis, axis, sensor.radius, sensor.depth};
}

}  // namespace agrisee::arm
