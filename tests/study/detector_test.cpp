// SPDX-License-Identifier: BSD-3-Clause
// The simulated detector errs as often, and as far, as its parameters say.
#include <agrisee/study/detector.hpp>

#include <set>

#include "catch.hpp"
#include "support/shapes.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace detector_test {

namespace {

const Pose kPose = look_along({0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0);
const sensor::Intrinsics kCamera = sensor::intrinsics_from_fov(320, 240, deg(50), deg(39));

/// Twelve fruit apart from one another before a wall of leaf.
Scene a_dozen() {
  Scene scene;
  for (int i = 0; i < 12; ++i)
    scene.objects.push_back(
        {i + 1, ObjectClass::fruit, shapes::sphere({-0.12 + 0.08 * (i % 4), 0.5, -0.09 + 0.09 * (i / 4)}, 0.025, 30)});
  scene.objects.push_back({0, ObjectClass::leaf, shapes::rectangle({-1, 0.6, -1}, {2, 0, 0}, {0, 0, 2})});
  return scene;
}

/// What a camera and a detector see of a scene.
struct Eye {
  explicit Eye(const Scene& scene) : traced(scene), rays(raycast(traced, kCamera, kPose, 0.0, 5.0)) {}

  sensor::DepthFrame look(const DetectorParameters& p, std::uint64_t view, std::uint64_t seed = 1) const {
    sensor::DepthFrame frame;
    frame.intrinsics = kCamera;
    frame.depth.assign(kCamera.size(), 0.5f);
    detect(frame, traced, rays, kPose, p, seed, view);
    check(frame);
    return frame;
  }
  /// The fruit (its id) or 0 at each pixel.
  std::vector<int> truth() const {
    std::vector<int> out;
    for (const std::uint32_t t : rays.triangle) out.push_back(t == kNoHit ? 0 : traced.looks()[traced.object(t)].id);
    return out;
  }

  TracedScene traced;
  RayImage rays;
};

std::size_t pixels(const sensor::DepthFrame& frame) {
  return static_cast<std::size_t>(
      std::count_if(frame.instances.begin(), frame.instances.end(), [](std::uint16_t i) { return i != 0; }));
}

}  // namespace

TEST_CASE("a perfect detector gives each fruit its pixels") {
  const Eye eye(a_dozen());
  const sensor::DepthFrame frame = eye.look(detector_named("perfect"), 0);
  const std::vector<int> truth = eye.truth();
  REQUIRE(frame.detected);
  REQUIRE(frame.detections.size() == 12);
  std::set<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    REQUIRE((frame.instances[i] != 0) == (truth[i] != 0));
    if (truth[i]) pairs.insert({truth[i], frame.instances[i]});
  }
  CHECK(pairs.size() == 12);
  for (const sensor::Detection& d : frame.detections) CHECK(d.score == 1.0);
}

TEST_CASE("fruit are missed at the rate stated, those half hidden more often") {
  Scene scene = a_dozen();
  const Eye open(scene);
  scene.objects.push_back({0, ObjectClass::leaf, shapes::rectangle({-1, 0.45, -0.085}, {2, 0, 0}, {0, 0, 0.02})});
  scene.objects.push_back({0, ObjectClass::leaf, shapes::rectangle({-1, 0.45, -0.005}, {2, 0, 0}, {0, 0, 0.02})});
  scene.objects.push_back({0, ObjectClass::leaf, shapes::rectangle({-1, 0.45, 0.075}, {2, 0, 0}, {0, 0, 0.02})});
  const Eye covered(scene);
  DetectorParameters p;
  p.miss = 0.2;
  p.miss_hidden = 0.8;
  double all = 0.0, half = 0.0;
  constexpr int kViews = 100;
  for (int view = 0; view < kViews; ++view) {
    all += static_cast<double>(open.look(p, static_cast<std::uint64_t>(view)).detections.size());
    half += static_cast<double>(covered.look(p, static_cast<std::uint64_t>(view)).detections.size());
  }
  CHECK(1.0 - all / (12.0 * kViews) == Approx(0.2).margin(0.05));
  const double missed = 1.0 - half / (12.0 * kViews);
  CHECK(missed > 0.3);
  CHECK(missed < 0.7);
}

TEST_CASE("misses that are alike are the same fruit in all views") {
  const Eye eye(a_dozen());
  DetectorParameters p;
  p.miss = p.miss_hidden = 0.4;
  p.alike = 1.0;
  const auto first = eye.look(p, 0).instances;
  for (std::uint64_t view = 1; view < 5; ++view) CHECK(eye.look(p, view).instances == first);
  CHECK_FALSE(eye.look(p, 0, 2).instances == first);
}

TEST_CASE("false masks lie on what is no fruit, as many as stated, with their own scores") {
  const Eye eye(a_dozen());
  DetectorParameters p;
  p.inventions = 2.0;
  p.false_score = 0.4;
  p.score_spread = 0.05;
  const std::vector<int> truth = eye.truth();
  double count = 0.0;
  constexpr int kViews = 60;
  for (int view = 0; view < kViews; ++view) {
    const sensor::DepthFrame frame = eye.look(p, static_cast<std::uint64_t>(view));
    for (const sensor::Detection& d : frame.detections)
      if (d.score < 0.7) count += 1.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      if (truth[i] == 0 && frame.instances[i] != 0)
        REQUIRE(frame.detections[frame.instances[i] - std::size_t{1}].score < 0.7);
  }
  CHECK(count / kViews == Approx(2.0 * 12 / 10).margin(0.5));
}

TEST_CASE("masks that touch merge at the rate stated") {
  Scene scene;
  scene.objects.push_back({1, ObjectClass::fruit, shapes::sphere({-0.028, 0.5, 0.0}, 0.03, 40)});
  scene.objects.push_back({2, ObjectClass::fruit, shapes::sphere({0.028, 0.5, 0.0}, 0.03, 40)});
  const Eye eye(scene);
  DetectorParameters p;
  p.merge = 0.3;
  int merged = 0;
  for (std::uint64_t view = 0; view < 200; ++view) merged += eye.look(p, view).detections.size() == 1;
  CHECK(merged / 200.0 == Approx(0.3).margin(0.09));
}

TEST_CASE("edges are off as far as stated") {
  const Eye eye(a_dozen());
  const double full = static_cast<double>(pixels(eye.look({}, 0)));
  DetectorParameters p;
  p.erosion = 2.0;
  const double radius = std::sqrt(full / 12.0 / kPi);
  CHECK(static_cast<double>(pixels(eye.look(p, 0))) / full == Approx(std::pow(1.0 - 2.0 / radius, 2)).margin(0.06));
  p.erosion = -2.0;
  CHECK(static_cast<double>(pixels(eye.look(p, 0))) / full == Approx(std::pow(1.0 + 2.0 / radius, 2)).margin(0.08));
  p.erosion = 0.0;
  p.shift = 3.0;
  const std::vector<int> truth = eye.truth();
  double across = 0.0;
  int masks = 0;
  for (std::uint64_t view = 0; view < 20; ++view) {
    const sensor::DepthFrame frame = eye.look(p, view);
    double sum[13][3] = {}, found[13][3] = {};
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double u = static_cast<double>(i % 320);
      if (truth[i]) sum[truth[i]][0] += u, sum[truth[i]][2] += 1.0;
      if (frame.instances[i]) found[frame.instances[i]][0] += u, found[frame.instances[i]][2] += 1.0;
    }
    for (int f = 1; f <= 12; ++f) {  // without other errors the masks are numbered as the fruit
      across += std::pow(found[f][0] / found[f][2] - sum[f][0] / sum[f][2], 2);
      ++masks;
    }
  }
  CHECK(std::sqrt(across / masks) == Approx(3.0).margin(0.8));
}

TEST_CASE("detectors have names, and their parameters limits") {
  CHECK_THROWS_AS(detector_named("yolo"), FieldError);
  CHECK(detector_named("typical").miss < detector_named("poor").miss);
  const Eye eye(a_dozen());
  DetectorParameters p;
  p.miss = 2.0;
  CHECK_THROWS_AS(eye.look(p, 0), ParameterError);
}

}  // namespace detector_test
