// SPDX-License-Identifier: BSD-3-Clause
// What a scan is given is checked when it is given, so that no later call fails because of it.
#include <agrisee/pipeline.hpp>

#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "pipeline/cell.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace input_checks_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Workcell cell() { return test::three_fruit_cell(); }

/// An arm that takes every view as it is asked for; its joints say nothing.
PipelineOptions own_arm() {
  PipelineOptions options;
  options.reach = [](const plan::ViewRequest& r, const Joints&) {
    plan::ReachableView view;
    view.target = r.target;
    view.world_T_optical = look_along(r.target - r.distance * r.direction, r.direction);
    return std::optional(view);
  };
  return options;
}

}  // namespace

TEST_CASE("a pose too far from the scan volume is refused when it is reported, and the scan goes on") {
  const bool own = GENERATE(false, true);
  const double off = GENERATE(21.0, 25.0, 650.0);
  const Workcell w = cell();
  Pipeline pipeline(w, {}, own ? own_arm() : PipelineOptions{});
  Joints joints = w.start;
  for (int v = 0; v < 3; ++v) {
    const auto next = pipeline.next_view(joints);
    REQUIRE(next);
    if (next->joints) joints = *next->joints;
    const auto frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical);
    if (v == 1) {
      const std::size_t merged = pipeline.merged().size();
      Pose glitch = next->world_T_optical;
      glitch.translation().x() += off;
      CHECK_THROWS_WITH(pipeline.observe(frame, glitch, next->joints),
                        test::says("observe: the sensor of view 1 stood") &&
                            test::says("from the scan volume: is its position in millimetres?"));
      CHECK_THROWS_AS(pipeline.observe(frame, glitch), InputError);
      CHECK(pipeline.views().size() == 1);
      CHECK(pipeline.merged().size() == merged);
      CHECK(pipeline.next_view(joints)->world_T_optical.matrix() == next->world_T_optical.matrix());
    }
    pipeline.observe(frame, next->world_T_optical, next->joints);
  }
  CHECK_FALSE(pipeline.result().fruits.empty());
}

TEST_CASE("a pose that was accepted does not make the result fail, wherever in the volume the points are") {
  const Workcell w = cell();
  Pipeline pipeline(w);
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  auto frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical);
  pipeline.observe(frame, next->world_T_optical);
  const double x = w.scan_volume.max.x() + 19.999;  // from the fruit it is more than 20 m
  pipeline.observe(frame, look_along({x, 0.5, 0.2}, Eigen::Vector3d::UnitY()));
  CHECK_NOTHROW(pipeline.result());
}

TEST_CASE("a scan volume that is empty, flat in any axis, or too far from the origin is refused") {
  const auto refuse = [](const std::string& message, auto&& change) {
    Workcell w = cell();
    change(w.scan_volume);
    CHECK_THROWS_WITH(Pipeline(w), test::says(message));
    CHECK_THROWS_WITH(Pipeline(w, {}, own_arm()), test::says(message));
  };
  const std::string empty = "the scan volume is empty, flat or infinite";
  refuse(empty, [](Aabb& v) { v = Aabb(); });
  refuse(empty, [](Aabb& v) { v.max = v.min; });
  refuse(empty, [](Aabb& v) { std::swap(v.min, v.max); });
  for (int a = 0; a < 3; ++a) {
    refuse(empty, [a](Aabb& v) { v.max[a] = v.min[a]; });
    refuse(empty, [a](Aabb& v) { v.max[a] = v.min[a] - 0.1; });
    refuse(empty, [a](Aabb& v) { v.min[a] = kNan; });
    refuse(empty, [a](Aabb& v) { v.max[a] = std::numeric_limits<double>::infinity(); });
    const auto moved = [a](double by) { return [a, by](Aabb& v) { v.min[a] += by, v.max[a] += by; }; };
    for (const double far : {-1500.0, 999.9, 1500.0, 5e5})
      refuse("from the origin, too far for coordinates in single precision: is it in millimetres?", moved(far));
    Workcell w = cell();
    moved(900.0)(w.scan_volume);
    CHECK_NOTHROW(Pipeline(w, {}, own_arm()));
  }
  refuse("the scan volume lies 1.5e+03 m from the origin", [](Aabb& v) { v.min.x() += 1500, v.max.x() += 1500; });
}

TEST_CASE("keep-out spaces and start joints are checked for an own arm, too") {
  const bool own = GENERATE(false, true);
  const auto made = [own](const Workcell& w) { Pipeline(w, {}, own ? own_arm() : PipelineOptions{}); };
  const auto refuse = [&](const KeepOut& space, const std::string& message) {
    Workcell w = cell();
    w.keep_out = {{"good", Box{{0, 2, 0}, {1, 1, 1}}}, space};
    CHECK_THROWS_AS(made(w), ParameterError);
    CHECK_THROWS_WITH(made(w), test::says(message));
  };
  refuse({"bad", Box{{0, 0, 0}, {-1, 1, 1}}}, "keep_out 'bad': size must be positive and finite, got -1");
  refuse({"bad", Box{{0, 0, 0}, {3, 3, 0}}}, "keep_out 'bad': size must be positive and finite, got 0");
  refuse({"bad", Box{{kNan, 0, 0}, {1, 1, 1}}}, "keep_out 'bad': center must be finite");
  refuse({"", Cylinder{{0, 0, 0}, 0, 1}}, "keep_out '': radius must be positive and finite, got 0");
  Workcell w = cell();
  w.start[2] = kNan;
  CHECK_THROWS_WITH(made(w), test::says("start: the joints are not finite"));
}

TEST_CASE("a gripper in millimetres is refused, and the likely cause is named") {
  const bool own = GENERATE(false, true);
  const auto made = [own](const Workcell& w, const Parameters& p = {}) {
    Pipeline(w, p, own ? own_arm() : PipelineOptions{});
  };
  Workcell w = cell();
  w.tool0_T_tool = pose_from_xyz_rpy({0.0, 0.0, 0.15}, {0.0, 0.0, 0.0});
  CHECK_NOTHROW(made(w));
  w.tool0_T_tool->translation() *= 1000.0;
  CHECK_THROWS_WITH(made(w), test::says("tool0_T_tool: the gripping point is 150 m from the flange: is it in mill"));
  const auto refused = [&](auto&& change, const std::string& message) {
    Parameters p;
    change(p.picking);
    CHECK_THROWS_AS(made(cell(), p), ParameterError);
    CHECK_THROWS_WITH(made(cell(), p), test::says(message));
  };
  refused([](auto& p) { p.stand_off = 120.0; },
          "picking.stand_off must be from 0 to 3, got 120: lengths are in metres");
  refused([](auto& p) { p.gripper_radius = 20.0; }, "picking.gripper_radius must be from 0 to 1, got 20: lengths are");
  refused([](auto& p) { p.tool_length = 150.0; }, "picking.tool_length must be from 0 to 3, got 150: lengths are in");
}

TEST_CASE("an own arm is asked only for distances in the camera's range, by every planner") {
  const std::string planner = GENERATE("gain", "see", "fixed", "random");
  Workcell w = cell();
  w.sensor.range_min = 0.45, w.sensor.range_max = 0.5;
  Parameters p;
  p.planner = planner;
  p.max_views = 3;
  p.gain.candidates = 100;
  PipelineOptions options = own_arm();
  int asked = 0;
  options.reach = [&, fly = options.reach](const plan::ViewRequest& r, const Joints& joints) {
    ++asked;
    CHECK(r.distance_min >= 0.45);
    CHECK(r.distance_max <= 0.5);
    CHECK((r.distance >= r.distance_min && r.distance <= r.distance_max));
    return fly(r, joints);
  };
  Pipeline pipeline(w, p, std::move(options));
  while (const auto next = pipeline.next_view(w.start))
    pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical),
                     next->world_T_optical);
  CHECK(asked > 0);
  CHECK_FALSE(pipeline.views().empty());
}

TEST_CASE("answers of an own approach are checked, and what it throws leaves the scan as it was") {
  const Workcell w = cell();
  PipelineOptions options = own_arm();
  enum class Answer { right, elsewhere, none } kind = Answer::elsewhere;
  options.approach = [&](const pick::ApproachRequest& r, const Joints&) -> pick::ApproachAnswer {
    if (kind == Answer::none) throw std::runtime_error("no answer");
    const Pose pose = kind == Answer::right ? look_along(r.start, r.direction) : Pose::Identity();
    return {pick::ReachableApproach{pose, std::nullopt}, PickingReason::reachable};
  };
  Pipeline pipeline(w, {}, std::move(options));
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), next->world_T_optical);
  CHECK_THROWS_WITH(pipeline.result(), test::says("approach: the origin of world_T_pre_grasp of its answer is"));
  kind = Answer::none;
  CHECK_THROWS_WITH(pipeline.result(), "no answer");
  kind = Answer::right;
  const ScanResult result = pipeline.result();
  REQUIRE_FALSE(result.fruits.empty());
  for (const Fruit& f : result.fruits) CHECK(f.picking->reachable);
  CHECK(pipeline.next_view(w.start));
}

TEST_CASE("a scan without a view says that none was taken") {
  CHECK_THAT(why_no_fruit(Pipeline(cell()).result()), test::says("no view was taken"));
  PipelineOptions options;
  options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };
  Pipeline pipeline(cell(), {}, std::move(options));
  CHECK_FALSE(pipeline.next_view(cell().start));
  CHECK_THAT(why_no_fruit(pipeline.result()), test::says("no view was taken: the arm can reach no view"));
}

TEST_CASE("what an own reach throws comes out of next_view, from its thread, and the scan goes on as without it") {
  const std::string planner = GENERATE("gain", "see", "fixed", "random");
  Parameters p = Parameters::named(planner == "see" ? "see" : "default");
  p.planner = planner;
  p.max_views = 3;
  p.gain.candidates = 100;
  // The poses of a scan with an arm that fails every now and then, and how often it was told.
  const auto scan = [&](int period, int& told) {
    PipelineOptions options = own_arm();
    options.threads = 3;
    int asked = 0;
    options.reach = [&, fly = options.reach, caller = std::this_thread::get_id()](const plan::ViewRequest& r,
                                                                                  const Joints& joints) {
      CHECK(std::this_thread::get_id() == caller);
      if (++asked == period) {
        period = 2 * period + 1;
        throw std::runtime_error("no answer");
      }
      return r.direction.y() > 0.3 ? fly(r, joints) : std::nullopt;
    };
    Pipeline pipeline(cell(), p, std::move(options));
    std::vector<Pose> poses;
    for (;;) {
      std::optional<plan::ReachableView> next;
      try {
        next = pipeline.next_view(cell().start);
      } catch (const std::runtime_error& e) {
        CHECK(std::string(e.what()) == "no answer");
        ++told;
        continue;
      }
      if (!next) return poses;
      poses.push_back(next->world_T_optical);
      pipeline.observe(test::render(test::kThreeFruit, cell().sensor.intrinsics, poses.back()), poses.back());
    }
  };
  int told = 0;
  const std::vector<Pose> expected = scan(-1, told);
  CHECK(told == 0);
  CHECK(expected.size() == 3);
  const std::vector<Pose> poses = scan(1, told);
  CHECK(told > 1);
  REQUIRE(poses.size() == expected.size());
  for (std::size_t i = 0; i < poses.size(); ++i) CHECK(poses[i].matrix() == expected[i].matrix());
}

}  // namespace input_checks_test
