// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include "catch.hpp"
#include "fuse/by_hand.hpp"
#include "spheres.hpp"

using namespace agrisee;
using namespace agrisee::fuse;
using Eigen::Vector3d;
using sensor::SurfaceImage;
using test::at;
using test::quarter;
using test::wall;

namespace {

const Sphere kBall{{0.0, 1.0, 0.2}, 0.05};

/// The ball as a camera 1 m away sees it: what `spheres` show, 0 where they show nothing.
SurfaceImage view_of(const std::vector<Sphere>& spheres, const Vector3d& from) {
  sensor::Intrinsics k = sensor::intrinsics_from_fov(160, 120, deg(18), deg(14));
  SurfaceImage view;
  view.intrinsics = k;
  view.world_T_optical = look_along(from, kBall.center - from);
  view.depth = test::render(spheres, k, view.world_T_optical).depth;
  view.fill = 1.0;
  return view;
}

/// Whether a view looked through a surface at p that faces it.
bool refutes(const SurfaceImage& view, const Vector3d& p, const FreeSpaceParameters& parameters) {
  return fuse::refutes(view, p, (view.world_T_optical.translation() - p).normalized(), parameters);
}

/// Share of the ball's surface that is seen from a place at less than an angle of incidence.
double share_seen(const Vector3d& from, double max_incidence) {
  double share = 0.0;
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b) {
    const Vector3d n = DirectionBins::directions()[b], to = kBall.center + kBall.radius * n - from;
    const double incidence = std::acos(-n.dot(to) / to.norm());
    if (incidence < max_incidence) share += DirectionBins::shares()[b];
  }
  return share;
}

const Vector3d kFront(0.0, 0.0, 0.2), kAside(0.3, 0.05, 0.2), kBehind(0.0, 2.0, 0.2);

}  // namespace

TEST_CASE("a place is free if more views looked through it, to something, than saw surface there") {
  const SurfaceImage through = wall(2.0f), ends = wall(1.0f), empty = wall(0.0f);
  const Vector3d p = at(through, 3, 2, 1.0);
  CHECK(is_free({through}, p, quarter()));
  CHECK_FALSE(is_free({ends}, p, quarter()));
  CHECK_FALSE(is_free({through, ends}, p, quarter()));
  CHECK(is_free({through, ends, through}, p, quarter()));
  CHECK(sight(empty, p, quarter()) == Sight::through);
  CHECK_FALSE(is_free({empty}, p, quarter()));  // as near a silhouette
  CHECK_FALSE(is_free({}, p, quarter()));
}

TEST_CASE("a sight line ends at a place, goes through it, or does not reach it") {
  const SurfaceImage view = wall(2.0f);
  const auto says = [&](double z) { return sight(view, at(view, 3, 2, z), quarter()); };
  CHECK(says(0.5) == Sight::through);
  CHECK(says(1.74) == Sight::through);
  CHECK(says(1.75) == Sight::surface);  // it ends exactly the margin behind it
  CHECK(says(2.0) == Sight::surface);
  CHECK(says(2.24) == Sight::surface);
  CHECK(says(2.25) == Sight::unknown);
  CHECK(says(3.0) == Sight::unknown);
  CHECK(says(-1.0) == Sight::unknown);  // behind the camera
  CHECK(sight(view, at(view, 8, 2, 1.0), quarter()) == Sight::unknown);
  CHECK(sight(view, at(view, 3, -1, 1.0), quarter()) == Sight::unknown);
  CHECK(sight(SurfaceImage{}, at(view, 3, 2, 1.0), quarter()) == Sight::unknown);
}

TEST_CASE("each sight line speaks for its own cell") {
  SurfaceImage view = wall(2.0f);
  test::depth_of(view, 5, 1) = 1.0f;
  for (int v = 0; v < 6; ++v)
    for (int u = 0; u < 8; ++u)
      CHECK(sight(view, at(view, u, v, 1.0), quarter()) == (u == 5 && v == 1 ? Sight::surface : Sight::through));
}

TEST_CASE("the margin is at least three standard deviations of the depths") {
  SurfaceImage view = wall(2.0f);
  const auto says = [&](double z) { return sight(view, at(view, 3, 2, z), quarter()); };
  view.noise = 0.25;  // a margin of 0.75
  CHECK(says(1.24) == Sight::through);
  CHECK(says(1.25) == Sight::surface);
  CHECK(says(2.74) == Sight::surface);
  CHECK(says(2.75) == Sight::unknown);
  view.noise = 0.0625;  // less than the margin
  CHECK(says(1.74) == Sight::through);
  CHECK(says(1.75) == Sight::surface);
}

TEST_CASE("a sight line without return went through where surfaces return nearly always") {
  FreeSpaceParameters parameters = quarter();
  parameters.min_fill = 0.75;
  for (const float nothing : {0.0f, -1.0f, std::nanf("")}) {
    SurfaceImage view = wall(nothing);
    const Vector3d p = at(view, 3, 2, 1.0);
    view.fill = 0.75;
    CHECK(sight(view, p, parameters) == Sight::through);
    CHECK(refutes(view, p, parameters));
    view.fill = 0.74;
    CHECK(sight(view, p, parameters) == Sight::unknown);
    CHECK_FALSE(refutes(view, p, parameters));
  }
}

TEST_CASE("a place is refuted where all nine sight lines around it went through") {
  const SurfaceImage view = wall(2.0f);
  const Vector3d p = at(view, 4, 3, 1.0);
  REQUIRE(refutes(view, p, quarter()));
  for (int v = 0; v < 6; ++v)
    for (int u = 0; u < 8; ++u) {
      CAPTURE(u, v);
      SurfaceImage blocked = view;
      test::depth_of(blocked, u, v) = 1.0f;
      CHECK(refutes(blocked, p, quarter()) == (std::abs(u - 4) > 1 || std::abs(v - 3) > 1));
    }
}

TEST_CASE("one cell without return is no proof where many are missing") {
  SurfaceImage view = wall(2.0f);
  test::depth_of(view, 5, 4) = 0.0f;
  const Vector3d p = at(view, 4, 3, 1.0);
  CHECK(refutes(view, p, quarter()));
  view.fill = 0.5;
  CHECK_FALSE(refutes(view, p, quarter()));
  CHECK(refutes(view, at(view, 3, 2, 1.0), quarter()));
}

TEST_CASE("a surface seen at a slant is not refuted by sight lines without return") {
  const FreeSpaceParameters parameters = quarter();
  for (const float behind : {0.0f, 2.0f}) {
    SurfaceImage view = wall(behind);
    view.fill = 1.0;
    const Vector3d p = at(view, 4, 3, 1.0), to_sensor = (view.world_T_optical.translation() - p).normalized();
    const Vector3d across = any_orthogonal<double>(to_sensor);
    for (const double angle : {deg(0), deg(69), deg(71), deg(89), deg(111), deg(180)}) {
      CAPTURE(behind, angle);
      const Vector3d normal = std::cos(angle) * to_sensor + std::sin(angle) * across;
      CHECK(fuse::refutes(view, p, normal, parameters) ==
            (behind > 0.0f || std::abs(std::cos(angle)) > std::cos(deg(70))));
    }
  }
}

TEST_CASE("nothing is refuted at the border of the image or outside") {
  SurfaceImage view = wall(2.0f);
  view.depth.resize(view.depth.size() + 16, 2.0f);  // what follows the image in memory
  for (int v = -1; v <= 6; ++v)
    for (int u = -1; u <= 8; ++u) {
      CAPTURE(u, v);
      CHECK(refutes(view, at(view, u, v, 1.0), quarter()) == (u >= 1 && u <= 6 && v >= 1 && v <= 4));
    }
  CHECK_FALSE(refutes(view, at(view, 3, 2, -1.0), quarter()));
  CHECK_FALSE(refutes(SurfaceImage{}, at(view, 3, 2, 1.0), quarter()));
}

TEST_CASE("a place is refuted only by sight lines that end more than the margin behind it") {
  SurfaceImage view = wall(2.0f);
  const auto refuted = [&](double z) { return refutes(view, at(view, 3, 2, z), quarter()); };
  CHECK(refuted(1.74));
  CHECK_FALSE(refuted(1.75));
  CHECK_FALSE(refuted(2.0));
  CHECK_FALSE(refuted(3.0));
  view.noise = 0.25;
  CHECK(refuted(1.24));
  CHECK_FALSE(refuted(1.25));
  view.noise = 0.0625;
  CHECK(refuted(1.74));
  CHECK_FALSE(refuted(1.75));
}

TEST_CASE("a ball that one view looked through is seen through where that view sees its surface") {
  const Ellipsoid ball(kBall);
  const SurfaceImage through = view_of({}, kFront), saw = view_of({kBall}, kFront);
  for (const double angle : {deg(30), deg(50), deg(70)}) {
    FreeSpaceParameters parameters;
    parameters.max_incidence = angle;
    const double share = seen_through({through}, ball, parameters);
    CHECK(share == Approx(share_seen(kFront, angle)));
    CHECK(share == Approx(0.5 * (1.0 - std::cos(angle))).margin(0.07));
  }
  CHECK(seen_through({through}, ball) == Approx(share_seen(kFront, deg(50))));
  CHECK(seen_through({}, ball) == 0.0);
  CHECK(seen_through({SurfaceImage{}}, ball) == 0.0);
  CHECK(seen_through({saw}, ball) == 0.0);
}

TEST_CASE("a ball is seen through where more views looked through than saw") {
  const Ellipsoid ball(kBall);
  const SurfaceImage through = view_of({}, kFront), saw = view_of({kBall}, kFront);
  const double share = share_seen(kFront, deg(50));
  CHECK(seen_through({through, saw}, ball) == 0.0);
  CHECK(seen_through({saw, through, through}, ball) == Approx(share));
  CHECK(seen_through({saw, through, saw, through}, ball) == 0.0);
  CHECK(seen_through({through, through, saw}, ball) == Approx(share));
}

TEST_CASE("a ball hidden behind something is neither seen nor seen through") {
  const Ellipsoid ball(kBall);
  const SurfaceImage hidden = view_of({{{0.0, 0.6, 0.2}, 0.2}}, kFront);
  CHECK(seen_through({hidden}, ball) == 0.0);
  CHECK(seen_through({hidden, view_of({}, kFront)}, ball) == Approx(share_seen(kFront, deg(50))));
  // Something far behind it does not hide it.
  CHECK(seen_through({view_of({{{0.0, 3.0, 0.2}, 1.0}}, kFront)}, ball) == Approx(share_seen(kFront, deg(50))));
}

TEST_CASE("views from two sides see through two sides") {
  const Ellipsoid ball(kBall);
  const double front = share_seen(kFront, deg(50)), behind = share_seen(kBehind, deg(50));
  CHECK(seen_through({view_of({}, kFront), view_of({}, kBehind)}, ball) == Approx(front + behind));
  CHECK(seen_through({view_of({kBall}, kFront), view_of({}, kBehind)}, ball) == Approx(behind));
  // Two overlapping sides count once.
  const double both = seen_through({view_of({}, kFront), view_of({}, kAside)}, ball);
  CHECK(both < front + share_seen(kAside, deg(50)) - 0.05);
  CHECK(both > front + 0.01);
}

TEST_CASE("how much of a known surface a view measures again") {
  // Points of the ball that face the view; the view lost the left half of its image, and its edge looks past the ball.
  SurfaceImage view = view_of({kBall}, kFront);
  SurfaceImage known;
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b) {
    const Vector3d n = DirectionBins::directions()[b];
    known.points.push_back((kBall.center + kBall.radius * n).cast<float>());
    known.normals.push_back(n.cast<float>());
  }
  const FreeSpaceParameters parameters;
  const Returned all = returned(view, known, parameters);
  CHECK(all.lost == 0);
  std::size_t facing = 0;
  for (std::size_t i = 0; i < known.points.size(); ++i) {
    const Vector3d to = (kFront - known.points[i].cast<double>()).normalized();
    facing += known.normals[i].cast<double>().dot(to) >= std::cos(parameters.max_incidence);
  }
  CHECK(all.seen == facing);  // not those behind, nor those at the rim
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 80; ++u) view.depth[std::size_t(v * 160 + u)] = 0.0f;
  const Returned half = returned(view, known, parameters);
  CHECK(half.seen + half.lost == all.seen);
  CHECK(double(half.lost) == Approx(0.5 * double(all.seen)).epsilon(0.2));
  // What something hides, or what it looks through to something farther, says nothing.
  for (float& z : view.depth) z = 0.5f;
  CHECK(returned(view, known, parameters).seen + returned(view, known, parameters).lost == 0);
  for (float& z : view.depth) z = 3.0f;
  CHECK(returned(view, known, parameters).seen + returned(view, known, parameters).lost == 0);
}

TEST_CASE("a view measures a point again up to exactly the margin before it and behind it") {
  SurfaceImage view = wall(2.0f);
  const auto measured = [&](double z) {
    SurfaceImage known;
    known.points = {at(view, 3, 2, z).cast<float>()};
    known.normals = {-Eigen::Vector3f::UnitY()};
    const Returned all = returned(view, known, quarter());
    CHECK(all.lost == 0);
    return all.seen == 1;
  };
  for (const double sign : {-1.0, 1.0}) {
    CHECK(measured(2.0 + sign * 0.25));
    CHECK_FALSE(measured(2.0 + sign * 0.2501));
  }
  view.noise = 0.25;  // a margin of 0.75
  for (const double sign : {-1.0, 1.0}) {
    CHECK(measured(2.0 + sign * 0.75));
    CHECK_FALSE(measured(2.0 + sign * 0.7501));
  }
}

TEST_CASE("a share of returns needs fifty points") {
  CHECK(Returned{0, 49}.share() == 1.0);
  CHECK(Returned{10, 40}.share() == 0.2);
  Returned sum{10, 40};
  sum += {50, 0};
  CHECK(sum.share() == 0.6);
  sum += {0, 20};
  CHECK(sum.share() == 0.5);
}
