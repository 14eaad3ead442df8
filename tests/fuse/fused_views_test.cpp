// SPDX-License-Identifier: BSD-3-Clause
// What becomes of the surfaces of views: they are registered and fused. discarded_views_test.cpp has the views that
// contradict one another.
#include <agrisee/sensor/reconstruct_surface.hpp>

#include "catch.hpp"
#include "fuse/three_fruit.hpp"

using namespace agrisee;
using namespace agrisee::fuse;
using namespace agrisee::test;

TEST_CASE("the surfaces of all views become surfels") {
  FusedViews map(kVolume, fine(), 1);
  CHECK(map.all().empty());
  CHECK(map.cloud().empty());
  SurfelMap expected(fine().surfels);
  for (int i = 0; i < 2; ++i) {
    const auto v = static_cast<std::size_t>(i);
    const Observation seen = map.look(frame_at(i), place(i));
    CHECK(map.images().size() == v);  // to look changes nothing
    CHECK(map.all().size() == expected.size());
    CHECK(seen.consistent);
    CHECK(seen.surface.points_in == count_inside(frame_at(i), place(i), kVolume));
    const Change change = map.take(seen, place(i));
    CHECK(change.points_in == seen.surface.points_in);
    CHECK((change.added == add(expected, seen.surface, i)));
    CHECK_FALSE(change.kept);
    // Of the image stay the depths and some points to compare later views with.
    REQUIRE(map.images().size() == v + 1);
    const sensor::SurfaceImage& image = map.images()[v];
    CHECK(same(image.world_T_optical, seen.surface.world_T_optical));
    CHECK((image.depth == seen.surface.depth));
    CHECK(image.normals.size() == image.points.size());
    CHECK(image.sigma.empty());
    std::vector<Vector3f> some;
    const std::size_t step = seen.surface.points.size() / 1000;
    REQUIRE(step >= 2);
    for (std::size_t c = 0; c < seen.surface.points.size(); c += step) some.push_back(seen.surface.points[c]);
    CHECK((image.points == some));
  }
  const Cloud cloud = expected.cloud();
  CHECK((map.cloud().points == cloud.points));
  CHECK((map.cloud().normals == cloud.normals));
  CHECK((map.cloud().views == cloud.views));
  CHECK((map.all().points == cloud.points));
  CHECK((map.all().views == cloud.views));
  CHECK(map.all().normals.empty());
  CHECK(discarded(map) == std::vector<bool>{false, false});
}

TEST_CASE("what lies outside the scan volume is left out of the map") {
  const Aabb left{{-0.3, 0.2, -0.1}, {-0.01, 0.9, 0.5}};
  FusedViews map(left, fine(), 1);
  const Change change = see(map, 0);
  CHECK(change.points_in == count_inside(frame_at(0), place(0), left));
  CHECK(change.points_in < count_inside(frame_at(0), place(0), kVolume));
  REQUIRE(map.all().size() > 100);
  for (const Vector3f& p : map.all().points) CHECK(p.x() < -0.008f);
}

TEST_CASE("registration corrects a small error of a pose") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0);
  Pose reported = off_by(place(1), {0.002, -0.001, 0.0015});
  reported.rotate(Eigen::AngleAxisd(deg(0.2), Vector3d::UnitX()));
  const Observation seen = map.look(frame_at(1), reported);
  CHECK(seen.consistent);
  CHECK(distance(seen.surface.world_T_optical, place(1)) < 0.0002);
  CHECK(angle_of(seen.surface.world_T_optical.inverse() * place(1)) < deg(0.03));
  // Points and normals are moved with the camera.
  const auto raw = sensor::reconstruct_surface(frame_at(1), reported, kVolume, fine().surface);
  const Eigen::Isometry3f correction = (seen.surface.world_T_optical * reported.inverse()).cast<float>();
  REQUIRE(seen.surface.points.size() == raw.points.size());
  double worst = 0.0, worst_normal = 0.0;
  for (std::size_t i = 0; i < raw.points.size(); ++i) {
    worst = std::max(worst, double((seen.surface.points[i] - correction * raw.points[i]).norm()));
    worst_normal =
        std::max(worst_normal, double((seen.surface.normals[i] - correction.linear() * raw.normals[i]).norm()));
  }
  CHECK(worst < 1e-6);
  CHECK(worst_normal < 1e-6);
  CHECK((seen.surface.sigma == raw.sigma));
  map.take(seen, reported);
  CHECK(same(map.images()[1].world_T_optical, seen.surface.world_T_optical));
}

TEST_CASE("a correction that is not accepted leaves the view where it is") {
  FusionParameters parameters = fine();
  parameters.icp.max_translation = 0.001;
  FusedViews map(kVolume, parameters, 1);
  see(map, 0);
  const Pose reported = off_by(place(1), {0.002, 0, 0});
  const Observation seen = map.look(frame_at(1), reported);
  CHECK(seen.consistent);
  CHECK(same(seen.surface.world_T_optical, reported));
  CHECK(seen.surface.points == sensor::reconstruct_surface(frame_at(1), reported, kVolume, fine().surface).points);
}

TEST_CASE("the two sides of something thin are not laid upon one another") {
  // Two huge balls, whose faces towards the cameras are 3 mm apart.
  const Sphere far{{0.0, 2.55, 0.2}, 2.0}, near{{0.0, -1.447, 0.2}, 2.0};
  const Pose front = look_along({0.0, 0.25, 0.2}, {0, 1, 0}), back = look_along({0.0, 0.85, 0.2}, {0, -1, 0});
  FusedViews map({{-0.06, 0.2, 0.14}, {0.06, 0.9, 0.26}}, fine(), 1);
  map.take(map.look(frame_from(front, {far}), front), front);
  const Observation seen = map.look(frame_from(back, {near}), back);
  CHECK(seen.consistent);
  CHECK(seen.surface.points.size() > 1000);
  CHECK(same(seen.surface.world_T_optical, back));
}

TEST_CASE("views of up to 2500 points are registered by all of their points") {
  const std::vector<Sphere> few{{{-0.03, 0.53, 0.2}, 0.022}, {{0.045, 0.54, 0.21}, 0.022}};
  FusionParameters parameters = fine();
  parameters.icp.min_matches = 1600;
  FusedViews map(kVolume, parameters, 1);
  see_spheres(map, few);
  const Pose reported = off_by(place(1), {0.001, 0, 0});
  const Observation seen = map.look(frame_from(place(1), few), reported);
  REQUIRE(seen.surface.points.size() > 2000);
  REQUIRE(seen.surface.points.size() < 2500);
  CHECK(distance(seen.surface.world_T_optical, place(1)) < 0.0005);
}

TEST_CASE("views are compared on bodies as well where they show much else") {
  std::vector<Sphere> with_wall = kThreeFruit;
  with_wall.push_back({{0.0, 2.85, 0.2}, 2.0});
  const auto around = [](double margin) {
    return Aabb{{-0.1 - margin, 0.45 - margin, 0.1 - margin}, {0.1 + margin, 0.7 + margin, 0.3 + margin}};
  };
  const bool registered = GENERATE(true, false);
  FusionParameters parameters;
  parameters.register_views = registered;
  FusedViews tight(around(0.0), parameters, 1), wide(around(2.0), parameters, 1);
  const auto bodies = [] {
    std::vector<Ellipsoid> all;
    for (const Sphere& s : kThreeFruit) all.emplace_back(s);
    return all;
  }();
  const std::vector<Vector3d> errors{{0, 0, 0}, {0.001, 0, 0}, {0, -0.001, 0}, {0, 0, 0.001}, {0, 0.001, 0.001}};
  for (int i = 0; i < 5; ++i) {
    const sensor::DepthFrame frame =
        test::render(with_wall, sensor::intrinsics_from_fov(320, 240, deg(100), deg(80)), place(i), 0.0005);
    const Pose reported = off_by(place(i), errors[static_cast<std::size_t>(i)]);
    for (FusedViews* map : {&tight, &wide}) map->take(map->look(frame, reported), reported);
  }
  REQUIRE(wide.cloud().size() > 20 * tight.cloud().size());
  const double apart = tight.check_calibration(bodies).apart;
  CHECK(apart > 0.0002);
  CHECK(wide.check_calibration(bodies).apart == Approx(apart).epsilon(0.5));
  const auto expected = tight.body_errors(bodies, {}), found = wide.body_errors(bodies, {});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    REQUIRE(expected[b].volume > 0.0);
    CAPTURE(registered, b);
    // A wall is registered, too, and takes the views elsewhere.
    const double most = registered ? 3.0 : 2.0;
    const double volumes = found[b].volume / expected[b].volume;
    const double centers = std::sqrt(found[b].center.trace() / expected[b].center.trace());
    CAPTURE(volumes, centers);
    CHECK((volumes > 0.5 && volumes < most));
    CHECK((centers > 0.5 && centers < most));
  }
  CHECK(wide.body_errors({}, {}).empty());
  CHECK(wide.check_calibration({}).apart == 0.0);
}

TEST_CASE("the number of threads does not change the map") {
  FusedViews one(kVolume, fine(), 1), three(kVolume, fine(), 3);
  for (FusedViews* map : {&one, &three}) {
    see(*map, 0);
    see(*map, 1, {0.001, 0.001, 0});
  }
  CHECK((one.cloud().points == three.cloud().points));
  CHECK((one.cloud().normals == three.cloud().normals));
  CHECK(same(one.images()[1].world_T_optical, three.images()[1].world_T_optical));
}

TEST_CASE("without registration views are taken as they are reported") {
  FusionParameters parameters = fine();
  parameters.register_views = false;
  FusedViews map(kVolume, parameters, 1);
  see(map, 0);
  for (const Vector3d& error : {Vector3d(0.002, 0, 0), kNearer}) {
    const Pose reported = off_by(place(1), error);
    const Observation seen = map.look(frame_at(1), reported);
    CHECK(seen.consistent);
    CHECK(same(seen.surface.world_T_optical, reported));
  }
}

TEST_CASE("a view that contradicts only until it is registered is kept") {
  FusionParameters parameters = fine();
  parameters.free_space.margin = 0.002;
  parameters.free_space.leaf_depth = 0.0;
  parameters.icp.independent = 0.0;
  const Pose reported = off_by(place(1), {0, -0.003, 0});
  {
    FusedViews map(kVolume, parameters, 1);
    see(map, 0);
    const Observation seen = map.look(frame_at(1), reported);
    CHECK(seen.consistent);
    CHECK(distance(seen.surface.world_T_optical, place(1)) < 0.0003);
  }
  {  // It is registered twice then. This shows when one step is not enough.
    FusionParameters one_step = parameters;
    one_step.icp.max_iterations = 1;
    FusedViews strict(kVolume, one_step, 1);
    see(strict, 0);
    const Observation twice = strict.look(frame_at(1), reported);
    one_step.free_space.max_contradiction = 1.0;
    FusedViews lenient(kVolume, one_step, 1);
    see(lenient, 0);
    const Observation once = lenient.look(frame_at(1), reported);
    CHECK(twice.consistent);
    CHECK(once.consistent);
    CHECK(distance(twice.surface.world_T_optical, place(1)) < 0.7 * distance(once.surface.world_T_optical, place(1)));
  }
  parameters.icp.max_translation = 0.001;
  FusedViews stiff(kVolume, parameters, 1);
  see(stiff, 0);
  const Observation seen = stiff.look(frame_at(1), reported);
  CHECK_FALSE(seen.consistent);
  CHECK(same(seen.surface.world_T_optical, reported));
}

TEST_CASE("surfels that enough views looked through are left out of the cloud") {
  // Little enough goes that the views still measure 85 % of what is known.
  const Sphere stays{{0.06, 0.55, 0.2}, 0.06}, gone{{-0.04, 0.53, 0.2}, 0.022};
  FusionParameters parameters = fine();
  parameters.register_views = false;
  const auto left = [&](int with, int without) {
    FusedViews map(kVolume, parameters, 1);
    for (int i = 0; i < with; ++i) see_spheres(map, {stays, gone});
    const std::size_t seen = near(map.all(), gone);
    REQUIRE(seen > 100);
    for (int i = 0; i < without; ++i) see_spheres(map, {stays});
    const Cloud all = map.all(), cloud = map.cloud();
    CHECK(near(all, gone) == seen);
    if (cloud.size() == all.size()) return "all";
    // The rim of what is gone stays: a surface seen at a slant might have returned nothing.
    const Vector3d eye = place(0).translation();
    std::vector<Vector3f> stay, stayed;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all.points[i].x() >= 0.0f) stay.push_back(all.points[i]);
    REQUIRE(cloud.normals.size() == cloud.size());
    REQUIRE(cloud.views.size() == cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Vector3d p = cloud.points[i].cast<double>();
      const bool rim = p.x() < 0.0;
      if (!rim) stayed.push_back(cloud.points[i]);
      const Vector3d outward = (p - (rim ? gone : stays).center).normalized();
      if (rim) REQUIRE(outward.dot((eye - p).normalized()) < std::cos(deg(64)));
      if (!rim) REQUIRE(outward.dot(cloud.normals[i].cast<double>()) > 0.95);
    }
    CHECK((stay == stayed));
    return "none";
  };
  CHECK(left(1, 1) == std::string("all"));
  CHECK(left(1, 2) == std::string("none"));
  CHECK(left(2, 2) == std::string("none"));
  CHECK(left(3, 2) == std::string("all"));  // more views saw it
  CHECK(left(3, 3) == std::string("none"));
  parameters.free_space.min_refuting = 3;
  CHECK(left(1, 2) == std::string("all"));
  CHECK(left(1, 3) == std::string("none"));
}

TEST_CASE("the map shifts by the mean difference of reported and registered poses") {
  FusedViews map(kVolume, fine(), 1);
  const Vector3d center(0.01, 0.55, 0.2);
  CHECK(map.shift_to_reported(center) == Vector3d::Zero());
  see(map, 0);
  CHECK(map.shift_to_reported(center).norm() < 1e-15);
  see(map, 1, {0.002, -0.001, 0.001});
  CHECK((map.shift_to_reported(center) - Vector3d(0.001, -0.0005, 0.0005)).norm() < 0.0001);
  see(map, 2, {0.001, 0.001, 0.002});
  CHECK((map.shift_to_reported(center) - Vector3d(0.001, 0.0, 0.001)).norm() < 0.0001);
  see(map, 3, kNearer);  // discarded, it does not count
  map.skip(frame_at(4), place(4));
  sensor::DepthFrame nothing = frame_at(4);  // nor does a view that shows nothing
  std::fill(nothing.depth.begin(), nothing.depth.end(), 0.0f);
  map.take(map.look(nothing, place(4)), place(4));
  CHECK((map.shift_to_reported(center) - Vector3d(0.001, 0.0, 0.001)).norm() < 0.0001);
}

TEST_CASE("the map of one view shifts by all of its difference") {
  FusedViews map(kVolume, fine(), 1);
  const Vector3d error(0.002, -0.001, 0.001);
  map.take(map.look(frame_at(0), place(0)), off_by(place(0), error));
  CHECK((map.shift_to_reported({0.01, 0.55, 0.2}) - error).norm() < 1e-12);
}

TEST_CASE("where a reported pose is turned the shift is that of the map's center") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0);
  const Vector3d center(0.01, 0.55, 0.2);
  Pose turned = place(1);
  turned.rotate(Eigen::AngleAxisd(deg(0.3), Vector3d::UnitY()));
  map.take(map.look(frame_at(1), turned), turned);
  const Vector3d moved = turned * place(1).inverse() * center - center;
  REQUIRE(moved.norm() > 0.001);
  CHECK((map.shift_to_reported(center) - 0.5 * moved).norm() < 0.0001);
}

TEST_CASE("a view that is skipped keeps its number and its pose") {
  FusedViews map(kVolume, fine(), 1);
  see(map, 0);
  const Cloud before = map.all();
  const Change change = map.skip(frame_at(1), place(1));
  CHECK(change.points_in == count_inside(frame_at(1), place(1), kVolume));
  CHECK(change.points_in > 0);
  CHECK(change.added.empty());
  CHECK_FALSE(change.kept);
  CHECK((map.all().points == before.points));
  REQUIRE(map.images().size() == 2);
  CHECK(same(map.images()[1].world_T_optical, place(1)));
  CHECK(map.images()[1].depth.empty());
  see(map, 2);
  CHECK(discarded(map) == std::vector<bool>{false, true, false});
  CHECK(map.all().views.back() == 2);
}

TEST_CASE("fused views need no filter") {
  FusedViews map(kVolume, fine(), 1);
  Change change = see(map, 0);
  const std::size_t added = change.added.size();
  map.filter(change);
  CHECK_FALSE(change.kept);
  CHECK(change.added.size() == added);
  CHECK(map.cloud().size() == added);
}

TEST_CASE("fused views refuse bad frames, poses and parameters") {
  const FusedViews map(kVolume, fine(), 1);
  sensor::DepthFrame frame = frame_at(0);
  frame.depth.pop_back();
  CHECK_THROWS_AS(map.look(frame, place(0)), InputError);
  Pose skewed = place(0);
  skewed.linear().col(0) *= 2.0;
  CHECK_THROWS_AS(map.look(frame_at(0), skewed), InputError);
  FusionParameters bad = fine();
  bad.surfels.separation = 0.0;
  CHECK_THROWS_AS(FusedViews(kVolume, bad, 1), ParameterError);
  bad = fine();
  bad.surface.spacing = 0.0;
  CHECK_THROWS_AS(FusedViews(kVolume, bad, 1).look(frame_at(0), place(0)), ParameterError);
}

TEST_CASE("patches that return nothing are no free space") {
  FusedViews map(kVolume, fine(), 1);
  for (int i = 0; i < 5; ++i) {  // a stripe of 50 columns is lost, another one in each view
    sensor::DepthFrame frame = frame_at(i);
    for (int v = 0; v < 120; ++v)
      for (int u = 25 * i; u < 25 * i + 50; ++u) frame.depth[std::size_t(v * 160 + u)] = 0.0f;
    const Observation seen = map.look(frame, place(i));
    CHECK(seen.consistent);
    map.take(seen, place(i));
  }
  for (const auto& image : map.images()) CHECK(image.fill < 0.85);
  CHECK(double(map.cloud().size()) > 0.99 * double(map.all().size()));
}
