// SPDX-License-Identifier: BSD-3-Clause
// Simulated colors: fruit as ripe as the scene says, other objects in the colors of their class, depths untouched.
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/true_ripeness.hpp>

#include "catch.hpp"
#include "support/shapes.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace color_camera_test {

namespace {

const Pose kPose = look_along({0.0, 0.0, 0.2}, {0.0, 1.0, 0.0}, 0.0);

sensor::DepthCamera small_sensor() {
  sensor::DepthCamera sensor = sensor::l515();
  sensor.intrinsics = sensor::intrinsics_from_fov(256, 192, deg(40), deg(31));
  return sensor;
}

/// A fruit before the camera, a leaf to its left and a stem to its right.
Scene three_things(std::optional<double> ripeness) {
  Scene scene;
  scene.objects.push_back({1, ObjectClass::fruit, shapes::sphere({0.0, 0.4, 0.2}, 0.035, 60)});
  scene.objects.back().ripeness = ripeness;
  scene.objects.push_back({0, ObjectClass::leaf, shapes::sphere({-0.09, 0.4, 0.2}, 0.03, 40)});
  scene.objects.push_back({0, ObjectClass::stem, shapes::sphere({0.09, 0.4, 0.2}, 0.03, 40)});
  return scene;
}

Capture look(const TracedScene& traced, const ImageOptions& options, std::uint64_t seed = 3, std::uint64_t view = 0,
             int threads = 1) {
  Capture c = capture(traced, small_sensor(), kPose, parse_noise("l515"), seed, view, threads);
  add_images(c.frame, traced, small_sensor(), kPose, options, seed, view, threads);
  return c;
}

/// The hue angle (rad, CIELAB) of linear light.
double hue_of_light(const Eigen::Vector3d& light) {
  Rgb rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<std::uint8_t>(
        std::lround(255.0 * (1.055 * std::pow(light[static_cast<Eigen::Index>(c)], 1.0 / 2.4) - 0.055)));
  return hue_of(to_lab(rgb));
}

/// The colors of the pixels that see one object.
std::vector<Rgb> colors_of_object(const TracedScene& traced, const Capture& c, std::uint32_t object) {
  const RayImage rays = raycast(traced, c.frame.intrinsics, kPose, 0.0, 5.0);
  std::vector<Rgb> out;
  for (std::size_t i = 0; i < rays.triangle.size(); ++i)
    if (rays.triangle[i] != kNoHit && traced.object(rays.triangle[i]) == object) out.push_back(c.frame.color[i]);
  return out;
}

}  // namespace

TEST_CASE("the share of a fruit's surface that has turned is that of the scene") {
  for (const double share : {0.0, 0.05, 0.2, 0.45, 0.75, 0.95, 1.0}) {
    const TracedScene traced(three_things(share));
    double ripe = 0.0, all = 0.0;
    Rng rng(5);
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d p = Eigen::Vector3d(0.0, 0.4, 0.2) + 0.035 * rng.direction();
      ripe += hue_of_light(surface_color(traced.looks()[0], 0, p)) < deg(70);
      all += 1.0;
    }
    CHECK(ripe / all == Approx(share).margin(0.035));
  }
}

TEST_CASE("ripeness is found again in a color image") {
  for (const RipenessClass real : {RipenessClass::green, RipenessClass::turning, RipenessClass::pink,
                                   RipenessClass::light_red, RipenessClass::red}) {
    const TracedScene traced(three_things(middle_share(real)));
    const Capture c = look(traced, {true, {}, {}});
    const auto found = ripeness_of(colors_of_object(traced, c, 0), 0.5);
    REQUIRE(found);
    CHECK(found->grade == real);
  }
}

TEST_CASE("leaves and stems are green, a fruit of unknown ripeness is red, an object's own color wins") {
  Scene scene = three_things({});
  scene.objects[2].color = Rgb{30, 60, 220};
  const TracedScene traced(scene);
  const Capture c = look(traced, {true, {}, {}});
  const auto mean = [&](std::uint32_t object) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const auto colors = colors_of_object(traced, c, object);
    for (const Rgb& rgb : colors) sum += Eigen::Vector3d(rgb[0], rgb[1], rgb[2]);
    return Eigen::Vector3d(sum / static_cast<double>(colors.size()));
  };
  CHECK(mean(0).x() > 1.5 * mean(0).y());
  CHECK(mean(1).y() > 1.1 * mean(1).x());
  CHECK(mean(2).z() > 2.0 * mean(2).x());
}

TEST_CASE("images change no depth, and depend on seed and view alone") {
  const TracedScene traced(three_things(0.4));
  const Capture plain = capture(traced, small_sensor(), kPose, parse_noise("l515"), 3, 0);
  const ImageOptions all{true, detector_named("typical"), {}};
  const Capture c = look(traced, all), again = look(traced, all, 3, 0, 4), other = look(traced, all, 3, 1);
  CHECK(c.frame.depth == plain.frame.depth);
  CHECK(c.frame.color == again.frame.color);
  CHECK(c.frame.instances == again.frame.instances);
  CHECK_FALSE(c.frame.color == other.frame.color);
  CHECK(plain.frame.color.empty());
  CHECK_FALSE(plain.frame.detected);
}

TEST_CASE("classes of ripeness have names and shares") {
  for (const char* name : {"green", "breakers", "turning", "pink", "light_red", "red"}) {
    const auto named = ripeness_named(name);
    REQUIRE(named);
    CHECK(to_string(*named) == std::string(name));
    CHECK(class_of(middle_share(*named)) == *named);
  }
  CHECK_FALSE(ripeness_named("blue"));
}

TEST_CASE("the fruit of a truss ripen from the top") {
  double first = 0.0, last = 0.0;
  int classes[kRipenessClasses] = {};
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed);
    const auto shares = draw_ripeness(7, rng);
    REQUIRE(shares.size() == 7);
    first += shares.front() / 200;
    last += shares.back() / 200;
    for (const double s : shares) ++classes[static_cast<std::size_t>(class_of(s))];
  }
  CHECK(first > last + 0.2);
  for (const int count : classes) CHECK(count > 70);
}

TEST_CASE("ripeness is judged fruit by fruit") {
  GroundTruth truth;
  Metrics metrics;
  std::vector<Fruit> found;
  for (int id = 1; id <= 4; ++id) {
    TrueFruit real;
    real.id = id;
    real.ripeness = 0.45;  // pink
    truth.fruits.push_back(real);
    FruitMetrics m;
    m.id = id;
    m.instance = 10 + id;
    m.detected = id != 4;
    metrics.fruits.push_back(m);
    Fruit f;
    f.id = 10 + id;
    f.ripeness = Ripeness();
    f.ripeness->ripe_share = id == 2 ? 0.7 : 0.45;
    f.ripeness->grade = id == 2 ? RipenessClass::light_red : RipenessClass::pink;
    found.push_back(f);
  }
  const auto judged = judge_ripeness(truth, metrics, found);
  REQUIRE(judged.size() == 3);
  CHECK(judged[1].off() == 1);
  const RipenessSummary all = summarize(judged);
  CHECK(all.right == Approx(2.0 / 3.0));
  CHECK(all.adjacent == Approx(1.0 / 3.0));
  CHECK(all.share_error == Approx(0.25 / 3.0));
}

}  // namespace color_camera_test
