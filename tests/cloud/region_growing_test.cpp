// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <deque>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

namespace {

/// The algorithm of the paper and, by its options, of PCL, on lists of all neighbors.
template <typename S>
Labels brute(const cases::Points<S>& cloud, const cases::Points<S>& normals, const RegionGrowingParameters& parameters,
             const std::vector<S>& curvatures) {
  const std::size_t n = cloud.size();
  const auto usable = [&](std::size_t i) { return is_finite(cloud[i]) && normals[i].norm() > 0; };
  const auto neighbors = [&](std::size_t i) {
    std::vector<std::pair<S, std::size_t>> near;
    for (std::size_t j = 0; j < n; ++j) {
      const S d_sq = distance_sq<S>(cloud[j], cloud[i]);
      if (is_finite(cloud[j]) && (parameters.neighbors > 0 || d_sq < S(parameters.radius) * S(parameters.radius)))
        near.emplace_back(d_sq, j);
    }
    std::sort(near.begin(), near.end());
    if (parameters.neighbors > 0) near.resize(std::min(near.size(), static_cast<std::size_t>(parameters.neighbors)));
    return near;
  };
  std::vector<std::size_t> seeds(n);
  for (std::size_t i = 0; i < n; ++i) seeds[i] = i;
  if (parameters.seeds_by_curvature)
    std::stable_sort(seeds.begin(), seeds.end(), [&](auto a, auto b) { return curvatures[a] < curvatures[b]; });
  std::vector<char> visited(n, 0);
  Labels labels(n, 0);
  int label = 0;
  for (const std::size_t seed : seeds) {
    if (visited[seed] || !usable(seed)) continue;
    std::vector<std::size_t> region{seed};
    std::deque<std::size_t> queue{seed};
    visited[seed] = 1;
    while (!queue.empty()) {
      const std::size_t j = queue.front();
      queue.pop_front();
      for (const auto& [d_sq, k] : neighbors(j)) {
        if (visited[k] || !usable(k)) continue;
        const S cosine = normals[j].dot(normals[k]);
        if (!((parameters.unsigned_normals ? std::abs(cosine) : cosine) > S(std::cos(parameters.smoothness)))) continue;
        visited[k] = 1;
        region.push_back(k);
        if (curvatures[k] <= S(parameters.max_curvature)) queue.push_back(k);
      }
    }
    if (region.size() < static_cast<std::size_t>(parameters.min_size)) continue;
    ++label;
    for (const std::size_t k : region) labels[k] = label;
  }
  return labels;
}

RegionGrowingParameters parameters_of(int mode) {
  RegionGrowingParameters p;
  p.radius = mode % 2 ? 0.006 : 0.01171875;  // the second is three spacings of "gridded": ties at r
  p.smoothness = deg(mode < 4 ? 25.0 : 12.0);
  p.min_size = mode < 3 ? 5 : mode < 6 ? 40 : 1;
  p.neighbors = mode == 6 ? 5 : mode >= 4 ? 12 : 0;
  p.seeds_by_curvature = mode >= 3;
  p.unsigned_normals = mode >= 2;
  p.max_curvature = mode == 5 ? 0.02 : 1.0;
  return p;
}

template <typename S>
void check_brute(const std::string& kind) {
  const auto cloud = cases::cloud_of<S>(kind);
  std::vector<S> curvatures;
  const auto normals = estimate_normals(cloud, {0.008, 20}, 1, &curvatures);
  for (int mode = 0; mode < 7; ++mode) {
    INFO(mode);
    const auto parameters = parameters_of(mode);
    const Labels expected = brute<S>(cloud, normals, parameters, curvatures);
    CHECK(grow_regions(cloud, normals, parameters, curvatures) == expected);
    CHECK(grow_regions(cloud, normals, parameters, curvatures, 2) == expected);
    CHECK(grow_regions(cloud, normals, parameters, KdTree<S>(cloud), curvatures) == expected);
    if (parameters.neighbors == 0) continue;
    const auto lists = nearest_neighbors(cloud, static_cast<std::size_t>(parameters.neighbors), 2);
    CHECK(grow_regions(cloud, normals, parameters, lists, curvatures) == expected);
  }
}

cases::Points<double> sphere_normals(const cases::Points<double>& points, const Eigen::Vector3d& first,
                                     const Eigen::Vector3d& second) {
  cases::Points<double> out;
  for (const auto& p : points)
    out.push_back(((p - first).norm() < (p - second).norm() ? p - first : p - second).normalized());
  return out;
}

}  // namespace

TEST_CASE("region growing equals the published algorithms") {
  for (const auto& kind : cases::kinds()) {
    INFO(kind);
    check_brute<float>(kind);
    check_brute<double>(kind);
  }
}

TEST_CASE("region growing separates touching spheres, and obeys the laws") {
  const Eigen::Vector3d first(0.2, 0.5, 0.3), second(0.261, 0.5, 0.3);
  const auto points = cases::cloud_of<double>("spheres", 3000);
  RegionGrowingParameters parameters;
  parameters.min_size = 100;
  const auto stage = [&](const auto& p, int) {
    const bool here = p.empty() || (p[0] - first).norm() < 0.1;
    const Pose motion = cases::some_motion();
    return grow_regions(p, here ? sphere_normals(p, first, second) : sphere_normals(p, motion * first, motion * second),
                        parameters);
  };
  cases::check_laws(points, stage,
                    [](const Labels& a, const Labels& b) { return cases::canonical(a) == cases::canonical(b); });
  const Labels labels = stage(points, 1);
  CHECK(*std::max_element(labels.begin(), labels.end()) == 2);
  for (std::size_t i = 0; i < points.size(); ++i) {  // point 0 lies on the second sphere
    const int mine = (points[i] - first).norm() < (points[i] - second).norm() ? 2 : 1;
    CHECK((labels[i] == 0 || labels[i] == mine));
  }
  CHECK(residual(labels).size() < 30);
}

TEST_CASE("a region's limits are strict, and small regions are residual") {
  const cases::Points<double> cloud{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const cases::Points<double> up(4, Eigen::Vector3d::UnitZ());
  RegionGrowingParameters p;
  p.smoothness = deg(10);
  p.min_size = 1;
  p.radius = 1.0;
  CHECK(grow_regions(cloud, up, p) == Labels{1, 2, 3, 4});
  p.radius = 1e-200;  // its square is 0
  CHECK(grow_regions(cases::Points<double>(4, {1, 1, 1}), up, p) == Labels{1, 2, 3, 4});
  p.radius = 1.0;
  p.radius = 1.001;
  CHECK(grow_regions(cloud, up, p) == Labels{1, 1, 1, 1});
  p.min_size = 5;
  CHECK(grow_regions(cloud, up, p) == Labels{0, 0, 0, 0});
  // Growth compares neighbors, not seeds: a slow turn by 9 degrees a point is one region.
  cases::Points<double> turning;
  for (int i = 0; i < 4; ++i) turning.push_back({std::sin(deg(9.0 * i)), 0, std::cos(deg(9.0 * i))});
  p.min_size = 2;
  CHECK(grow_regions(cloud, turning, p) == Labels{1, 1, 1, 1});
  turning[2].setZero();
  CHECK(grow_regions(cloud, turning, p) == Labels{1, 1, 0, 0});
  turning[2] = -Eigen::Vector3d(std::sin(deg(18.0)), 0, std::cos(deg(18.0)));
  CHECK(grow_regions(cloud, turning, p) == Labels{1, 1, 0, 0});
  p.unsigned_normals = true;
  CHECK(grow_regions(cloud, turning, p) == Labels{1, 1, 1, 1});
}

TEST_CASE("regions of nearest neighbors: crowds, strays and one-way edges, on any number of threads") {
  Rng rng(5);
  cases::Points<float> cloud, normals;
  const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    cloud.push_back(p.cast<float>());
    normals.push_back(n.normalized().cast<float>());
  };
  for (int i = 0; i < 3000; ++i) add(rng.direction(), rng.direction() + 3.0 * Eigen::Vector3d::UnitZ());
  for (int i = 0; i < 1500; ++i) add({0, 0, 0}, rng.direction() + 2.0 * Eigen::Vector3d::UnitZ());  // at one place
  for (int i = 0; i < 1500; ++i) add({2.0 + 1e-3 * rng.uniform(), 0, 0}, rng.direction());          // crowded
  for (int i = 0; i < 200; ++i) add(rng.direction() * (1.0 + 30.0 * rng.uniform()), rng.direction());
  std::vector<float> curvatures;
  for (std::size_t i = 0; i < cloud.size(); ++i) curvatures.push_back(float(rng.below(50)));
  for (const int k : {1, 2, 6, 12}) {
    const auto lists = nearest_neighbors(cloud, static_cast<std::size_t>(k));
    for (const double smoothness : {0.1, 0.3, 1.5})
      for (const bool by_curvature : {false, true}) {
        INFO(k << " neighbors, " << smoothness << " rad, by curvature: " << by_curvature);
        RegionGrowingParameters p;
        p.neighbors = k, p.smoothness = smoothness, p.min_size = 1, p.seeds_by_curvature = by_curvature;
        const Labels expected = grow_regions(cloud, normals, p, lists, curvatures);  // from seed to seed
        CHECK((grow_regions(cloud, normals, p, curvatures) == expected));
        CHECK((grow_regions(cloud, normals, p, curvatures, 3) == expected));
      }
  }
}

TEST_CASE("regions of nearest neighbors whose squared distances overflow, of points without a curvature or a normal") {
  for (const double scale : {1.0, 1e19, 1e20, 4e20}) {
    Rng rng(6);
    cases::Points<float> cloud, normals;
    std::vector<float> curvatures;
    for (int i = 0; i < 600; ++i) {
      cloud.push_back((scale * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform())).cast<float>());
      normals.push_back((rng.direction() + 2.0 * Eigen::Vector3d::UnitZ()).normalized().cast<float>());
      curvatures.push_back(float(rng.uniform()));
    }
    for (std::size_t i = 0; i < cloud.size(); i += 17) normals[i].setConstant(std::nanf(""));
    for (std::size_t i = 5; i < cloud.size(); i += 23) curvatures[i] = std::nanf("");
    RegionGrowingParameters p;
    p.min_size = 1, p.seeds_by_curvature = true;
    for (const int k : {1, 12, 599, 2500, 2000000000}) {
      INFO(k << " neighbors, scale " << scale);
      p.neighbors = k;
      const auto lists = nearest_neighbors(cloud, std::min<std::size_t>(static_cast<std::size_t>(k), cloud.size()));
      CHECK((grow_regions(cloud, normals, p, curvatures, 2) == grow_regions(cloud, normals, p, lists, curvatures)));
    }
  }
}

TEST_CASE("region growing of next to nothing, and bad input") {
  using P = cases::Points<float>;
  const P up(3, Eigen::Vector3f::UnitZ()), none;
  CHECK(grow_regions(none, none).empty());
  RegionGrowingParameters p;
  p.min_size = 1;
  CHECK(grow_regions(P{{1, 2, 3}}, P{{0, 0, 1}}, p) == Labels{1});
  const float nan = std::nanf("");
  CHECK(grow_regions(P{{1, 2, 3}, {nan, 0, 0}, {1, 2, 3}}, up, p) == Labels{1, 0, 1});
  CHECK(grow_regions(P(3, {1, 2, 3}), P{{0, 0, 1}, {nan, 0, 0}, {0, 0, 0}}, p) == Labels{1, 0, 0});
  CHECK_THROWS_AS(grow_regions(P(2, {0, 0, 0}), up), InputError);
  p.seeds_by_curvature = true;
  CHECK_THROWS_AS(grow_regions(P(3, {0, 0, 0}), up, p), InputError);
  const auto rejects = [&](auto change, const char* name) {
    RegionGrowingParameters bad;
    change(bad);
    CHECK(cases::rejects(name, [&] { grow_regions(P(3, {0, 0, 0}), up, bad); }));
  };
  rejects([](auto& b) { b.radius = 0; }, "radius");
  rejects([](auto& b) { b.radius = std::nan(""); }, "radius");
  rejects([](auto& b) { b.smoothness = -1; }, "smoothness");
  rejects([](auto& b) { b.min_size = 0; }, "min_size");
  rejects([](auto& b) { b.neighbors = -1; }, "neighbors");
  rejects([](auto& b) { b.max_curvature = -1; }, "max_curvature");
}
