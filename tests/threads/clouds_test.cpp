// SPDX-License-Identifier: BSD-3-Clause
// Stages on clouds, large enough for several threads: the same answer as from one. ThreadSanitizer looks at this
// program in CI (AGRISEE_SANITIZE).
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/see/density.hpp>

#include <algorithm>
#include <thread>

#include "catch.hpp"

using namespace agrisee;

namespace {

constexpr int kThreads = 4;

/// Eight noisy spheres that touch; 2 mm between points.
const std::vector<Eigen::Vector3f>& fruit() {
  static const std::vector<Eigen::Vector3f> points = [] {
    Rng rng(3);
    std::vector<Eigen::Vector3f> p;
    for (int i = 0; i < 16000; ++i) {
      const Eigen::Vector3d center(0.06 * (i % 2), 0.06 * (i / 2 % 2), 0.06 * (i / 4 % 2));
      p.push_back((center + (0.03 + 0.0003 * rng.normal()) * rng.direction()).cast<float>());
    }
    return p;
  }();
  return points;
}

}  // namespace

TEST_CASE("threads: lists of neighbors") {
  CHECK(nearest_neighbors(fruit(), 12, 1).ids == nearest_neighbors(fruit(), 12, kThreads).ids);
}

TEST_CASE("threads: grids") {  // large enough to be divided, with gaps and points that are not finite
  Rng rng(8);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 90000; ++i)
    points.push_back(i % 7 == 0 && i > 0 ? points.back()
                                         : Eigen::Vector3f((0.1 * rng.uniform() * rng.direction()).cast<float>()));
  for (std::size_t i = 0; i < points.size(); i += 997) points[i].y() = std::nanf("");
  for (const float cell : {0.002f, 0.02f, 0.5f}) {
    const Grid one(points, cell);
    for (const int threads : {2, 3, kThreads}) {
      INFO("cell " << cell << ", threads " << threads);
      const Grid more(points, cell, threads);
      CHECK(one.ids() == more.ids());
      CHECK(one.x() == more.x());
      CHECK(one.y() == more.y());
      CHECK(one.z() == more.z());
      for (int x = -1; x < 102; ++x)
        for (int z = 0; z < 100; z += 9) REQUIRE(one.run(x, x + 1, 50, z) == more.run(x, x + 1, 50, z));
    }
    // In the order of the cells, and of the indices in a cell.
    std::size_t seen = 0;
    one.cells(0, one.stored(), [&](const Grid<float>::Cell&, std::size_t begin, std::size_t end) {
      CHECK(begin == seen);
      CHECK(std::is_sorted(one.ids().begin() + std::ptrdiff_t(begin), one.ids().begin() + std::ptrdiff_t(end)));
      seen = end;
    });
    CHECK(seen == points.size() - 91);
  }
  CHECK(nearest_neighbors(points, 5, 1).ids == nearest_neighbors(points, 5, kThreads).ids);
}

TEST_CASE("threads: outlier removal") {
  CHECK(remove_statistical_outliers(fruit(), {}, 1) == remove_statistical_outliers(fruit(), {}, kThreads));
}

TEST_CASE("threads: normals, their orientation, regions") {
  const auto axes = estimate_normals(fruit(), {}, 1);
  CHECK(axes == estimate_normals(fruit(), {}, kThreads));
  const auto normals = orient_normals_consistently(axes, fruit(), {}, 1);
  CHECK(normals == orient_normals_consistently(axes, fruit(), {}, kThreads));
  CHECK(grow_regions(fruit(), normals, {}, {}, 1) == grow_regions(fruit(), normals, {}, {}, kThreads));
  RegionGrowingParameters nearest;
  nearest.neighbors = 12;
  CHECK(grow_regions(fruit(), normals, nearest, {}, 1) == grow_regions(fruit(), normals, nearest, {}, kThreads));
}

TEST_CASE("threads: regions of points that are crowded, at one place, astray") {
  auto points = fruit();
  Rng rng(4);
  for (int i = 0; i < 3000; ++i) points.push_back({0, 0, 0});
  for (int i = 0; i < 3000; ++i) points.push_back({1.0f + 1e-4f * float(rng.uniform()), 0, 0});
  for (int i = 0; i < 500; ++i) points.push_back((3.0 * rng.uniform() * rng.direction()).cast<float>());
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < points.size(); ++i)
    normals.push_back((rng.direction() + 3.0 * Eigen::Vector3d::UnitZ()).normalized().cast<float>());
  RegionGrowingParameters p;
  p.neighbors = 8, p.min_size = 1;
  CHECK(grow_regions(points, normals, p, {}, 1) == grow_regions(points, normals, p, {}, kThreads));
}

TEST_CASE("threads: clusters") {
  CHECK(dbscan(fruit(), {0.003, 5}, 1) == dbscan(fruit(), {0.003, 5}, kThreads));
  CHECK(dbscan(fruit(), {0.02, 5}, 1) == dbscan(fruit(), {0.02, 5}, kThreads));
}

TEST_CASE("threads: density classes, from scratch and view by view") {
  const see::Parameters parameters;
  CHECK(see::classify(fruit(), parameters, 1).classes == see::classify(fruit(), parameters, kThreads).classes);
}

TEST_CASE("threads: registration") {
  const auto normals = estimate_normals(fruit(), {}, 1);
  Pose moved = Pose::Identity();
  moved.translation() = Eigen::Vector3d(0.001, -0.0005, 0.0008);
  const auto at = [&](int threads) {
    return register_cloud(fruit(), normals, fruit(), normals, {}, moved, threads).target_T_source.matrix().eval();
  };
  CHECK(at(1) == at(kThreads));
}

TEST_CASE("threads: a stage is cancelled from another thread") {
  Cancellation cancellation;
  std::thread other([&] { cancellation.request(); });
  try {
    const CancellationScope scope(cancellation);
    for (int i = 0; i < 3; ++i) remove_statistical_outliers(fruit(), {}, kThreads);
  } catch (const Cancelled&) {  // or it was faster
  }
  other.join();
  SUCCEED();
}
