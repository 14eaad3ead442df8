// SPDX-License-Identifier: BSD-3-Clause
// Density and the classes core, frontier and outlier: the same whatever the place, scale and precision; density and
// core points whatever the order, too. With a minimum separation the first of two near points is kept, so shuffles keep
// others; what is kept obeys the same law.
#include <agrisee/see/density.hpp>

#include "properties/oracles.hpp"

using namespace agrisee;
using see::PointClass;

namespace {

/// Parameters with the radius r and k neighbors.
see::Parameters with(double r, double k) {
  see::Parameters p;
  p.radius = r;
  p.rho = (k - 0.5) / (4.0 / 3.0 * kPi * r * r * r);
  return p;
}

/// Count and class in one, to be compared.
std::vector<std::pair<int, PointClass>> both(const see::Classification& c) {
  std::vector<std::pair<int, PointClass>> out;
  for (std::size_t i = 0; i < c.counts.size(); ++i) out.emplace_back(c.counts[i], c.classes[i]);
  return out;
}

}  // namespace

TEMPLATE_TEST_CASE("density: motions, scales, shuffles and precision change nothing", "", float, double) {
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const double k = GENERATE(2.0, 7.0, 19.0);
  INFO(kind << ", k " << k);
  laws::check_exact_laws<TestType>(
      kind,
      [&](const auto& p, double scale, int threads) {
        return both(see::classify(p, with(scale * 0x1p-7, k), threads));
      },
      [](const auto& v) {  // which of the other points are frontiers depends on their order
        std::vector<std::pair<int, bool>> out;
        for (const auto& [count, what] : v) out.emplace_back(count, what == PointClass::core);
        return out;
      });
}

TEMPLATE_TEST_CASE("density: m of each point are m times as dense", "", float, double) {
  // With m times the neighbors asked for the same are core.
  const std::string kind = GENERATE(from_range(laws::exact_kinds()));
  const std::size_t m = GENERATE(2u, 5u);
  const auto cloud = laws::exact_cloud<TestType>(kind);
  for (const double k : {2.0, 7.0, 19.0}) {
    INFO(kind << ", m " << m << ", k " << k);
    const auto once = see::classify(cloud, with(0x1p-7, k));
    const auto more = see::classify(laws::repeated(cloud, m), with(0x1p-7, k * double(m)));
    for (std::size_t i = 0; i < more.counts.size(); ++i) {
      const std::size_t from = i / m;
      REQUIRE(more.counts[i] == static_cast<int>(m) * once.counts[from]);
      REQUIRE((more.classes[i] == PointClass::core) == (once.classes[from] == PointClass::core));
    }
  }
}

TEMPLATE_TEST_CASE("density of exact and hostile clouds is what its definition says", "", float, double) {
  auto kinds = laws::hostile_kinds();
  for (const auto& kind : laws::exact_kinds()) kinds.push_back(kind);
  for (const auto& kind : kinds) {
    const auto exact = laws::exact_cloud<TestType>(kind);
    const auto cloud = exact.empty() ? laws::hostile_cloud<TestType>(kind) : exact;
    for (const double r : {0x1p-9, 0x1p-7, 0.3})
      for (const double k : {1.0, 2.0, 12.0}) {
        INFO(kind << ", r " << r << ", k " << k);
        const see::Parameters parameters = with(r, k);
        REQUIRE(parameters.k() == static_cast<std::size_t>(k));
        REQUIRE(both(see::classify(cloud, parameters, 2)) == both(oracle::classify(cloud, r, parameters.k())));
      }
  }
}

TEMPLATE_TEST_CASE("density: whatever comes first, merged points keep their distance and cover the rest", "", float,
                   double) {
  for (const auto& kind : laws::exact_kinds())
    for (const std::uint64_t seed : {3u, 4u}) {
      INFO(kind);
      const auto all = laws::exact_cloud<TestType>(kind);
      const auto cloud = laws::pick(all, laws::shuffled(all.size(), seed));
      const double separation = 0x1p-8;
      see::DensityMap<TestType> map(with(0x1p-7, 5.0), separation);
      map.insert(cloud, 0);
      const auto& kept = map.cloud().points;
      const auto apart = TestType(separation * separation);
      for (std::size_t i = 0; i < kept.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) REQUIRE(distance_sq<TestType>(kept[i], kept[j]) >= apart);
      for (const auto& p : cloud)
        REQUIRE(std::any_of(kept.begin(), kept.end(),
                            [&](const auto& q) { return p == q || distance_sq<TestType>(p, q) < apart; }));
      REQUIRE(both(map.classification()) == both(oracle::classify(kept, 0x1p-7, 5)));
    }
}
