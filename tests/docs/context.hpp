// SPDX-License-Identifier: BSD-3-Clause
// What the reader of a document has: the names beginning with `my_` in its C++ blocks, and the messages that came. They
// are only declared.
#pragma once

#include <agrisee/agrisee.hpp>

#include <cstdint>

#include "../support/ros_messages.hpp"

std::vector<Eigen::Vector3f> my_points();
std::vector<float> my_buffer();
std::vector<std::uint16_t> my_image();
agrisee::sensor::Intrinsics my_intrinsics();
agrisee::Workcell my_cell();
std::optional<agrisee::Joints> my_inverse_kinematics(const agrisee::Pose& world_T_optical, const agrisee::Joints& near);
double my_time_to_move(const agrisee::Joints& from, const agrisee::Joints& to);

extern const mock::PointCloud2 message;
extern const mock::Image image;
extern const mock::CameraInfo camera_info;
