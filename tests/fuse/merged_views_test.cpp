// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sor.hpp>
#include <agrisee/fuse/merged_views.hpp>

#include "catch.hpp"
#include "fuse/by_hand.hpp"

using namespace agrisee;
using namespace agrisee::fuse;
using Eigen::Vector3f;

namespace {

const Aabb kEverywhere{{-100, -100, -100}, {100, 100, 100}};

/// A frame of two rows of three pixels. The rays of the rows are at y = 0 and 1, those of the columns at x = -1, 0, 1.
sensor::DepthFrame frame_of(std::vector<float> depth) {
  sensor::DepthFrame frame;
  frame.intrinsics.width = 3;
  frame.intrinsics.height = 2;
  frame.intrinsics.fx = frame.intrinsics.fy = 1.0;
  frame.intrinsics.cx = 1.0;
  frame.depth = std::move(depth);
  return frame;
}

/// Look and take.
Change see(MergedViews& map, const sensor::DepthFrame& frame, const Pose& pose = Pose::Identity()) {
  return map.take(map.look(frame, pose), pose);
}

}  // namespace

TEST_CASE("raw points are what the pixels return inside the scan volume") {
  const Aabb volume{{-100, 1, -100}, {100, 4, 3}};
  const MergedViews map(volume, 0.01, std::nullopt, 1);
  const Pose pose = test::small_pose();  // x right, y down, z forward are x, -z and y of world, from (1, 2, 3)
  const Observation seen = map.look(frame_of({1, 2, 3, std::nanf(""), -1, 1}), pose);
  // The third pixel of the first row ends at y = 5, outside; in the second row only the third returns.
  CHECK(seen.surface.points == std::vector<Vector3f>{{0, 3, 3}, {1, 4, 3}, {2, 3, 2}});
  CHECK(seen.surface.points_in == 3);
  CHECK(seen.surface.world_T_optical.matrix() == pose.matrix());
  CHECK(seen.surface.normals.empty());
  CHECK(seen.consistent);
  CHECK(map.cloud().empty());
  CHECK(map.images().empty());
}

TEST_CASE("of raw points at one place the first wins") {
  MergedViews map(kEverywhere, 1.0, std::nullopt, 1);
  Change change = see(map, frame_of({1, 0.5f, 1, 0, 0, 0}));
  CHECK(change.points_in == 3);
  CHECK(change.added == std::vector<Vector3f>{{-1, 0, 1}, {0, 0, 0.5f}, {1, 0, 1}});
  CHECK_FALSE(change.kept);
  change = see(map, frame_of({1.2f, 5, 1.4f, 0, 0, 5}));
  CHECK(change.points_in == 4);
  CHECK(change.added == std::vector<Vector3f>{{0, 0, 5}, {5, 5, 5}});
  CHECK_FALSE(change.kept);
  const std::vector<Vector3f> points{{-1, 0, 1}, {0, 0, 0.5f}, {1, 0, 1}, {0, 0, 5}, {5, 5, 5}};
  for (const Cloud& cloud : {map.cloud(), map.all()}) {
    CHECK(cloud.points == points);
    CHECK(cloud.views == std::vector<int>{0, 0, 0, 1, 1});
    CHECK(cloud.normals.empty());
  }
}

TEST_CASE("a raw view reports all points that it saw, those at known places, too") {
  MergedViews map(kEverywhere, 1.0, std::nullopt, 1);
  CHECK(see(map, frame_of({1, 0.5f, 0, 0, 0, 0})).observed == std::vector<Vector3f>{{-1, 0, 1}, {0, 0, 0.5f}});
  const Change change = see(map, frame_of({1.25f, 5, 0, 0, 0, 5}));
  CHECK(change.observed == std::vector<Vector3f>{{-1.25f, 0, 1.25f}, {0, 0, 5}, {5, 5, 5}});
  CHECK(change.added.size() == 2);
  CHECK(see(map, frame_of({0, 0, 0, 0, 0, 0})).observed.empty());
}

TEST_CASE("a raw view that is skipped keeps its number") {
  MergedViews map({{-100, -100, -100}, {100, 100, 2}}, 0.5, std::nullopt, 1);
  see(map, frame_of({1, 0, 0, 0, 0, 0}));
  const Change skipped = map.skip(frame_of({1, 1, 3, 0, 2, 0}), Pose::Identity());
  CHECK(skipped.points_in == 3);
  CHECK(skipped.added.empty());
  CHECK_FALSE(skipped.kept);
  see(map, frame_of({0, 0, 0, 0, 0, 1}));
  CHECK(map.cloud().views == std::vector<int>{0, 2});
  CHECK_FALSE(map.discarded(0));
  CHECK(map.discarded(1));
  CHECK_FALSE(map.discarded(2));
}

TEST_CASE("raw points are no evidence of free space and do not move") {
  MergedViews map(kEverywhere, 0.5, std::nullopt, 1);
  see(map, frame_of({1, 1, 1, 1, 1, 1}), test::small_pose());
  CHECK(map.images().empty());
  CHECK(map.shift_to_reported({1, 2, 3}) == Eigen::Vector3d::Zero());
}

TEST_CASE("the filter of raw points reports which points stay") {
  SorParameters parameters;
  parameters.mean_k = 2;
  parameters.std_ratio = 1.0;
  MergedViews map(kEverywhere, 0.1, parameters, 1);
  Change change = see(map, frame_of({1, 1, 1, 1, 1, 40}));
  CHECK_FALSE(change.kept);  // not before the filter
  const Cloud before = map.cloud();
  REQUIRE(before.size() == 6);
  map.filter(change);
  REQUIRE(change.kept);
  CHECK(*change.kept == Indices{0, 1, 2, 3, 4});
  CHECK(*change.kept == remove_statistical_outliers(before, parameters));
  CHECK(change.added.size() == 6);
  CHECK(map.cloud().points == std::vector<Vector3f>(before.points.begin(), before.points.end() - 1));
  CHECK(map.all().points == before.points);
  // The place of what was removed is free again.
  change = see(map, frame_of({0, 0, 0, 0, 0, 40}));
  CHECK(change.added == std::vector<Vector3f>{{40, 40, 40}});
  CHECK(map.cloud().size() == 6);
  CHECK(map.all().size() == 7);
  CHECK(map.all().views.back() == 1);
}

TEST_CASE("without a filter or without points nothing is filtered") {
  MergedViews unfiltered(kEverywhere, 0.1, std::nullopt, 1);
  Change change = see(unfiltered, frame_of({1, 1, 1, 1, 1, 40}));
  unfiltered.filter(change);
  CHECK_FALSE(change.kept);
  CHECK(unfiltered.cloud().size() == 6);
  MergedViews empty(kEverywhere, 0.1, SorParameters{}, 1);
  change = see(empty, frame_of({0, 0, 0, 0, 0, 0}));
  empty.filter(change);
  CHECK_FALSE(change.kept);
  CHECK(change.points_in == 0);
  MergedViews bad(kEverywhere, 0.1, SorParameters{0, 1.0, false}, 1);
  change = see(bad, frame_of({1, 1, 1, 1, 1, 1}));
  CHECK_THROWS_AS(bad.filter(change), ParameterError);
}

TEST_CASE("merged views refuse bad frames, poses and separations") {
  const MergedViews map(kEverywhere, 0.1, std::nullopt, 1);
  CHECK_THROWS_AS(map.look(frame_of({1, 1, 1}), Pose::Identity()), InputError);
  Pose skewed = Pose::Identity();
  skewed.linear()(0, 0) = 2.0;
  CHECK_THROWS_AS(map.look(frame_of({1, 1, 1, 1, 1, 1}), skewed), InputError);
  Pose nowhere = Pose::Identity();
  nowhere.translation().x() = std::nan("");
  CHECK_THROWS_AS(map.look(frame_of({1, 1, 1, 1, 1, 1}), nowhere), InputError);
  CHECK_THROWS_AS(MergedViews(kEverywhere, 0.0, std::nullopt, 1), ParameterError);
}
