// SPDX-License-Identifier: BSD-3-Clause
// DBSCAN, outlier removal and normals against Open3D.
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/sor.hpp>

#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

TEST_CASE("Open3D's DBSCAN finds the same clusters, border points aside") {
  for (const std::string kind : {"random", "spheres", "outliers", "duplicated", "equal"}) {
    INFO(kind);
    const auto cloud = cases::cloud_of<double>(kind, 2000);
    const open3d::geometry::PointCloud theirs_in(cloud);
    for (const double eps : {0.0021, 0.0045, 0.007})
      for (const int min_points : {1, 4, 12, 60}) {
        INFO(eps << " " << min_points);
        Labels theirs = theirs_in.ClusterDBSCAN(eps, static_cast<std::size_t>(min_points));
        for (int& label : theirs) ++label;  // -1 is their noise
        CHECK((dbscan(cloud, {eps, min_points}) == theirs));
      }
  }
}

TEST_CASE("Open3D's outlier removal keeps the same points with one neighbor more") {
  for (const std::string kind : {"random", "spheres", "outliers"}) {
    INFO(kind);
    const auto cloud = cases::cloud_of<double>(kind, 3000);
    for (const int k : {1, 8, 20}) {
      const auto [rest, kept] =
          open3d::geometry::PointCloud(cloud).RemoveStatisticalOutliers(static_cast<std::size_t>(k) + 1, 1.0);
      Indices theirs;
      for (const std::size_t i : kept) theirs.push_back(static_cast<Index>(i));
      const Indices ours = remove_statistical_outliers(cloud, {k, 1.0, true});
      CHECK(ours.size() < cloud.size());
      CHECK((ours == theirs));
    }
  }
}

TEST_CASE("Open3D's hybrid normals are the same") {
  const auto cloud = cases::cloud_of<double>("spheres", 3000);
  open3d::geometry::PointCloud theirs(cloud);
  theirs.EstimateNormals(open3d::geometry::KDTreeSearchParamHybrid(0.006, 25));
  const auto normals = estimate_normals(cloud);
  std::size_t known = 0, same = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (normals[i].isZero(0)) continue;
    ++known;
    same += std::abs(normals[i].dot(theirs.normals_[i])) > std::cos(deg(0.01));
  }
  CHECK(known > 2900);
  CHECK(same == known);
}
