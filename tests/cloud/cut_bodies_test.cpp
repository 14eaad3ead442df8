// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/cut_bodies.hpp>
#include <agrisee/core/pose.hpp>

#include "catch.hpp"
#include "cloud/cloud_cases.hpp"

using namespace agrisee;
using cases::all_of;

namespace cut_bodies_test {

namespace {

constexpr double kRadius = 0.025;

/// The scan volume: its upper face is at z = 0.
Aabb volume() {
  Aabb box;
  box.extend(Eigen::Vector3d(-0.2, -0.2, -0.4));
  box.extend(Eigen::Vector3d(0.2, 0.2, 0.0));
  return box;
}

void add(Cloud& cloud, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  if (!volume().contains(point)) return;
  cloud.points.push_back(point.cast<float>());
  cloud.normals.push_back(normal.cast<float>());
}

/// A ball that the volume cuts. @param height of its center (m)
Cloud ball(double height) {
  Cloud cloud;
  for (int i = 0; i < 2000; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 2000, phi = 2.4 * i, s = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d n(s * std::cos(phi), s * std::sin(phi), z);
    add(cloud, Eigen::Vector3d(0, 0, height) + kRadius * n, n);
  }
  return cloud;
}

/// The end of an upright post at the upper face, `length` long.
Cloud post(double length, double top = 0.0) {
  Cloud cloud;
  for (int i = 0; i < 2000; ++i) {
    const double phi = 2.4 * i;
    const Eigen::Vector3d n(std::cos(phi), std::sin(phi), 0.0);
    add(cloud, kRadius * n + Eigen::Vector3d(0, 0, top - length * i / 2000.0), n);
  }
  return cloud;
}

Ellipsoid sphere_at(double height) { return Ellipsoid(Sphere{Eigen::Vector3d(0, 0, height), kRadius}); }

}  // namespace

TEST_CASE("a fruit that the scan volume cuts closes towards its border") {
  for (const double height : {-0.024, -0.02, -0.015, -0.008, 0.0, 0.01}) {
    CAPTURE(height);
    const Cloud cloud = ball(height);
    CHECK_FALSE(goes_on_beyond(cloud, all_of(cloud), sphere_at(height), volume()));
  }
}

TEST_CASE("the end of a post at the border of the scan volume goes on beyond it") {
  for (const double height : {-0.018, -0.015, -0.01}) {
    CAPTURE(height);
    const Cloud cloud = post(0.04);
    CHECK(goes_on_beyond(cloud, all_of(cloud), sphere_at(height), volume()));
  }
}

TEST_CASE("what does not reach the border, or hardly shows there, is not judged by it") {
  const Cloud away = post(0.03, -0.005);  // ends 5 mm below the border
  CHECK_FALSE(goes_on_beyond(away, all_of(away), sphere_at(-0.015), volume()));
  const Cloud cloud = post(0.04);
  CHECK_FALSE(goes_on_beyond(cloud, {0, 1, 2, 3, 4, 5, 6}, sphere_at(-0.015), volume()));
  CHECK(goes_on_beyond(cloud, {0, 1, 2, 3, 4, 5, 6, 7}, sphere_at(-0.015), volume()));
  CHECK_FALSE(goes_on_beyond(Cloud(), {}, sphere_at(-0.015), volume()));
}

TEST_CASE("every face of the scan volume is a border") {
  Pose turn = Pose::Identity();
  const Aabb box = volume();
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      CAPTURE(axis, side);
      const Eigen::Vector3d out = side * Eigen::Vector3d::Unit(axis);
      turn.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out).toRotationMatrix();
      turn.translation() = (side < 0.0 ? box.min[axis] : box.max[axis]) * Eigen::Vector3d::Unit(axis);
      if (axis != 2) turn.translation().z() = -0.2;
      Cloud cloud = post(0.04);
      for (auto& p : cloud.points) p = (turn * p.cast<double>()).cast<float>();
      for (auto& n : cloud.normals) n = (turn.linear() * n.cast<double>()).cast<float>();
      Ellipsoid body = sphere_at(-0.015);
      body.center = turn * body.center;
      CHECK(goes_on_beyond(cloud, all_of(cloud), body, box));
    }
}

}  // namespace cut_bodies_test
