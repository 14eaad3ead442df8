// SPDX-License-Identifier: BSD-3-Clause
// Views whose pose or frame is wrong are not believed.
#include <agrisee/pipeline.hpp>

#include <set>

#include "catch.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

Workcell cell() {
  Workcell w;
  w.scan_volume.extend({-0.17, 0.40, -0.02});
  w.scan_volume.extend({0.17, 0.72, 0.42});
  w.sensor.intrinsics = sensor::intrinsics_from_fov(400, 300, deg(70), deg(55));
  return w;
}

/// Views around the fruit; `wrong` are reported this far off. Returns what the pipeline makes of them.
ScanResult look_around(int views, const std::set<int>& wrong, const Eigen::Vector3d& off, int frozen = -1) {
  const Workcell w = cell();
  Pipeline pipeline(w);
  sensor::DepthFrame last;
  for (int v = 0; v < views; ++v) {
    const double angle = deg(-70.0 + 140.0 * v / (views - 1));
    const Eigen::Vector3d target(0.01, 0.55, 0.2);
    const Eigen::Vector3d direction(std::sin(angle), std::cos(angle), 0.1 * (v % 3 - 1));
    Pose pose = Pose::Identity();
    const Eigen::Vector3d z = direction.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    pose.linear() << x, z.cross(x), z;
    pose.translation() = target - 0.38 * z;
    sensor::DepthFrame frame =
        test::render(test::kThreeFruit, w.sensor.intrinsics, pose, 0.001, static_cast<std::uint64_t>(v + 1));
    if (v == frozen) frame = last;
    last = frame;
    if (wrong.count(v)) pose.translation() += off;
    pipeline.observe(frame, pose);
  }
  return pipeline.result();
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
        "1 of 8 views was discarded: view 4 repeats the frame before (does the camera hang?)");
  check_found(result);
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
