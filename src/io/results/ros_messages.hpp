// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages of ROS 2 as bytes (CDR), and their definitions as MCAP files hold them. Metres, radians; times in ns.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/result.hpp>
#include <agrisee/sensor/camera_info.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace agrisee::io::ros {

/// A type of message: its name and definition ("ros2msg").
struct Type {
  const char *name, *definition;
};
extern const Type kImage, kCameraInfo, kTransforms, kJointState, kPointCloud;

/// Time and frame of a message.
struct Header {
  std::uint64_t time = 0;  ///< ns
  std::string frame;
};

/// A depth image as it is stored.
struct Image {
  Header header;
  std::uint32_t width = 0, height = 0, step = 0;  ///< pixels, and bytes a row
  std::string encoding;                           ///< "32FC1" (m), "16UC1" or "mono16" (mm)
  bool big_endian = false;
  std::string_view data;  ///< valid as long as the message
};

/// A camera.
struct CameraInfo {
  Header header;
  sensor::CameraInfo camera;
};

/// One transform: frame_T_child at a time.
struct Transform {
  Header header;
  std::string child;
  Pose pose = Pose::Identity();
};

/// The time in the header is within this many bytes of the beginning of a message.
constexpr std::uint64_t kTimeSize = 12;

// Take messages apart. All throw InputError for a message that is too short or says the impossible.
Image read_image(std::string_view message);
/// The time (ns) of a message that begins with a header; kTimeSize bytes are enough.
std::uint64_t read_time(std::string_view message);
CameraInfo read_camera_info(std::string_view message);
std::vector<Transform> read_transforms(std::string_view message);

/// The depths (m) of an image; no return is 0. @throws InputError for another encoding or size than its data
std::vector<float> depths_of(const Image& image);

// Compose messages.
std::string image_message(const Header& header, const sensor::DepthFrame& frame);
std::string camera_info_message(const Header& header, const sensor::Intrinsics& intrinsics);
std::string transform_message(const Header& header, const std::string& child, const Pose& pose);
std::string joint_state_message(const Header& header, const Joints& joints);
/// x y z, and the fruit of each point (0 = none) as `instance`.
std::string cloud_message(const Header& header, const Cloud& cloud, const std::vector<int>& labels);

}  // namespace agrisee::io::ros
