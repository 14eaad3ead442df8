// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Checks of what a scan or a ready cloud is given: the workcell, joints, and the places of its sensors.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/workcell.hpp>

#include <string>
#include <vector>

namespace agrisee {

/// Farther from the origin (m) single precision is too coarse: there it has steps of 0.06 mm.
constexpr double kFarFromOrigin = 1000.0;

/// That something is too far from the origin, and what to do.
/// @param distance m
/// @param from of what an offset has to be subtracted
std::string far_from_origin(const std::string& what, double distance, const std::string& from);

/// Check the workcell of a scan, and make its poses rigid.
/// @param own_arm whether the model in `workcell` describes the arm
/// @param notes receives a sentence for each pose that was changed
/// @throws ParameterError, InputError that name the field, as Pipeline's constructor
void check_workcell(Workcell& workcell, bool own_arm, std::vector<std::string>& notes);

/// @param slack how far joints may be outside of the limits of the workcell's arm (rad)
/// @throws InputError for joint angles farther outside
void check_joints(const char* name, const Workcell& workcell, const Joints& joints, double slack = 0.0);

/// @param who begins the message: "a sensor"
/// @param box what the sensor saw (m), and `what` it is: "the cloud"
/// @throws InputError if the sensor stood farther from all of it than any sensor sees, so that its position must be in
///   millimetres
void check_distance(const std::string& who, const Eigen::Vector3d& sensor, const Aabb& box, const char* what);

}  // namespace agrisee
