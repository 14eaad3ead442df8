// SPDX-License-Identifier: BSD-3-Clause
// cloud.ply through Open3D and back.
#include <open3d/geometry/PointCloud.h>
#include <open3d/io/PointCloudIO.h>

#include "interop/result_cloud.hpp"

using namespace agrisee;

TEST_CASE("Open3D reads points, normals and colors of cloud.ply, and what it writes is the same cloud") {
  const test::ResultCloud result("open3d");
  open3d::geometry::PointCloud theirs;
  REQUIRE(open3d::io::ReadPointCloud(result.file.string(), theirs));
  REQUIRE(theirs.points_.size() == result.cloud.size());
  REQUIRE(theirs.HasNormals());
  REQUIRE(theirs.HasColors());
  std::size_t same = 0;
  for (std::size_t i = 0; i < theirs.points_.size(); ++i) {
    const Eigen::Vector3d c = (255.0 * theirs.colors_[i]).array().round();
    same += theirs.points_[i].cast<float>() == result.cloud.points[i] &&
            theirs.normals_[i].cast<float>() == result.cloud.normals[i] &&
            io::Rgb{std::uint8_t(c.x()), std::uint8_t(c.y()), std::uint8_t(c.z())} == result.color(i);
  }
  CHECK(same == theirs.points_.size());

  REQUIRE(open3d::io::WritePointCloud(result.copy.string(), theirs));
  const io::CloudFile back = io::read_ply(result.copy);  // Open3D keeps no instances
  CHECK((back.cloud.points == result.cloud.points));
  REQUIRE(back.cloud.normals.size() == result.cloud.size());
  double normals = 0.0;
  for (std::size_t i = 0; i < back.cloud.size(); ++i)
    normals = std::max(normals, double((back.cloud.normals[i] - result.cloud.normals[i]).norm()));
  CHECK(normals < 1e-6);
}
