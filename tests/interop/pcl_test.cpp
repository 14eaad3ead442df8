// SPDX-License-Identifier: BSD-3-Clause
// Clouds of PCL, in place.
#include <agrisee/cloud/sor.hpp>
#include <agrisee/interop/pcl.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/process.hpp>

#include <pcl/impl/point_types.hpp>
#include <pcl/point_types.h>

#include "interop/same_result.hpp"

using namespace agrisee;

namespace {

/// A point type of one's own: double precision, other members between.
struct OwnPoint {
  double x, y;
  int ring;
  double z;
};

template <typename T>
pcl::PointCloud<T> converted(const Cloud& cloud) {
  pcl::PointCloud<T> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    T p{};
    p.x = cloud.points[i].x();
    p.y = cloud.points[i].y();
    p.z = cloud.points[i].z();
    out.push_back(p);
  }
  out.is_dense = false;
  return out;
}

/// As docs/interop.md has it.
ScanResult as_documented(const pcl::PointCloud<pcl::PointXYZ>& pcl_cloud) {
  agrisee::CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d::Zero();  // where the points were seen from (m)
  const agrisee::ScanResult result = agrisee::process(pcl_cloud, {}, origin);
  return result;
}

/// As docs/interop.md has it.
ScanResult with_colors(const pcl::PointCloud<pcl::PointXYZRGB>& pcl_cloud, const CloudOrigin& origin) {
  agrisee::Cloud cloud = agrisee::finite_points(pcl_cloud);
  for (const pcl::PointXYZRGB& p : pcl_cloud)  // a color for each point that is left
    if (agrisee::is_finite(p.getVector3fMap())) cloud.colors.push_back({p.r, p.g, p.b});
  const agrisee::ScanResult result = agrisee::process(cloud, {}, origin);
  return result;
}

}  // namespace

TEST_CASE("PCL clouds of every point type give the same fruit as our own") {
  Cloud own = test::two_fruit();
  pcl::PointCloud<pcl::PointNormal> with_normals = converted<pcl::PointNormal>(own);
  for (std::size_t i = 0; i < own.size(); ++i) with_normals[i].getNormalVector3fMap() = own.normals[i];
  test::check_same(process(with_normals, {}, test::from_origin()), process(own, {}, test::from_origin()));

  own.normals.clear();
  const ScanResult expected = process(own, {}, test::from_origin());
  test::check_same(as_documented(converted<pcl::PointXYZ>(own)), expected);
  test::check_same(process(converted<pcl::PointXYZRGB>(own), {}, test::from_origin()), expected);
  test::check_same(process(converted<pcl::PointNormal>(own), {}, test::from_origin()), expected);  // normals unknown
  test::check_same(process(converted<OwnPoint>(own), {}, test::from_origin()), expected);
}

TEST_CASE("colors of PCL clouds count once they are added") {
  auto theirs = converted<pcl::PointXYZRGB>(test::two_fruit());
  for (auto& p : theirs) p.r = 200, p.g = 30, p.b = 20;
  CHECK(process(theirs, {}, test::from_origin()).raw.colors.empty());
  const ScanResult result = with_colors(theirs, test::from_origin());
  CHECK(result.raw.colors.size() == result.raw.size());
  REQUIRE(result.fruits.size() == 2);
  for (const Fruit& fruit : result.fruits) {
    REQUIRE(fruit.ripeness);
    CHECK(fruit.ripeness->grade == RipenessClass::red);
  }
}

TEST_CASE("stages read PCL clouds where they lie") {
  const Cloud own = test::two_fruit();
  const auto theirs = converted<pcl::PointXYZI>(own);
  CHECK((remove_statistical_outliers(theirs) == remove_statistical_outliers(own)));
  Neighbors<float> a, b;
  KdTree(theirs).knn(own.points[3], 9, a);
  KdTree(own).knn(own.points[3], 9, b);
  CHECK(a == b);
}
