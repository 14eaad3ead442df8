// SPDX-License-Identifier: BSD-3-Clause
// ROS messages whose sizes, offsets and types are whatever the bytes say; the first byte chooses cloud or image.
#include <agrisee/interop/ros.hpp>

#include <cmath>
#include <cstring>

#include "support/ros_messages.hpp"
#include "targets.hpp"

namespace agrisee::fuzz {
namespace {

/// Takes numbers off the front; zeros once the bytes are used up.
struct Bytes {
  const std::uint8_t* data;
  std::size_t size;

  template <typename T>
  T take() {
    T value{};
    const std::size_t n = std::min(sizeof value, size);
    std::memcpy(&value, data, n);
    data += n;
    size -= n;
    return value;
  }
  /// What is left, in memory of its own, so that a sanitizer sees who reads past it.
  std::vector<std::uint8_t> rest() const { return {data, data + size}; }
};

void cloud(Bytes bytes) {
  mock::PointCloud2 message;
  message.width = bytes.take<std::uint32_t>();
  message.height = bytes.take<std::uint32_t>();
  message.point_step = bytes.take<std::uint32_t>();
  message.row_step = bytes.take<std::uint32_t>();
  message.is_bigendian = bytes.take<std::uint8_t>() % 2 == 1;
  message.fields.resize(bytes.take<std::uint8_t>() % 6);
  for (mock::PointField& field : message.fields) {
    field.name = std::string(1, "xyzi"[bytes.take<std::uint8_t>() % 4]);
    field.offset = bytes.take<std::uint32_t>();
    field.datatype = bytes.take<std::uint8_t>();
    field.count = bytes.take<std::uint8_t>();
  }
  message.data = bytes.rest();
  const interop::PointCloud2View<mock::PointCloud2> view(message);
  const interop::PointCloud2View<mock::PointCloud2, double> wide(message);
  require(view.size() == std::uint64_t(message.width) * message.height, "as many points as the message says");
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Eigen::Vector3f p = view.point(i), q = wide.point(i).cast<float>();
    for (int a = 0; a < 3; ++a) require(p[a] == q[a] || std::isnan(p[a]), "either scalar reads the same");
  }
}

void image(Bytes bytes) {
  mock::Image message;
  message.width = bytes.take<std::uint32_t>();
  message.height = bytes.take<std::uint32_t>();
  message.step = bytes.take<std::uint32_t>();
  const auto kind = bytes.take<std::uint8_t>();
  message.is_bigendian = kind & 1;
  message.encoding = kind & 2 ? "16UC1" : kind & 4 ? "32FC1" : "rgb8";
  mock::CameraInfo info;
  info.width = kind & 8 ? bytes.take<std::uint32_t>() : message.width;
  info.height = kind & 8 ? bytes.take<std::uint32_t>() : message.height;
  if (kind & 16) info.roi.width = bytes.take<std::uint8_t>();
  if (kind & 32) info.d.assign(5, bytes.take<double>());
  for (const std::size_t at : {0, 2, 4, 5}) info.k[at] = kind & 64 ? bytes.take<double>() : 100.0;
  message.data = bytes.rest();
  const sensor::DepthFrame frame = interop::depth_frame(message, info, (kind & 128) != 0);
  require(frame.depth.size() == std::size_t(message.width) * message.height, "as many depths as pixels");
  check(frame);
}

}  // namespace

void messages(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const Bytes bytes{data + 1, size - 1};
  attempt([&] { data[0] % 2 == 0 ? cloud(bytes) : image(bytes); });
}

}  // namespace agrisee::fuzz
