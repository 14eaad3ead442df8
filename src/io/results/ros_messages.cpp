// SPDX-License-Identifier: BSD-3-Clause
#include "io/results/ros_messages.hpp"

#include <agrisee/sensor/depth_encoding.hpp>

#include <algorithm>
#include <cmath>

#include "io/formats/cdr.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io::ros {
namespace {

constexpr std::uint64_t kSecond = 1000000000;  // ns

#define AGRISEE_ROS_LINE "================================================================================\n"
#define AGRISEE_ROS_HEADER                                                                                   \
  AGRISEE_ROS_LINE "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" AGRISEE_ROS_LINE \
                   "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"

CdrWriter& put_header(CdrWriter& out, const Header& header) {
  out.put(static_cast<std::int32_t>(header.time / kSecond));
  out.put(static_cast<std::uint32_t>(header.time % kSecond));
  return out.text(header.frame);
}

std::uint64_t take_time(CdrReader& in) {
  const auto seconds = in.take<std::int32_t>();
  check_input(seconds >= 0, "has a time before 1970");
  return static_cast<std::uint64_t>(seconds) * kSecond + in.take<std::uint32_t>();
}

Header take_header(CdrReader& in) {
  Header header;
  header.time = take_time(in);
  header.frame = in.text();
  if (!header.frame.empty() && header.frame[0] == '/') header.frame.erase(0, 1);  // as old drivers write it
  return header;
}

}  // namespace

const Type kImage{"sensor_msgs/msg/Image",
                  "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
                  "uint32 step\nuint8[] data\n" AGRISEE_ROS_HEADER};
const Type kCameraInfo{"sensor_msgs/msg/CameraInfo",
                       "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
                       "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
                       "sensor_msgs/RegionOfInterest roi\n" AGRISEE_ROS_LINE
                       "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\n"
                       "uint32 width\nbool do_rectify\n" AGRISEE_ROS_HEADER};
const Type kTransforms{
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/TransformStamped[] transforms\n" AGRISEE_ROS_LINE
    "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform\n" AGRISEE_ROS_LINE
    "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation\n" AGRISEE_ROS_LINE
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" AGRISEE_ROS_LINE
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" AGRISEE_ROS_HEADER};
const Type kJointState{"sensor_msgs/msg/JointState",
                       "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
                       "float64[] effort\n" AGRISEE_ROS_HEADER};
const Type kPointCloud{"sensor_msgs/msg/PointCloud2",
                       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
                       "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool "
                       "is_dense\n" AGRISEE_ROS_LINE
                       "MSG: sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 "
                       "count\n" AGRISEE_ROS_HEADER};

std::uint64_t read_time(std::string_view message) {
  CdrReader in(message);
  return take_time(in);
}

Image read_image(std::string_view message) {
  CdrReader in(message);
  Image image;
  image.header = take_header(in);
  image.height = in.take<std::uint32_t>();
  image.width = in.take<std::uint32_t>();
  image.encoding = in.text();
  image.big_endian = in.take<std::uint8_t>() != 0;
  image.step = in.take<std::uint32_t>();
  image.data = in.data();
  return image;
}

std::vector<float> depths_of(const Image& image) {
  const std::size_t bytes = sensor::depth_bytes(image.encoding);
  if (bytes == 0)
    throw InputError("has the encoding " + excerpt(image.encoding) + ", not that of depths (32FC1 or 16UC1)");
  const std::size_t width = image.width, height = image.height, step = image.step;
  check_input(width > 0 && height > 0 && step >= width * bytes && image.data.size() / step >= height,
              "has less data than its size says");
  std::vector<float> out(width * height);
  const auto* data = reinterpret_cast<const std::uint8_t*>(image.data.data());
  for (std::size_t v = 0; v < height; ++v)
    for (std::size_t u = 0; u < width; ++u)
      out[v * width + u] = sensor::depth_of_pixel(data + v * step + u * bytes, bytes, image.big_endian);
  return out;
}

CameraInfo read_camera_info(std::string_view message) {
  constexpr std::uint32_t kMostCoefficients = 64;
  CdrReader in(message);
  CameraInfo out;
  out.header = take_header(in);
  sensor::CameraInfo& camera = out.camera;
  camera.height = in.take<std::uint32_t>();
  camera.width = in.take<std::uint32_t>();
  camera.distortion_model = in.text();
  const auto count = in.take<std::uint32_t>();
  check_input(count < kMostCoefficients, "has a camera with too many coefficients of distortion");
  camera.d.resize(count);
  for (double& value : camera.d) value = in.take<double>();
  for (double& value : camera.k) value = in.take<double>();
  for (int i = 0; i < 9; ++i) in.take<double>();  // the rotation of a stereo pair's rectification
  for (double& value : camera.p) value = in.take<double>();
  for (std::uint32_t* value : {&camera.binning_x, &camera.binning_y, &camera.roi_x_offset, &camera.roi_y_offset,
                               &camera.roi_height, &camera.roi_width})
    *value = in.take<std::uint32_t>();
  return out;
}

std::vector<Transform> read_transforms(std::string_view message) {
  CdrReader in(message);
  std::vector<Transform> out;
  const auto count = in.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    Transform t;
    t.header = take_header(in);
    t.child = in.text();
    if (!t.child.empty() && t.child[0] == '/') t.child.erase(0, 1);
    for (int a = 0; a < 3; ++a) t.pose.translation()[a] = in.take<double>();
    Eigen::Vector4d q;
    for (int a = 0; a < 4; ++a) q[a] = in.take<double>();
    if (!t.pose.translation().allFinite() || !(std::abs(q.norm() - 1.0) < 1e-2))
      throw InputError("has a transform to " + excerpt(t.child) + " that is not rigid");
    t.pose.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
    out.push_back(std::move(t));
  }
  return out;
}

std::string image_message(const Header& header, const sensor::DepthFrame& frame) {
  CdrWriter out;
  put_header(out, header);
  const auto width = static_cast<std::uint32_t>(frame.intrinsics.width);
  out.put(static_cast<std::uint32_t>(frame.intrinsics.height)).put(width).text("32FC1").put(std::uint8_t{0});
  out.put(4 * width).data(frame.depth.data(), frame.depth.size() * sizeof(float));
  return out.str();
}

std::string camera_info_message(const Header& header, const sensor::Intrinsics& i) {
  CdrWriter out;
  put_header(out, header);
  out.put(static_cast<std::uint32_t>(i.height)).put(static_cast<std::uint32_t>(i.width)).text("plumb_bob");
  out.put(std::uint32_t{5});
  for (int n = 0; n < 5; ++n) out.put(0.0);
  for (const double value : {i.fx, 0.0, i.cx, 0.0, i.fy, i.cy, 0.0, 0.0, 1.0}) out.put(value);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) out.put(value);
  for (const double value : {i.fx, 0.0, i.cx, 0.0, 0.0, i.fy, i.cy, 0.0, 0.0, 0.0, 1.0, 0.0}) out.put(value);
  for (int n = 0; n < 6; ++n) out.put(std::uint32_t{0});  // binning, region of interest
  out.put(std::uint8_t{0});
  return out.str();
}

std::string transform_message(const Header& header, const std::string& child, const Pose& pose) {
  CdrWriter out;
  put_header(out.put(std::uint32_t{1}), header).text(child);
  const Eigen::Quaterniond q = quaternion(pose.linear());
  for (int a = 0; a < 3; ++a) out.put(pose.translation()[a]);
  for (int a = 0; a < 4; ++a) out.put(q.coeffs()[a]);
  return out.str();
}

std::string joint_state_message(const Header& header, const Joints& joints) {
  CdrWriter out;
  put_header(out, header).put(std::uint32_t{6});
  for (const char* name :
       {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"})
    out.text(name);
  out.put(std::uint32_t{6});
  for (int a = 0; a < 6; ++a) out.put(joints[a]);
  out.put(std::uint32_t{0}).put(std::uint32_t{0});
  return out.str();
}

std::string cloud_message(const Header& header, const Cloud& cloud, const std::vector<int>& labels) {
  constexpr std::uint32_t kStep = 16;
  constexpr std::uint8_t kFloat32 = 7, kInt32 = 5;  // of sensor_msgs/PointField
  CdrWriter out;
  const auto count = static_cast<std::uint32_t>(cloud.size());
  put_header(out, header).put(std::uint32_t{1}).put(count).put(std::uint32_t{4});
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "instance"}) {
    out.text(name).put(offset).put(offset < 12 ? kFloat32 : kInt32).put(std::uint32_t{1});
    offset += 4;
  }
  out.put(std::uint8_t{0}).put(kStep).put(kStep * count);
  std::string data(std::size_t{kStep} * count, '\0');
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::int32_t label = labels.empty() ? 0 : labels[i];
    std::memcpy(&data[kStep * i], cloud.points[i].data(), 12);
    std::memcpy(&data[kStep * i + 12], &label, 4);
  }
  out.data(data.data(), data.size()).put(std::uint8_t{1});
  return out.str();
}

}  // namespace agrisee::io::ros
