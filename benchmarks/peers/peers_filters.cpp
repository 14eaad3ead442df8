// SPDX-License-Identifier: BSD-3-Clause
// Outlier removal, normals and voxel averaging against PCL and Open3D.
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/cloud/voxel.hpp>

#ifdef PEERS_PCL
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/search/kdtree.h>
#endif
#ifdef PEERS_OPEN3D
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#endif

#include "conversions.hpp"

using namespace agrisee;

namespace {

constexpr double kWhole = 1.0;  // m, no point is farther

/// Shares of points that may differ: theirs are decided by other roundings.
void same_points(const Indices& a, const Indices& b, const char* what) {
  Indices different;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(different));
  peers::require(different.size() <= 1 + a.size() / 50000, what);
}

void outliers(std::size_t n, int threads) {
  const auto ours = [=](int t) { return remove_statistical_outliers(peers::cloud(n), {20, 2.0, true}, t); };
  peers::add("sor", "ours", n, threads, ours, peers::Unchecked());
#ifdef PEERS_PCL
  if (threads == 1)
    peers::add(
        "sor", "PCL", n, threads,
        [=](int) {
          pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
          filter.setInputCloud(peers::pcl_cloud(n));
          filter.setMeanK(20);
          filter.setStddevMulThresh(2.0);
          pcl::Indices kept;
          filter.filter(kept);
          return Indices(kept.begin(), kept.end());
        },
        [=](const Indices& theirs) { same_points(ours(1), theirs, "outlier removal of PCL"); });
#endif
#ifdef PEERS_OPEN3D
  peers::add(
      "sor", "Open3D", n, threads,
      [=](int) {
        const auto kept = std::get<1>(peers::open3d_cloud(n).RemoveStatisticalOutliers(21, 2.0));
        return Indices(kept.begin(), kept.end());
      },
      [=](const Indices& theirs) { same_points(ours(1), theirs, "outlier removal of Open3D"); });
#endif
}

template <typename At>
void same_normals(std::size_t n, At&& theirs, const char* what) {
  const auto mine = estimate_normals(peers::cloud(n), {kWhole, 25});
  std::size_t same = 0;
  for (std::size_t i = 0; i < n; ++i) same += std::abs(mine[i].dot(theirs(i))) > std::cos(deg(0.5));
  peers::require(same > n * 99 / 100, what);
}

void normals(std::size_t n, int threads) {
  peers::add(
      "normals", "ours", n, threads,
      [=](int t) {
        return estimate_normals(peers::cloud(n), {kWhole, 25}, t);
      },
      peers::Unchecked());
#ifdef PEERS_PCL
  peers::add(
      "normals", "PCL", n, threads,
      [=](int t) {
        pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(static_cast<unsigned>(t));
        estimation.setInputCloud(peers::pcl_cloud(n));
        estimation.setKSearch(25);
        pcl::PointCloud<pcl::Normal> out;
        estimation.compute(out);
        return out;
      },
      [=](const auto& theirs) {
        same_normals(
            n, [&](std::size_t i) { return theirs[i].getNormalVector3fMap(); }, "normals of PCL");
      });
#endif
#ifdef PEERS_OPEN3D
  peers::add(
      "normals", "Open3D", n, threads,
      [=](int) {
        auto& cloud = peers::open3d_cloud(n);
        cloud.normals_.clear();
        cloud.EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(25));
        return cloud.normals_;
      },
      [=](const auto& theirs) {
        same_normals(
            n, [&](std::size_t i) { return Eigen::Vector3f(theirs[i].template cast<float>()); }, "normals of Open3D");
      });
#endif
}

void voxels(std::size_t n) {
  const auto ours = [=](int) { return average_in_voxels(peers::bare_cloud(n), 0.002).points; };
  peers::add("voxel", "ours", n, 1, ours, peers::Unchecked());
#ifdef PEERS_PCL
  peers::add(
      "voxel", "PCL", n, 1,
      [=](int) {
        pcl::VoxelGrid<pcl::PointXYZ> filter;
        filter.setInputCloud(peers::pcl_cloud(n));
        filter.setLeafSize(0.002f, 0.002f, 0.002f);
        pcl::PointCloud<pcl::PointXYZ> out;
        filter.filter(out);
        return out;
      },
      [=](const auto& theirs) {  // the floor of x / leaf in float moves single points to the next cell
        const double mine = static_cast<double>(ours(1).size());
        peers::require(std::abs(mine - static_cast<double>(theirs.size())) < 1e-3 * mine, "voxels of PCL");
      });
#endif
#ifdef PEERS_OPEN3D
  peers::add(
      "voxel", "Open3D", n, 1, [=](int) { return peers::open3d_cloud(n).VoxelDownSample(0.002)->points_; },
      peers::Unchecked());  // its cells are anchored elsewhere
#endif
}

}  // namespace

int main(int argc, char** argv) {
  peers::for_sizes([](std::size_t n, int threads) {
    outliers(n, threads);
    normals(n, threads);
    if (threads == 1) voxels(n);
  });
  return peers::main(argc, argv);
}
