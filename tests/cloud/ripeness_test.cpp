// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/cloud.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;

namespace {

constexpr Rgb kRed{190, 40, 30}, kGreen{110, 150, 60}, kWhite{255, 255, 255}, kDark{12, 10, 8};

/// 100 points, of which so many are ripe.
std::vector<Rgb> tomato(std::size_t ripe) {
  std::vector<Rgb> colors(100, kGreen);
  std::fill_n(colors.begin(), ripe, kRed);
  return colors;
}

}  // namespace

TEST_CASE("colors in CIELAB are those of the standard") {
  const Eigen::Vector3d white = to_lab(kWhite), red = to_lab({255, 0, 0}), green = to_lab({0, 255, 0});
  CHECK(white.isApprox(Eigen::Vector3d(100, 0, 0), 1e-6));
  CHECK((red - Eigen::Vector3d(53.24, 80.09, 67.20)).norm() < 0.05);
  CHECK((green - Eigen::Vector3d(87.74, -86.18, 83.18)).norm() < 0.05);
  CHECK(to_lab({0, 0, 0}).norm() < 1e-9);
}

TEST_CASE("the class of ripeness follows from the share of ripe surface") {
  const std::pair<std::size_t, RipenessClass> kCases[] = {{0, RipenessClass::green},      {5, RipenessClass::breakers},
                                                          {20, RipenessClass::turning},   {45, RipenessClass::pink},
                                                          {75, RipenessClass::light_red}, {100, RipenessClass::red}};
  for (const auto& [ripe, expected] : kCases) {
    const auto r = ripeness_of(tomato(ripe), 1.0);
    REQUIRE(r);
    CHECK(r->grade == expected);
    CHECK(r->ripe_share == Approx(0.01 * static_cast<double>(ripe)).margin(0.005));
    CHECK(r->probability > 0.5);
  }
}

TEST_CASE("a point counts as ripe by the probability that its hue is below the ripe one") {
  const std::vector<Rgb> colors(100, kRed);
  const double hue = hue_of(to_lab(kRed));
  for (const double above : {-2.0, -1.0, 0.0, 1.0, 2.0}) {  // standard deviations of a hue, which are 8 degrees
    RipenessParameters parameters;
    parameters.ripe_hue = hue + above * deg(8);
    const auto r = ripeness_of(colors, 1.0, parameters);
    REQUIRE(r);
    CHECK(r->ripe_share == Approx(0.5 * std::erfc(-above / std::sqrt(2.0))));
  }
}

TEST_CASE("highlights and shade do not change the ripeness") {
  std::vector<Rgb> colors(100, kRed);
  std::fill_n(colors.begin(), 12, kWhite);
  std::fill_n(colors.begin() + 12, 12, kDark);
  const auto r = ripeness_of(colors, 0.4);
  REQUIRE(r);
  CHECK((r->lab - to_lab(kRed)).norm() < 1e-9);
  CHECK(r->grade == RipenessClass::red);
}

TEST_CASE("a fruit of which little was seen is of a less certain class") {
  const auto much = ripeness_of(tomato(50), 0.9), little = ripeness_of(tomato(50), 0.2);
  REQUIRE((much && little));
  CHECK(little->ripe_share_error > 2.0 * much->ripe_share_error);
  CHECK(little->probability < much->probability);
}

TEST_CASE("colors that say nothing give no ripeness") {
  CHECK_FALSE(ripeness_of({}, 1.0));
  CHECK_FALSE(ripeness_of(std::vector<Rgb>(7, kRed), 1.0));
  CHECK_FALSE(ripeness_of(std::vector<Rgb>(100, {120, 120, 120}), 1.0));
  RipenessParameters wrong;
  wrong.pink = 0.05;
  CHECK_THROWS_AS(ripeness_of(tomato(50), 1.0, wrong), FieldError);
}

TEST_CASE("selected points keep their colors and detections") {
  Cloud cloud;
  cloud.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  cloud.colors = {kRed, kGreen, kWhite};
  cloud.instances = {5, 6, 7};
  const Cloud some = select(cloud, {2, 0});
  CHECK(some.colors == std::vector<Rgb>{kWhite, kRed});
  CHECK(some.instances == std::vector<int>{7, 5});
  CHECK(some.normals.empty());
}
