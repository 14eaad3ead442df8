// SPDX-License-Identifier: BSD-3-Clause
// Voxel averages: cells are anchored at the origin, so that shifts by whole cells and, where no point lies on a border
// (cells are half open), turns by right angles move the means with the points; their order is that of the cells. Means
// agree to the last bits of their sums.
#include <agrisee/cloud/voxel.hpp>

#include <map>

#include "properties/laws.hpp"

using namespace agrisee;

namespace {

constexpr double kLeaf = 0x1p-8;

template <typename S>
PointCloud<S> cloud_of(const laws::Points<S>& points) {
  PointCloud<S> out;
  out.points = points;
  return out;
}

/// Every cell by its coordinates, in the order of the answer: z, then y, then x.
template <typename S>
std::map<std::array<double, 3>, std::pair<Eigen::Vector3d, int>> cells_of(const laws::Points<S>& points, double leaf) {
  std::map<std::array<double, 3>, std::pair<Eigen::Vector3d, int>> cells;
  const double inverse = 1.0 / leaf;
  for (const auto& p : points) {
    if (!is_finite(p)) continue;
    const Eigen::Vector3d d = p.template cast<double>();
    auto& [sum, n] =
        cells
            .try_emplace({std::floor(d.z() * inverse), std::floor(d.y() * inverse), std::floor(d.x() * inverse)},
                         Eigen::Vector3d::Zero(), 0)
            .first->second;
    sum += (d - sum) / ++n;  // the running mean
  }
  return cells;
}

template <typename S>
void check_means(const PointCloud<S>& got, const std::vector<int>& members, const laws::Points<S>& points,
                 double leaf) {
  const auto cells = cells_of(points, leaf);
  REQUIRE(got.size() == cells.size());
  REQUIRE(members.size() == cells.size());
  std::size_t i = 0;
  for (const auto& [cell, mean] : cells) {
    INFO(i);
    const Eigen::Vector3d p = got.points[i].template cast<double>();
    REQUIRE(members[i] == mean.second);
    REQUIRE((p - mean.first).norm() <= 4.0 * double(std::numeric_limits<S>::epsilon()) * (mean.first.norm() + leaf));
    ++i;
  }
}

}  // namespace

TEMPLATE_TEST_CASE("voxels of exact and hostile clouds are what their definition says", "", float, double) {
  auto kinds = laws::hostile_kinds();
  for (const auto& kind : laws::exact_kinds()) kinds.push_back(kind);
  for (const auto& kind : kinds)
    for (const double leaf : {kLeaf, 0.0025, 1e-20, 1e6}) {
      INFO(kind << ", leaf " << leaf);
      const auto exact = laws::exact_cloud<TestType>(kind);
      const auto points = exact.empty() ? laws::hostile_cloud<TestType>(kind) : exact;
      std::vector<int> members;
      const auto got = average_in_voxels(cloud_of(points), leaf, &members);
      check_means(got, members, points, leaf);
    }
}

TEMPLATE_TEST_CASE("voxels: motions, scales, shuffles, copies and precision change nothing", "", float, double) {
  using S = TestType;
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  INFO(kind);
  const Eigen::Matrix3d still = Eigen::Matrix3d::Identity();
  // Half a unit off, so that no point is on a border of cells.
  const auto points = laws::moved(laws::exact_cloud<S>(kind), still, Eigen::Vector3d::Constant(0x1p-15));
  std::vector<int> members, other;
  const auto straight = average_in_voxels(cloud_of(points), kLeaf, &members);
  check_means(straight, members, points, kLeaf);
  const double last_bits = 8.0 * double(std::numeric_limits<S>::epsilon());
  const auto check = [&](const laws::Points<S>& got, const laws::Points<S>& expected, double bits) {
    REQUIRE(got.size() == expected.size());
    for (std::size_t i = 0; i < got.size(); ++i)
      REQUIRE(double((got[i] - expected[i]).norm()) <= bits * double(expected[i].norm() + S(kLeaf)));
  };
  check(average_in_voxels(cloud_of(laws::pick(points, laws::shuffled(points.size()))), kLeaf, &other).points,
        straight.points, last_bits);
  CHECK(other == members);
  check(average_in_voxels(cloud_of(laws::moved(points, still, laws::far_shift<S>())), kLeaf, &other).points,
        laws::moved(straight.points, still, laws::far_shift<S>()), last_bits);
  CHECK(other == members);
  for (const double by : {0.125, 64.0}) {
    check(average_in_voxels(cloud_of(laws::scaled(points, by)), by * kLeaf, &other).points,
          laws::scaled(straight.points, by), 0.0);
    CHECK(other == members);
  }
  check(average_in_voxels(cloud_of(laws::repeated(points, 3)), kLeaf, &other).points, straight.points, last_bits);
  for (std::size_t i = 0; i < other.size(); ++i) CHECK(other[i] == 3 * members[i]);
  for (const auto& turn : laws::right_angles()) {
    const auto turned = laws::moved(points, turn, {0, 0, 0});
    check_means(average_in_voxels(cloud_of(turned), kLeaf, &other), other, turned, kLeaf);
    std::vector<int> a = members, b = other;
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    CHECK(a == b);
  }
}
