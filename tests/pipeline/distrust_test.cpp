// SPDX-License-Identifier: BSD-3-Clause
// Views whose pose or frame is wrong are not believed.
#include <agrisee/cloud/volume.hpp>
#include <agrisee/pipeline.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "catch.hpp"
#include "pipeline/cell.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

Workcell cell() { return test::three_fruit_cell(); }

/// A pose at this distance from the target (m), looking at it.
Pose looking_at(const Eigen::Vector3d& target, const Eigen::Vector3d& direction, double distance) {
  Pose pose = Pose::Identity();
  const Eigen::Vector3d z = direction.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = target - distance * z;
  return pose;
}

/// The pose of view `v` of some around the fruit.
Pose pose_around(int v, int views) {
  const double angle = deg(-70.0 + 140.0 * v / (views - 1));
  return looking_at({0.01, 0.55, 0.2}, {std::sin(angle), std::cos(angle), 0.1 * (v % 3 - 1)}, 0.38);
}

/// What the workcell's camera sees of the fruit.
sensor::DepthFrame frame_at(const Pose& pose, int v) {
  return test::render(test::kThreeFruit, cell().sensor.intrinsics, pose, 0.001, static_cast<std::uint64_t>(v + 1));
}

/// Views around the fruit; `wrong` are reported this far off. Returns what the pipeline makes of them.
ScanResult look_around(int views, const std::set<int>& wrong, const Eigen::Vector3d& off, int frozen = -1) {
  const Workcell w = cell();
  Pipeline pipeline(w);
  sensor::DepthFrame last;
  for (int v = 0; v < views; ++v) {
    Pose pose = pose_around(v, views);
    sensor::DepthFrame frame = frame_at(pose, v);
    if (v == frozen) frame = last;
    last = frame;
    if (wrong.count(v)) pose.translation() += off;
    pipeline.observe(frame, pose);
  }
  return pipeline.result();
}

/// All warnings of a scan of some views, each changed before it is observed.
template <typename Change>
std::string warnings_after(int views, Change&& change) {
  Pipeline pipeline(cell());
  for (int v = 0; v < views; ++v) {
    Pose pose = pose_around(v, std::max(views, 2));
    sensor::DepthFrame frame = frame_at(pose, v);
    change(frame, pose);
    pipeline.observe(std::move(frame), pose);
  }
  std::string all;
  for (const std::string& w : pipeline.result().warnings) all += w + "\n";
  return all;
}

std::set<int> discarded(const ScanResult& result) {
  std::set<int> out;
  for (std::size_t v = 0; v < result.views.size(); ++v)
    if (result.views[v].discarded) out.insert(static_cast<int>(v));
  return out;
}

void check_found(const ScanResult& result) {
  REQUIRE(result.fruits.size() == test::kThreeFruit.size());
  for (const Sphere& s : test::kThreeFruit) {
    double best = 1.0;
    for (const Fruit& f : result.fruits)
      if (f.body) best = std::min(best, (f.body->center - s.center).norm());
    CHECK(best < 0.002);
  }
}

}  // namespace

TEST_CASE("views that are right are believed") {
  const ScanResult result = look_around(8, {}, Eigen::Vector3d::Zero());
  CHECK(discarded(result).empty());
  CHECK(discarded_views(result.views).empty());
  CHECK(result.warnings.empty());
}

TEST_CASE("a view whose reported pose is 50 mm off is discarded, in whatever direction") {
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1),
        Eigen::Vector3d(-0.6, 0.0, -0.8)}) {
    INFO(direction.transpose());
    const ScanResult result = look_around(8, {3, 6}, 0.05 * direction);
    CHECK(discarded(result) == std::set<int>{3, 6});
    for (const View& v : result.views)
      CHECK(v.discard_reason == (v.discarded ? DiscardReason::contradicts_others : DiscardReason::none));
    CHECK(discarded_views(result.views) ==
          "2 of 8 views were discarded: views 3, 6 contradict the others (are their poses wrong?)");
    for (const int v : result.raw.views) CHECK((v != 3 && v != 6));
    check_found(result);
  }
}

TEST_CASE("where many views contradict the others, what all of them share is doubted") {
  const auto told = [](std::size_t wrong) {
    std::vector<View> views(12);
    for (std::size_t v = 0; v < wrong; ++v) {
      views[v].discarded = true;
      views[v].discard_reason = DiscardReason::contradicts_others;
    }
    return discarded_views(views);
  };
  CHECK_THAT(told(3), test::says("views 0, 1, 2 contradict the others (are their poses wrong?)"));
  CHECK_THAT(told(4), test::says("4 of 12 views were discarded: views 0, 1, 2, 3 contradict the others (is each pose "
                                 "that of its image"));
}

TEST_CASE("of views that contradict one another the more are believed, even when the first is wrong") {
  const ScanResult result = look_around(8, {0}, {0.04, 0.0, 0.03});
  CHECK(discarded(result) == std::set<int>{0});
  check_found(result);
}

TEST_CASE("a frame that comes again is discarded") {
  const ScanResult result = look_around(8, {}, Eigen::Vector3d::Zero(), 4);
  CHECK(discarded(result) == std::set<int>{4});
  CHECK(result.views[4].discard_reason == DiscardReason::repeated_frame);
  CHECK(discarded_views(result.views) ==
        "1 of 8 views was discarded: view 4 repeats the frame before (is the camera frozen?)");
  check_found(result);
}

TEST_CASE("a camera that hangs ends the scan") {
  Pipeline pipeline(cell());
  const Pose pose = pose_around(0, 2);
  const sensor::DepthFrame frame = frame_at(pose, 0);
  for (int v = 0; v <= Pipeline::kMostRepeats; ++v) {
    REQUIRE(pipeline.next_view(pipeline.workcell().start));
    pipeline.observe(frame, pose);
  }
  CHECK_FALSE(pipeline.next_view(pipeline.workcell().start));
  CHECK(pipeline.stop_reason() == StopReason::camera_hangs);
  CHECK(to_string(pipeline.stop_reason()) == std::string("camera_hangs"));
  pipeline.observe(frame_at(pose, 1), pose);  // it works again
  CHECK(pipeline.next_view(pipeline.workcell().start));
}

TEST_CASE("where many views contradict the others, a warning says so, with the mistake if it is known") {
  int v = 0;
  const auto two_of_four = [&](sensor::DepthFrame&, Pose& pose) {
    if (v++ % 3 == 1) pose.translation() += Eigen::Vector3d(0.05, 0.0, 0.0);
  };
  CHECK_THAT(warnings_after(6, two_of_four),
             test::says("2 of 6 views contradict the others, so the places of the fruit may be wrong, too"));
  const auto inverted = [](sensor::DepthFrame&, Pose& pose) { pose = pose.inverse(); };
  CHECK_THAT(warnings_after(6, inverted), test::says("it seems that the poses are inverted"));
}

TEST_CASE("frames of another camera than the workcell's, and unusual intrinsics, are told") {
  const auto longer = [](sensor::DepthFrame& frame, Pose&) { frame.intrinsics.fx *= 1.1; };
  CHECK_THAT(warnings_after(2, longer), test::says("view 0: the frame has 400 x 300 pixels with a focal length of"));
  CHECK_THAT(warnings_after(2, longer), test::says("(so in 2 views)"));
  const auto transposed = [](sensor::DepthFrame& frame, Pose&) {
    std::swap(frame.intrinsics.width, frame.intrinsics.height);
  };
  CHECK_THAT(warnings_after(1, transposed), test::says("is the image transposed?"));
  const auto calibrated = [](sensor::DepthFrame& frame, Pose&) { frame.intrinsics.fx *= 1.005; };
  CHECK(warnings_after(2, calibrated).empty());
}

TEST_CASE("a wrong scale of the depths, and a hand-eye transform that is left out, are told") {
  CHECK(warnings_after(8, [](sensor::DepthFrame&, Pose&) {}).empty());
  const std::string scale = warnings_after(8, [](sensor::DepthFrame& frame, Pose&) {
    for (float& z : frame.depth) z *= 0.96f;
  });
  CHECK_THAT(scale, test::says("the views show the surface of the fruit"));
  CHECK_THAT(scale, test::says("all depths were multiplied by 1.04 (is the depth scale right?)"));
  const std::string aside =
      warnings_after(8, [](sensor::DepthFrame&, Pose& pose) { pose.translate(Eigen::Vector3d(0.008, 0.0, 0.0)); });
  CHECK_THAT(aside, test::says("if the camera were 8 mm further left in its own frame"));
}

TEST_CASE("fruit that reach out of the scan volume are named") {
  const auto told = [](double right) {
    Workcell w = cell();
    w.scan_volume.max.x() = right;
    Pipeline pipeline(w);
    for (int v = 0; v < 4; ++v) pipeline.observe(frame_at(pose_around(v, 4), v), pose_around(v, 4));
    std::string all;
    for (const std::string& warning : pipeline.result().warnings) all += warning + "\n";
    return all;
  };
  double right = 0.0;
  for (const auto& fruit : test::kThreeFruit) right = std::max(right, fruit.center.x() + fruit.radius);
  CHECK(told(right + 0.01).empty());
  CHECK_THAT(told(right - 0.02), test::says("reaches out of the scan volume, where nothing is measured"));
}

TEST_CASE("where views alone show fruit that all together do not, a warning doubts poses and calibration") {
  const auto after = [](double ahead) {
    return warnings_after(8,
                          [&](sensor::DepthFrame&, Pose& pose) { pose.translate(Eigen::Vector3d(0.0, 0.0, ahead)); });
  };
  CHECK_THAT(after(0.02), !test::says("alone shows"));  // the fruit are found, and tell what is wrong
  const std::string far = after(0.03);
  CHECK_THAT(far,
             test::says("view 0 alone shows 3 fruit and view 2 alone shows 3 fruit, but all views together show 0"));
  CHECK_THAT(far, test::says("Are the hand-eye transform and the depth scale right?"));
  // A place where nothing is seen is no reason for doubt.
  const auto nothing_seen = [](sensor::DepthFrame& frame, Pose&) {
    std::fill(frame.depth.begin(), frame.depth.end(), 0.0f);
  };
  CHECK_THAT(warnings_after(8, nothing_seen), !test::says("alone shows"));
}

TEST_CASE("a wrong scale of the depths counts as an error of the fruit") {
  const auto scanned = [](float scale) {
    Pipeline pipeline(cell());
    for (int v = 0; v < 8; ++v) {
      sensor::DepthFrame frame = frame_at(pose_around(v, 8), v);
      for (float& z : frame.depth) z *= scale;
      pipeline.observe(std::move(frame), pose_around(v, 8));
    }
    return pipeline.result();
  };
  for (const auto& [scale, told] : {std::pair{1.0f, false}, {1.04f, true}}) {
    const ScanResult result = scanned(scale);
    CHECK(result.warnings.empty() != told);
    REQUIRE(!result.fruits.empty());
    for (const Fruit& f : result.fruits) {
      REQUIRE(f.body);
      double off = 1.0, size = 0.0;
      for (const Sphere& s : test::kThreeFruit) {
        const double distance = (f.body->center - s.center).norm();
        if (distance < off) off = distance, size = volume(Ellipsoid(s));
      }
      const double stated = std::sqrt(f.body->center_covariance.trace());
      CHECK(off < 3.0 * stated);
      CHECK(std::abs(f.body->volume - size) < 3.0 * f.body->volume_error);
      CHECK(f.body->mass_error >= f.body->mass * f.body->volume_error / f.body->volume);
      CHECK((stated > 0.005) == told);
      CHECK((f.body->volume_error > 0.2 * f.body->volume) == told);
    }
  }
}

TEST_CASE("a plant that moved during the scan is told, and counts as an error of its fruit") {
  const ScanResult still = look_around(8, {}, Eigen::Vector3d::Zero());
  CHECK(still.warnings.empty());
  const ScanResult moved = look_around(8, {4, 5, 6, 7}, {0.006, 0.0, 0.0});
  REQUIRE(moved.warnings.size() == 1);
  CHECK_THAT(moved.warnings[0], test::says("if the plant had moved by") && test::says("between views 3 and 4"));
  REQUIRE(moved.fruits.size() == still.fruits.size());
  for (std::size_t f = 0; f < moved.fruits.size(); ++f) {
    const Body &now = *moved.fruits[f].body, &before = *still.fruits[f].body;
    CHECK(std::sqrt(now.center_covariance(0, 0)) > 0.0055);
    CHECK(std::sqrt(before.center_covariance(0, 0)) < 0.001);
    CHECK(now.volume_error / now.volume > 0.1);
    CHECK(now.mass_error / now.mass > 0.1);
  }
}

TEST_CASE("views that look beside the scan volume are told") {
  int view = 0;
  const std::string told = warnings_after(9, [&](sensor::DepthFrame&, Pose& pose) {
    if (view++ % 3 == 0) pose.linear() = pose.linear() * Eigen::DiagonalMatrix<double, 3>(-1.0, 1.0, -1.0);
  });
  CHECK_THAT(told, test::says("3 of 9 views show nothing of the scan volume (0,3,6): are their poses right?"));
}

TEST_CASE("a mask of the background is told, a depth image as masks is refused") {
  const auto as_masks = [](auto&& value) {
    return [value](sensor::DepthFrame& frame, Pose&) {
      frame.detected = true;
      for (const float z : frame.depth) frame.instances.push_back(static_cast<std::uint16_t>(value(z)));
    };
  };
  CHECK_THAT(warnings_after(1, as_masks([](float) { return 1; })),
             test::says("view 0: instance 1 of the masks covers 100 % of the image: is it the background?"));
  CHECK_THROWS_WITH(warnings_after(1, as_masks([](float z) { return z > 0.0f ? std::lround(1e4f * z) : 0; })),
                    test::says("observe: the array `instances` of view 0 holds") && test::says("a depth image?"));
}

TEST_CASE("a workcell in millimetres is refused, or told") {
  Workcell far = cell();
  far.tool0_T_optical.translation() = Eigen::Vector3d(30.0, 0.0, 50.0);
  CHECK_THROWS_WITH(Pipeline(far), test::says("tool0_T_optical: the camera is 58.3 m from the flange: is it in mill"));
  Workcell ranges = cell();
  ranges.sensor.range_min = 100.0, ranges.sensor.range_max = 800.0;
  CHECK_THROWS_WITH(Pipeline(ranges), test::says("sensor.range_min must be 10 m or less (is it in millimetres?)"));
  ranges.sensor.range_min = 0.6, ranges.sensor.range_max = 4.0;
  const auto told = Pipeline(ranges).warnings();
  REQUIRE(told.size() == 1);
  CHECK_THAT(told[0], test::says("measures from 0.6 m to 4 m, but views are taken from 0.27 m to 0.55 m"));
  Workcell away = cell();
  away.scan_volume.min.x() += 3.0, away.scan_volume.max.x() += 3.0;
  Pipeline pipeline(away);
  CHECK_FALSE(pipeline.next_view(away.start));
  CHECK_THAT(why_no_fruit(pipeline.result()), test::says("no view was taken: the arm can reach no view"));
}

TEST_CASE("answers of an own reach are checked") {
  const auto asked = [](const std::function<void(plan::ReachableView&)>& change) {
    PipelineOptions options;
    options.reach = [&change](const plan::ViewRequest& r, const Joints&) {
      plan::ReachableView view;
      view.world_T_optical = looking_at(r.target, r.direction, r.distance);
      change(view);
      return std::optional(view);
    };
    Pipeline pipeline(cell(), {}, std::move(options));
    return pipeline.next_view(pipeline.workcell().start).has_value();
  };
  CHECK(asked([](plan::ReachableView&) {}));
  CHECK_THROWS_WITH(asked([](plan::ReachableView& v) { v.world_T_optical.linear() *= 2.0; }),
                    test::says("reach: world_T_optical of its answer is not a rigid pose"));
  CHECK_THROWS_WITH(asked([](plan::ReachableView& v) { v.world_T_optical = Pose::Identity(); }),
                    test::says("does not look at the requested target"));
  CHECK_THROWS_WITH(asked([](plan::ReachableView& v) { v.move_time = -1.0; }), test::says("reach: move_time"));
  CHECK_THROWS_WITH(asked([](plan::ReachableView& v) { v.joints = Joints::Constant(std::nan("")); }),
                    test::says("reach: the joints of its answer are not finite"));
}

TEST_CASE("an arm that refuses everything ends the scan") {
  for (const char* planner : {"gain", "see", "fixed", "random"}) {
    Parameters parameters;
    parameters.planner = planner;
    Pipeline pipeline(cell(), parameters);
    int asked = 0;
    while (pipeline.next_view(pipeline.workcell().start)) {
      pipeline.refused();
      REQUIRE(++asked <= Pipeline::kMostRefusals);
    }
    CHECK(pipeline.stop_reason() != StopReason::not_stopped);
    CHECK(pipeline.result().fruits.empty());
  }
}
