// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/fuse/surfels.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::fuse;
using Eigen::Vector3f;

namespace {

const Vector3f kX(1, 0, 0), kUp(0, 0, 1);

/// A map in units in which the right numbers are easy to write down.
SurfelMap map_of(double separation, double agreement) {
  SurfelParameters parameters;
  parameters.separation = separation;
  parameters.agreement = agreement;
  return SurfelMap(parameters);
}

}  // namespace

TEST_CASE("the first sample of a place founds a surfel") {
  SurfelMap map = map_of(1.0, 0.5);
  CHECK(map.size() == 0);
  CHECK(map.add({1, 2, 3}, kUp, 0.5f, 7));
  REQUIRE(map.size() == 1);
  const Surfel& s = map.surfels()[0];
  CHECK(s.position == Vector3f(1, 2, 3));
  CHECK(s.normal == kUp);
  CHECK(s.weight == 4.0f);
  CHECK(s.view == 7);
  CHECK(s.last_view == 7);
  CHECK(s.seen_by == 1);
}

TEST_CASE("a surfel without samples is of no view and weighs nothing") {
  const Surfel s{};
  CHECK(s.weight == 0.0f);
  CHECK(s.view == -1);
  CHECK(s.last_view == -1);
  CHECK(s.seen_by == 0);
}

TEST_CASE("a surfel moves along its normal by inverse variance") {
  SurfelMap map = map_of(1.0, 0.5);
  map.add({0, 0, 0}, kUp, 0.5f, 3);
  CHECK_FALSE(map.add({0.25f, 0.5f, 1.0f}, {0.6f, 0.0f, 0.8f}, 1.0f, 4));
  REQUIRE(map.size() == 1);
  const Surfel& s = map.surfels()[0];
  CHECK(s.position.x() == 0.0f);
  CHECK(s.position.y() == 0.0f);
  CHECK(s.position.z() == Approx(0.2));  // weights 4 and 1
  const Vector3f mean = Vector3f(0.12f, 0.0f, 0.96f).normalized();
  CHECK((s.normal - mean).norm() < 1e-6f);
  CHECK(s.weight == 5.0f);
  CHECK(s.view == 3);
  CHECK(s.last_view == 4);

  // The next sample moves it along the new normal, with a share of 5 / 10.
  const Vector3f before = s.position;
  CHECK_FALSE(map.add(before + 0.1f * mean, mean, float(1.0 / std::sqrt(5.0)), 4));
  CHECK((map.surfels()[0].position - (before + 0.05f * mean)).norm() < 1e-6f);
  CHECK(map.surfels()[0].weight == Approx(10.0));
}

TEST_CASE("a surfel adds up its samples and the views that saw it") {
  SurfelMap map = map_of(1.0, 0.5);
  for (const int view : {2, 2, 2, 5, 5, 6}) map.add({0, 0, 0}, kUp, 0.5f, view);
  REQUIRE(map.size() == 1);
  CHECK(map.surfels()[0].weight == 6 * 4.0f);
  CHECK(map.surfels()[0].seen_by == 3);
  CHECK(map.surfels()[0].view == 2);
  CHECK(map.surfels()[0].last_view == 6);
}

TEST_CASE("samples nearer than the separation across the surface belong to one surfel") {
  const auto founds = [](const Vector3f& p, const Vector3f& normal) {
    SurfelMap map = map_of(1.0, 2.0);
    map.add({0, 0, 0}, normal, 0.01f, 0);
    return map.add(p, normal, 0.01f, 1);
  };
  CHECK(founds({1, 0, 0}, kUp));
  CHECK_FALSE(founds({0.99f, 0, 0}, kUp));
  CHECK(founds({0.8f, 0.7f, 0}, kUp));
  CHECK_FALSE(founds({0.7f, 0.7f, 0}, kUp));
  CHECK_FALSE(founds({0.9f, 0, 0.9f}, kUp));  // 1.27 away, but 0.9 across
  CHECK_FALSE(founds({0.9f, 0, 0.9f}, kX));
  CHECK(founds({0.9f, 1, 0}, kX));
}

TEST_CASE("the separation is square where it is not 1") {
  SurfelMap map = map_of(0.25, 0.5);
  map.add({0, 0, 0}, kUp, 0.01f, 0);
  CHECK(map.add({0.25f, 0, 0}, kUp, 0.01f, 0));
  CHECK_FALSE(map.add({0, 0.24f, 0}, kUp, 0.01f, 0));
  SurfelMap wide = map_of(4.0, 0.5);
  wide.add({0, 0, 0}, kUp, 0.01f, 0);
  CHECK_FALSE(wide.add({3.9f, 0, 0}, kUp, 0.01f, 0));
  CHECK(wide.add({0, 4.0f, 0}, kUp, 0.01f, 0));
}

TEST_CASE("a surfel is found from all neighboring cells") {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        CAPTURE(x, y, z);
        const Vector3f toward(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        const Vector3f middle = Vector3f::Constant(0.5f);
        SurfelMap map = map_of(1.0, 0.5);
        map.add(middle + 0.48f * toward, kUp, 0.01f, 0);
        CHECK_FALSE(map.add(middle + 0.52f * toward, kUp, 0.01f, 0));
      }
}

TEST_CASE("surfels two cells away are not looked for, however uncertain they are") {
  const Vector3f middle = Vector3f::Constant(0.5f);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-2.0f, 2.0f}) {
      SurfelMap map = map_of(1.0, 0.5);
      const Vector3f normal = Vector3f::Unit(axis);
      map.add(middle, normal, 1.0f, 0);
      CHECK(map.add(middle + side * normal, normal, 1.0f, 0));
      CHECK_FALSE(map.add(middle + 0.5f * side * normal, normal, 1.0f, 0));
    }
}

TEST_CASE("surfels up to the agreement away are found along any normal") {
  for (const Vector3f& n : {Vector3f(0, 0, 1), Vector3f(0, -1, 0), Vector3f(1, 1, 1), Vector3f(-0.6f, 0.0f, 0.8f)}) {
    const Vector3f normal = n.normalized(), middle(0.3f, -0.7f, 0.1f);
    for (const float side : {-1.0f, 1.0f}) {
      CAPTURE(normal, side);
      SurfelMap map = map_of(1.0, 5.0);
      map.add(middle, normal, 0.01f, 0);
      CHECK_FALSE(map.add(middle + side * 4.9f * normal, normal, 10.0f, 0));
      CHECK(map.add(middle + side * 5.1f * normal, normal, 0.01f, 1));
    }
  }
}

TEST_CASE("a sample agrees within the agreement and three standard deviations along the normal") {
  const auto founds = [](double agreement, float z, float sigma) {
    SurfelMap map = map_of(4.0, agreement);
    map.add({1, 1, 1}, kUp, 0.4f, 0);
    return map.add({1, 1, 1 + z}, kUp, sigma, 1);
  };
  // With 0.3 and 0.4 the difference has a standard deviation of 0.5.
  for (const float side : {-1.0f, 1.0f}) {
    CHECK_FALSE(founds(0.5, side * 1.99f, 0.3f));
    CHECK(founds(0.5, side * 2.01f, 0.3f));
    CHECK_FALSE(founds(0.0, side * 1.49f, 0.3f));
    CHECK(founds(0.0, side * 1.51f, 0.3f));
    CHECK(founds(0.5, side * 1.99f, 0.2f));
  }
}

TEST_CASE("a sample exactly at the end of the agreement still agrees") {
  SurfelMap map = map_of(16.0, 0.5);
  map.add({0, 0, 0}, kUp, 3.0f, 0);
  const float off = 0.5f + 3.0f * std::sqrt(4.0f * 4.0f + 1.0f / map.surfels()[0].weight);  // about 15.5
  CHECK(map.add({0, 0, std::nextafter(off, 20.0f)}, kUp, 4.0f, 0));
  CHECK_FALSE(map.add({0, 0, -off}, kUp, 4.0f, 0));
}

TEST_CASE("samples whose normals differ by more than the largest angle belong to another surface") {
  const auto founds = [](double max_angle, const Vector3f& normal) {
    SurfelParameters parameters;
    parameters.max_angle = max_angle;
    SurfelMap map(parameters);
    map.add({0, 0, 0}, kUp, 0.001f, 0);
    return map.add({0, 0, 0}, normal, 0.001f, 0);
  };
  const auto tilted = [](double angle) {
    return Vector3f(static_cast<float>(std::sin(angle)), 0.0f, static_cast<float>(std::cos(angle)));
  };
  CHECK_FALSE(founds(deg(60), tilted(deg(59.9))));
  CHECK(founds(deg(60), tilted(deg(60.1))));
  CHECK_FALSE(founds(deg(60), {std::sqrt(0.75f), 0.0f, 0.5f}));  // exactly at the limit
  CHECK_FALSE(founds(deg(20), tilted(deg(19.9))));
  CHECK(founds(deg(20), tilted(deg(20.1))));
  CHECK(founds(deg(60), -kUp));  // the other side of a leaf
}

TEST_CASE("a sample joins the surfel that is nearest across the surface") {
  const auto joined = [](std::vector<Vector3f> surfels, const Vector3f& sample) {
    SurfelMap map = map_of(1.0, 0.5);
    for (const Vector3f& p : surfels) REQUIRE(map.add(p, kUp, 0.001f, 0));
    REQUIRE_FALSE(map.add(sample, kUp, 0.001f, 0));
    for (std::size_t i = 0; i < map.size(); ++i)
      if (map.surfels()[i].weight > 1.5e6f) return static_cast<int>(i);
    return -1;
  };
  CHECK(joined({{0, 0, 0}, {1.5f, 0, 0}}, {0.7f, 0, 0}) == 0);
  CHECK(joined({{0, 0, 0}, {1.5f, 0, 0}}, {0.8f, 0, 0}) == 1);
  CHECK(joined({{1.5f, 0, 0}, {0, 0, 0}}, {0.7f, 0, 0}) == 1);
  CHECK(joined({{1.5f, 0, 0}, {0, 0, 0}}, {0.8f, 0, 0}) == 0);
  // Distance along the normal does not count: 0.46 and 0.40 in all, but 0.1 and 0.2 across.
  CHECK(joined({{0.1f, 0, -0.4f}, {0.2f, 0, 0.4f}}, {0, 0, 0.05f}) == 0);
  CHECK(joined({{0.2f, 0, -0.4f}, {0.1f, 0, 0.4f}}, {0, 0, -0.05f}) == 1);
  // Of equally near ones the oldest, in whatever order they are found.
  CHECK(joined({{0, 0, 0}, {1.5f, 0, 0}}, {0.75f, 0, 0}) == 0);
  CHECK(joined({{1.5f, 0, 0}, {0, 0, 0}}, {0.75f, 0, 0}) == 0);
}

TEST_CASE("all surfels of a cell are found again") {
  SurfelMap map = map_of(1.0, 0.1);
  const Vector3f p(0.5f, 0.5f, 0.5f);
  const std::vector<Vector3f> normals{kUp, -kUp, kX, -kX};
  for (const Vector3f& n : normals) CHECK(map.add(p, n, 0.001f, 0));
  for (const Vector3f& n : normals) CHECK_FALSE(map.add(p, n, 0.001f, 1));
  REQUIRE(map.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(map.surfels()[i].normal == normals[i]);
    CHECK(map.surfels()[i].weight == Approx(2e6));
  }
}

TEST_CASE("samples that are not finite or not certain are ignored") {
  SurfelMap map;
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  CHECK_FALSE(map.add({nan, 0, 0}, kUp, 0.001f, 0));
  CHECK_FALSE(map.add({0, inf, 0}, kUp, 0.001f, 0));
  CHECK_FALSE(map.add({0, 0, 0}, {0, 0, nan}, 0.001f, 0));
  for (const float sigma : {0.0f, -0.001f, nan, inf}) CHECK_FALSE(map.add({0, 0, 0}, kUp, sigma, 0));
  CHECK(map.size() == 0);
  map.add({0, 0, 0}, kUp, 0.001f, 0);
  CHECK_FALSE(map.add({0, 0, 0.001f}, kUp, 0.0f, 0));
  CHECK(map.surfels()[0].weight == Approx(1e6));
}

TEST_CASE("the cloud of a map holds points, normals and founding views in order") {
  SurfelMap map = map_of(1.0, 0.5);
  map.add({0, 0, 0}, kUp, 0.5f, 4);
  map.add({5, 0, 0}, kX, 0.5f, 2);
  map.add({0, 0, 0}, kUp, 0.5f, 9);
  const Cloud cloud = map.cloud();
  CHECK(cloud.points == std::vector<Vector3f>{{0, 0, 0}, {5, 0, 0}});
  CHECK(cloud.normals == std::vector<Vector3f>{kUp, kX});
  CHECK(cloud.views == std::vector<int>{4, 2});
}

TEST_CASE("surfels of one surface keep their separation however often it is seen") {
  SurfelMap map;
  Rng rng(3);
  for (int view = 0; view < 5; ++view)
    for (int i = 0; i < 4000; ++i)
      map.add({static_cast<float>(rng.uniform(0, 0.05)), static_cast<float>(rng.uniform(0, 0.05)),
               static_cast<float>(0.0003 * rng.normal())},
              {0, 0, 1}, 0.0003f, view);
  const double separation = SurfelParameters{}.separation;
  const auto& s = map.surfels();
  double nearest = 1.0, mean = 0.0;
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, double((s[i].position - s[j].position).head<2>().norm()));
  CHECK(nearest > 0.95 * separation);
  for (const auto& q : s) mean += std::abs(double(q.position.z())) / double(s.size());
  CHECK(mean < 0.0002);
}

TEST_CASE("a map of surfels refuses bad parameters") {
  CHECK_THROWS_AS(map_of(0.0, 0.001), ParameterError);
  CHECK_THROWS_AS(map_of(0.002, -0.001), ParameterError);
  SurfelParameters parameters;
  parameters.max_angle = kPi;
  CHECK_THROWS_AS(SurfelMap(parameters), ParameterError);
}
