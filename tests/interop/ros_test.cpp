// SPDX-License-Identifier: BSD-3-Clause
// Messages of both ROS generations: structs of our own with the same members, the real ones where ROS 1 is installed,
// and those that rosidl makes for ROS 2 (tests/ros2).
#include <agrisee/interop/ros.hpp>
#include <agrisee/process.hpp>

#include "catch.hpp"
#include "spheres.hpp"
#include "support/ros_messages.hpp"
#include "support/says.hpp"

#ifdef AGRISEE_HAS_ROS1
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#endif
#ifdef AGRISEE_HAS_ROS2
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#endif

using namespace agrisee;
using interop::PointCloud2View;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// How a message lays its points out.
struct Layout {
  bool wide = false;           ///< float64
  bool big = false;            ///< big-endian
  std::uint32_t lead = 0;      ///< bytes before x
  std::uint32_t tail = 0;      ///< bytes after z
  std::uint32_t row_tail = 0;  ///< bytes after each row
  std::uint32_t height = 1;
  bool reversed = false;  ///< z first, in the fields and in the point
};

template <typename T>
void put(std::vector<std::uint8_t>& data, std::size_t at, T value, bool big) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big != interop::detail::host_is_big_endian()) std::reverse(bytes.begin(), bytes.end());
  std::copy(bytes.begin(), bytes.end(), data.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Bytes that are not coordinates are 0xff, as floats NaN.
template <typename Message>
Message message_of(const std::vector<Eigen::Vector3f>& points, const Layout& layout = {}) {
  Message m;
  const std::uint32_t scalar = layout.wide ? 8 : 4;
  m.height = layout.height;
  m.width = static_cast<std::uint32_t>(points.size()) / layout.height;
  REQUIRE(std::size_t{m.width} * m.height == points.size());
  m.point_step = layout.lead + 3 * scalar + layout.tail;
  m.row_step = m.width * m.point_step + layout.row_tail;
  m.is_bigendian = layout.big;
  m.data.assign(std::size_t{m.row_step} * m.height, 0xff);
  m.fields.resize(4);
  m.fields[0].name = "intensity";
  m.fields[0].datatype = 2;
  m.fields[0].count = 1;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t axis = layout.reversed ? 2 - k : k;
    m.fields[k + 1].name = std::string(1, "xyz"[axis]);
    m.fields[k + 1].offset = layout.lead + k * scalar;
    m.fields[k + 1].datatype = layout.wide ? 8 : 7;
    m.fields[k + 1].count = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t at = (i / m.width) * m.row_step + (i % m.width) * m.point_step + m.fields[k + 1].offset;
      const float value = points[i][static_cast<Eigen::Index>(axis)];
      layout.wide ? put(m.data, at, double(value), layout.big) : put(m.data, at, value, layout.big);
    }
  }
  return m;
}

std::vector<Layout> layouts() {
  std::vector<Layout> all;
  for (const bool wide : {false, true})
    for (const bool big : {false, true}) {
      all.push_back({wide, big});
      all.push_back({wide, big, 4, 16, 0, 1, true});
      all.push_back({wide, big, 3, 1, 7, 4});  // nothing aligned, rows with an end of their own
    }
  return all;
}

const std::vector<Eigen::Vector3f> kPoints = {{1.0f, 2.0f, 3.0f},     {-0.25f, 1e-7f, 4e8f}, {kNaN, 0.0f, 1.0f},
                                              {0.5f, -0.125f, 0.75f}, {0.1f, 0.2f, 0.3f},    {4.0f, 5.0f, -6.0f},
                                              {0.0f, 0.0f, 0.0f},     {7.0f, 8.0f, 9.0f}};

bool same(const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return std::memcmp(a.data(), b.data(), 12) == 0; }

template <typename Message>
void reads_every_layout() {
  for (const Layout& layout : layouts()) {
    const Message m = message_of<Message>(kPoints, layout);
    const PointCloud2View view(m);
    REQUIRE(agrisee::size(view) == kPoints.size());
    for (std::size_t i = 0; i < kPoints.size(); ++i) {
      if (i == 2)
        CHECK_FALSE(is_finite(point(view, i)));
      else
        CHECK(same(point(view, i), kPoints[i]));
    }
    CHECK(finite_indices(view) == Indices{0, 1, 3, 4, 5, 6, 7});
    const PointCloud2View<Message, double> in_double(m);
    CHECK(point(in_double, 4) == kPoints[4].cast<double>());
  }
}

/// What a sensor at the origin of `pose` sees of two fruit, organized, NaN without return; world frame.
std::vector<Eigen::Vector3f> scan_of_two() {
  const std::vector<Sphere> fruit = {{{-0.05, 0.5, 0.2}, 0.035}, {{0.04, 0.52, 0.2}, 0.03}};
  const sensor::Intrinsics camera = sensor::intrinsics_from_fov(256, 192, deg(50), deg(38));
  const Pose pose = look_along({0.0, 0.15, 0.2}, Eigen::Vector3d::UnitY());
  const sensor::DepthFrame frame = test::render(fruit, camera, pose);
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      points.push_back(sensor::DepthFrame::valid(frame.at(u, v))
                           ? (pose * frame.point(u, v).cast<double>()).cast<float>().eval()
                           : Eigen::Vector3f(Eigen::Vector3f::Constant(kNaN)));
  return points;
}

template <typename Message>
void processes_alike() {
  const auto points = scan_of_two();
  Cloud own;
  own.points = points;
  CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d(0.0, 0.15, 0.2);
  const ScanResult expected = process(own, {}, origin);
  REQUIRE(expected.fruits.size() == 2);
  for (const Layout& layout : {Layout{}, Layout{true, true, 4, 12, 5, 192}}) {
    const Message m = message_of<Message>(points, layout);
    const ScanResult result = process(PointCloud2View(m), {}, origin);
    REQUIRE(result.fruits.size() == 2);
    CHECK(result.labels == expected.labels);
    CHECK((result.cloud.points == expected.cloud.points));
    for (std::size_t f = 0; f < 2; ++f) {
      CHECK(result.fruits[f].centroid == expected.fruits[f].centroid);
      CHECK(result.fruits[f].body->center == expected.fruits[f].body->center);
    }
  }
}

template <typename Info>
struct Names;
template <typename Info>
struct Names2 {
  static auto& K(Info& m) { return m.k; }
  static auto& P(Info& m) { return m.p; }
  static auto& D(Info& m) { return m.d; }
};
template <>
struct Names<mock::CameraInfo> : Names2<mock::CameraInfo> {};
template <typename Info>
struct Names1 {
  static auto& K(Info& m) { return m.K; }
  static auto& P(Info& m) { return m.P; }
  static auto& D(Info& m) { return m.D; }
};
template <>
struct Names<mock::CameraInfo1> : Names1<mock::CameraInfo1> {};
#ifdef AGRISEE_HAS_ROS1
template <>
struct Names<sensor_msgs::CameraInfo> : Names1<sensor_msgs::CameraInfo> {};
#endif
#ifdef AGRISEE_HAS_ROS2
template <>
struct Names<sensor_msgs::msg::CameraInfo> : Names2<sensor_msgs::msg::CameraInfo> {};
#endif

template <typename Info>
Info camera_4x3() {
  Info info;
  info.width = 4;
  info.height = 3;
  Names<Info>::K(info) = {100.0, 0.0, 1.5, 0.0, 110.0, 1.0, 0.0, 0.0, 1.0};
  Names<Info>::P(info) = {90.0, 0.0, 1.25, 0.0, 0.0, 95.0, 0.75, 0.0, 0.0, 0.0, 1.0, 0.0};
  Names<Info>::D(info).assign(5, 0.0);
  return info;
}

/// Depth i * 0.25 m at pixel i, two bytes at the end of each row.
template <typename Image>
Image image_4x3(bool millimetres, bool big) {
  Image m;
  m.width = 4;
  m.height = 3;
  m.encoding = millimetres ? "16UC1" : "32FC1";
  m.is_bigendian = big;
  const std::uint32_t bytes = millimetres ? 2 : 4;
  m.step = 4 * bytes + 2;
  m.data.assign(m.step * 3, 0xff);
  for (std::size_t i = 0; i < 12; ++i) {
    const std::size_t at = (i / 4) * m.step + (i % 4) * bytes;
    if (millimetres)
      put(m.data, at, static_cast<std::uint16_t>(250 * i), big);
    else
      put(m.data, at, 0.25f * static_cast<float>(i), big);
  }
  return m;
}

template <typename Image, typename Info>
void reads_frames() {
  Info info = camera_4x3<Info>();
  for (const bool millimetres : {false, true})
    for (const bool big : {false, true}) {
      const auto image = image_4x3<Image>(millimetres, big);
      const sensor::DepthFrame frame = interop::depth_frame(image, info);
      check(frame);
      REQUIRE(frame.depth.size() == 12);
      for (std::size_t i = 0; i < 12; ++i) CHECK(frame.depth[i] == Approx(0.25 * static_cast<double>(i)).margin(1e-6));
      CHECK_FALSE(sensor::DepthFrame::valid(frame.at(0, 0)));
      CHECK(frame.at(1, 2) == Approx(2.25));
      CHECK((frame.intrinsics.fx == 100.0 && frame.intrinsics.fy == 110.0));
      CHECK((frame.intrinsics.cx == 1.5 && frame.intrinsics.cy == 1.0));
    }
  auto gray = image_4x3<Image>(true, true);
  gray.encoding = "mono16";  // as some drivers call it
  CHECK(interop::depth_frame(gray, info).depth == interop::depth_frame(image_4x3<Image>(true, true), info).depth);
  auto full = image_4x3<Image>(true, false);
  full.data[2] = full.data[3] = 0xff;  // the second pixel: no return
  CHECK(interop::depth_frame(full, info).at(1, 0) == 0.0f);
  const auto image = image_4x3<Image>(true, false);
  const sensor::Intrinsics rectified = interop::depth_frame(image, info, true).intrinsics;
  CHECK((rectified.fx == 90.0 && rectified.fy == 95.0 && rectified.cx == 1.25 && rectified.cy == 0.75));
  auto bent = info;
  std::fill(Names<Info>::D(bent).begin(), Names<Info>::D(bent).end(), 0.0);
  Names<Info>::D(bent)[0] = 2000.0;  // the corners are seen outside of the image
  const sensor::DepthFrame straight = interop::depth_frame(image, bent), raw = interop::depth_frame(image, bent, true);
  CHECK(straight.depth == sensor::rectified(sensor::DepthFrame{straight.intrinsics, raw.depth},
                                            sensor::distortion_from(Names<Info>::D(bent)))
                              .depth);
  CHECK(straight.depth != raw.depth);
  bent.distortion_model = "equidistant";
  CHECK_THROWS_WITH(interop::depth_frame(image, bent), test::says("equidistant"));
  CHECK_NOTHROW(interop::depth_frame(image, info, true));
}

template <typename Change>
mock::PointCloud2 broken(Change&& change) {
  auto m = message_of<mock::PointCloud2>(kPoints, {false, false, 0, 4, 0, 2});
  change(m);
  return m;
}

}  // namespace

TEST_CASE("a PointCloud2 is a cloud, whatever its layout") {
  reads_every_layout<mock::PointCloud2>();
#ifdef AGRISEE_HAS_ROS1
  reads_every_layout<sensor_msgs::PointCloud2>();
#endif
#ifdef AGRISEE_HAS_ROS2
  reads_every_layout<sensor_msgs::msg::PointCloud2>();
#endif
}

TEST_CASE("a PointCloud2 is processed as our own cloud is") {
  processes_alike<mock::PointCloud2>();
#ifdef AGRISEE_HAS_ROS1
  processes_alike<sensor_msgs::PointCloud2>();
#endif
#ifdef AGRISEE_HAS_ROS2
  processes_alike<sensor_msgs::msg::PointCloud2>();
#endif
}

TEST_CASE("a PointCloud2 without points is an empty cloud") {
  const mock::PointCloud2 m;
  CHECK(agrisee::size(PointCloud2View(m)) == 0);
  const auto wide = broken([](auto& b) { b.height = 0; });
  CHECK(agrisee::size(PointCloud2View(wide)) == 0);
}

TEST_CASE("a malformed PointCloud2 is refused, and nothing outside of its data is read") {
  using M = mock::PointCloud2;
  const auto refuses = [](const std::function<void(M&)>& change, const char* text) {
    const M m = broken(change);
    INFO(text);
    CHECK_THROWS_AS(PointCloud2View(m), InputError);
    CHECK_THROWS_WITH(PointCloud2View(m), test::says(text));
  };
  CHECK_NOTHROW([] {
    const M m = broken([](M&) {});
    return PointCloud2View(m).size();
  }());
  refuses([](M& m) { m.data.pop_back(); }, "row_step * height");
  refuses([](M& m) { m.data.clear(); }, "row_step * height");
  refuses([](M& m) { --m.row_step; }, "below width * point_step");
  refuses([](M& m) { m.row_step = 0; }, "below width * point_step");
  refuses([](M& m) { m.height = m.width = 0xffffffffu; }, "too many");
  refuses([](M& m) { m.width = 0x40000000u; }, "too many");
  refuses(
      [](M& m) {
        m.height = 0x10000000u;
        m.row_step = 0xffffffffu;
      },
      "row_step * height");
  refuses([](M& m) { m.point_step = 0; }, "outside of point_step");
  refuses([](M& m) { m.point_step = 8; }, "outside of point_step");
  refuses([](M& m) { m.fields[3].offset = 13; }, "outside of point_step");
  refuses([](M& m) { m.fields[1].offset = 0xffffffffu; }, "outside of point_step");
  refuses([](M& m) { m.fields.clear(); }, "no field 'x'");
  refuses([](M& m) { m.fields.pop_back(); }, "no field 'z'");
  refuses([](M& m) { m.fields.push_back(m.fields[2]); }, "field 'y' twice");
  refuses([](M& m) { m.fields[2].datatype = 5; }, "neither FLOAT32 nor FLOAT64");
  refuses([](M& m) { m.fields[2].datatype = 8; }, "differ in their type");
  refuses([](M& m) { m.fields[1].count = 3; }, "several values");
}

TEST_CASE("depth images in metres and millimetres are frames") {
  reads_frames<mock::Image, mock::CameraInfo>();
  reads_frames<mock::Image, mock::CameraInfo1>();
#ifdef AGRISEE_HAS_ROS1
  reads_frames<sensor_msgs::Image, sensor_msgs::CameraInfo>();
#endif
#ifdef AGRISEE_HAS_ROS2
  reads_frames<sensor_msgs::msg::Image, sensor_msgs::msg::CameraInfo>();
#endif
}

TEST_CASE("a malformed image or camera is refused") {
  const auto refuses = [](const std::function<void(mock::Image&, mock::CameraInfo&)>& change, const char* text) {
    auto image = image_4x3<mock::Image>(true, false);
    auto info = camera_4x3<mock::CameraInfo>();
    CHECK_NOTHROW(interop::depth_frame(image, info));
    change(image, info);
    INFO(text);
    CHECK_THROWS_AS(interop::depth_frame(image, info), InputError);
    CHECK_THROWS_WITH(interop::depth_frame(image, info), test::says(text));
  };
  using I = mock::Image;
  using C = mock::CameraInfo;
  refuses([](I& i, C&) { i.encoding = "rgb8"; }, "got 'rgb8'");
  refuses([](I& i, C&) { i.data.pop_back(); }, "step * height");
  refuses([](I& i, C&) { i.step = 7; }, "below the row's 8");
  refuses([](I& i, C&) { i.width = 5; }, "CameraInfo says 4 x 3");
  refuses([](I& i, C& c) { i.width = c.width = 0; }, "0 x 3 pixels");
  refuses([](I& i, C& c) { i.height = c.height = 0xffffffffu; }, "pixels");
  refuses([](I&, C& c) { c.k[0] = 0.0; }, "no focal length: 0 and 110 (k[0] and k[4])");
  refuses([](I&, C& c) { c.k[5] = std::nan(""); }, "principal point");
  refuses([](I&, C& c) { c.d[4] = std::nan(""); }, "not finite");
  refuses([](I&, C& c) { c.d[0] = -1e6; }, "folds the image");
  refuses([](I&, C& c) { c.d.assign(3, 0.1); }, "4, 5 or 8 coefficients");
  refuses(
      [](I&, C& c) {
        c.d[4] = 1e-3;
        c.distortion_model = "equidistant";
      },
      "the model 'equidistant'");
  refuses([](I&, C& c) { c.binning_x = 2; }, "binning");
  refuses([](I&, C& c) { c.roi.width = 2; }, "region of interest");
  refuses([](I&, C& c) { c.roi.x_offset = 1; }, "region of interest");
}
