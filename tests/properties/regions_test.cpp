// SPDX-License-Identifier: BSD-3-Clause
// Region growing: with the paper's rule regions are the parts of a graph, so that labels are the same, numbers
// included, as long as the order of the points is, and up to their numbers in any order. With k nearest neighbors or
// growth from flat points alone earlier seeds win, and shuffles may move points between regions: not tested here but
// for motions.
#include <agrisee/cloud/region_growing.hpp>

#include "properties/oracles.hpp"

using namespace agrisee;

namespace {

/// Normals that any exact motion turns exactly: along axes, and along diagonals of two, of length about one.
template <typename S>
laws::Points<S> exact_normals(std::size_t n) {
  Rng rng(17);
  laws::Points<S> out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto kind = rng.below(10);
    Vector3<S> v(0, 0, 1);
    if (kind == 7) v = Vector3<S>(0, S(0.703125), S(0.703125));
    if (kind == 8) v = Vector3<S>(S(0.703125), 0, S(0.703125));
    if (kind == 9) v.setZero();
    out.push_back(v);
  }
  return out;
}

RegionGrowingParameters parameters(int mode, double scale = 1.0) {
  RegionGrowingParameters p;
  p.radius = scale * (mode == 0 ? 0x1p-8 : 0x1.8p-8);  // exactly the spacing of "lattice", and more
  p.smoothness = deg(mode == 1 ? 50.0 : 30.0);
  p.min_size = mode == 1 ? 1 : 4;
  p.unsigned_normals = mode == 2;
  p.neighbors = mode == 3 ? 9 : 0;
  return p;
}

}  // namespace

TEMPLATE_TEST_CASE("region growing: motions, scales, shuffles and precision change nothing", "", float, double) {
  using S = TestType;
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const int mode = GENERATE(0, 1, 2, 3);
  INFO(kind << ", mode " << mode);
  const auto cloud = laws::exact_cloud<S>(kind);
  const auto normals = exact_normals<S>(cloud.size());
  const Labels straight = grow_regions(cloud, normals, parameters(mode));
  CHECK(grow_regions(cloud, normals, parameters(mode), {}, 3) == straight);
  for (const auto& turn : laws::right_angles())
    CHECK(grow_regions(laws::moved(cloud, turn, laws::far_shift<S>()), laws::moved(normals, turn, {0, 0, 0}),
                       parameters(mode)) == straight);
  for (const double by : {0.125, 3.0, 64.0})
    CHECK(grow_regions(laws::scaled(cloud, by), normals, parameters(mode, by)) == straight);
  CHECK(grow_regions(laws::exact_cloud<double>(kind), exact_normals<double>(cloud.size()), parameters(mode)) ==
        straight);
  if (mode == 3) return;
  const Indices order = laws::shuffled(cloud.size());
  CHECK(laws::partition(grow_regions(laws::pick(cloud, order), laws::pick(normals, order), parameters(mode))) ==
        laws::partition(laws::pick(straight, order)));
}

TEMPLATE_TEST_CASE("region growing: m of each point and m times the least size change nothing", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  INFO(kind);
  const auto cloud = laws::exact_cloud<TestType>(kind);
  const auto normals = exact_normals<TestType>(cloud.size());
  for (const std::size_t m : {2u, 5u}) {
    RegionGrowingParameters more = parameters(0);
    more.min_size *= static_cast<int>(m);
    CHECK(grow_regions(laws::repeated(cloud, m), laws::repeated(normals, m), more) ==
          laws::repeated(grow_regions(cloud, normals, parameters(0)), m));
  }
}

TEMPLATE_TEST_CASE("region growing of exact and hostile clouds is what its definition says", "", float, double) {
  auto kinds = laws::hostile_kinds();
  for (const auto& kind : laws::exact_kinds()) kinds.push_back(kind);
  for (const auto& kind : kinds) {
    const auto exact = laws::exact_cloud<TestType>(kind);
    const auto cloud = exact.empty() ? laws::hostile_cloud<TestType>(kind) : exact;
    auto normals = exact_normals<TestType>(cloud.size());
    for (std::size_t i = 0; i < normals.size(); i += 37) normals[i].x() = std::numeric_limits<TestType>::quiet_NaN();
    for (const double radius : {0x1p-8, 0x1.8p-8, 0.3, 1e-18, 1e10})
      for (const double smoothness : {0.3, 0.9, 2.0})
        for (const int min_size : {1, 4}) {
          INFO(kind << ", radius " << radius << ", smoothness " << smoothness << ", min_size " << min_size);
          RegionGrowingParameters p;
          p.radius = radius, p.smoothness = smoothness, p.min_size = min_size;
          const Labels expected = oracle::regions(cloud, normals, radius, smoothness, min_size);
          CHECK((grow_regions(cloud, normals, p, {}, 2) == expected));
        }
  }
}
