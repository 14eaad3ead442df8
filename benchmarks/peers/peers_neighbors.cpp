// SPDX-License-Identifier: BSD-3-Clause
// Neighbors of all points: how many within a radius, and the k nearest; against nanoflann, trees included.
#include <agrisee/core/parallel.hpp>
#include <agrisee/neighbors/count_neighbors.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <nanoflann.hpp>

#include "peers.hpp"

using namespace agrisee;

namespace {

struct Points {
  const std::vector<Eigen::Vector3f>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t d) const { return points[i][static_cast<Eigen::Index>(d)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, int>;

/// Counts, without storing what it finds.
struct Counter {
  float r_sq;
  int found = 0;
  bool full() const { return true; }
  float worstDist() const { return r_sq; }
  bool addPoint(float d_sq, int) {
    found += d_sq <= r_sq;
    return true;
  }
};

std::vector<int> nanoflann_counts(const Cloud& cloud, float r, int threads) {
  const Points points{cloud.points};
  Tree tree(3, points);
  tree.buildIndex();
  std::vector<int> counts(cloud.size());
  parallel_for(cloud.size(), threads, [&](std::size_t i) {
    Counter counter{r * r};
    tree.findNeighbors(counter, cloud.points[i].data(), {});
    counts[i] = counter.found;
  });
  return counts;
}

Indices nanoflann_nearest(const Cloud& cloud, std::size_t k, int threads) {
  const Points points{cloud.points};
  Tree tree(3, points);
  tree.buildIndex();
  Indices out(cloud.size() * k);
  parallel_chunks(cloud.size(), threads, 512, [&](std::size_t begin, std::size_t end) {
    std::vector<float> distances(k);
    for (std::size_t i = begin; i < end; ++i) tree.knnSearch(cloud.points[i].data(), k, &out[i * k], distances.data());
  });
  return out;
}

void counts(const char* stage, std::size_t n, int threads, double neighbors) {
  const float r = peers::radius_of(n, neighbors);
  const auto ours = [=](int t) { return count_neighbors(peers::cloud(n), r, t); };
  peers::add(stage, "ours", n, threads, ours, peers::Unchecked());
  peers::add(
      stage, "nanoflann", n, threads, [=](int t) { return nanoflann_counts(peers::cloud(n), r, t); },
      [=](const auto& theirs) {  // its bounds carry rounding errors, which costs it a few points at the very radius
        const auto mine = ours(1);
        std::size_t different = 0;
        for (std::size_t i = 0; i < n; ++i) different += mine[i] != theirs[i];
        peers::require(different <= n / 1000, std::string(stage) + " of nanoflann");
      });
}

void nearest(std::size_t n, int threads) {
  constexpr std::size_t k = 20;
  const auto ours = [=](int t) { return nearest_neighbors(peers::cloud(n), k, t).ids; };
  peers::add("knn", "ours", n, threads, ours, peers::Unchecked());
  peers::add(
      "knn", "nanoflann", n, threads, [=](int t) { return nanoflann_nearest(peers::cloud(n), k, t); },
      [=](const Indices& theirs) {
        const Indices mine = ours(1);
        const auto& p = peers::cloud(n).points;
        const auto at = [&](Index i) { return p[static_cast<std::size_t>(i)]; };
        for (std::size_t i = 0; i < mine.size(); ++i)  // ties may be ordered otherwise
          peers::require(distance_sq<float>(at(mine[i]), p[i / k]) == distance_sq<float>(at(theirs[i]), p[i / k]),
                         "nearest neighbors of nanoflann");
      });
}

}  // namespace

int main(int argc, char** argv) {
  peers::for_sizes([](std::size_t n, int threads) {
    counts("density", n, threads, n <= 150000 ? 1500 : 300);
    counts("radius_count", n, threads, 50);
    nearest(n, threads);
  });
  return peers::main(argc, argv);
}
