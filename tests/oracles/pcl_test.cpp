// SPDX-License-Identifier: BSD-3-Clause
// Outlier removal, normals and region growing against PCL, on noisy touching spheres.
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/sor.hpp>

#include <pcl/features/normal_3d.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

PclPoints::Ptr to_pcl(const cases::Points<float>& points) {
  PclPoints::Ptr out(new PclPoints);
  for (const auto& p : points) out->emplace_back(p.x(), p.y(), p.z());
  return out;
}

PclNormals::Ptr pcl_normals(const PclPoints::Ptr& points, int k) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(points);
  estimation.setKSearch(k);
  PclNormals::Ptr out(new PclNormals);
  estimation.compute(*out);
  return out;
}

}  // namespace

TEST_CASE("PCL's outlier removal keeps the same points") {
  for (const std::string kind : {"random", "spheres", "outliers", "duplicated"}) {
    INFO(kind);
    const auto cloud = cases::cloud_of<float>(kind, 3000);
    for (const int k : {1, 8, 20}) {
      pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
      filter.setInputCloud(to_pcl(cloud));
      filter.setMeanK(k);
      filter.setStddevMulThresh(1.0);
      pcl::Indices kept;
      filter.filter(kept);
      const Indices ours = remove_statistical_outliers(cloud, {k, 1.0, true});
      if (kind != "duplicated") CHECK(ours.size() < cloud.size());
      CHECK((Indices(kept.begin(), kept.end()) == ours));
    }
  }
}

TEST_CASE("PCL's normals and curvatures are the same") {
  for (const std::string kind : {"random", "spheres"}) {
    INFO(kind);
    const auto cloud = cases::cloud_of<float>(kind, 3000);
    std::vector<float> curvatures;
    const auto normals = estimate_normals(cloud, {1.0, 25}, KdTree(cloud), 1, &curvatures);
    const auto theirs = pcl_normals(to_pcl(cloud), 25);
    std::size_t same = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3f n = (*theirs)[i].getNormalVector3fMap();
      same +=
          std::abs(normals[i].dot(n)) > std::cos(deg(0.5)) && std::abs(curvatures[i] - (*theirs)[i].curvature) < 1e-3f;
    }
    CHECK(same > cloud.size() * 99 / 100);  // theirs sums in single precision, which round neighborhoods notice
  }
}

TEST_CASE("PCL's region growing finds the same regions") {
  for (const std::string kind : {"random", "spheres", "outliers"}) {
    INFO(kind);
    const auto cloud = cases::cloud_of<float>(kind, 4000);
    const auto points = to_pcl(cloud);
    const auto normals = pcl_normals(points, 25);  // theirs, so that this stage alone is compared
    cases::Points<float> ours_in;
    std::vector<float> curvatures;
    for (const auto& n : *normals) {
      ours_in.push_back(n.getNormalVector3fMap());
      curvatures.push_back(n.curvature);
    }
    for (const double angle : {6.0, 12.0})
      for (const bool gate : {false, true}) {
        INFO(angle << " " << gate);
        pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
        growing.setInputCloud(points);
        growing.setInputNormals(normals);
        growing.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
        growing.setNumberOfNeighbours(20);
        growing.setSmoothnessThreshold(static_cast<float>(deg(angle)));
        growing.setCurvatureTestFlag(gate);
        growing.setCurvatureThreshold(0.01f);
        growing.setMinClusterSize(30);
        std::vector<pcl::PointIndices> clusters;
        growing.extract(clusters);
        Labels theirs(cloud.size(), 0);
        for (std::size_t c = 0; c < clusters.size(); ++c)
          for (const auto i : clusters[c].indices) theirs[static_cast<std::size_t>(i)] = static_cast<int>(c) + 1;

        RegionGrowingParameters parameters;
        parameters.neighbors = 20;
        parameters.smoothness = deg(angle);
        parameters.min_size = 30;
        parameters.seeds_by_curvature = true;
        parameters.unsigned_normals = true;
        parameters.max_curvature = gate ? 0.01 : 1.0;
        CHECK((grow_regions(cloud, ours_in, parameters, KdTree(cloud), curvatures) == theirs));
      }
  }
}
