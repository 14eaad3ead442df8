// SPDX-License-Identifier: BSD-3-Clause
// Clouds of Open3D, in place.
#include <agrisee/cloud/sor.hpp>
#include <agrisee/interop/open3d.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include "interop/same_result.hpp"

using namespace agrisee;

TEST_CASE("Open3D clouds give the same fruit as our own") {
  Cloud own = test::two_fruit();
  open3d::geometry::PointCloud theirs;
  for (std::size_t i = 0; i < own.size(); ++i) {
    theirs.points_.push_back(own.points[i].cast<double>());
    theirs.normals_.push_back(own.normals[i].cast<double>());
  }
  test::check_same(process(theirs, {}, test::from_origin()), process(own, {}, test::from_origin()));
  own.normals.clear();
  theirs.normals_.clear();
  test::check_same(process(theirs, {}, test::from_origin()), process(own, {}, test::from_origin()));
}

TEST_CASE("stages read Open3D clouds where they lie") {
  open3d::geometry::PointCloud theirs;
  for (const auto& p : test::two_fruit().points) theirs.points_.push_back(p.cast<double>());
  CHECK((remove_statistical_outliers(theirs) == remove_statistical_outliers(theirs.points_)));
}
