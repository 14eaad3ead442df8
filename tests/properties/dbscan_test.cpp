// SPDX-License-Identifier: BSD-3-Clause
// DBSCAN: labels are the same, numbers included, as long as the order of the points is. Shuffles renumber the clusters
// and may give a border point within reach of two clusters to the other one: of those, core points, noise and the
// partition of the core points are the same.
#include <agrisee/cloud/dbscan.hpp>

#include "properties/oracles.hpp"

using namespace agrisee;

TEMPLATE_TEST_CASE("DBSCAN: motions, scales, shuffles and precision change nothing", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const int min_points = GENERATE(1, 4, 9);
  INFO(kind << ", min_points " << min_points);
  const double eps = 0x1p-8;  // the spacing of "lattice", twice that of "sheet": ties
  const auto cloud = laws::exact_cloud<TestType>(kind);
  const auto near = oracle::within(cloud, TestType(eps));
  laws::check_exact_laws<TestType>(
      kind,
      [&](const auto& p, double scale, int threads) {
        return dbscan(p, {scale * eps, min_points}, threads);
      },
      [&](const Labels& labels) {  // what every order of the points shares
        Labels kept;
        for (const int label : labels) kept.push_back(label > 0);
        return kept;
      });
  // The partition of the core points.
  const auto cores = [&](const Labels& labels, const Indices& order) {
    Labels out(labels.size(), 0);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const auto original = static_cast<std::size_t>(order[i]);
      if (near[original].size() >= static_cast<std::size_t>(min_points)) out[i] = labels[i];
    }
    return laws::partition(out);
  };
  const Labels straight = dbscan(cloud, {eps, min_points});
  const Indices order = laws::shuffled(cloud.size());
  CHECK(cores(dbscan(laws::pick(cloud, order), {eps, min_points}), order) == cores(laws::pick(straight, order), order));
}

TEMPLATE_TEST_CASE("DBSCAN: m of each point and m times the neighbors change nothing", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const std::size_t m = GENERATE(2u, 5u);
  INFO(kind << ", m " << m);
  const auto cloud = laws::exact_cloud<TestType>(kind);
  for (const int min_points : {1, 4, 9}) {
    const int more = min_points * static_cast<int>(m);
    CHECK(dbscan(laws::repeated(cloud, m), {0x1p-8, more}) == laws::repeated(dbscan(cloud, {0x1p-8, min_points}), m));
  }
}

TEMPLATE_TEST_CASE("DBSCAN of exact and hostile clouds is what its definition says", "", float, double) {
  auto kinds = laws::hostile_kinds();
  for (const auto& kind : laws::exact_kinds()) kinds.push_back(kind);
  for (const auto& kind : kinds) {
    const auto exact = laws::exact_cloud<TestType>(kind);
    const auto cloud = exact.empty() ? laws::hostile_cloud<TestType>(kind) : exact;
    for (const double eps : {0x1p-9, 0x1p-8, 0.3, 1e-18, 1e10})
      for (const int min_points : {1, 3, 12}) {
        INFO(kind << ", eps " << eps << ", min_points " << min_points);
        CHECK(
            (dbscan(cloud, {eps, min_points}, 2) == oracle::dbscan(cloud, eps, static_cast<std::size_t>(min_points))));
      }
  }
}
