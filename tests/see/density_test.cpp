// SPDX-License-Identifier: BSD-3-Clause
// Counts and classes equal brute force; views merged one by one equal a classification from scratch.
#include <agrisee/see/density.hpp>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;

namespace {

template <typename S>
Classification brute_force(const std::vector<Vector3<S>>& cloud, double radius, std::size_t k) {
  const std::size_t n = cloud.size();
  const S r = static_cast<S>(radius);
  const auto near = [&](std::size_t i, std::size_t j) {
    return is_finite(cloud[i]) && is_finite(cloud[j]) && distance_sq<S>(cloud[i], cloud[j]) <= r * r;
  };
  Classification out;
  out.counts.assign(n, 0);
  out.classes.assign(n, PointClass::outlier);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out.counts[i] += near(i, j) ? 1 : 0;
  const auto core = [&](std::size_t i) { return static_cast<std::size_t>(out.counts[i]) >= k; };
  for (std::size_t i = 0; i < n; ++i) {
    bool has_core = false, has_other = false;
    for (std::size_t j = 0; j < n; ++j)
      if (j != i && near(i, j)) (core(j) ? has_core : has_other) = true;
    if (is_finite(cloud[i]) && core(i))
      out.classes[i] = PointClass::core;
    else if (has_core && has_other)
      out.classes[i] = PointClass::frontier;
  }
  return out;
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
  for (auto field : {&Parameters::rho, &Parameters::radius, &Parameters::view_distance, &Parameters::psi,
                     &Parameters::upsilon, &Parameters::max_incidence, &Parameters::least_move})
    for (double bad : {0.0, -1.0, nan}) rejects(field, bad);
  for (auto field : {&Parameters::separation, &Parameters::give_up_radius}) rejects(field, -1.0);
  for (auto field : {&Parameters::max_updates, &Parameters::max_views}) rejects(field, 0);
  for (auto field : {&Parameters::min_gain, &Parameters::max_shifts, &Parameters::max_pulls}) rejects(field, -1);
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
  REQUIRE(fields == 16);
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

TEST_CASE("views merged one by one equal a classification from scratch", "[see]") {
  const Parameters params = small();
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Rng rng(seed);
    DensityMap<float> map(params);
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
      const Classification scratch = classify(map.cloud(), params);
      REQUIRE(map.counts() == scratch.counts);
      REQUIRE(map.classes() == scratch.classes);
    }
    const Classification brute = brute_force(map.cloud().points, params.radius, params.k());
    REQUIRE(map.counts() == brute.counts);
    REQUIRE(map.classes() == brute.classes);
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
    REQUIRE(map.classes() == classify(expected, params).classes);
    REQUIRE_THROWS_AS(map.keep({static_cast<Index>(map.size())}), InputError);
    map.insert(Points(1, Eigen::Vector3f::Constant(5.0f)), 9);
    REQUIRE(map.classes() == classify(map.cloud(), params).classes);
  }
}

TEST_CASE("merged points keep their distance, and every point has one near", "[see]") {
  const Parameters params;
  const auto epsilon = static_cast<float>(params.min_separation());
  DensityMap<float> map(params);
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
  for (const Parameters& params : {Parameters(), Parameters::paper()}) {
    DensityMap<float> map(params);
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
