// SPDX-License-Identifier: BSD-3-Clause
// cloud.ply through PCL and back.
#include <pcl/PCLPointCloud2.h>
#include <pcl/conversions.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include "interop/result_cloud.hpp"

using namespace agrisee;

TEST_CASE("PCL reads points, normals, colors and instances of cloud.ply, and what it writes is the same cloud") {
  const test::ResultCloud result("pcl");
  pcl::PCLPointCloud2 message;
  REQUIRE(pcl::PLYReader().read(result.file.string(), message) == 0);
  pcl::PointCloud<pcl::PointXYZRGBNormal> theirs;
  pcl::fromPCLPointCloud2(message, theirs);
  REQUIRE(theirs.size() == result.cloud.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < theirs.size(); ++i)
    same += theirs[i].getVector3fMap() == result.cloud.points[i] &&
            theirs[i].getNormalVector3fMap() == result.cloud.normals[i] &&
            io::Rgb{theirs[i].r, theirs[i].g, theirs[i].b} == result.color(i);
  CHECK(same == theirs.size());

  for (const bool binary : {true, false}) {
    INFO(binary);
    REQUIRE(pcl::PLYWriter().write(result.copy.string(), message, Eigen::Vector4f::Zero(),
                                   Eigen::Quaternionf::Identity(), binary, false) == 0);
    const io::CloudFile back = io::read_ply(result.copy);
    CHECK((back.instance == result.labels));
    REQUIRE(back.cloud.size() == result.cloud.size());
    REQUIRE(back.cloud.normals.size() == result.cloud.size());
    double points = 0.0, normals = 0.0;  // their text keeps six digits, and our reader makes normals unit anew
    for (std::size_t i = 0; i < back.cloud.size(); ++i) {
      points = std::max(points, double((back.cloud.points[i] - result.cloud.points[i]).norm()));
      normals = std::max(normals, double((back.cloud.normals[i] - result.cloud.normals[i]).norm()));
    }
    CHECK(points <= (binary ? 0.0 : 2e-6));
    CHECK(normals < 2e-6);
  }
}
