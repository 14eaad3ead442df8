// SPDX-License-Identifier: BSD-3-Clause
// Masks and colors from a frame to fruit.
#include <agrisee/pipeline.hpp>
#include <agrisee/process.hpp>
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/study/truss.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include "catch.hpp"

using namespace agrisee;

namespace {

constexpr Rgb kRed{200, 40, 30}, kGreen{60, 140, 50};

/// A red ball of 35 mm radius, 1 m before the camera and 0.6 m before a green wall, with a mask. A leaf, 6 cm before
/// the ball, hides the columns from `hidden_from` on.
sensor::DepthFrame ball_frame(int hidden_from) {
  const Eigen::Vector3d center(0.0, 0.0, 1.0);
  constexpr double kRadius = 0.035;
  sensor::DepthFrame f;
  f.intrinsics = {240, 200, 700.0, 700.0, 119.5, 99.5};
  f.detected = true;
  for (int v = 0; v < 200; ++v)
    for (int u = 0; u < 240; ++u) {
      const Eigen::Vector3d d = f.intrinsics.ray(u, v);
      const double t = center.dot(d) / d.squaredNorm();
      const double inside = kRadius * kRadius - (center - t * d).squaredNorm();
      double z = 1.6 + 0.001 * ((u * 7 + v * 13) % 5);
      bool ball = inside > 0.0;
      if (ball) z = t - std::sqrt(inside / d.squaredNorm());
      if (u >= hidden_from) z = 0.9 + 0.0004 * (u - hidden_from), ball = false;
      f.depth.push_back(static_cast<float>(z));
      f.instances.push_back(ball ? 1 : 0);
      f.color.push_back(ball ? kRed : kGreen);
    }
  return f;
}

/// Process a frame as a cloud from one viewpoint.
ScanResult processed(const sensor::DepthFrame& frame, Parameters parameters = {}) {
  Cloud cloud;
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) cloud.points.push_back(frame.point(u, v));
  parameters.expect_radii(0.02, 0.06);
  CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d::Zero();
  origin.trust_viewpoint = true;
  if (frame.detected || !frame.color.empty()) origin.detected.push_back({frame, Pose::Identity()});
  return process(cloud, parameters, origin);
}

}  // namespace

TEST_CASE("a mask finds the fruit of which a leaf leaves a sliver") {
  sensor::DepthFrame frame = ball_frame(110);  // 9 pixels left of the middle of a ball of 25 pixels radius
  const ScanResult with = processed(frame);
  REQUIRE(with.fruits.size() == 1);
  const Fruit& fruit = with.fruits.front();
  CHECK(fruit.found_by == "mask");
  CHECK(fruit.body->radii.mean() == Approx(0.035).margin(0.003));
  CHECK((fruit.body->center - Eigen::Vector3d(0, 0, 1)).norm() < 0.006);
  CHECK(fruit.body->confidence > 0.5);
}

TEST_CASE("colors give ripeness, without a detector, too") {
  sensor::DepthFrame frame = ball_frame(240);
  frame.detected = false;
  frame.instances.clear();
  const ScanResult result = processed(frame);
  REQUIRE(result.fruits.size() == 1);
  CHECK(result.fruits.front().found_by != "mask");
  REQUIRE(result.fruits.front().ripeness);
  CHECK(result.fruits.front().ripeness->grade == RipenessClass::red);
  REQUIRE(result.trusses.front().ripeness);
  CHECK(result.trusses.front().ripeness->grade == RipenessClass::red);
}

TEST_CASE("without masks and colors nothing of them is in a result") {
  sensor::DepthFrame frame = ball_frame(240);
  frame.detected = false;
  frame.color.clear();
  const ScanResult result = processed(frame);
  CHECK(result.cloud.colors.empty());
  CHECK(result.cloud.instances.empty());
  for (const Fruit& f : result.fruits) CHECK_FALSE(f.ripeness);
}

TEST_CASE("a pipeline takes masks and colors with its frames") {
  Workcell workcell;
  workcell.scan_volume = Aabb{{-0.15, -0.15, 0.8}, {0.15, 0.15, 1.3}};
  Parameters parameters;
  parameters.expect_radii(0.02, 0.06);
  PipelineOptions options;
  options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };
  Pipeline pipeline(workcell, parameters, std::move(options));
  pipeline.observe(ball_frame(110), Pose::Identity());
  const ScanResult result = pipeline.result();
  REQUIRE(result.fruits.size() == 1);
  CHECK(result.fruits.front().found_by == "mask");
  CHECK(result.fruits.front().body->radii.mean() == Approx(0.035).margin(0.003));
  REQUIRE(result.fruits.front().ripeness);
  CHECK(result.fruits.front().ripeness->grade == RipenessClass::red);
  options = {};
  options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };
  Pipeline gray(workcell, parameters, std::move(options));
  sensor::DepthFrame frame = ball_frame(110);
  frame.color.assign(frame.color.size(), {90, 90, 90});
  gray.observe(frame, Pose::Identity());
  const std::vector<std::string> told = gray.result().warnings;
  REQUIRE(told.size() == result.warnings.size() + 1);
  CHECK(told.back().find("is gray or black") != std::string::npos);
}

TEST_CASE("frames may be shared, and are not copied") {
  Workcell workcell;
  workcell.scan_volume = Aabb{{-0.15, -0.15, 0.8}, {0.15, 0.15, 1.3}};
  PipelineOptions options;
  options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };
  Pipeline pipeline(workcell, {}, std::move(options));
  const auto frame = std::make_shared<const sensor::DepthFrame>(ball_frame(110));
  pipeline.observe(frame, Pose::Identity());
  CHECK(frame.use_count() > 1);
  CHECK_THROWS_AS(pipeline.observe(std::shared_ptr<const sensor::DepthFrame>(), Pose::Identity()), InputError);
  sensor::DepthFrame broken = ball_frame(120);
  broken.detections = {{1, 2.0, true, "fruit", std::nullopt}};
  CHECK_THROWS_AS(pipeline.observe(broken, Pose::Identity()), InputError);
  CHECK(pipeline.views().size() == 1);
}

TEST_CASE("colors alone propose the fruit of which a leaf leaves a sliver, if they are asked") {
  sensor::DepthFrame frame = ball_frame(108);
  frame.detected = false;
  frame.instances.clear();
  for (const Fruit& f : processed(frame).fruits) CHECK(f.found_by != "mask");
  Parameters parameters;
  parameters.color_prior.enabled = true;
  const ScanResult with = processed(frame, parameters);
  REQUIRE(with.fruits.size() == 1);
  CHECK(with.fruits.front().found_by == "mask");
  CHECK(with.fruits.front().body->radii.mean() == Approx(0.035).margin(0.004));
}

TEST_CASE("masks reach a simulated scan, and its planner") {
  // Four fruit with a detector without errors: none is missed or invented, and the fruit have a ripeness.
  study::TrussParameters truss;
  truss.total = 4;
  truss.hidden = 0;
  const study::Truss scene = study::make_truss(truss);
  const study::TracedScene traced(scene.scene);
  Workcell cell = scene.workcell;
  cell.sensor.intrinsics = sensor::intrinsics_from_fov(320, 240, deg(70), deg(55));
  study::SimulationOptions options;
  options.images = {true, study::detector_named("perfect"), {}};
  bool told = false;
  options.on_view = [&](const Pipeline& p) { told |= p.masks().log_odds != nullptr; };
  Parameters parameters;
  parameters.max_views = 4;
  const ScanResult result = study::scan(cell, traced, parameters, std::move(options));
  CHECK(told);
  CHECK(result.fruits.size() == 4);
  for (const Fruit& f : result.fruits) {
    CHECK(f.ripeness);
    CHECK(f.body->confidence > 0.5);
  }
}

TEST_CASE("colors that are asked for and missing, gray, or of swapped channels are told of") {
  const auto tells = [](const sensor::DepthFrame& frame, const char* what, const Parameters& parameters = {}) {
    const ScanResult result = processed(frame, parameters);
    CHECK(result.fruits.size() == 1);
    const auto says = [&](const std::string& text) { return text.find(what) != std::string::npos; };
    return std::count_if(result.warnings.begin(), result.warnings.end(), says) == 1;
  };
  const sensor::DepthFrame frame = ball_frame(240);
  CHECK_FALSE(tells(frame, "gray"));
  CHECK_FALSE(tells(frame, "swapped"));
  Parameters colors;
  colors.color_prior.enabled = true;
  CHECK_FALSE(tells(frame, "color_prior.enabled is true, but", colors));
  sensor::DepthFrame changed = frame;
  for (Rgb& c : changed.color) std::swap(c[0], c[2]);
  CHECK(tells(changed, "are red and blue swapped"));
  for (Rgb& c : changed.color) c = {c[1], c[1], static_cast<std::uint8_t>(c[1] + 4)};
  CHECK(tells(changed, "is gray or black"));
  changed.color.assign(changed.color.size(), {0, 0, 0});
  CHECK(tells(changed, "is gray or black"));
  changed.color.clear();
  CHECK_FALSE(tells(changed, "gray"));
  CHECK(tells(changed, "color_prior.enabled is true, but no view has a color image", colors));
}
