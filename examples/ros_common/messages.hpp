// SPDX-License-Identifier: BSD-3-Clause
// Results as ROS messages. The message types are template parameters, so that ROS 1 and ROS 2 fit alike; headers are
// the caller's.
#pragma once

#include <agrisee/interop/ros.hpp>
#include <agrisee/io/palette.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/result.hpp>

#include <cstring>
#include <map>
#include <string>

namespace agrisee::robot {

/// A geometry_msgs/Pose of a rigid pose, and back.
template <typename Message>
Message pose_message(const Pose& pose) {
  Message m;
  m.position.x = pose.translation().x();
  m.position.y = pose.translation().y();
  m.position.z = pose.translation().z();
  const Eigen::Quaterniond q = quaternion(pose.linear());
  m.orientation.x = q.x();
  m.orientation.y = q.y();
  m.orientation.z = q.z();
  m.orientation.w = q.w();
  return m;
}

/// A rigid pose of a geometry_msgs/Transform. @throws InputError for a rotation that is none
template <typename Message>
Pose pose_of(const Message& transform) {
  const auto& r = transform.rotation;
  const Eigen::Quaterniond q(r.w, r.x, r.y, r.z);
  check_input(std::abs(q.norm() - 1.0) < 1e-3, "a transform's quaternion is not of unit length");
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() << transform.translation.x, transform.translation.y, transform.translation.z;
  return pose;
}

/// A geometry_msgs/Point or Vector3.
template <typename Message>
Message point_message(const Eigen::Vector3d& p) {
  Message m;
  m.x = p.x();
  m.y = p.y();
  m.z = p.z();
  return m;
}

/// The poses that a result is published as, each list by its own order.
struct ResultPoses {
  std::vector<Pose> fruits;      ///< poses for a gripper (Fruit::pose), by id
  std::vector<Pose> bodies;      ///< center and semi-axes of the bodies, by id; the pose frame where none was fitted
  std::vector<Pose> pre_grasps;  ///< of the tool, in the order of picking; only of fruit that can be picked
};
inline ResultPoses result_poses(const std::vector<Fruit>& fruits) {
  ResultPoses out;
  std::map<int, Pose> by_order;
  for (const Fruit& f : fruits) {
    out.fruits.push_back(f.pose());
    out.bodies.push_back(f.pose());
    if (f.body) {
      out.bodies.back().linear() = f.body->axes;
      out.bodies.back().translation() = f.body->center;
    }
    if (f.picking && f.picking->reachable) by_order[f.picking->order] = f.picking->world_T_pre_grasp;
  }
  for (const auto& entry : by_order) out.pre_grasps.push_back(entry.second);
  return out;
}

/// A geometry_msgs/PoseArray.
template <typename PoseArray, typename Header>
PoseArray pose_array(const Header& header, const std::vector<Pose>& poses) {
  PoseArray out;
  out.header = header;
  for (const Pose& p : poses) out.poses.push_back(pose_message<typename decltype(PoseArray::poses)::value_type>(p));
  return out;
}

/// Fill a sensor_msgs/PointCloud2 with x, y, z, normal_x, normal_y, normal_z, rgb (a color per fruit) and instance
/// (the fruit's id, 0 = none), as `cloud.ply` holds them. Labels may be empty.
template <typename Message>
void fill_cloud(Message& m, const Cloud& cloud, const Labels& labels) {
  constexpr std::uint32_t kStep = 32;
  const char* names[] = {"x", "y", "z", "normal_x", "normal_y", "normal_z", "rgb", "instance"};
  m.fields.resize(8);
  for (std::uint32_t i = 0; i < 8; ++i) {
    m.fields[i].name = names[i];
    m.fields[i].offset = 4 * i;
    m.fields[i].datatype = i == 7 ? 5 : 7;  // INT32, FLOAT32
    m.fields[i].count = 1;
  }
  m.height = 1;
  m.width = static_cast<std::uint32_t>(cloud.size());
  m.point_step = kStep;
  m.row_step = kStep * m.width;
  m.is_bigendian = interop::detail::host_is_big_endian();
  m.is_dense = true;
  m.data.assign(std::size_t{kStep} * cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::uint8_t* at = m.data.data() + kStep * i;
    const int id = labels.empty() ? 0 : labels[i];
    const io::Rgb c = io::fruit_color(id);
    const std::uint32_t rgb = std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2];
    const std::int32_t instance = id;
    std::memcpy(at, cloud.points[i].data(), 12);
    if (!cloud.normals.empty()) std::memcpy(at + 12, cloud.normals[i].data(), 12);
    std::memcpy(at + 24, &rgb, 4);
    std::memcpy(at + 28, &instance, 4);
  }
}

/// Makes the markers of a visualization_msgs/MarkerArray, all with one header. Each layer is a namespace that can be
/// switched in RViz; the first marker deletes what was drawn before.
template <typename MarkerArray>
class MarkerMaker {
 public:
  using Marker = typename decltype(MarkerArray::markers)::value_type;
  using Header = decltype(Marker::header);

  explicit MarkerMaker(const Header& header) : header_(header) {
    Marker& all = add("", Marker::CUBE, Pose::Identity(), Eigen::Vector3d::Ones(), {0, 0, 0}, 0.0);
    all.action = Marker::DELETEALL;
  }

  /// Bodies, pose frames, ids (with the ripeness, where it is known) and pre-grasp arrows of fruit.
  void fruits(const std::vector<Fruit>& fruits) {
    for (const Fruit& f : fruits) {
      const io::Rgb color = io::fruit_color(f.id);
      double radius = 0.03;
      const Eigen::Vector3d center = f.position();
      if (f.body) {
        Pose pose = Pose::Identity();
        pose.linear() = f.body->axes;
        pose.translation() = center;
        radius = f.body->radii.mean();
        add("bodies", Marker::SPHERE, pose, 2.0 * f.body->radii, color, 0.55);
      }
      frame("frames", f.pose(), 1.5 * radius);
      // Where nothing hides it: at the tail of the arrow, else above.
      const bool arrow_drawn = f.picking && f.picking->reachable;
      Pose label = Pose::Identity();
      label.translation() = center + Eigen::Vector3d(0.0, 0.0, 1.3 * radius);
      if (arrow_drawn) label.translation() = f.picking->world_T_pre_grasp.translation() - 0.015 * f.picking->direction;
      add("ids", Marker::TEXT_VIEW_FACING, label, Eigen::Vector3d(0.0, 0.0, 0.025), {20, 20, 20}, 1.0).text =
          std::to_string(f.id) + (f.ripeness ? std::string(", ") + to_string(f.ripeness->grade) : "");
      if (arrow_drawn) {
        Marker& arrow =
            add("picking", Marker::ARROW, Pose::Identity(), Eigen::Vector3d(0.003, 0.008, 0.012), color, 0.9);
        line(arrow, f.picking->world_T_pre_grasp.translation(), center - radius * f.picking->direction);
      }
    }
  }

  /// Sensor pyramids of the views taken, the way between them, the candidates (a stroke each along its axis, the more
  /// it promises the greener) and the chosen one.
  void views(const std::vector<View>& taken, const std::vector<plan::ReachableView>& candidates,
             const std::optional<plan::ReachableView>& chosen, const sensor::Intrinsics& camera) {
    Marker& path = add("path", Marker::LINE_STRIP, Pose::Identity(), {0.002, 0.0, 0.0}, {60, 60, 70}, 0.7);
    for (const View& v : taken) path.points.push_back(point(v.world_T_optical.translation()));
    if (path.points.size() < 2) out_.markers.pop_back();
    for (const View& v : taken) pyramid("taken", v.world_T_optical, camera, 0.03, 0.001, {60, 60, 70});
    if (chosen) pyramid("chosen", chosen->world_T_optical, camera, 0.06, 0.003, {230, 120, 20});
    if (candidates.empty()) return;
    double best = 0.0;
    for (const auto& c : candidates) best = std::max(best, c.gain);
    Marker& strokes = add("candidates", Marker::LINE_LIST, Pose::Identity(), {0.0012, 0.0, 0.0}, {0, 0, 0}, 0.8);
    for (const auto& c : candidates) {
      const Eigen::Vector3d from = c.world_T_optical.translation();
      line(strokes, from, from + 0.02 * c.world_T_optical.linear().col(2));
      const double share = best > 0.0 ? c.gain / best : 0.0;
      const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(255.0 * x)); };
      const auto color = rgba({byte(0.75 * (1.0 - share)), byte(0.35 + 0.35 * share), byte(0.55 * (1.0 - share))}, 0.8);
      strokes.colors.insert(strokes.colors.end(), 2, color);
    }
  }

  MarkerArray take() { return std::move(out_); }

 private:
  using Color = decltype(Marker::color);
  using Point = typename decltype(Marker::points)::value_type;

  static Point point(const Eigen::Vector3d& p) { return point_message<Point>(p); }
  static void line(Marker& m, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    m.points.push_back(point(a));
    m.points.push_back(point(b));
  }
  static Color rgba(const io::Rgb& rgb, double alpha) {
    Color c;
    c.r = static_cast<float>(rgb[0]) / 255.0f;
    c.g = static_cast<float>(rgb[1]) / 255.0f;
    c.b = static_cast<float>(rgb[2]) / 255.0f;
    c.a = static_cast<float>(alpha);
    return c;
  }

  Marker& add(const char* layer, int type, const Pose& pose, const Eigen::Vector3d& scale, const io::Rgb& color,
              double alpha) {
    out_.markers.emplace_back();
    Marker& m = out_.markers.back();
    m.header = header_;
    m.ns = layer;
    m.id = static_cast<int>(out_.markers.size());
    m.type = type;
    m.action = Marker::ADD;
    m.pose = pose_message<decltype(Marker::pose)>(pose);
    m.scale = point_message<decltype(Marker::scale)>(scale);
    m.color = rgba(color, alpha);
    return m;
  }

  void frame(const char* layer, const Pose& pose, double length) {
    const io::Rgb colors[] = {{220, 40, 40}, {40, 160, 60}, {40, 80, 220}};
    for (int axis = 0; axis < 3; ++axis) {
      Marker& arrow = add(layer, Marker::ARROW, Pose::Identity(), {0.003, 0.006, 0.01}, colors[axis], 1.0);
      line(arrow, pose.translation(), pose * Eigen::Vector3d(length * Eigen::Vector3d::Unit(axis)));
    }
  }

  void pyramid(const char* layer, const Pose& pose, const sensor::Intrinsics& camera, double length, double width,
               const io::Rgb& color) {
    Marker& m = add(layer, Marker::LINE_LIST, Pose::Identity(), {width, 0.0, 0.0}, color, 0.9);
    const double w = camera.width, h = camera.height;
    const Eigen::Vector3d corners[] = {pose * (length * camera.ray(0, 0)), pose * (length * camera.ray(w, 0)),
                                       pose * (length * camera.ray(w, h)), pose * (length * camera.ray(0, h))};
    for (int i = 0; i < 4; ++i) {
      line(m, pose.translation(), corners[i]);
      line(m, corners[i], corners[(i + 1) % 4]);
    }
  }

  Header header_;
  MarkerArray out_;
};

}  // namespace agrisee::robot
