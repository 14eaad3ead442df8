// SPDX-License-Identifier: BSD-3-Clause
// From the pixels of one mask to the outline, the front and the first guess of the body under it.
#include "fuse/mask_outline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "catch.hpp"

using namespace agrisee;
using fuse::guess_bodies;
using fuse::MaskGuess;

namespace mask_outline_test {

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kFocal = 600.0, kCu = 79.5, kCv = 59.5;  // pixels

/// A pose of no special kind.
Pose somewhere() { return look_along(Eigen::Vector3d(0.3, -0.2, 0.5), Eigen::Vector3d(0.6, 0.7, -0.2), 0.4); }

/// A view in which every pixel has a distance (m, from the sensor; 0: no return) and belongs to the mask or not.
struct Scene {
  sensor::Intrinsics intrinsics{kWidth, kHeight, kFocal, kFocal, kCu, kCv};
  Pose pose = somewhere();
  std::vector<double> distance = std::vector<double>(intrinsics.size(), 0.0);
  std::vector<std::uint16_t> instances = std::vector<std::uint16_t>(intrinsics.size(), 0);

  /// The distance (m) of all pixels where of(u, v) is true.
  template <typename F>
  Scene& put(double d, F&& of) {
    for (int v = 0; v < intrinsics.height; ++v)
      for (int u = 0; u < intrinsics.width; ++u)
        if (of(u, v)) distance[intrinsics.index(u, v)] = d;
    return *this;
  }
  /// Mask 1, at a distance of 1 m, where of(u, v) is true.
  template <typename F>
  Scene& mask(F&& of) {
    for (int v = 0; v < intrinsics.height; ++v)
      for (int u = 0; u < intrinsics.width; ++u)
        if (of(u, v)) instances[intrinsics.index(u, v)] = 1, distance[intrinsics.index(u, v)] = 1.0;
    return *this;
  }
  fuse::MaskImage image() const {
    sensor::DepthFrame f;
    f.intrinsics = intrinsics;
    f.detected = true;
    f.instances = instances;
    for (int v = 0; v < intrinsics.height; ++v)
      for (int u = 0; u < intrinsics.width; ++u)
        f.depth.push_back(static_cast<float>(distance[intrinsics.index(u, v)] / intrinsics.ray(u, v).norm()));
    return fuse::mask_image({std::move(f), pose});
  }
  std::vector<MaskGuess> guesses(const BodyParameters& bodies = {}, const fuse::MaskParameters& p = {}) const {
    return guess_bodies(image(), 1, bodies, p);
  }
  MaskGuess guess(const BodyParameters& bodies = {}, const fuse::MaskParameters& p = {}) const {
    const auto all = guesses(bodies, p);
    REQUIRE(all.size() == 1);
    return all[0];
  }
  /// The direction (unit, world) of a place in the image.
  Eigen::Vector3d direction(double u, double v) const {
    const Eigen::Vector3d ray((u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1.0);
    return (pose.linear() * ray).normalized();
  }
  /// Where in the image (pixels) a point (m, world) is.
  Eigen::Vector2d place(const Eigen::Vector3d& p) const { return intrinsics.project(pose.inverse() * p); }
};

auto disc(double u0, double v0, double radius) {
  return [=](int u, int v) { return std::hypot(u - u0, v - v0) < radius; };
}

/// 36 x 35 pixels, as many as a disc with a radius of 20.03.
bool rectangle(int u, int v) { return u >= 60 && u < 96 && v >= 40 && v < 75; }

/// The radius (pixels) of a circle that a sphere fills, if it is small beside its distance.
double pixels(const Sphere& s, const Scene& scene) {
  const double sine = s.radius / (s.center - scene.pose.translation()).norm();
  return kFocal * sine / std::sqrt(1.0 - sine * sine);
}

/// The weights of the places on the side of the rectangle that the direction (du, dv) points to.
std::vector<double> side(const MaskGuess& guess, const Scene& scene, int du, int dv) {
  std::vector<double> out;
  for (std::size_t i = 0; i < guess.outline.rays.size(); ++i) {
    const Eigen::Vector2d at = scene.place(scene.pose.translation() + guess.outline.rays[i]);
    const double end = du ? (du > 0 ? 95.5 : 59.5) : (dv > 0 ? 74.5 : 39.5);
    if (std::abs((du ? at.x() : at.y()) - end) < 1e-6) out.push_back(guess.outline.weights[i]);
  }
  return out;
}

}  // namespace

TEST_CASE("the densest range holds most items, the first one of equals") {
  const auto densest = [](const std::vector<double>& items, double length) {
    return fuse::densest(items, length, [](double x) { return x; });
  };
  using Range = std::pair<std::size_t, std::size_t>;
  CHECK(densest({}, 1.0) == Range(0, 0));
  CHECK(densest({5.0}, 1.0) == Range(0, 1));
  CHECK(densest({0.0, 2.0, 3.0, 7.0, 8.0}, 1.0) == Range(1, 3));
  CHECK(densest({0.0, 1.5, 3.0, 3.5, 4.0, 6.0}, 1.0) == Range(2, 5));
  CHECK(densest({0.0, 0.5, 4.0, 4.5, 4.75}, 0.75) == Range(2, 5));
  CHECK(densest({1.0, 1.0, 1.0, 2.0}, 0.0) == Range(0, 3));
}

TEST_CASE("a disc is guessed as the ball that fills its outline, with its front at its depths") {
  for (const double radius : {8.5, 12.5, 20.5, 30.5}) {
    const Scene scene = Scene().put(3.0, [](int, int) { return true; }).mask(disc(90, 50, radius));
    const MaskGuess guess = scene.guess();
    CHECK(pixels(guess.sphere, scene) == Approx(radius).margin(0.8));
    const Eigen::Vector2d middle = scene.place(guess.sphere.center);
    CHECK(middle.x() == Approx(90.0).margin(0.8));
    CHECK(middle.y() == Approx(50.0).margin(0.8));
    CHECK((guess.sphere.center - scene.pose.translation()).norm() - guess.sphere.radius == Approx(1.0));
    CHECK(guess.outline.seen > 0.95);
    CHECK(guess.outline.sensor == scene.pose.translation());
  }
}

TEST_CASE("there is no guess where each ball of an expected size contradicts the mask or what is seen beside it") {
  const auto far_wall = [](int, int) { return true; };
  BodyParameters large;  // the disc is one of 2.1 cm
  large.radius_min = 0.06, large.radius_max = 0.1;
  CHECK(Scene().put(3.0, far_wall).mask(disc(90, 50, 12.5)).guesses(large).empty());
  CHECK(Scene().put(3.0, far_wall).mask(disc(90, 50, 42.5)).guesses(large).size() == 1);

  // One sees past a half disc where the other half of the ball would be.
  BodyParameters alike;  // as the whole disc, of 3.5 cm
  alike.radius_min = 0.031, alike.radius_max = 0.04;
  const auto half = [](int u, int v) { return u <= 80 && disc(80, 60, 20.5)(u, v); };
  CHECK(Scene().put(3.0, far_wall).mask(half).guesses(alike).empty());
  CHECK(Scene().put(0.9, [](int u, int) { return u > 80; }).mask(half).guesses(alike).size() == 1);  // a leaf is there
}

TEST_CASE("the outline has a sight line between each pixel of the mask and each beside it, in order") {
  const Scene scene = Scene().mask(rectangle);
  const MaskGuess guess = scene.guess();
  std::vector<Eigen::Vector3d> expected;
  for (int u = 60; u < 96; ++u)
    expected.push_back(scene.direction(u, 39.5)), expected.push_back(scene.direction(u, 74.5));
  for (int v = 40; v < 75; ++v)
    expected.push_back(scene.direction(59.5, v)), expected.push_back(scene.direction(95.5, v));
  REQUIRE(guess.outline.rays.size() == expected.size());
  for (const Eigen::Vector3d& e : expected)
    CHECK(std::count_if(guess.outline.rays.begin(), guess.outline.rays.end(),
                        [&](const Eigen::Vector3d& ray) { return (ray - e).norm() < 1e-12; }) == 1);
  double before = -kPi;
  for (const Eigen::Vector3d& ray : guess.outline.rays) {
    const Eigen::Vector2d at = scene.place(scene.pose.translation() + ray);
    const double turn = std::atan2(at.y() - 57.0, at.x() - 77.5);
    if (std::abs(turn) > kPi - 1e-6) continue;  // the first or the last
    CHECK(turn > before);
    before = turn;
  }
  for (const double weight : guess.outline.weights) CHECK(weight == 1.0);
}

TEST_CASE("the error of a sight line is that of the mask's edge") {
  fuse::MaskParameters parameters;
  parameters.edge = 2.5;
  Scene scene = Scene().mask(disc(90, 50, 20.5));
  CHECK(scene.guess({}, parameters).outline.angle_error == Approx(2.5 / kFocal));
  scene.intrinsics.fy = 500.0;
  CHECK(scene.guess({}, parameters).outline.angle_error == Approx(2.5 / std::sqrt(600.0 * 500.0)));
}

TEST_CASE("the front is at most 400 points at the depth of most pixels, behind a tenth of them") {
  Scene scene = Scene().mask(rectangle);
  std::vector<Eigen::Vector3d> layer;
  int i = 0;
  for (int v = 40; v < 75; ++v)
    for (int u = 60; u < 96; ++u, ++i) {
      double& d = scene.distance[scene.intrinsics.index(u, v)];
      if (i % 9 == 0)
        d = 0.9;  // before it: 140 of 1260
      else if (i % 9 == 1)
        d = 2.0;  // behind it
      else if (i % 9 == 2)
        d = 0.0;
      else
        d = 1.0 + 0.00004 * double(layer.size()), layer.push_back(scene.pose.translation() + d * scene.direction(u, v));
    }
  REQUIRE(layer.size() == 840);
  const MaskGuess guess = scene.guess();
  REQUIRE(guess.outline.front.size() == 280);  // every third of 840
  for (std::size_t k = 0; k < 280; ++k) CHECK((guess.outline.front[k] - layer[3 * k]).norm() < 1e-6);
  CHECK((guess.sphere.center - guess.outline.sensor).norm() - guess.sphere.radius == Approx(1.0 + 0.00004 * 84));
}

TEST_CASE("the nearest and the farthest pixel at the depth of most belong to the front") {
  Scene scene = Scene().mask(disc(80, 60, 10.5));
  std::vector<Eigen::Vector3d> expected;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const std::size_t p = scene.intrinsics.index(u, v);
      if (!scene.instances[p]) continue;
      scene.distance[p] = 1.0 + 0.0001 * double(expected.size());  // each its own, 35 mm in all
      expected.push_back(scene.pose.translation() + scene.distance[p] * scene.direction(u, v));
    }
  REQUIRE(expected.size() < 400);
  const std::vector<Eigen::Vector3d> front = scene.guess().outline.front;
  REQUIRE(front.size() == expected.size());
  CHECK((front.front() - expected.front()).norm() < 1e-6);
  CHECK((front.back() - expected.back()).norm() < 1e-6);
}

TEST_CASE("the front is thinned from 400 points on") {
  const auto front = [](int columns, int extra) {
    return Scene()
        .mask([=](int u, int v) {
          return (u >= 60 && u < 60 + columns && v >= 40 && v < 60) || (u < 60 + extra && u >= 60 && v == 60);
        })
        .guess()
        .outline.front.size();
  };
  CHECK(front(19, 19) == 399);
  CHECK(front(20, 0) == 200);
  CHECK(front(20, 1) == 201);
  CHECK(front(39, 19) == 400);  // of 799
  CHECK(front(40, 1) == 267);   // of 801
}

TEST_CASE("a body is guessed from twelve depths on, of an expected size") {
  const auto guessed = [](int depths, double smallest, double largest) {
    Scene scene = Scene().mask(disc(80, 60, 12.5));  // a ball of 21 mm, whose center is 21 mm behind its front at 1 m
    for (std::size_t i = 0; i < scene.distance.size(); ++i)
      if (scene.instances[i] && --depths < 0) scene.distance[i] = 0.0;
    BodyParameters bodies;
    bodies.radius_min = smallest;
    bodies.radius_max = largest;
    return scene.guesses(bodies).size();
  };
  CHECK(guessed(12, 0.01, 0.06) == 1);
  CHECK(guessed(11, 0.01, 0.06) == 0);
  CHECK(guessed(1000, 0.001, 0.002) == 0);
}

TEST_CASE("where something nearer is just outside, the mask does not end because the body ends") {
  // One looks 2, 4, 5 and 7 pixels beyond the last pixel. Half of them hidden leave 0.05, a fourth leaves 0.75.
  for (const auto& [from, to, weight] :
       {std::tuple(5, 9, 0.05), std::tuple(7, 7, 0.75), std::tuple(8, 9, 1.0), std::tuple(2, 2, 0.75),
        std::tuple(3, 4, 0.75), std::tuple(3, 3, 1.0), std::tuple(2, 4, 0.05), std::tuple(5, 6, 0.75)})
    for (const auto& [du, dv] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      Scene scene = Scene().put(3.0, [](int, int) { return true; });
      scene.put(0.5, [&, du = du, dv = dv, from = from, to = to](int u, int v) {
        const int beyond = du > 0 ? u - 95 : du < 0 ? 60 - u : dv > 0 ? v - 74 : 40 - v;
        return beyond >= from && beyond <= to;
      });
      const MaskGuess guess = scene.mask(rectangle).guess();
      for (const auto& [a, b] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        const std::vector<double> weights = side(guess, scene, a, b);
        CHECK(weights.size() == (a ? 35 : 36));
        for (const double w : weights) CHECK(w == (a == du && b == dv ? weight : 1.0));
      }
    }
}

TEST_CASE("what hides a body is nearer than a third of its radius behind its front") {
  const auto weight = [](double behind, const BodyParameters& bodies = {}) {
    Scene scene = Scene().put(1.0 + behind, [](int u, int) { return u > 90; }).mask(rectangle);
    return side(scene.guess(bodies), scene, 1, 0).front();
  };
  const double radius = std::sqrt(36 * 35 / kPi) / kFocal;  // m, at 1 m
  CHECK(weight(0.35 * radius - 0.0005) == 0.05);
  CHECK(weight(0.35 * radius + 0.0005) == 1.0);
  BodyParameters larger;  // so that the mask shows a part of the smallest body
  larger.radius_min = 0.038;
  CHECK(weight(0.35 * 0.038 - 0.0005, larger) == 0.05);
  CHECK(weight(0.35 * 0.038 + 0.0005, larger) == 1.0);
  BodyParameters smaller;
  smaller.radius_max = 0.031;
  CHECK(weight(0.35 * 0.031 - 0.0005, smaller) == 0.05);
  CHECK(weight(0.35 * 0.031 + 0.0005, smaller) == 1.0);
}

TEST_CASE("where the image ends the mask does not end because the body ends") {
  const auto at = [](int du, int dv) {  // the rectangle of 36 x 35 pixels, moved
    Scene scene = Scene().mask([=](int u, int v) { return rectangle(u - du, v - dv); });
    const MaskGuess guess = scene.guess();
    double least = 1.0;
    for (const double w : guess.outline.weights) least = std::min(least, w);
    return least;
  };
  // The seventh pixel beyond the last has to be in the image.
  CHECK(at(-60 + 7, 0) == 1.0);
  CHECK(at(-60 + 6, 0) == 0.05);
  CHECK(at(kWidth - 96 - 7, 0) == 1.0);
  CHECK(at(kWidth - 96 - 6, 0) == 0.05);
  CHECK(at(0, -40 + 7) == 1.0);
  CHECK(at(0, -40 + 6) == 0.05);
  CHECK(at(0, kHeight - 75 - 7) == 1.0);
  CHECK(at(0, kHeight - 75 - 6) == 0.05);
  CHECK(at(-60, 0) == 0.05);
  CHECK(at(kWidth - 96, kHeight - 75) == 0.05);
}

TEST_CASE("the share of the outline that is seen is what nothing hides") {
  const auto seen = [](int from_u) {
    Scene scene = Scene().mask(disc(80, 60, 24.5));
    for (int v = 0; v < kHeight; ++v)
      for (int u = from_u; u < kWidth; ++u) {
        scene.instances[scene.intrinsics.index(u, v)] = 0;
        scene.distance[scene.intrinsics.index(u, v)] = 0.5;
      }
    const MaskGuess guess = scene.guess();
    CHECK(pixels(guess.sphere, scene) == Approx(24.5).margin(1.2));
    return guess.outline.seen;
  };
  CHECK(seen(kWidth) == Approx(1.0));
  CHECK(seen(80) == Approx(0.5).margin(0.08));
  CHECK(seen(80 + 12) == Approx(2.0 / 3.0).margin(0.08));  // half the radius from the middle: 120 degrees are hidden
  Scene hidden = Scene().put(0.5, [](int, int) { return true; }).mask(disc(80, 60, 20.5));
  CHECK(hidden.guess().outline.seen == Approx(0.05));
}

TEST_CASE("two discs that touch are two balls, each with the outline next to it") {
  for (const bool mirrored : {false, true}) {
    const auto flip = [=](int u) { return mirrored ? kWidth - 1 - u : u; };
    Scene scene =
        Scene().mask([&](int u, int v) { return disc(55, 60, 24.5)(flip(u), v) || disc(95, 60, 16.5)(flip(u), v); });
    const auto guesses = scene.guesses();
    REQUIRE(guesses.size() == 2);
    const std::size_t large = guesses[0].sphere.radius > guesses[1].sphere.radius ? 0 : 1;
    CHECK(pixels(guesses[large].sphere, scene) == Approx(24.5).margin(0.8));
    CHECK(pixels(guesses[1 - large].sphere, scene) == Approx(16.5).margin(0.8));
    CHECK(scene.place(guesses[large].sphere.center).x() == Approx(flip(55)).margin(0.8));
    CHECK(scene.place(guesses[1 - large].sphere.center).x() == Approx(flip(95)).margin(0.8));
    for (std::size_t i = 0; i < guesses[0].outline.rays.size(); ++i) {
      const Eigen::Vector2d at = scene.place(scene.pose.translation() + guesses[0].outline.rays[i]);
      const double u = mirrored ? kWidth - 1 - at.x() : at.x();
      if (std::abs(u - 79.0) < 12.0) continue;  // next to both
      CHECK(guesses[large].outline.weights[i] == (u < 79.0 ? 1.0 : 0.0));
      CHECK(guesses[1 - large].outline.weights[i] == (u < 79.0 ? 0.0 : 1.0));
    }
  }
}

TEST_CASE("a second body is like the first in size and stands apart") {
  const auto two = [](double radius, double apart) {
    return Scene()
               .mask([=](int u, int v) { return disc(60, 60, 24.5)(u, v) || disc(60 + apart, 60, radius)(u, v); })
               .guesses()
               .size() == 2;
  };
  CHECK(two(24.5, 46.0));
  CHECK(two(24.5, 26.0));
  CHECK_FALSE(two(24.5, 14.0));  // less than 0.8 of the radius apart
  CHECK(two(16.0, 38.0));
  CHECK_FALSE(two(11.0, 34.0));  // less than 0.55 of the larger
}

TEST_CASE("a mask that bulges in places is as large as most of its border says") {
  // Of the border three quarters are at 40 pixels. The rest is at 47, less than two tolerances of 4 pixels outside.
  fuse::MaskParameters parameters;
  parameters.edge = 4.0;
  BodyParameters bodies;
  bodies.radius_max = 0.12;
  Scene scene = Scene().mask([](int u, int v) {
    const double turn = 5.0 * std::atan2(v - 60.0, u - 80.0) / kTwoPi;
    return std::hypot(u - 80.0, v - 60.0) < (turn - std::floor(turn) < 0.25 ? 47.0 : 40.0);
  });
  const MaskGuess guess = scene.guess(bodies, parameters);
  CHECK(pixels(guess.sphere, scene) == Approx(41.0).margin(2.0));
}

TEST_CASE("a turned or mirrored mask gives the body turned or mirrored") {
  // Few pixels, so that the border is tried in full and there is one best circle.
  for (const std::vector<std::string>& rows : {std::vector<std::string>{".##....",  //
                                                                        "#####..",  //
                                                                        "######.",  //
                                                                        "######.",  //
                                                                        ".#####.",  //
                                                                        "..##...",  //
                                                                        "......."},
                                               std::vector<std::string>{"..#....",  //
                                                                        ".###...",  //
                                                                        ".####..",  //
                                                                        "######.",  //
                                                                        ".#####.",  //
                                                                        ".####..",  //
                                                                        "..#...."},
                                               std::vector<std::string>{".......",  //
                                                                        ".##....",  //
                                                                        "####...",  //
                                                                        "#####..",  //
                                                                        ".####..",  //
                                                                        ".###...",  //
                                                                        "......."}}) {
    std::vector<Eigen::Vector3d> found;  // the place (pixels) and the size, turned back
    for (int turn = 0; turn < 8; ++turn) {
      const auto turned = [turn](double u, double v) {  // of places about the middle
        for (int k = 0; k < turn % 4; ++k) u = std::exchange(v, -u);
        return Eigen::Vector2d(turn < 4 ? u : -u, v);
      };
      Scene scene;
      scene.intrinsics = {21, 21, 60.0, 60.0, 10.0, 10.0};
      scene.pose = Pose::Identity();
      scene.distance.assign(441, 0.0);
      scene.instances.assign(441, 0);
      fuse::MaskParameters parameters;
      parameters.edge = 0.75;
      for (int v = 0; v < 7; ++v)
        for (int u = 0; u < 7; ++u) {
          const Eigen::Vector2d at = turned(u - 3, v - 3);
          const std::size_t p = scene.intrinsics.index(10 + int(std::lround(at.x())), 10 + int(std::lround(at.y())));
          if (rows[std::size_t(v)][std::size_t(u)] == '#') scene.instances[p] = 1, scene.distance[p] = 1.0;
        }
      const MaskGuess guess = scene.guess({}, parameters);
      const Eigen::Vector2d at = scene.place(guess.sphere.center) - Eigen::Vector2d(10, 10);
      Eigen::Vector2d back = turn < 4 ? at : Eigen::Vector2d(-at.x(), at.y());
      for (int k = 0; k < turn % 4; ++k) back = Eigen::Vector2d(-back.y(), back.x());
      found.emplace_back(back.x(), back.y(), guess.sphere.radius * 60.0);
    }
    for (const Eigen::Vector3d& f : found) {
      INFO(f.transpose() << " and " << found[0].transpose());
      CHECK((f - found[0]).norm() < 1e-6);
    }
  }
}

TEST_CASE("a disc with a stalk is a large ball, unless one sees through it") {
  for (const int scale : {1, 2})  // of the larger disc every second pixel is looked at
    for (const auto& [du, dv] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      Scene scene;
      scene.intrinsics = {200 * scale, 200 * scale, kFocal * scale, kFocal * scale, 99.5 * scale, 99.5 * scale};
      scene.distance.assign(scene.intrinsics.size(), 0.0);
      scene.instances.assign(scene.intrinsics.size(), 0);
      scene.mask([&, du = du, dv = dv](int u, int v) {
        const int along = du * (u - 100 * scale) + dv * (v - 100 * scale),
                  aside = dv ? u - 100 * scale : v - 100 * scale;
        return std::hypot(along, aside) < 16.5 * scale || (along > 0 && along < 60 * scale && std::abs(aside) <= scale);
      });
      BodyParameters bodies;
      bodies.radius_max = 0.1;
      const auto size = [&](double wall) {
        Scene seen = scene;
        for (std::size_t i = 0; i < seen.distance.size(); ++i)
          if (!seen.instances[i]) seen.distance[i] = wall;
        return pixels(seen.guesses(bodies).at(0).sphere, seen);
      };
      // The large ball has a radius of some 38 pixels, so its center is 6.8 cm behind its front, that of the disc 2.8.
      CHECK(size(3.0) == Approx(16.5).margin(0.7));
      if (scale == 2) continue;
      CHECK(size(0.0) == Approx(38.0).margin(2.0));
      CHECK(size(1.045) == Approx(38.0).margin(2.0));
    }
}

}  // namespace mask_outline_test
