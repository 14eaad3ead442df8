// SPDX-License-Identifier: BSD-3-Clause
// A cloud for every kind of container, and whether what process() makes of it is the same to the bit.
#pragma once

#include <agrisee/process.hpp>

#include "catch.hpp"
#include "spheres.hpp"

namespace agrisee::test {

/// What an eye at the origin sees of two fruit, with normals, and amid them a pixel without return.
inline Cloud two_fruit() {
  Cloud cloud;
  for (const Sphere& s : {Sphere{{-0.05, 0.5, 0.2}, 0.035}, Sphere{{0.04, 0.52, 0.2}, 0.03}}) {
    add_sphere(
        cloud, s, 0.0028, [&](const Eigen::Vector3d& d) { return d.dot(s.center.normalized()) < -0.2; }, 2e-4);
    cloud.points.emplace_back(std::nanf(""), 0.0f, 0.0f);
    cloud.normals.emplace_back(0.0f, -1.0f, 0.0f);
  }
  return cloud;
}

inline CloudOrigin from_origin() {
  CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d::Zero();
  return origin;
}

/// Two fruit, and both results the same.
inline void check_same(const ScanResult& a, const ScanResult& b) {
  REQUIRE(a.fruits.size() == 2);
  REQUIRE(b.fruits.size() == 2);
  CHECK((a.raw.points == b.raw.points));
  CHECK((a.raw.normals == b.raw.normals));
  CHECK((a.cloud.points == b.cloud.points));
  CHECK((a.cloud.normals == b.cloud.normals));
  CHECK((a.labels == b.labels));
  for (std::size_t f = 0; f < 2; ++f) {
    CHECK(a.fruits[f].id == b.fruits[f].id);
    CHECK((a.fruits[f].body->center == b.fruits[f].body->center));
    CHECK((a.fruits[f].body->radii == b.fruits[f].body->radii));
    CHECK(a.fruits[f].body->confidence == b.fruits[f].body->confidence);
  }
}

}  // namespace agrisee::test
