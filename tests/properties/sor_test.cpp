// SPDX-License-Identifier: BSD-3-Clause
// Outlier removal: the set of points that stay. A point at the threshold to within rounding may go or stay when the
// order in which the mean is summed changes; no cloud here has one unless all its d_i are equal, and then all stay.
#include <agrisee/cloud/sor.hpp>

#include "properties/oracles.hpp"

using namespace agrisee;

namespace {

template <typename S>
std::vector<char> stays(const laws::Points<S>& cloud, const SorParameters& parameters, int threads = 1) {
  std::vector<char> out(cloud.size(), 0);
  for (const Index i : remove_statistical_outliers(cloud, parameters, threads)) out[static_cast<std::size_t>(i)] = 1;
  return out;
}

}  // namespace

TEMPLATE_TEST_CASE("outlier removal: motions, scales, shuffles and precision change nothing", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const int k = GENERATE(1, 6, 20);
  INFO(kind << ", k " << k);
  // Distances round like coordinates do: the mean's last bits, which may decide where all are equal, are covered.
  laws::check_exact_laws<TestType>(
      kind,
      [&](const auto& p, double, int threads) {
        return stays(p, {k, 1.3, false}, threads);
      },
      [](const auto& v) { return v; });
}

TEMPLATE_TEST_CASE("outlier removal: m of each point and m (K + 1) - 1 neighbors change nothing", "", float, double) {
  // Every d_i is multiplied by m K / (m (K + 1) - 1), and mean and deviation with it.
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const std::size_t m = GENERATE(2u, 5u);
  INFO(kind << ", m " << m);
  const auto cloud = laws::exact_cloud<TestType>(kind);
  const int k = 8, more = static_cast<int>(m) * (k + 1) - 1;
  CHECK(stays(laws::repeated(cloud, m), {more, 1.3, false}) == laws::repeated(stays(cloud, {k, 1.3, false}), m));
}

TEMPLATE_TEST_CASE("outlier removal: mean distances of hostile clouds are those of all pairs", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::hostile_kinds()));
  INFO(kind);
  const auto cloud = laws::hostile_cloud<TestType>(kind);
  for (const int k : {1, 5, 20, 1000}) {
    const auto expected = oracle::mean_distances(cloud, static_cast<std::size_t>(k));
    const auto got = mean_neighbor_distances(cloud, k, 2);
    REQUIRE(got.size() == expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      INFO(i << ": " << got[i] << " and " << expected[i]);
      REQUIRE(((std::isnan(got[i]) && std::isnan(expected[i])) || got[i] == expected[i] ||
               std::abs(got[i] - expected[i]) <= 1e-12 * expected[i]));
    }
  }
}

TEMPLATE_TEST_CASE("outlier removal: a few points that are too far to tell how far go, and only they", "", float,
                   double) {
  const auto cloud = laws::hostile_cloud<TestType>("huge");
  const auto stay = stays(cloud, {20, 6.0, false});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    INFO(i);
    CHECK(bool(stay[i]) == (double(cloud[i].norm()) < 1.0));
  }
}
