// SPDX-License-Identifier: BSD-3-Clause
// Counts and classes equal brute force; views merged one by one equal a classification from scratch.
#include <agrisee/see/density.hpp>

#include <numeric>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;

namespace {

/// The rule without any search: views come one after the other, and every pair of points is looked at.
template <typename S>
struct BruteForce {
  S r;
  std::size_t k;
  std::vector<Vector3<S>> cloud;
  Classification now;

  BruteForce(double radius, std::size_t core) : r(static_cast<S>(radius)), k(core) {}
  bool near(std::size_t i, std::size_t j) const {
    return is_finite(cloud[i]) && is_finite(cloud[j]) && distance_sq<S>(cloud[i], cloud[j]) <= r * r;
  }
  bool core(std::size_t i) const { return static_cast<std::size_t>(now.counts[i]) >= k; }
  bool has(std::size_t i, PointClass c, std::size_t end) const {
    for (std::size_t j = 0; j < end; ++j)
      if (j != i && near(i, j) && now.classes[j] == c) return true;
    return false;
  }
  void count() {
    now.counts.assign(cloud.size(), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (std::size_t j = 0; j < cloud.size(); ++j) now.counts[i] += near(i, j) ? 1 : 0;
  }
  /// Add the points of a view.
  void add(const std::vector<Vector3<S>>& points) {
    const std::size_t before = cloud.size();
    cloud.insert(cloud.end(), points.begin(), points.end());
    now.classes.resize(cloud.size(), PointClass::outlier);
    count();
    std::vector<bool> beside(cloud.size(), false);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (std::size_t j = before; j < cloud.size(); ++j) beside[i] = beside[i] || near(i, j);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (core(i)) now.classes[i] = PointClass::core;
    const auto classify = [&](std::size_t i, bool outlier) {
      now.classes[i] = outlier && has(i, PointClass::core, cloud.size()) ? PointClass::frontier : PointClass::outlier;
    };
    for (std::size_t i = before; i < cloud.size(); ++i)
      if (!core(i)) classify(i, has(i, PointClass::outlier, i));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (!core(i) && beside[i])
        classify(i, now.classes[i] == PointClass::outlier || has(i, PointClass::outlier, cloud.size()));
  }
  /// Remove all points but those at `kept`.
  void keep(const Indices& kept) {
    std::vector<Vector3<S>> points;
    std::vector<PointClass> before;
    for (Index i : kept) {
      points.push_back(cloud[static_cast<std::size_t>(i)]);
      before.push_back(now.classes[static_cast<std::size_t>(i)]);
    }
    cloud = points;
    now.classes = before;
    count();
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (before[i] == PointClass::core && !core(i)) now.classes[i] = PointClass::outlier;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (core(i) || before[i] == PointClass::outlier) continue;
      now.classes[i] = has(i, PointClass::core, cloud.size()) ? PointClass::frontier : PointClass::outlier;
    }
  }
};

template <typename S>
Classification brute_force(const std::vector<Vector3<S>>& cloud, double radius, std::size_t k) {
  BruteForce<S> all(radius, k);
  all.add(cloud);
  return all.now;
}

Parameters small() {  // k = 14
  Parameters p;
  p.radius = 0.01;
  p.rho = 3.2e6;
  return p;
}

template <typename S>
std::vector<Vector3<S>> awkward(int kind) {
  Rng rng(3, static_cast<std::uint64_t>(kind));
  std::vector<Vector3<S>> p;
  for (int i = 0; i < 1200; ++i) {
    const Eigen::Vector3d u(rng.uniform(), rng.uniform(), rng.uniform());
    switch (kind) {
      case 0:
        p.push_back((u * 0.08).cast<S>());
        break;
      case 1:
        p.push_back(Vector3<S>(S(i % 30), S(i / 30), 0) * S(0.0025));
        break;  // lattice: many pairs at exactly r
      case 2:
        p.push_back((u * 0.01 + Eigen::Vector3d::Constant((i % 5) * 0.02)).cast<S>());
        break;
      case 3:
        p.push_back(Vector3<S>(S(i) * S(0.0002), 0, 0));
        break;
      case 4:
        p.push_back(i % 100 ? Vector3<S>((u * 0.05).cast<S>()) : Vector3<S>::Constant(S(i) * S(1e5)));
        break;
      case 5:
        p.push_back((u * 0.05).cast<S>());
        if (i % 50 == 0) p.back().z() = std::numeric_limits<S>::infinity();
        break;
      default:
        p.push_back(Vector3<S>((u * 0.08).cast<S>()) + Vector3<S>::Constant(S(100)));
        break;
    }
  }
  return p;
}

}  // namespace

TEST_CASE("parameters: k, separation, checks", "[see]") {
  const Parameters paper = Parameters::paper();
  REQUIRE(paper.k() == 537);
  REQUIRE(paper.min_separation() == Approx(0.002122).margin(5e-7));
  REQUIRE_NOTHROW(paper.check());
  REQUIRE_NOTHROW(Parameters().check());
  Parameters scaled;  // twice the radius at the same k: a similar figure, so twice the separation
  scaled.radius *= 2.0;
  scaled.rho /= 8.0;
  REQUIRE(scaled.min_separation() == Approx(2.0 * Parameters().min_separation()));
  const auto rejects = [](auto field, auto value) {
    Parameters p;
    p.*field = value;
    REQUIRE_THROWS_AS(p.check(), ParameterError);
    REQUIRE_THROWS_AS(DensityMap<float>(p), ParameterError);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto field :
       {&Parameters::rho, &Parameters::radius, &Parameters::view_distance, &Parameters::psi, &Parameters::upsilon})
    for (double bad : {0.0, -1.0, nan}) rejects(field, bad);
  for (auto field : {&Parameters::separation, &Parameters::min_move}) rejects(field, -1.0);
  for (auto field : {&Parameters::max_updates, &Parameters::max_views}) rejects(field, 0);
  rejects(&Parameters::radius, 1e9);
  for (double bad : {-1.0, nan, 1e9, std::numeric_limits<double>::infinity()}) {
    scaled.radius = bad;
    REQUIRE(scaled.k() == 0);
  }
  scaled.radius = -0.04, scaled.rho = -2e6;
  REQUIRE(scaled.k() == 0);
  scaled.radius = 1.0, scaled.rho = 2e8;
  REQUIRE(scaled.k() == 0);
  int fields = 0;
  Parameters p;
  Parameters::fields(p, [&](const char*, auto&, const auto&...) { ++fields; });
  REQUIRE(fields == 12);
}

TEMPLATE_TEST_CASE("classification equals brute force", "[see]", float, double) {
  const int kind = GENERATE(0, 1, 2, 3, 4, 5, 6);
  CAPTURE(kind);
  const auto cloud = awkward<TestType>(kind);
  const Classification expected = brute_force(cloud, small().radius, small().k());
  for (int threads : {1, 2}) {
    const Classification got = classify(cloud, small(), threads);
    REQUIRE(got.counts == expected.counts);
    REQUIRE(got.classes == expected.classes);
  }
}

TEST_CASE("classification of degenerate clouds", "[see]") {
  const Classification none = classify(Points{}, small());
  REQUIRE(none.counts.empty());
  REQUIRE(classify(Points(1, Eigen::Vector3f::Zero()), small()).counts == std::vector<int>{1});
  const Classification equal = classify(Points(50, Eigen::Vector3f::Constant(0.1f)), small());
  REQUIRE(equal.counts == std::vector<int>(50, 50));
  REQUIRE(equal.classes == std::vector<PointClass>(50, PointClass::core));
  const Classification nan = classify(Points(3, Eigen::Vector3f::Constant(std::nanf(""))), small());
  REQUIRE(nan.counts == std::vector<int>(3, 0));
  REQUIRE(nan.classes == std::vector<PointClass>(3, PointClass::outlier));
}

TEST_CASE("views merged one by one equal brute force, whatever the number of threads", "[see]") {
  const Parameters parameters = small();
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Rng rng(seed);
    DensityMap<float> map(parameters);
    BruteForce<float> brute(parameters.radius, parameters.k());
    std::size_t given = 0;
    for (int view = 0; view < 9; ++view) {
      Points points;  // a patch of a wavy surface, now and then stray points, nothing, or something not finite
      const Eigen::Vector3d at(rng.uniform(0.0, 0.06), rng.uniform(0.0, 0.06), 0.0);
      const std::size_t n = rng.below(4) == 0 ? rng.below(3) : 200 + rng.below(2500);
      for (std::size_t i = 0; i < n; ++i) {
        Eigen::Vector3d p = at + 0.03 * Eigen::Vector3d(rng.uniform(), rng.uniform(), 0.0);
        p.z() = 0.005 * std::sin(100.0 * p.x()) + (rng.below(40) == 0 ? rng.uniform(0.0, 0.03) : 0.0);
        points.push_back(p.cast<float>());
        if (rng.below(300) == 0) points.back().x() = std::nanf("");
      }
      const std::size_t before = map.size();
      const Indices kept = map.insert(points, view, 1 + view % 2);
      given += kept.size();
      REQUIRE(map.size() == before + kept.size());
      REQUIRE(std::is_sorted(kept.begin(), kept.end()));
      for (std::size_t j = 0; j < kept.size(); ++j) {
        REQUIRE(map.cloud().points[before + j] == points[static_cast<std::size_t>(kept[j])]);
        REQUIRE(map.cloud().views[before + j] == view);
      }
      brute.add(Points(map.cloud().points.begin() + static_cast<std::ptrdiff_t>(before), map.cloud().points.end()));
      REQUIRE(map.added() == kept.size());
      REQUIRE(map.counts() == brute.now.counts);
      REQUIRE(map.classes() == brute.now.classes);
      Indices all(map.size());
      std::iota(all.begin(), all.end(), 0);
      DensityMap<float> same = map;
      same.keep(all);  // a filter that removes nothing changes nothing
      REQUIRE(same.counts() == map.counts());
      REQUIRE(same.classes() == map.classes());
      REQUIRE(same.added() == map.added());
      REQUIRE(same.near_added() == map.near_added());
      if (kept.empty()) continue;
      all.resize(before);
      same.keep(all);  // a filter that removes all that is new
      REQUIRE(same.added() == 0);
    }
    std::size_t of_any = 0;
    for (auto c : {PointClass::core, PointClass::frontier, PointClass::outlier}) {
      REQUIRE_FALSE(map.of_class(c).empty());  // all three occur
      of_any += map.of_class(c).size();
    }
    REQUIRE(of_any == given);

    Indices kept;  // forget some
    for (std::size_t i = 0; i < map.size(); ++i)
      if (rng.below(4) != 0) kept.push_back(static_cast<Index>(i));
    const Cloud expected = select(map.cloud(), kept);
    map.keep(kept);
    REQUIRE(map.cloud().points == expected.points);
    REQUIRE(map.cloud().views == expected.views);
    brute.keep(kept);
    REQUIRE(map.counts() == brute.now.counts);
    REQUIRE(map.classes() == brute.now.classes);
    REQUIRE_THROWS_AS(map.keep({static_cast<Index>(map.size())}), InputError);
    map.insert(Points(1, Eigen::Vector3f::Constant(5.0f)), 9);
    brute.add(Points(1, Eigen::Vector3f::Constant(5.0f)));
    REQUIRE(map.classes() == brute.now.classes);
  }
}

TEST_CASE("a frontier that is given up is an outlier until a new point comes near", "[see]") {
  // A row of points 4 mm apart: with r = 10 mm an inner point has 5 of them within r, the second one 4, the first 3.
  Parameters parameters;
  parameters.radius = 0.01;
  parameters.rho = 1e6;  // k = 5
  REQUIRE(parameters.k() == 5);
  parameters.separation = 0.001;
  DensityMap<float> map(parameters);
  Points row;
  for (int i = 0; i < 9; ++i) row.emplace_back(0.004f * static_cast<float>(i), 0.0f, 0.0f);
  map.insert(row, 0);
  const PointClass o = PointClass::outlier, f = PointClass::frontier, c = PointClass::core;
  // At first, 0 is an outlier, for there is none to be near. 1 is near it and near core points, so it is a frontier;
  // the same with 7 and 8, which are not near 0. Then 0 finds itself and becomes a frontier; this leaves 1 without an
  // outlier near it. 7 finds itself, and 8 loses its outlier.
  REQUIRE(map.classes() == std::vector<PointClass>{f, o, c, c, c, c, c, f, o});
  map.give_up(0);
  REQUIRE(map.classes()[0] == o);
  REQUIRE(map.counts()[0] == 3);
  map.insert(Points(1, Eigen::Vector3f(0.2f, 0.0f, 0.0f)), 1);  // far away: nothing changes
  REQUIRE(map.classes()[0] == o);
  REQUIRE(map.near_added() == 1);  // the new point itself
  map.insert(Points{}, 2);
  REQUIRE(map.classes()[0] == o);
  REQUIRE(map.near_added() == 0);
  map.insert(Points(1, Eigen::Vector3f(-0.009f, 0.0f, 0.0f)), 3);  // within r of point 0 alone
  REQUIRE(map.classes()[0] == f);
  REQUIRE(map.classes().back() == o);  // no core point within r
  REQUIRE_THROWS_AS(map.give_up(3), InputError);
  REQUIRE_THROWS_AS(map.give_up(-1), InputError);
  REQUIRE_THROWS_AS(map.give_up(100), InputError);
}

TEST_CASE("merged points keep their distance, and every point has one near", "[see]") {
  const Parameters parameters;
  const auto epsilon = static_cast<float>(parameters.min_separation());
  DensityMap<float> map(parameters);
  const Points cloud = test::sphere({0.1, 0.2, 0.3}, 0.035, 400000);
  map.insert(cloud, 0);
  for (std::size_t i = 0; i < map.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      REQUIRE_FALSE(distance_sq<float>(map.cloud().points[i], map.cloud().points[j]) < epsilon * epsilon);
  for (std::size_t i = 0; i < cloud.size(); i += 7) REQUIRE(map.grid().nearer(cloud[i], epsilon));
  REQUIRE(map.insert(cloud, 1).empty());  // nothing new
  // A sphere as large as a fruit, seen all around, is all core: no frontier is left on a closed surface.
  REQUIRE(map.of_class(PointClass::core).size() == map.size());
  // Saturation is what the separation was derived from.
  const double area = 4.0 * kPi * 0.035 * 0.035;
  const double per_disc = double(map.size()) / area * kPi * epsilon * epsilon;
  REQUIRE(per_disc == Approx(kSaturation).epsilon(0.05));
}

TEST_CASE("frontiers lie along the edge of what was seen", "[see]") {
  for (const Parameters& parameters : {Parameters(), Parameters::paper()}) {
    DensityMap<float> map(parameters);
    map.insert(test::rectangle(-0.15, 0.15, -0.15, 0.15, 400000), 0);
    std::size_t frontiers = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Eigen::Vector3f p = map.cloud().points[i];
      const float to_edge = 0.15f - p.cwiseAbs().head<2>().maxCoeff();
      const PointClass c = map.classes()[i];
      if (to_edge < 0.002f) REQUIRE(c != PointClass::core);
      if (to_edge > 0.03f) REQUIRE(c == PointClass::core);
      frontiers += c == PointClass::frontier ? 1u : 0u;
    }
    REQUIRE(frontiers > 300);
  }
}
