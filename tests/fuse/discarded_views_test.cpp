// SPDX-License-Identifier: BSD-3-Clause
// Fused views that contradict one another: which of them are kept.
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"
#include "fuse/by_hand.hpp"
#include "fuse/three_fruit.hpp"

using namespace agrisee;
using namespace agrisee::test;

TEST_CASE("of two views that contradict one another the later is discarded") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0);
  const Cloud before = map.all();
  const Pose reported = off_by(place(1), kNearer);
  const Observation seen = map.look(frame_at(1), reported);
  CHECK_FALSE(seen.consistent);
  CHECK_FALSE(seen.surface.points.empty());
  const Change change = map.take(seen, reported);
  CHECK(change.points_in == seen.surface.points_in);
  CHECK(change.points_in > 1000);
  CHECK(change.added.empty());
  CHECK_FALSE(change.kept);
  CHECK(discarded(map) == std::vector<bool>{false, true});
  CHECK((map.all().points == before.points));
  CHECK((map.cloud().points == before.points));
  CHECK(same(map.images()[1].world_T_optical, reported));
  CHECK(map.images()[1].depth.empty());
  see(map, 2);
  CHECK(discarded(map) == std::vector<bool>{false, true, false});
}

TEST_CASE("views that contradict in all they show are kept where that is allowed") {
  FusionParameters parameters = fine();
  parameters.free_space.max_contradiction = 1.0;
  FusedViews map(kVolume, parameters, 1);
  const Sphere ball{{0.01, 0.55, 0.2}, 0.035};
  see_spheres(map, {ball});
  see_spheres(map, {ball}, kNearer);
  CHECK(compare(map.images()[0], map.images()[1], parameters.free_space).contradiction() == 1.0);
  CHECK(discarded(map) == std::vector<bool>{false, false});
}

TEST_CASE("when two views show that the first was wrong the map starts again") {
  FusedViews map(kVolume, fine(), 1), right(kVolume, fine(), 1);
  const Vector3d small(0.001, 0.001, -0.001);
  see(map, 0, kNearer);
  see(map, 1);
  CHECK(discarded(map) == std::vector<bool>{false, true});
  const std::size_t before = map.all().size();
  const Change change = see(map, 2, small);
  CHECK(discarded(map) == std::vector<bool>{true, false, false});
  // The map is that of the two right views alone.
  const Change first = see(right, 1), second = see(right, 2, small);
  CHECK((map.all().points == right.all().points));
  CHECK((map.cloud().points == right.cloud().points));
  std::vector<int> views = right.all().views;
  for (int& v : views) ++v;
  CHECK((map.all().views == views));
  std::vector<Vector3f> added = first.added;
  added.insert(added.end(), second.added.begin(), second.added.end());
  CHECK((change.added == added));
  CHECK(change.points_in == second.points_in);
  REQUIRE(change.kept);  // of the old map nothing, of what was added all
  REQUIRE(change.kept->size() == added.size());
  for (std::size_t i = 0; i < added.size(); ++i) REQUIRE((*change.kept)[i] == static_cast<Index>(before + i));
  for (std::size_t v = 0; v < 2; ++v) {
    CHECK((map.images()[v + 1].depth == right.images()[v].depth));
    CHECK((map.images()[v + 1].points == right.images()[v].points));
    CHECK(same(map.images()[v + 1].world_T_optical, right.images()[v].world_T_optical));
  }
  CHECK(distance(map.images()[2].world_T_optical, place(2)) < 0.0003);
  CHECK(map.images()[0].depth.empty());
  CHECK(map.images()[0].points.empty());
  CHECK(same(map.images()[0].world_T_optical, off_by(place(0), kNearer)));
  see(map, 3);
  see(map, 4, kNearer);
  CHECK(discarded(map) == std::vector<bool>{true, false, false, false, true});
}

TEST_CASE("when the map starts again the first views no longer speak against its points") {
  FusionParameters parameters;
  parameters.free_space.margin = 0.25;
  parameters.free_space.min_refuting = 1;
  FusedViews map(kVolume, parameters, 1);
  // Small views of a wall, and points 1 m before the camera: the first view looks through its own.
  const auto take = [&](float depth, int column, bool consistent) {
    Observation out;
    out.surface = wall(depth);
    out.surface.points_in = 25;
    out.surface.points.assign(25, at(out.surface, column, 2, 1.0).cast<float>());
    out.surface.normals.assign(25, -Vector3f::UnitY());
    out.surface.sigma.assign(25, 0.001f);
    out.consistent = consistent;
    return map.take(out, small_pose());
  };
  take(2.0f, 3, true);
  CHECK(map.all().size() == 1);
  CHECK(map.cloud().empty());
  take(1.0f, 3, false);
  CHECK(take(1.0f, 4, false).kept);  // two against one
  CHECK(discarded(map) == std::vector<bool>{true, false, false});
  CHECK(map.all().size() == 2);
  CHECK((map.cloud().points == map.all().points));
}

TEST_CASE("the map starts again only when more views agree than it is made of") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0);
  see(map, 1, kNearer);
  see(map, 2);
  see(map, 3, kNearer);  // two against two
  CHECK(discarded(map) == std::vector<bool>{false, true, false, true});
  const Change change = see(map, 4, kNearer);  // three against two
  CHECK(discarded(map) == std::vector<bool>{true, false, true, false, false});
  REQUIRE(change.kept);
  CHECK(map.all().size() == change.added.size());
  CHECK(map.all().views.front() == 1);
  CHECK(map.all().views.back() == 4);
  for (const std::size_t v : {1, 3, 4}) CHECK_FALSE(map.images()[v].depth.empty());
  for (const std::size_t v : {0, 2}) CHECK(map.images()[v].depth.empty());
  // What the first map was made of still counts: with one more there are three against three, then four.
  see(map, 1);
  CHECK(discarded(map) == std::vector<bool>{true, false, true, false, false, true});
  see(map, 3);
  CHECK(discarded(map) == std::vector<bool>{false, true, false, true, true, false, false});
  // The map is that of the right views alone.
  FusedViews right(kVolume, fine(), 1);
  for (const int i : {0, 2, 1, 3}) see(right, i);
  REQUIRE(map.all().size() > 1000);
  CHECK(map.all().size() == Approx(right.all().size()).epsilon(0.01));
  for (const auto& [view, place_of] : {std::pair(0, 0), {2, 2}, {5, 1}, {6, 3}})
    CHECK(distance(map.images()[static_cast<std::size_t>(view)].world_T_optical, place(place_of)) < 0.0003);
}

TEST_CASE("three wrong views do not win against five right ones, in any order") {
  const std::vector<std::pair<int, bool>> views{{0, true},  {1, false}, {3, false}, {2, true},
                                                {4, false}, {1, true},  {3, true},  {4, true}};
  std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6, 7};
  Rng rng(5);
  for (int round = 0; round < 12; ++round) {
    FusedViews map(kVolume, fine(), 1);
    std::vector<bool> wrong;
    for (const std::size_t i : order) {
      see(map, views[i].first, views[i].second ? kRight : kNearer);
      wrong.push_back(!views[i].second);
    }
    CHECK(discarded(map) == wrong);
    for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[rng.below(i + 1)]);
  }
}

TEST_CASE("views that saw nothing and views that were skipped have no say") {
  FusedViews map(kVolume, fine(), 1);
  const Change nothing = see_spheres(map, {});
  CHECK(nothing.points_in == 0);
  CHECK(nothing.added.empty());
  CHECK_FALSE(map.discarded(0));
  map.skip(frame_at(0), place(0));
  see(map, 1, kNearer);
  see(map, 2);  // one against one
  CHECK(discarded(map) == std::vector<bool>{false, true, false, true});
  see(map, 3);  // two against one
  CHECK(discarded(map) == std::vector<bool>{false, true, true, false, false});
  CHECK_FALSE(map.images()[0].depth.empty());  // it still shows what is empty
  CHECK(map.images()[2].depth.empty());
}

TEST_CASE("views that share no surface do not agree") {
  const Sphere left{{-0.1, 0.55, 0.2}, 0.03}, right{{0.1, 0.55, 0.2}, 0.03};
  const Vector3d error(0, -0.05, 0);
  FusedViews map(kVolume, fine(), 1);
  const auto see_closely = [&](const Sphere& s, double from_side) {
    const Vector3d from = s.center + Vector3d(from_side, -0.25, 0);
    const Pose pose = look_along(from, s.center - from);
    const Observation seen = map.look(frame_from(pose, {left, right}, deg(20), deg(15)), off_by(pose, error));
    CHECK_FALSE(seen.consistent);
    CHECK(seen.surface.points.size() > 200);
    return map.take(seen, off_by(pose, error));
  };
  map.take(map.look(frame_from(place(0), {left, right}, deg(70), deg(55)), place(0)), place(0));
  CHECK(near(map.all(), left) > 50);
  CHECK(near(map.all(), right) > 50);
  see_closely(left, 0.0);
  see_closely(right, 0.0);
  CHECK(discarded(map) == std::vector<bool>{false, true, true});
  // One that shares enough with the first of them.
  see_closely(left, 0.02);
  CHECK(discarded(map) == std::vector<bool>{true, false, true, false});
}

TEST_CASE("views agree from 50 common points and up to the largest contradiction") {
  FusionParameters parameters;
  parameters.free_space.margin = 0.25;
  parameters.free_space.max_contradiction = 0.3;
  // A small view of a wall at 2 m: some points on the wall and some 1 m in front of it.
  const auto seen = [](int agree, int refute, bool consistent) {
    Observation out;
    out.surface = wall(2.0f);
    out.surface.points_in = 1;
    out.consistent = consistent;
    for (int i = 0; i < agree + refute; ++i) {
      out.surface.points.push_back(at(out.surface, 3, 2, i < agree ? 2.0 : 1.0).cast<float>());
      out.surface.normals.emplace_back(0.0f, -1.0f, 0.0f);
      out.surface.sigma.push_back(0.001f);
    }
    return out;
  };
  const auto starts_again = [&](const Observation& a, const Observation& b) {
    FusedViews map(kVolume, parameters, 1);
    map.take(seen(1, 0, true), small_pose());
    CHECK_FALSE(map.take(a, small_pose()).kept);
    return map.take(b, small_pose()).kept.has_value();
  };
  CHECK_FALSE(starts_again(seen(25, 0, false), seen(24, 0, false)));
  CHECK(starts_again(seen(25, 0, false), seen(25, 0, false)));
  CHECK(starts_again(seen(35, 15, false), seen(0, 0, false)));  // 15 of 50 are 0.3
  CHECK_FALSE(starts_again(seen(35, 15, false), seen(0, 1, false)));
  CHECK_FALSE(starts_again(seen(34, 16, false), seen(0, 0, false)));
}

TEST_CASE("to take a view in cannot be cancelled, to look can") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0, kNearer);
  see(map, 1);
  Observation seen = map.look(frame_at(2), place(2));
  const Cancellation stop;
  stop.request();
  const CancellationScope scope(stop);
  CHECK_THROWS_AS(map.look(frame_at(2), place(2)), Cancelled);
  map.take(std::move(seen), place(2));  // the map starts again, and registers what it starts with
  CHECK(discarded(map) == std::vector<bool>{true, false, false});
  CHECK(map.all().size() > 100);
}
