// SPDX-License-Identifier: BSD-3-Clause
// Poses that are no world_T_optical are recognized by how the views agree.
#include <agrisee/fuse/pose_check.hpp>

#include "catch.hpp"
#include "fuse/three_fruit.hpp"

using namespace test;

namespace {

const Aabb kNowhere;

/// What the camera sees at five places; the poses are reported as report(pose).
template <typename Report>
std::vector<ViewSample> seen(Report&& report) {
  std::vector<ViewSample> views;
  for (int i = 0; i < 5; ++i) views.push_back(sample_of(frame_at(i), report(place(i))));
  return views;
}

Pose rotated(const Pose& pose, const Eigen::Matrix3d& by) {
  Pose out = pose;
  out.linear() = pose.linear() * by;
  return out;
}

Pose right(const Pose& pose) { return pose; }
Pose inverted(const Pose& pose) { return pose.inverse(Eigen::Isometry); }
/// Of the frame with x forward, y left and z up.
Pose of_body(const Pose& pose) { return rotated(pose, (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished()); }
/// Of the frame with z backward and y up.
Pose of_graphics(const Pose& pose) { return rotated(pose, Eigen::Vector3d(1, -1, -1).asDiagonal()); }

}  // namespace

TEST_CASE("right poses are believed, also when they are off by some millimetres") {
  for (const Aabb& volume : {kNowhere, kVolume}) {
    const PoseCheck check = check_poses(seen(right), volume);
    CHECK(check.mistake.empty());
    CHECK(check.as_reported > 0.7);
    CHECK(check.as_reported > check.mended);
  }
  int view = 0;
  const PoseCheck check =
      check_poses(seen([&](const Pose& pose) { return off_by(pose, 0.008 * Vector3d::Unit(view++ % 3)); }), kNowhere);
  CHECK(check.mistake.empty());
  CHECK(check.as_reported > 0.6);
}

TEST_CASE("poses that are inverted, or of other axes, are recognized") {
  const auto mistake = [](Pose (*report)(const Pose&), const Aabb& volume = kNowhere) {
    return check_poses(seen(report), volume).mistake;
  };
  for (const Aabb& volume : {kNowhere, kVolume}) {
    CHECK(mistake(inverted, volume) == "are inverted (optical_T_world)");
    CHECK(mistake(of_body, volume) == "are those of a frame with x forward and z up");
    CHECK(mistake(of_graphics, volume) == "are those of a frame with z backward and y up");
  }
}

TEST_CASE("of poses that no change mends none is named") {
  Rng rng(5);
  const std::vector<ViewSample> views = seen([&](const Pose& pose) {
    const Eigen::AngleAxisd turn(kPi * rng.uniform(), rng.direction());
    return rotated(pose, turn.toRotationMatrix());
  });
  for (const Aabb& volume : {kNowhere, kVolume}) {
    const PoseCheck check = check_poses(views, volume);
    CHECK(check.mistake.empty());
    CHECK(check.as_reported < 0.3);
  }
}

TEST_CASE("a single view tells by the scan volume alone") {
  const auto alone = [](Pose (*report)(const Pose&)) {
    return std::vector<ViewSample>{sample_of(frame_at(0), report(place(0)))};
  };
  CHECK(check_poses(alone(right), kVolume).mistake.empty());
  CHECK(check_poses(alone(inverted), kNowhere).mistake.empty());
  CHECK(check_poses(alone(of_body), kVolume).mistake == "are those of a frame with x forward and z up");
  Aabb elsewhere = kVolume;
  elsewhere.min.x() += 5.0;
  elsewhere.max.x() += 5.0;
  CHECK(check_poses(alone(right), elsewhere).mistake.empty());  // no change helps
}

TEST_CASE("views without points, or without others, agree with nothing") {
  CHECK(agreement({}, 0.01) == 0.0);
  CHECK(check_poses({}, kVolume).mistake.empty());
  std::vector<ViewSample> views = seen(right);
  for (std::size_t i = 1; i < views.size(); ++i) views[i].points.clear();
  CHECK(agreement(views, 0.01) == 0.0);
  CHECK(check_poses(views, kNowhere).mistake.empty());
}

TEST_CASE("agreement is the mean share of points that another view has") {
  ViewSample a, b;
  a.points = {{0, 0, 1}, {0.5f, 0, 1}};
  b.points = {{0, 0, 1}, {5, 0, 1}, {6, 0, 1}, {7, 0, 1}};
  CHECK(agreement({a, a}, 0.01) == 1.0);
  CHECK(agreement({a, b}, 0.01) == 0.5 * (0.5 + 0.25));
}

TEST_CASE("of many views some are compared, and poses far away are no trouble") {
  std::vector<ViewSample> many;
  for (int i = 0; i < 50; ++i) many.push_back(sample_of(frame_at(i % 5), place(i % 5)));
  CHECK(agreement(many, 0.01) > 0.9);
  for (ViewSample& view : many) view.world_T_optical.translation() *= 1e9;
  CHECK(check_poses(many, kVolume).mistake.empty());
}

TEST_CASE("a sample is spread over the whole image") {
  const sensor::DepthFrame& frame = frame_at(0);
  sensor::DepthFrame full = frame;
  full.depth.assign(full.depth.size(), 0.5f);
  const ViewSample sample = sample_of(full, place(0));
  CHECK(sample.points.size() > 3000);
  CHECK(sample.points.size() < 10000);
  CHECK(sample.points.front().x() < -0.17f);
  CHECK(sample.points.back().x() > 0.17f);
}

TEST_CASE("of a small frame every pixel is taken") {
  sensor::DepthFrame frame;
  frame.intrinsics = {3, 2, 1.0, 1.0, 0.0, 0.0};
  frame.depth.assign(6, 1.0f);
  CHECK(sample_of(frame, place(0)).points ==
        std::vector<Vector3f>{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {0, 1, 1}, {1, 1, 1}, {2, 1, 1}});
}
