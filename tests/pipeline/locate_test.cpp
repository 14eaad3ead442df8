// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/split.hpp>
#include <agrisee/locate.hpp>

#include <numeric>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

/// A pear with its neck upwards, 64 mm wide, seen from all sides but below.
/// @param half_length m
Cloud pear(double half_length = 0.048) {
  const auto radius = [=](const Eigen::Vector3d& d) {
    const double s2 = 1.0 - d.z() * d.z(), across = 0.032 * (1.0 - 0.45 * d.z());
    return 1.0 / std::sqrt(s2 / (across * across) + d.z() * d.z() / (half_length * half_length));
  };
  const auto at = [&](const Eigen::Vector3d& e) -> Eigen::Vector3d { return radius(e.normalized()) * e.normalized(); };
  Cloud cloud;
  test::add_sphere(cloud, {Eigen::Vector3d::Zero(), 1.0}, 0.08, [](const Eigen::Vector3d& d) { return d.z() > -0.8; });
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d d = cloud.normals[i].cast<double>(), u = d.unitOrthogonal(), v = d.cross(u);
    const double h = 1e-4;
    cloud.points[i] = at(d).cast<float>();
    cloud.normals[i] = (at(d + h * u) - at(d - h * u)).cross(at(d + h * v) - at(d - h * v)).normalized().cast<float>();
  }
  return cloud;
}

/// A segmentation in which all points are one body's, with the ellipsoid of the first `skin` points.
Split one_body(const Cloud& cloud, std::size_t skin) {
  Indices own(skin);
  std::iota(own.begin(), own.end(), Index{0});
  const auto sphere = sphere_from_normals(cloud, own);
  REQUIRE(sphere);
  const auto fit = fit_ellipsoid(cloud, own, Ellipsoid(*sphere));
  REQUIRE(fit);
  Split split;
  split.labels.assign(cloud.size(), 1);
  split.found.resize(1);
  split.found[0].fit = *fit;
  return split;
}

/// How many fruit are located in a cloud that is segmented as one body. All points are labeled if there is one, none
/// otherwise.
/// @param found_round whether the body was found as a ball
std::size_t located(const Cloud& cloud, const Parameters& parameters, bool found_round = false) {
  Split split = one_body(cloud, cloud.size());
  if (found_round) split.found[0].fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), 0.036});
  Labels labels;
  const std::vector<Fruit> fruits = locate(cloud, split, Eigen::Vector3d::Zero(), parameters, labels);
  REQUIRE(labels == Labels(cloud.size(), fruits.empty() ? 0 : 1));
  return fruits.size();
}

}  // namespace

TEST_CASE("completeness is the share that was seen, however small the body and however few its points") {
  for (const double radius : {0.009, 0.035}) {
    const Sphere sphere{{0.1, 0.5, 0.2}, radius};
    Cloud cloud;
    test::add_sphere(cloud, sphere, 0.0024, [](const Eigen::Vector3d& d) { return d.y() < 0.4; });  // 70 %
    Labels labels;
    const auto fruits = locate(cloud, one_body(cloud, cloud.size()), Eigen::Vector3d::Zero(), {}, labels);
    REQUIRE(fruits.size() == 1);
    CHECK(fruits[0].body->completeness == Approx(0.7).margin(0.06));
  }
}

TEST_CASE("a body whose closed surface has the size or shape of no fruit is none") {
  Parameters usual;
  CHECK(located(pear(), usual) == 1);
  Parameters small;
  small.split.bodies.radius_max = 0.02;
  CHECK(located(pear(), small) == 0);
  usual.split.bodies.radius_max = 0.040;
  CHECK(located(pear(0.070), usual) == 0);  // its tips are too far apart
}

TEST_CASE(
    "a closed surface that is somewhat more slender than fruit are is dropped, and the body keeps its ellipsoid") {
  Parameters parameters;
  parameters.split.bodies.min_roundness = 0.8;  // the pear has 0.65
  CHECK(located(pear(), parameters, true) == 1);
  parameters.split.bodies.radius_max = 0.035;  // but it is too long then
  CHECK(located(pear(), parameters, true) == 0);
}

TEST_CASE("a flat body that is wider than any expected fruit is none, though its volume is that of one") {
  const Cloud flat = pear(0.024);  // 64 mm wide, with the volume of a ball 58 mm wide
  Parameters parameters;
  parameters.split.bodies.radius_max = 0.030;
  CHECK(located(flat, parameters) == 1);
  parameters.split.bodies.radius_max = 0.0265;
  CHECK(located(flat, parameters) == 0);
}

TEST_CASE("points labeled as a fruit's that lie far outside its closed surface lose their label") {
  Cloud cloud = pear();
  const std::size_t skin = cloud.size();
  for (int i = 0; i < 81; ++i) {  // a piece of leaf in front, 20 mm wide
    cloud.points.emplace_back(0.0025f * static_cast<float>(i % 9) - 0.01f, -0.043f,
                              0.0025f * static_cast<float>(i / 9));
    cloud.normals.push_back(-Eigen::Vector3f::UnitY());
  }
  Labels labels;
  const std::vector<Fruit> fruits = locate(cloud, one_body(cloud, skin), Eigen::Vector3d::Zero(), {}, labels);
  REQUIRE(fruits.size() == 1);
  Labels expected(skin, 1);
  expected.resize(cloud.size(), 0);
  CHECK(labels == expected);
  CHECK(fruits[0].points == skin);
}

TEST_CASE("the end of a post is no fruit, a fruit on a thin shelf is one") {
  constexpr double kRadius = 0.03;
  const IsFree nothing = [](const Eigen::Vector3d&) { return false; };
  Parameters parameters;
  const auto count = [&](const Cloud& cloud, std::size_t own) {
    Indices first(own);
    std::iota(first.begin(), first.end(), Index{0});
    Split split;
    split.labels.assign(cloud.size(), 0);
    std::fill_n(split.labels.begin(), own, 1);
    split.found.resize(1);
    const auto fit = fit_ellipsoid(cloud, first, Ellipsoid(Sphere{Eigen::Vector3d::Zero(), kRadius}));
    REQUIRE(fit);
    split.found[0].fit = *fit;
    Labels labels;
    BodyCounts counts;
    counts.taken = 1;
    const std::size_t fruits =
        locate(cloud, split, Eigen::Vector3d::Zero(), parameters, labels, nothing, 0.0, &counts).size();
    CHECK(counts.taken == fruits);
    CHECK(counts.too_flat == 1 - fruits);
    return fruits;
  };
  const auto above = [](const Eigen::Vector3d& d) { return d.z() > -0.6; };
  Cloud shelf;
  test::add_sphere(shelf, {Eigen::Vector3d::Zero(), kRadius}, 0.002, above);
  const std::size_t fruit = shelf.size();
  for (double x = -0.08; x <= 0.08; x += 0.002)
    for (double y = -0.08; y <= 0.08; y += 0.002)
      for (const float side : {-1.0f, 1.0f}) {  // 4 mm thick; what lies below the fruit shows from below alone
        if (side > 0.0f && std::hypot(x, y) < 0.7 * kRadius) continue;
        shelf.points.emplace_back(float(x), float(y), float(-kRadius - 0.002) + 0.002f * side);
        shelf.normals.emplace_back(0.0f, 0.0f, side);
      }
  CHECK(count(shelf, fruit) == 1);
  // A post with a rounded end, of which a body took the upper 55 mm.
  Cloud post;
  test::add_sphere(post, {Eigen::Vector3d::Zero(), kRadius}, 0.002,
                   [](const Eigen::Vector3d& d) { return d.z() >= 0.0; });
  std::size_t end = 0;
  for (double z = -0.001; z > -0.15; z -= 0.002) {
    for (double a = 0.0; a < 2.0 * kPi; a += 0.002 / kRadius) {
      const Eigen::Vector3d n(std::cos(a), std::sin(a), 0.0);
      post.points.push_back((kRadius * n + z * Eigen::Vector3d::UnitZ()).cast<float>());
      post.normals.push_back(n.cast<float>());
    }
    if (z > -0.025) end = post.size();
  }
  CHECK(count(post, end) == 0);
}

TEST_CASE("a body whose ellipsoid explains it is not judged by a closed surface") {
  Cloud ball;
  test::add_sphere(ball, {{0.1, 0.5, 0.2}, 0.03}, 0.0025, [](const Eigen::Vector3d& d) { return d.y() < 0.3; });
  Parameters small;
  small.split.bodies.radius_max = 0.02;
  CHECK(located(ball, small) == 1);
}
