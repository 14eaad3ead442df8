// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/fuse/color_prior.hpp>

#include <map>
#include <set>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// An image of leaves with red discs of 20 pixels, all 1 m away: two that touch, and one apart.
sensor::DepthFrame discs() {
  sensor::DepthFrame f;
  f.intrinsics = {200, 120, 600.0, 600.0, 99.5, 59.5};
  f.depth.assign(f.intrinsics.size(), 1.0f);
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 200; ++u) {
      const bool red = std::hypot(u - 40, v - 60) < 20 || std::hypot(u - 76, v - 60) < 20 ||
                       std::hypot(u - 150, v - 60) < 20 || (u == 20 && v == 10);
      f.color.push_back(red ? Rgb{190, 40, 35} : Rgb{60, 120, 50});
    }
  return f;
}

const Rgb kRed{190, 40, 35}, kGreen{60, 120, 50};

/// An image of leaves, 1 m away, that is red where red(u, v) is true. A fruit of 10 mm has a radius of 6 pixels.
template <typename Red>
sensor::DepthFrame image_of(Red&& red, int width = 200, int height = 120) {
  sensor::DepthFrame f;
  f.intrinsics = {width, height, 600.0, 600.0, 99.5, 59.5};
  f.depth.assign(f.intrinsics.size(), 1.0f);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) f.color.push_back(red(u, v) ? kRed : kGreen);
  return f;
}

/// A red rectangle with a corner at (u0, v0).
sensor::DepthFrame rectangle(int u0, int v0, int width = 20, int height = 20) {
  return image_of([=](int u, int v) { return u >= u0 && u < u0 + width && v >= v0 && v < v0 + height; });
}

/// Two red discs in one row, their middles `apart` (pixels).
sensor::DepthFrame two_discs(double left, double right, double apart) {
  return image_of(
      [=](int u, int v) { return std::hypot(u - 50, v - 60) < left || std::hypot(u - 50 - apart, v - 60) < right; });
}

/// The number of pixels of each instance.
std::map<int, int> sizes(const sensor::DepthFrame& frame) {
  std::map<int, int> out;
  for (const std::uint16_t i : frame.instances)
    if (i) ++out[i];
  return out;
}

/// The parameters with which a patch is dropped that has fewer pixels than this, at 1 m.
fuse::ColorPriorParameters least(double pixels, const BodyParameters& bodies = {}) {
  fuse::ColorPriorParameters p;
  p.least_disc = pixels / (kPi * std::pow(600.0 * bodies.radius_min, 2));
  return p;
}

std::size_t found(const sensor::DepthFrame& frame, const BodyParameters& bodies = {},
                  const fuse::ColorPriorParameters& parameters = {}) {
  return fuse::detected_by_color(frame, bodies, parameters).detections.size();
}

// A square of 20 pixels less three at each corner: about those at most 12 of 25 pixels are red.
constexpr int kSquare = 20 * 20 - 4 * 3;

}  // namespace

TEST_CASE("patches of the color of fruit become masks, cut where two touch") {
  const sensor::DepthFrame frame = fuse::detected_by_color(discs());
  REQUIRE(frame.detected);
  REQUIRE(frame.detections.size() == 3);
  const auto at = [&](int u, int v) { return int(frame.instances[frame.intrinsics.index(u, v)]); };
  CHECK(std::set<int>{at(40, 60), at(76, 60), at(150, 60)} == std::set<int>{1, 2, 3});
  CHECK(at(20, 10) == 0);
  CHECK(at(100, 100) == 0);
  for (const sensor::Detection& d : frame.detections) CHECK(d.fruit);
}

TEST_CASE("a step in depth cuts a patch, a detector's masks stay") {
  sensor::DepthFrame frame = discs();
  for (int v = 0; v < 120; ++v)
    for (int u = 150; u < 200; ++u) frame.depth[frame.intrinsics.index(u, v)] = 1.1f;
  const sensor::DepthFrame cut = fuse::detected_by_color(frame);
  CHECK(cut.detections.size() == 4);
  frame.detected = true;
  CHECK(fuse::detected_by_color(frame).detections.empty());
  frame.detected = false;
  frame.color.clear();
  CHECK_FALSE(fuse::detected_by_color(frame).detected);
}

TEST_CASE("a pixel has the color of fruit if most of the 25 about it have") {
  CHECK(sizes(fuse::detected_by_color(rectangle(70, 40))) == std::map<int, int>{{1, kSquare}});
  // Next to the border of the image there are no 25: two rows and columns and, far from the border, a corner are lost.
  for (const auto& [u, v] : {std::pair(0, 0), std::pair(180, 0), std::pair(0, 100), std::pair(180, 100)})
    CHECK(sizes(fuse::detected_by_color(rectangle(u, v))) == std::map<int, int>{{1, 18 * 18 - 3}});
  const sensor::DepthFrame frame = fuse::detected_by_color(rectangle(70, 40));
  const auto at = [&](int u, int v) { return frame.instances[frame.intrinsics.index(u, v)] != 0; };
  for (const auto& [u, v] : {std::pair(70, 50), std::pair(89, 50), std::pair(80, 40), std::pair(80, 59)})
    CHECK(at(u, v));
  for (const auto& [u, v] : {std::pair(69, 50), std::pair(90, 50), std::pair(80, 39), std::pair(80, 60)})
    CHECK_FALSE(at(u, v));
}

TEST_CASE("hue and chroma of fruit may be at the ends of their ranges") {
  const sensor::DepthFrame frame = rectangle(70, 40);
  const Eigen::Vector3d lab = to_lab(kRed);
  const double hue = hue_of(lab), chroma = std::hypot(lab.y(), lab.z());
  const auto with = [&](double from, double to, double least_chroma) {
    fuse::ColorPriorParameters p;
    p.hue_from = from;
    p.hue_to = to;
    p.min_chroma = least_chroma;
    return found(frame, {}, p);
  };
  CHECK(with(hue, hue, chroma) == 1);
  CHECK(with(hue + 1e-6, hue + 0.1, chroma) == 0);
  CHECK(with(hue - 0.1, hue - 1e-6, chroma) == 0);
  CHECK(with(hue, hue, chroma + 1e-6) == 0);
}

TEST_CASE("patches are dropped by their size at the mean of their depths") {
  sensor::DepthFrame frame = rectangle(70, 40);
  CHECK(found(frame, {}, least(kSquare - 0.3)) == 1);
  CHECK(found(frame, {}, least(kSquare + 0.3)) == 0);
  std::fill(frame.depth.begin(), frame.depth.end(), 0.0f);
  CHECK(found(frame) == 0);  // no depth at all
  const auto middle = frame.intrinsics.index(80, 50), aside = frame.intrinsics.index(82, 50);
  frame.depth[middle] = 1.0f;  // a single one
  CHECK(found(frame, {}, least(kSquare - 0.3)) == 1);
  CHECK(found(frame, {}, least(kSquare + 0.3)) == 0);
  frame.depth[middle] = 0.75f, frame.depth[aside] = 1.25f;  // their mean is 1 m
  CHECK(found(frame, {}, least(kSquare - 0.3)) == 1);
  CHECK(found(frame, {}, least(kSquare + 0.3)) == 0);
  frame.depth[middle] = 2.0f, frame.depth[aside] = 2.0f;  // so far away a fruit has a quarter of the pixels
  CHECK(found(frame, {}, least(4.0 * (kSquare - 0.3))) == 1);
  CHECK(found(frame, {}, least(4.0 * (kSquare + 0.3))) == 0);
}

TEST_CASE("a step of more than a quarter of the largest radius cuts a patch") {
  for (const double largest : {0.06, 0.1})
    for (const double sign : {-1.0, 1.0})
      for (const bool beside : {false, true}) {
        BodyParameters bodies;
        bodies.radius_max = largest;
        const auto with = [&](double step) {
          sensor::DepthFrame frame = rectangle(60, 30, 40, 40);
          for (int v = 0; v < 120; ++v)
            for (int u = 0; u < 200; ++u)
              if ((beside ? u : v + 30) >= 80)
                frame.depth[frame.intrinsics.index(u, v)] += static_cast<float>(sign * step);
          return found(frame, bodies);
        };
        CHECK(with(0.25 * largest - 0.001) == 1);
        CHECK(with(0.25 * largest + 0.001) == 2);
      }
}

TEST_CASE("patches at both sides of an image are two") {
  const sensor::DepthFrame frame = image_of([](int u, int v) { return (u < 20 || u >= 180) && v >= 40 && v < 70; });
  CHECK(sizes(fuse::detected_by_color(frame)) == std::map<int, int>{{1, 18 * 30 - 6}, {2, 18 * 30 - 6}});
}

TEST_CASE("a patch is cut where it is narrow between discs of like size") {
  // At 1.5 radii the neck has 0.66 of a radius. At 1.15 radii it has 0.82, and the middles are too near.
  CHECK(found(two_discs(30, 30, 45)) == 2);
  CHECK(found(two_discs(30, 30, 34.5)) == 1);
  CHECK(found(two_discs(30, 24, 48)) == 2);
  CHECK(found(two_discs(24, 30, 48)) == 2);
  CHECK(found(two_discs(30, 18, 46)) == 1);  // less than 0.7 of the larger radius
  CHECK(found(two_discs(18, 30, 46)) == 1);
  CHECK(found(rectangle(30, 40, 120, 40)) == 1);  // long, but nowhere narrow
}

TEST_CASE("bulges smaller than half the smallest fruit cut nothing") {
  const sensor::DepthFrame frame = two_discs(9.5, 8, 16);
  BodyParameters bodies;
  for (const auto& [radius, parts] : {std::pair(13.0, 2u), std::pair(18.0, 1u)}) {  // pixels
    bodies.radius_min = radius / 600.0;
    CHECK(found(frame, bodies, least(30.0, bodies)) == parts);
  }
}

TEST_CASE("pixels go to the disc in which they lie deepest") {
  const sensor::DepthFrame frame = fuse::detected_by_color(two_discs(30, 24, 48));
  REQUIRE(frame.detections.size() == 2);
  const auto at = [&](int u, int v) { return int(frame.instances[frame.intrinsics.index(u, v)]); };
  const int large = at(50, 60), small = at(98, 60);
  CHECK(large != small);
  for (const int v : {55, 60, 65}) {  // as deep in both at 77: 30 - 27 = 24 - 21
    CHECK(at(74, v) == large);
    CHECK(at(80, v) == small);
  }
  // A smaller part that has too few pixels is dropped, the larger one stays.
  CHECK(found(two_discs(30, 24, 48), {}, least(2300.0)) == 1);
}

TEST_CASE("a patch is cut alike whichever way it bends") {
  // Three discs in a row, and a bar that leads to the middle one from below and begins above them all.
  const auto bent = [](int u, int v) {
    for (const int middle : {80, 106, 132})
      if (std::hypot(u - middle, v - 50) < 14) return true;
    return (u >= 20 && u < 27 && v >= 15 && v < 102) || (v >= 95 && v < 102 && u >= 20 && u < 110) ||
           (u >= 103 && u < 110 && v >= 50 && v < 102);
  };
  for (const bool left : {false, true})
    for (const bool down : {false, true}) {
      const auto turned = [&](int u, int v) { return std::pair(left ? 199 - u : u, down ? 119 - v : v); };
      const sensor::DepthFrame frame = fuse::detected_by_color(image_of([&](int u, int v) {
        const auto [a, b] = turned(u, v);
        return bent(a, b);
      }));
      CHECK(frame.detections.size() == 3);
      std::set<int> instances;
      for (const int middle : {80, 106, 132}) {
        const auto [u, v] = turned(middle, 50);
        const int instance = frame.instances[frame.intrinsics.index(u, v)];
        instances.insert(instance);
        for (const int off : {-10, 10}) CHECK(frame.instances[frame.intrinsics.index(u, v + off)] == instance);
      }
      CHECK(instances == std::set<int>{1, 2, 3});
    }
}

TEST_CASE("detections are numbered from 1 and have the score of the prior") {
  sensor::DepthFrame frame = rectangle(30, 40);
  for (int v = 40; v < 60; ++v)
    for (int u = 130; u < 150; ++u) frame.color[frame.intrinsics.index(u, v)] = kRed;
  fuse::ColorPriorParameters parameters;
  parameters.score = 0.625;
  frame.detections.resize(5);  // of nobody: no detector has looked
  const sensor::DepthFrame seen = fuse::detected_by_color(frame, {}, parameters);
  REQUIRE(seen.detections.size() == 2);
  for (int i = 0; i < 2; ++i) {
    const sensor::Detection& d = seen.detections[static_cast<std::size_t>(i)];
    CHECK(d.instance == i + 1);
    CHECK(d.score == 0.625);
    CHECK(d.fruit);
    CHECK(d.name == "color");
    CHECK_FALSE(d.box);
  }
  CHECK(sizes(seen) == std::map<int, int>{{1, kSquare}, {2, kSquare}});
}

TEST_CASE("wrong parameters and frames of two sizes are refused") {
  fuse::ColorPriorParameters parameters;
  parameters.least_disc = 0.0;
  CHECK_THROWS_AS(fuse::detected_by_color(rectangle(70, 40), {}, parameters), ParameterError);
  sensor::DepthFrame frame = rectangle(70, 40);
  frame.color.pop_back();
  CHECK_THROWS_AS(fuse::detected_by_color(frame), InputError);
}
