// SPDX-License-Identifier: BSD-3-Clause
#include "input_checks.hpp"

#include <agrisee/core/rigid_pose.hpp>

#include <cmath>

namespace agrisee {
namespace {

/// @throws InputError for a volume that cannot be scanned
void check_volume(const Aabb& volume) {
  const Eigen::Vector3d lengths = volume.size();
  check_input(lengths.minCoeff() > 0.0 && lengths.allFinite(), "the scan volume is empty, flat or infinite");
  constexpr double kLargest = 50.0;  // m; no arm sees as much, and a truss in millimetres is larger
  const double size = lengths.maxCoeff();
  if (size > kLargest)
    throw InputError("the scan volume is " + std::to_string(std::lround(size)) +
                     " m long: is it in millimetres? Lengths have to be in metres");
  if (volume.min.cwiseAbs().cwiseMax(volume.max.cwiseAbs()).maxCoeff() > kFarFromOrigin)
    throw InputError(far_from_origin("the scan volume", volume.center().norm(), "it, and from all poses"));
}

}  // namespace

std::string far_from_origin(const std::string& what, double distance, const std::string& from) {
  return what + " lies " + metres(distance) +
         " from the origin, too far for coordinates in single precision: is it in millimetres? If not, subtract an "
         "offset from " +
         from;
}

void check_workcell(Workcell& workcell, bool own_arm, std::vector<std::string>& notes) {
  check_volume(workcell.scan_volume);
  workcell.world_T_base = made_rigid(workcell.world_T_base, "world_T_base", &notes);
  workcell.tool0_T_optical = made_rigid(workcell.tool0_T_optical, "tool0_T_optical", &notes);
  if (const auto fault = fault_of_hand_eye(workcell)) throw InputError("tool0_T_optical: " + *fault);
  if (workcell.tool0_T_tool) workcell.tool0_T_tool = made_rigid(*workcell.tool0_T_tool, "tool0_T_tool", &notes);
  if (const auto fault = fault_of_gripper(workcell)) throw InputError("tool0_T_tool: " + *fault);
  workcell.sensor.check();
  for (const KeepOut& space : workcell.keep_out) space.check();
  check_input(workcell.start.allFinite(), "start: the joints are not finite");
  if (own_arm) check_joints("start", workcell, workcell.start);
}

void check_joints(const char* name, const Workcell& workcell, const Joints& joints, double slack) {
  const std::string complaint = workcell.arm.limits.complaint(joints, slack);
  if (!complaint.empty()) throw InputError(std::string(name) + ": " + complaint);
}

void check_distance(const std::string& who, const Eigen::Vector3d& sensor, const Aabb& box, const char* what) {
  constexpr double kFarthest = 20.0;  // m; depth cameras see less far, and 20 mm are nearer than any of them sees
  const double distance = box.distance(sensor);
  if (!(distance <= kFarthest))
    throw InputError(who + " stood " + metres(distance) + " from " + what +
                     ": is its position in millimetres? Positions have to be in metres, in the frame of " + what);
}

}  // namespace agrisee
