// SPDX-License-Identifier: BSD-3-Clause
// Region growing, clustering and the whole chain against PCL and Open3D.
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/sor.hpp>

#ifdef PEERS_PCL
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/region_growing.h>
#endif
#ifdef PEERS_OPEN3D
#include <open3d/geometry/PointCloud.h>
#endif

#include "conversions.hpp"

using namespace agrisee;

namespace {

constexpr double kWhole = 1.0;  // m, no point is farther

/// PCL's rule.
RegionGrowingParameters growing() {
  RegionGrowingParameters p;
  p.neighbors = 25;
  p.min_size = 100;
  p.seeds_by_curvature = true;
  p.unsigned_normals = true;
  return p;
}

struct Normals {
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> curvatures;
};

Normals normals_of(const std::vector<Eigen::Vector3f>& points, int threads) {
  Normals out;
  out.normals = estimate_normals(points, {kWhole, 25}, threads, &out.curvatures);
  return out;
}

const Normals& normals_of(std::size_t n) {
  static std::map<std::size_t, Normals> all;
  Normals& mine = all[n];
  if (mine.normals.empty()) mine = normals_of(peers::cloud(n).points, 2);
  return mine;
}

#ifdef PEERS_PCL
using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

PclNormals::Ptr pcl_normals(const Normals& ours) {
  PclNormals::Ptr out(new PclNormals);
  for (std::size_t i = 0; i < ours.normals.size(); ++i) {
    const auto& v = ours.normals[i];
    pcl::Normal normal(v.x(), v.y(), v.z());
    normal.curvature = ours.curvatures[i];
    out->push_back(normal);
  }
  return out;
}

PclNormals::Ptr pcl_normals(std::size_t n) {
  static std::map<std::size_t, PclNormals::Ptr> all;
  auto& mine = all[n];
  if (!mine) mine = pcl_normals(normals_of(n));
  return mine;
}

Labels pcl_regions(const PclPoints::Ptr& points, const PclNormals::Ptr& normals) {
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> region_growing;
  region_growing.setInputCloud(points);
  region_growing.setInputNormals(normals);
  region_growing.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  region_growing.setNumberOfNeighbours(25);
  region_growing.setSmoothnessThreshold(static_cast<float>(deg(12.0)));
  region_growing.setCurvatureTestFlag(false);
  region_growing.setMinClusterSize(100);
  std::vector<pcl::PointIndices> clusters;
  region_growing.extract(clusters);
  Labels labels(points->size(), 0);
  for (std::size_t c = 0; c < clusters.size(); ++c)
    for (const auto i : clusters[c].indices) labels[static_cast<std::size_t>(i)] = static_cast<int>(c) + 1;
  return labels;
}

Labels pcl_clusters(const PclPoints::Ptr& points, double eps) {
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setInputCloud(points);
  extraction.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  extraction.setClusterTolerance(eps);
  extraction.setMinClusterSize(10);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  Labels labels(points->size(), 0);
  for (std::size_t c = 0; c < clusters.size(); ++c)
    for (const auto i : clusters[c].indices) labels[static_cast<std::size_t>(i)] = static_cast<int>(c) + 1;
  return labels;
}
#endif

/// Points whose labels differ.
std::size_t different(const Labels& a, const Labels& b) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out += a[i] != b[i];
  return out;
}

void regions(std::size_t n, int threads) {
  const auto ours = [=](int t) {
    const Normals& normals = normals_of(n);
    return grow_regions(peers::cloud(n), normals.normals, growing(), normals.curvatures, t);
  };
  peers::add("region_growing", "ours", n, threads, ours, peers::Unchecked());
#ifdef PEERS_PCL
  if (threads == 1)
    peers::add(
        "region_growing", "PCL", n, threads, [=](int) { return pcl_regions(peers::pcl_cloud(n), pcl_normals(n)); },
        [=](const Labels& theirs) {  // equal curvatures come in no fixed order there
          peers::require(different(theirs, ours(1)) <= n / 1000, "regions of PCL");
        });
#endif
}

void clusters(std::size_t n, int threads) {
  const double eps = peers::radius_of(n, 20);
  const auto ours = [=](int t) { return dbscan(peers::cloud(n), {eps, 10}, t); };
  peers::add("dbscan", "ours", n, threads, ours, peers::Unchecked());
#ifdef PEERS_PCL
  if (threads == 1)  // without a core test, so its answer is another
    peers::add(
        "dbscan", "PCL Euclidean", n, threads, [=](int) { return pcl_clusters(peers::pcl_cloud(n), eps); },
        peers::Unchecked());
#endif
#ifdef PEERS_OPEN3D
  peers::add(
      "dbscan", "Open3D", n, threads,
      [=](int) {
        Labels labels = peers::open3d_cloud(n).ClusterDBSCAN(eps, 10);
        for (int& label : labels) ++label;
        return labels;
      },
      [=](const Labels& theirs) {  // distances there are double
        peers::require(different(theirs, ours(1)) <= n / 10000, "clusters of Open3D");
      });
#endif
}

/// Points that stay, regions and clusters of the residual.
using Counts = std::array<std::size_t, 3>;

std::size_t labels_in(const Labels& labels) {
  return labels.empty() ? 0 : static_cast<std::size_t>(*std::max_element(labels.begin(), labels.end()));
}

Counts our_chain(std::size_t n, int threads) {
  const Cloud& all = peers::cloud(n);
  const Indices kept = remove_statistical_outliers(all, {20, 2.0, true}, threads);
  const auto points = select(peers::bare_cloud(n), kept).points;
  Normals normals;
  normals.normals = estimate_normals(points, {kWhole, 25}, threads, &normals.curvatures);
  const Labels labels = grow_regions(points, normals.normals, growing(), normals.curvatures, threads);
  std::vector<Eigen::Vector3f> rest;
  for (const Index i : residual(labels)) rest.push_back(points[static_cast<std::size_t>(i)]);
  return {kept.size(), labels_in(labels), labels_in(dbscan(rest, {peers::radius_of(n, 20), 10}, threads))};
}

void chain(std::size_t n, int threads) {
  const auto ours = [=](int t) { return our_chain(n, t); };
  peers::add("chain", "ours", n, threads, ours, peers::Unchecked());
#ifdef PEERS_PCL
  peers::add(
      "chain", "PCL", n, threads,
      [=](int t) {
        pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
        filter.setInputCloud(peers::pcl_cloud(n));
        filter.setMeanK(20);
        filter.setStddevMulThresh(2.0);
        PclPoints::Ptr kept(new PclPoints);
        filter.filter(*kept);
        pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(static_cast<unsigned>(t));
        estimation.setInputCloud(kept);
        estimation.setKSearch(25);
        PclNormals::Ptr normals(new PclNormals);
        estimation.compute(*normals);
        const Labels labels = pcl_regions(kept, normals);
        PclPoints::Ptr rest(new PclPoints);
        for (std::size_t i = 0; i < labels.size(); ++i)
          if (labels[i] == 0) rest->push_back((*kept)[i]);
        return Counts{kept->size(), labels_in(labels), labels_in(pcl_clusters(rest, peers::radius_of(n, 20)))};
      },
      [=](const Counts& theirs) {
        const Counts mine = ours(1);
        peers::require(theirs[0] <= mine[0] + 2 && mine[0] <= theirs[0] + 2 && theirs[1] == mine[1],
                       "chain of PCL: " + std::to_string(theirs[0]) + " points, " + std::to_string(theirs[1]) +
                           " regions; ours " + std::to_string(mine[0]) + ", " + std::to_string(mine[1]));
      });
#endif
}

}  // namespace

int main(int argc, char** argv) {
  peers::for_sizes([](std::size_t n, int threads) {
    regions(n, threads);
    clusters(n, threads);
    chain(n, threads);
  });
  return peers::main(argc, argv);
}
