// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/cloud.hpp>

#include <cmath>
#include <limits>
#include <string>

#include "catch.hpp"

using namespace agrisee;

namespace {

constexpr Rgb kRed{190, 40, 30}, kGreen{110, 150, 60}, kWhite{255, 255, 255}, kDark{12, 10, 8}, kGrey{120, 120, 120};

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
  wrong = {};
  wrong.hue_error = 8.0;
  CHECK_THROWS_WITH(ripeness_of(tomato(50), 1.0, wrong),
                    "hue_error must be above 0 and at most pi (3.14159265), got 8: angles are in radians; 8 degrees "
                    "are 0.13962634");
}

TEST_CASE("light and lightness by hand") {
  CHECK(linear_light(0.0) == 0.0);
  CHECK(linear_light(0.04) == Approx(0.04 / 12.92));
  CHECK(linear_light(0.05) == Approx(std::pow(0.105 / 1.055, 2.4)));
  CHECK(linear_light(0.5) == Approx(0.214041).epsilon(1e-5));
  CHECK(linear_light(1.0) == Approx(1.0));
  CHECK(to_lab({128, 128, 128}).x() == Approx(53.585).epsilon(1e-4));
  CHECK(to_lab({1, 1, 1}).x() == Approx(24389.0 / 27.0 / 255.0 / 12.92));  // the straight part near black
  const Eigen::Vector3d blue = to_lab({0, 0, 255});
  CHECK((blue - Eigen::Vector3d(32.30, 79.19, -107.86)).norm() < 0.05);
}

TEST_CASE("hue angles count from red over yellow and green; blue is far from red") {
  CHECK(hue_of({50, 1, 0}) == 0.0);
  CHECK(hue_of({50, 1, 1}) == Approx(kPi / 4));
  CHECK(hue_of({50, 0, 2}) == Approx(kPi / 2));
  CHECK(hue_of({50, -3, 0}) == Approx(kPi));
  CHECK(hue_of({50, -1, -1}) == Approx(1.25 * kPi));
  CHECK(hue_of({50, 1, -1}) == Approx(-kPi / 4));
}

TEST_CASE("a class holds shares up to and with its upper limit") {
  using C = RipenessClass;
  const std::pair<double, C> kCases[] = {{0.0, C::green},      {0.01, C::green},    {0.011, C::breakers},
                                         {0.10, C::breakers},  {0.101, C::turning}, {0.30, C::turning},
                                         {0.301, C::pink},     {0.60, C::pink},     {0.601, C::light_red},
                                         {0.90, C::light_red}, {0.901, C::red},     {1.0, C::red}};
  for (const auto& [share, expected] : kCases) CHECK(class_of(share) == expected);
  RipenessParameters parameters;
  parameters.red = 0.95;
  CHECK(class_of(0.94, parameters) == C::light_red);
}

TEST_CASE("classes have names, and only these") {
  const char* const kNames[] = {"green", "breakers", "turning", "pink", "light_red", "red"};
  for (std::size_t c = 0; c < kRipenessClasses; ++c) {
    CHECK(to_string(static_cast<RipenessClass>(c)) == std::string(kNames[c]));
    CHECK(ripeness_named(kNames[c]) == static_cast<RipenessClass>(c));
  }
  CHECK_FALSE(ripeness_named("Red"));
  CHECK_FALSE(ripeness_named(""));
}

TEST_CASE("points without a hue do not count in the share, but in the color") {
  std::vector<Rgb> colors(30, kRed);
  colors.insert(colors.begin(), 10, kGrey);
  RipenessParameters parameters;
  parameters.trim = 0.0;
  const auto r = ripeness_of(colors, 1.0, parameters);
  REQUIRE(r);
  CHECK(r->points == 30);
  CHECK(r->ripe_share == Approx(ripeness_of(std::vector<Rgb>(30, kRed), 1.0)->ripe_share));
  CHECK((r->lab - 0.75 * to_lab(kRed) - 0.25 * to_lab(kGrey)).norm() < 1e-9);
  CHECK(r->hue == Approx(hue_of(0.75 * to_lab(kRed) + 0.25 * to_lab(kGrey))));
  const auto few = ripeness_of(std::vector<Rgb>(8, kRed), 1.0);  // no fewer will do
  REQUIRE(few);
  CHECK(few->points == 8);
  CHECK(Ripeness().points == 0);
  // What has hardly any chroma is left out from the limit on.
  const double chroma = to_lab(kRed).tail<2>().norm();
  parameters.min_chroma = chroma - 1e-6;
  CHECK(ripeness_of(colors, 1.0, parameters)->points == 30);
  parameters.min_chroma = chroma + 1e-6;
  CHECK_FALSE(ripeness_of(colors, 1.0, parameters));
}

TEST_CASE("15 of 100 points are trimmed at either end, or as many as are asked for") {
  const auto color = [](std::size_t bright, std::size_t dark, double trim) {
    std::vector<Rgb> colors(100, kRed);
    std::fill_n(colors.begin() + 20, bright, kWhite);
    std::fill_n(colors.begin() + 60, dark, kDark);
    RipenessParameters parameters;
    if (trim >= 0.0) parameters.trim = trim;
    return (ripeness_of(colors, 1.0, parameters)->lab - to_lab(kRed)).norm();
  };
  CHECK(color(15, 15, -1.0) < 1e-9);
  CHECK(color(16, 0, -1.0) > 0.1);
  CHECK(color(0, 16, -1.0) > 0.1);
  CHECK(color(30, 30, 0.3) < 1e-9);
  CHECK(color(31, 0, 0.3) > 0.1);
  CHECK(color(1, 0, 0.0) > 0.1);
  CHECK(color(0, 0, 0.0) < 1e-9);
}

TEST_CASE("errors of the hue and of the share, by hand") {
  const auto share_below = [](double deviations) { return 0.5 * std::erfc(-deviations / std::sqrt(2.0)); };
  RipenessParameters parameters;
  parameters.trim = 0.0;
  // All of one hue, which is just the ripe one: half counts as ripe, 69 or 31 % if all hues are off by half an error.
  parameters.ripe_hue = hue_of(to_lab(kRed));
  const double shifted = share_below(0.5) - 0.5;
  const std::pair<double, double> kUnseen[] = {// the share that was seen, and the error for what was not
                                               {1.0, 0.0},
                                               {0.25, std::sqrt(0.25 / 3.0 * 0.75)},
                                               {0.0, 0.5},
                                               {0.05, std::sqrt(0.25 * 0.95)}};
  for (const auto& [seen, unseen] : kUnseen) {
    CAPTURE(seen);
    const auto r = ripeness_of(std::vector<Rgb>(20, kRed), seen, parameters);
    REQUIRE(r);
    CHECK(r->ripe_share == Approx(0.5));
    CHECK(r->ripe_share_error == Approx(std::hypot(unseen, shifted)));
    CHECK(r->hue_error == Approx(deg(4)));
    CHECK(r->grade == RipenessClass::pink);
    CHECK(r->probability == Approx(share_below(0.1 / r->ripe_share_error) - share_below(-0.2 / r->ripe_share_error)));
  }
  // Two hues: they spread about that of the mean color.
  parameters.ripe_hue = deg(70);
  const auto r = ripeness_of(tomato(50), 0.5, parameters);
  REQUIRE(r);
  const double red = hue_of(to_lab(kRed)), green = hue_of(to_lab(kGreen));
  const double mean = hue_of(0.5 * to_lab(kRed) + 0.5 * to_lab(kGreen));
  const double spread = 0.5 * (std::pow(red - mean, 2) + std::pow(green - mean, 2));
  CHECK(r->hue == Approx(mean));
  CHECK(r->hue_error == Approx(std::sqrt(std::pow(deg(4), 2) + spread / 6.0)));
}

TEST_CASE("shares that are none are refused") {
  CHECK_THROWS_WITH(ripeness_of(tomato(50), 1.5), "ripeness_of: the share that was seen must be from 0 to 1, got 1.5");
  for (const double seen : {-0.1, 40.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_AS(ripeness_of(tomato(50), seen), InputError);
    CHECK_THROWS_AS(ripeness_of({}, seen), InputError);
  }
  CHECK_THROWS_AS(class_of(std::numeric_limits<double>::quiet_NaN()), InputError);
}

TEST_CASE("a class without any doubt has the probability one") {
  const auto r = ripeness_of(std::vector<Rgb>(20, Rgb{40, 160, 60}), 1.0);  // far from ripe
  REQUIRE(r);
  CHECK(r->ripe_share < 1e-6);
  CHECK(r->grade == RipenessClass::green);
  CHECK(r->probability == Approx(1.0));
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
