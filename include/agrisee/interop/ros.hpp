// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads ROS messages in place: `sensor_msgs/PointCloud2` as a cloud, `sensor_msgs/Image` with `CameraInfo` as a depth
/// frame, with the colors and the labels of a detector from further images.
///
/// The message types are template parameters, so both ROS 1 and ROS 2 are supported and no ROS header is included. A
/// message is checked before it is read: even if its sizes are wrong, nothing outside its data is accessed.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/sensor/camera_info.hpp>
#include <agrisee/sensor/depth_encoding.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/rectify.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <type_traits>

namespace agrisee::interop {

namespace detail {

/// Throw InputError("<what>: <message>") unless `ok`.
inline void check_message(bool ok, const char* what, const std::string& message) {
  if (!ok) throw InputError(std::string(what) + ": " + message);
}

inline bool host_is_big_endian() {
  const std::uint16_t one = 1;
  std::uint8_t first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}

/// A number of type T from bytes that need not be aligned, in reverse order where `swap`.
template <typename T>
T read_number(const std::uint8_t* bytes, bool swap) {
  std::array<std::uint8_t, sizeof(T)> own;
  std::memcpy(own.data(), bytes, sizeof(T));
  if (swap) std::reverse(own.begin(), own.end());
  T value;
  std::memcpy(&value, own.data(), sizeof(T));
  return value;
}

/// The camera matrix is named K and P in ROS 1, k and p in ROS 2.
template <typename Info, typename = void>
struct InRos1 : std::false_type {};
template <typename Info>
struct InRos1<Info, std::void_t<decltype(std::declval<const Info&>().K)>> : std::true_type {};

}  // namespace detail

/// A view of the points of a `sensor_msgs/PointCloud2` as a cloud (see core/traits.hpp) of scalar S. Its fields x, y
/// and z must all be float32 or all float64, at any offsets, strides and byte order; other fields are ignored. Points
/// that are not finite (pixels without return) keep their places: indices are those of the message, row by row, and
/// each stage skips such points.
///
/// The view holds a reference: the message must outlive it unchanged.
template <typename Message, typename S = float>
class PointCloud2View {
 public:
  /// O(number of fields).
  /// @throws InputError for a message without x, y or z, of another datatype, whose fields exceed the point, whose
  /// points exceed the row, whose data are shorter than its rows, or with more points than an Index counts
  explicit PointCloud2View(const Message& message) : data_(message.data.data()) {
    const std::uint64_t width = message.width, height = message.height, step = message.point_step,
                        row = message.row_step;
    const auto check = [](bool ok, const std::string& text) { detail::check_message(ok, "PointCloud2", text); };
    check(width * height <= static_cast<std::uint64_t>(std::numeric_limits<Index>::max()),
          std::to_string(width) + " x " + std::to_string(height) + " points are too many");
    size_ = static_cast<std::size_t>(width * height);
    if (size_ == 0) return;
    check(row >= width * step, "row_step " + std::to_string(row) + " is below width * point_step");
    check(row <= std::numeric_limits<std::uint64_t>::max() / height && row * height <= message.data.size(),
          "data hold " + std::to_string(message.data.size()) + " bytes, row_step * height says more");
    width_ = static_cast<std::size_t>(width);
    point_step_ = static_cast<std::size_t>(step);
    row_step_ = static_cast<std::size_t>(row);
    gapless_ = row == width * step;
    swap_ = static_cast<bool>(message.is_bigendian) != detail::host_is_big_endian();
    int type = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const auto has_name = [&](const auto& f) { return f.name == name; };
      const auto field = std::find_if(message.fields.begin(), message.fields.end(), has_name);
      check(field != message.fields.end(), "no field '" + name + "'");
      check(std::count_if(message.fields.begin(), message.fields.end(), has_name) == 1, "field '" + name + "' twice");
      const int datatype = field->datatype;
      check(datatype == kFloat32 || datatype == kFloat64,
            "field '" + name + "' is neither FLOAT32 nor FLOAT64 but type " + std::to_string(datatype));
      check(axis == 0 || datatype == type, "x, y and z differ in their type");
      check(field->count <= 1, "field '" + name + "' holds several values");
      const std::uint64_t offset = field->offset, bytes = datatype == kFloat64 ? 8 : 4;
      check(offset + bytes <= step, "field '" + name + "' at offset " + std::to_string(offset) +
                                        " lies outside of point_step " + std::to_string(step));
      type = datatype;
      offsets_[axis] = static_cast<std::size_t>(offset);
    }
    double_ = type == kFloat64;
  }
  explicit PointCloud2View(const Message&&) = delete;

  /// Number of points, including those that are not finite.
  std::size_t size() const { return size_; }
  /// Point i < size() (m, in the frame of the message's header).
  Vector3<S> point(std::size_t i) const {
    const std::size_t start = gapless_ ? i * point_step_ : (i / width_) * row_step_ + (i % width_) * point_step_;
    return {read(start + offsets_[0]), read(start + offsets_[1]), read(start + offsets_[2])};
  }

 private:
  static constexpr int kFloat32 = 7, kFloat64 = 8;  // sensor_msgs/PointField

  S read(std::size_t at) const {
    return double_ ? static_cast<S>(detail::read_number<double>(data_ + at, swap_))
                   : static_cast<S>(detail::read_number<float>(data_ + at, swap_));
  }

  const std::uint8_t* data_;
  std::size_t size_ = 0, width_ = 0, point_step_ = 0, row_step_ = 0;
  std::array<std::size_t, 3> offsets_{};
  bool gapless_ = true, swap_ = false, double_ = false;
};

/// The numbers of a `sensor_msgs/CameraInfo`.
template <typename Info>
sensor::CameraInfo camera_info_of(const Info& info) {
  sensor::CameraInfo out;
  out.width = info.width;
  out.height = info.height;
  out.distortion_model = info.distortion_model;
  const auto take = [&out](const auto& coefficients, const auto& camera, const auto& projection) {
    out.d.assign(coefficients.begin(), coefficients.end());
    std::copy_n(camera.begin(), out.k.size(), out.k.begin());
    std::copy_n(projection.begin(), out.p.size(), out.p.begin());
  };
  if constexpr (detail::InRos1<Info>::value)
    take(info.D, info.K, info.P);
  else
    take(info.d, info.k, info.p);
  out.binning_x = info.binning_x;
  out.binning_y = info.binning_y;
  out.roi_x_offset = info.roi.x_offset;
  out.roi_y_offset = info.roi.y_offset;
  out.roi_width = info.roi.width;
  out.roi_height = info.roi.height;
  return out;
}

/// The intrinsics of the images of a `sensor_msgs/CameraInfo`, as sensor::intrinsics_of, which see.
/// @throws InputError as sensor::intrinsics_of
template <typename Info>
sensor::Intrinsics intrinsics_of(const Info& info, bool rectified = false) {
  return sensor::intrinsics_of(camera_info_of(info), rectified);
}

/// The distortion of the images of a `sensor_msgs/CameraInfo`, as sensor::distortion_of, which see.
/// @throws InputError as sensor::distortion_of
template <typename Info>
sensor::Distortion distortion_of(const Info& info) {
  return sensor::distortion_of(camera_info_of(info));
}

/// Images registered to a depth image and of its size, each where there is one.
template <typename Image>
struct Channels {
  const Image* color = nullptr;   ///< `rgb8` or `bgr8`, with or without a fourth byte (`rgba8`, `bgra8`)
  const Image* labels = nullptr;  ///< `16UC1` or `8UC1` (also called `mono16`, `mono8`): the detection whose mask holds
                                  ///< each pixel, 0 = none
  double score = 1.0;             ///< the detector's for each of them, 0..1; all are fruit
};

namespace detail {

/// f(pixel, bytes) for every pixel of an image, row by row. @throws InputError for data shorter than the rows
template <typename Image, typename F>
void for_each_pixel(const Image& image, std::size_t bytes, F&& f) {
  const std::size_t width = image.width, height = image.height, step = image.step;
  check_message(step >= width * bytes, "Image",
                "step " + std::to_string(step) + " is below the row's " + std::to_string(width * bytes));
  check_message(image.data.size() >= step * height, "Image",
                "data hold " + std::to_string(image.data.size()) + " bytes, step * height says more");
  for (std::size_t v = 0; v < height; ++v)
    for (std::size_t u = 0; u < width; ++u) f(v * width + u, image.data.data() + v * step + u * bytes);
}

/// Whether the 16 or 32 bit numbers of an image are in reverse order.
template <typename Image>
bool swapped(const Image& image) {
  return static_cast<bool>(image.is_bigendian) != host_is_big_endian();
}

/// @throws InputError unless the image is as large as the frame
template <typename Image>
void check_registered(const Image& image, const sensor::Intrinsics& k, const std::string& name) {
  check_message(
      image.width == static_cast<std::uint32_t>(k.width) && image.height == static_cast<std::uint32_t>(k.height),
      "Image",
      name + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
          " pixels, but the depth image has " + std::to_string(k.width) + " x " + std::to_string(k.height) +
          ": register it to the depth image");
}

template <typename Image>
void add_color(sensor::DepthFrame& frame, const Image& image) {
  check_registered(image, frame.intrinsics, "color");
  const std::string encoding(image.encoding);
  const bool four = encoding == "rgba8" || encoding == "bgra8";
  check_message(four || encoding == "rgb8" || encoding == "bgr8", "Image",
                "color: the encoding has to be rgb8 or bgr8, got '" + encoding + "'");
  const std::size_t red = encoding[0] == 'r' ? 0 : 2;
  frame.color.resize(frame.intrinsics.size());
  for_each_pixel(image, four ? 4 : 3, [&](std::size_t i, const std::uint8_t* at) {
    frame.color[i] = {at[red], at[1], at[2 - red]};
  });
}

template <typename Image>
void add_labels(sensor::DepthFrame& frame, const Image& image, double score) {
  check_registered(image, frame.intrinsics, "labels");
  check_message(score >= 0.0 && score <= 1.0, "Image", "labels: the score is outside of 0..1");
  const std::string encoding(image.encoding);
  const bool wide = encoding == "16UC1" || encoding == "mono16";
  check_message(wide || encoding == "8UC1" || encoding == "mono8", "Image",
                "labels: the encoding has to be 16UC1 or 8UC1, got '" + encoding + "'");
  const bool swap = swapped(image);
  frame.instances.resize(frame.intrinsics.size());
  for_each_pixel(image, wide ? 2 : 1, [&](std::size_t i, const std::uint8_t* at) {
    frame.instances[i] = wide ? read_number<std::uint16_t>(at, swap) : *at;
  });
  for (const std::uint16_t instance : std::set<std::uint16_t>(frame.instances.begin(), frame.instances.end())) {
    if (instance == 0) continue;
    frame.detections.emplace_back();
    frame.detections.back().instance = instance;
    frame.detections.back().score = score;
  }
  frame.detected = true;
}

}  // namespace detail

/// A depth image, `16UC1` or `mono16` (mm; 0 and 65535 = no return) or `32FC1` (m; 0, NaN and infinities = no return),
/// as a frame in metres, with the colors and labels registered to it. The distortion that its CameraInfo states is
/// removed from all of them.
/// @param image sensor_msgs/Image  @param info the CameraInfo that came with it
/// @param rectified whether the image was rectified before, see intrinsics_of
/// @param channels images that belong to it; a label image without labels says that a detector found nothing
/// @throws InputError for another encoding, data shorter than the rows, a size that differs from the camera's, or an
/// unusable camera
template <typename Image, typename Info>
sensor::DepthFrame depth_frame(const Image& image, const Info& info, bool rectified = false,
                               const Channels<Image>& channels = {}) {
  const auto check = [](bool ok, const std::string& text) { detail::check_message(ok, "Image", text); };
  sensor::DepthFrame frame;
  const sensor::CameraInfo camera = camera_info_of(info);
  frame.intrinsics = sensor::intrinsics_of(camera, rectified);
  check(image.width == info.width && image.height == info.height,
        std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels, but CameraInfo says " +
            std::to_string(info.width) + " x " + std::to_string(info.height));
  const std::size_t bytes = sensor::depth_bytes(std::string(image.encoding));
  check(bytes > 0, "encoding has to be 16UC1 or 32FC1, got '" + std::string(image.encoding) + "'");
  const auto big_endian = static_cast<bool>(image.is_bigendian);
  frame.depth.resize(frame.intrinsics.size());
  detail::for_each_pixel(image, bytes, [&](std::size_t i, const std::uint8_t* at) {
    frame.depth[i] = sensor::depth_of_pixel(at, bytes, big_endian);
  });
  if (channels.color) detail::add_color(frame, *channels.color);
  if (channels.labels) detail::add_labels(frame, *channels.labels, channels.score);
  if (!rectified) return sensor::rectified(frame, sensor::distortion_of(camera));
  return frame;
}

}  // namespace agrisee::interop

namespace agrisee {

/// Traits of clouds in messages.
template <typename Message, typename S>
struct CloudTraits<interop::PointCloud2View<Message, S>> {
  /// Type of a coordinate.
  using Scalar = S;
  /// Number of points.
  static std::size_t size(const interop::PointCloud2View<Message, S>& c) { return c.size(); }
  /// Point i (m).
  static Vector3<S> point(const interop::PointCloud2View<Message, S>& c, std::size_t i) { return c.point(i); }
};

}  // namespace agrisee
