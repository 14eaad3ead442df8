// SPDX-License-Identifier: BSD-3-Clause
// Which fruit surface is known, which is expected, and what of it a view shows, on spheres seen in part.
#include <agrisee/plan/expected_surface.hpp>

#include <numeric>

#include "plan/fruit_cases.hpp"

using namespace cases;

namespace {

/// One whole fruit of which everything is expected, since hardly any sample has a point.
ExpectedSurface one_fruit(const ExpectedSurfaceParameters& p = bare()) {
  Scan scan;
  add_fruit(scan, kFruit);
  return model_of(scan, p);
}

std::vector<std::uint32_t> first_indices(std::size_t n) {
  std::vector<std::uint32_t> out(n);
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

/// A sample as the tests make it out; of voxels the normal is zero.
struct Expected {
  Vector3d point, normal = Vector3d::Zero();
  int body = -1;
};

/// All samples of a model none of whose surface is covered.
std::vector<Expected> samples_of(const ExpectedSurface& model, const ExpectedSurfaceParameters& p, const Aabb& volume) {
  std::vector<Expected> out;
  const auto& bodies = model.bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (const Vector3d& d : spread_directions(p.samples)) {
      const Vector3d point = bodies[b].fit.body.surface(d);
      bool inside = false;
      for (std::size_t o = 0; o < bodies.size(); ++o)
        inside = inside || (o != b && (point - bodies[o].fit.body.center).norm() < 0.97 * kRadius);
      if (!inside) out.push_back({point, d, static_cast<int>(b)});
    }
  const int n = static_cast<int>(std::lround((volume.max - volume.min).x() / p.voxel));
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3d point = volume.min + p.voxel * Vector3d(i % n + 0.5, i / n % n + 0.5, i / n / n + 0.5);
    double nearest = 10.0;
    for (const FoundBody& b : bodies) nearest = std::min(nearest, (point - b.fit.body.center).norm() - kRadius);
    if (nearest >= 0.0 && nearest <= p.neighborhood) out.push_back({point});
  }
  return out;
}

/// Whether a view shows a sample: 1 or 0; -1 where it is too close to call.
int shows(const Pose& pose, const Expected& s, const ExpectedSurface& model, const ExpectedSurfaceParameters& p) {
  const Vector3d camera = pose.translation(), d = s.point - camera, u = d.normalized(), q = pose.inverse() * s.point;
  bool close = false;
  const auto above = [&](double value, double limit, double margin = 1e-4) {
    close = close || std::abs(value - limit) < margin;
    return value > limit;
  };
  bool out = s.body < 0 || above(-u.dot(s.normal), std::cos(p.max_incidence));
  out = out && q.z() > 0.0 && above(0.75, std::abs(q.x() / q.z())) && above(0.5625, std::abs(q.y() / q.z()));
  for (std::size_t b = 0; out && b < model.bodies().size(); ++b) {
    if (static_cast<int>(b) == s.body) continue;
    const Vector3d c = model.bodies()[b].fit.body.center - camera;
    const double along = c.dot(u), off = (c - along * u).norm(), r = 0.97 * kRadius;
    if (along > 0.0 && above(r, off, 1e-5) && above(d.norm() - 0.001, along - std::sqrt(r * r - off * off), 1e-5))
      out = false;
  }
  return close ? -1 : out;
}

}  // namespace

TEST_CASE("expected surface: of a fruit, a view shows what faces it below the largest angle of incidence") {
  // From a distance D, the surface of a sphere of radius R is seen at less than the angle i up to the angle
  // i - asin(R sin i / D) from the axis. From above: 69.96 degrees, z > 0.3427, which 66 of 200 samples are.
  const ExpectedSurface model = one_fruit();
  REQUIRE(model.areas().size() == 200);
  const Pose above = look_at(kFruit, kFruit + Vector3d(0, 0, 0.385));
  CHECK(model.shown(above) == first_indices(66));
  CHECK(gain_of(model, above) == Approx(66 * kSurface / 200));
  const Pose below = look_at(kFruit, kFruit - Vector3d(0, 0, 0.385));
  const auto lowest = model.shown(below);
  CHECK(lowest.size() == 66);
  CHECK(lowest.front() == 134);
  CHECK(lowest.back() == 199);
  ExpectedSurfaceParameters steep = bare();
  steep.max_incidence = deg(30);  // 27.4 degrees, z > 0.888
  CHECK(one_fruit(steep).shown(above) == first_indices(11));
}

TEST_CASE("expected surface: from afar, from aside or from inside nothing is shown") {
  const ExpectedSurface model = one_fruit();
  CHECK(gain_of(model, look_at(kFruit, kFruit + Vector3d(0, 0, 9.9))) > 0.0);
  CHECK(gain_of(model, look_at(kFruit, kFruit + Vector3d(0, 0, 10.1))) == 0.0);
  CHECK(gain_of(model, look_along(kFruit + Vector3d(0, 0, 0.385), {0, 1, 0})) == 0.0);
  CHECK(gain_of(model, look_along(kFruit + Vector3d(0, 0, 0.385), {0, 0, 1})) == 0.0);
  CHECK(gain_of(model, look_along(kFruit, {0, 0, 1})) == 0.0);  // all faces away
}

TEST_CASE("expected surface: half of a sphere is covered, which brings no gain, the other half is expected") {
  ExpectedSurfaceParameters p = bare(2000);
  p.cover_radius = 0.005;
  Scan scan;
  add_fruit(
      scan, kFruit, [](const Vector3d& d) { return d.y() < 0.0; }, 0.002);
  const ExpectedSurface model = model_of(scan, p);
  REQUIRE(model.bodies().size() == 1);
  std::size_t covered = 0;
  for (const Vector3d& d : spread_directions(2000)) {
    const Eigen::Vector3f s = model.bodies()[0].fit.body.surface(d).cast<float>();
    covered += std::any_of(scan.cloud.points.begin(), scan.cloud.points.end(),
                           [&](const Eigen::Vector3f& q) { return (q - s).norm() <= 0.005f; });
  }
  // Points reach 5 mm past the equator: 8.2 degrees.
  const double share = static_cast<double>(covered) / 2000;
  CHECK(share == Approx(0.5 + 0.5 * std::sin(2.0 * std::asin(0.0025 / kRadius))).margin(0.01));
  CHECK(model.areas().size() == 2000 - covered);
  CHECK(model.covered_area() == Approx(share * kSurface).epsilon(1e-4));
  CHECK(model.area() == Approx(kSurface).epsilon(1e-4));
  CHECK(gain_of(model, look_at(kFruit, kFruit - Vector3d(0, 0.385, 0))) == 0.0);
  // From behind, a cap of 69.96 degrees.
  CHECK(gain_of(model, look_at(kFruit, kFruit + Vector3d(0, 0.385, 0))) == Approx(0.3286 * kSurface).epsilon(0.015));

  std::vector<char> seen(model.areas().size(), 0);
  Completeness none = model.completeness(seen);
  REQUIRE(none.fruits.size() == 1);
  CHECK((none.fruits[0].center - kFruit).norm() < 1e-5);
  CHECK(none.seen == Approx(share));
  CHECK(none.observable == Approx(share));
  CHECK(none.fruits[0].seen == Approx(share));
  CHECK(none.of_observable() == Approx(1.0));
  std::fill_n(seen.begin(), 300, 1);
  const Completeness some = model.completeness(seen);
  CHECK(some.seen == Approx(share));
  CHECK(some.observable == Approx(share + 300.0 / 2000));
  CHECK(some.fruits[0].observable == Approx(share + 300.0 / 2000));
  std::fill(seen.begin(), seen.end(), 1);
  CHECK(model.completeness(seen).observable == Approx(1.0));
}

TEST_CASE("expected surface: a lobe that stands out from the fitted ellipsoid covers what is below it") {
  ExpectedSurfaceParameters p = bare(2000);
  p.cover_radius = 0.003;
  // The lobe is a cap where the fruit has no points.
  const auto open_below = [&](double out, double facing) {
    Scan scan;
    add_fruit(
        scan, kFruit, [](const Vector3d& d) { return d.z() < std::cos(deg(25)); }, 0.002);
    test::add_sphere(scan.cloud, {kFruit, kRadius + out}, 0.002,
                     [](const Vector3d& d) { return d.z() > std::cos(deg(20)); });
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      if ((scan.cloud.points[i].cast<double>() - kFruit).norm() > kRadius + 0.5 * out)
        scan.cloud.normals[i] *= static_cast<float>(facing);
    const ExpectedSurface model = model_of(scan, p);
    REQUIRE(model.bodies().size() == 1);
    REQUIRE((model.bodies()[0].fit.body.center - kFruit).norm() < 2e-3);
    return 1.0 - model.covered_area() / model.area();
  };
  const double cap = 0.5 * (1.0 - std::cos(deg(20)));  // 5 degrees of the gap are 3 mm
  CHECK(open_below(0.007, 1.0) < 0.2 * cap);
  CHECK(open_below(0.007, -1.0) > 0.7 * cap);  // the inside of something
  CHECK(open_below(0.015, 1.0) > 0.7 * cap);   // too far out
}

TEST_CASE("expected surface: completeness is told for each fruit, and unknown voxels are none of it") {
  ExpectedSurfaceParameters p = bare();
  p.cover_radius = 0.004;
  p.neighborhood = 0.02;
  Scan scan;
  const Vector3d other = kFruit + Vector3d(0.1, 0, 0);
  add_fruit(scan, kFruit, test::everywhere, 0.002);
  add_fruit(
      scan, other, [](const Vector3d& d) { return d.z() > 0.0; }, 0.002);
  const ExpectedSurface model = model_of(scan, p);
  REQUIRE(model.bodies().size() == 2);
  REQUIRE((model.bodies()[0].fit.body.center - kFruit).norm() < 1e-5);
  const Completeness c = model.completeness(std::vector<char>(model.areas().size(), 1));
  CHECK(c.fruits[0].seen == Approx(1.0));
  CHECK(c.fruits[0].observable == Approx(1.0));
  CHECK(c.fruits[1].seen == Approx(0.557).margin(0.02));  // 4 mm are 6.6 degrees
  CHECK(c.fruits[1].observable == Approx(1.0));
  CHECK((c.fruits[1].center - other).norm() < 1e-5);
  CHECK(c.seen == Approx(0.5 * (1.0 + c.fruits[1].seen)).epsilon(1e-4));
  CHECK(c.observable == Approx(1.0));
}

TEST_CASE("expected surface: a fruit behind another is not shown, from the other side it is") {
  Scan scan;
  const Vector3d behind = kFruit + Vector3d(0, 0.1, 0);
  add_fruit(scan, kFruit);
  add_fruit(scan, behind);
  const ExpectedSurface model = model_of(scan);
  REQUIRE(model.bodies().size() == 2);
  const std::size_t back = (model.bodies()[0].fit.body.center - behind).norm() < 1e-3 ? 0 : 1;
  const auto shown = [&](const Vector3d& from, const Vector3d& along) {
    std::array<std::size_t, 2> count{};
    for (const std::uint32_t i : model.shown(look_along(from, along))) ++count[i / 200];
    return std::array<std::size_t, 2>{count[1 - back], count[back]};
  };
  // Seen from 0.4 m, the front one fills 4.9 degrees, the other one 4.0.
  const auto front = shown({0, 0.1, 0.2}, {0, 1, 0});
  CHECK(front[0] > 60);
  CHECK(front[1] == 0);
  const auto rear = shown({0, 1.0, 0.2}, {0, -1, 0});
  CHECK(rear[0] == 0);
  CHECK(rear[1] > 60);
  const auto side = shown({-0.4, 0.55, 0.2}, {1, 0, 0});
  CHECK(side[0] > 60);
  CHECK(side[1] > 60);
  const auto between = shown({0, 0.545, 0.2}, {0, 1, 0});  // the front one is behind the camera and hides nothing
  CHECK(between[0] == 0);
  CHECK(between[1] > 0);
}

TEST_CASE("expected surface: a long fruit hides more along its axis than across it") {
  const double length = 0.05, width = 0.03;  // semi-axes (m); a sphere of the mean radius has 0.0346
  const auto rear_shown = [&](const Vector3d& semi_axes) {
    Scan scan;
    for (const Vector3d& d : spread_directions(1200)) {
      scan.cloud.points.push_back((kFruit + semi_axes.cwiseProduct(d)).cast<float>());
      scan.cloud.normals.push_back(d.cwiseQuotient(semi_axes).normalized().cast<float>());
    }
    add_fruit(scan, kFruit + Vector3d(0, 0.12, 0.07));
    const ExpectedSurface model = model_of(scan);
    REQUIRE(model.bodies().size() == 2);
    const std::size_t rear = model.bodies()[0].fit.body.center.y() > 0.55 ? 0 : 1;
    std::size_t count = 0;
    for (const std::uint32_t i : model.shown(look_along({0, 0.1, 0.2}, {0, 1, 0}))) count += i / 200 == rear;
    return count;
  };
  // From the camera the rear one is a disc about z = 0.254 of radius 0.027 at the front one, which ends at 0.25 upright
  // and at 0.23 lying: a quarter of the disc is hidden, or hardly anything.
  const std::size_t upright = rear_shown({width, width, length}), lying = rear_shown({length, width, width});
  CHECK(lying > 60);
  CHECK(upright < 55);
  CHECK(upright > 40);
}

TEST_CASE("expected surface: what random views show of two fruits and the space around them, sample by sample") {
  Scan scan;
  const Vector3d other = kFruit + Vector3d(0.04, 0.045, 0.01);  // 61 mm away: they go 9 mm into each other
  const auto outside = [](const Vector3d& own, const Vector3d& of) {
    return [=](const Vector3d& d) { return (own + kRadius * d - of).norm() > kRadius; };
  };
  add_fruit(scan, kFruit, outside(kFruit, other));
  add_fruit(scan, other, outside(other, kFruit));
  ExpectedSurfaceParameters p = bare();
  p.voxel = 0.01;
  p.neighborhood = 0.02;
  const Aabb volume = box(kFruit, 0.12);
  const ExpectedSurface model = model_of(scan, p);
  REQUIRE(model.bodies().size() == 2);
  const auto samples = samples_of(model, p, volume);
  REQUIRE(model.areas().size() == samples.size());
  const auto on_fruit = [](const Expected& s) { return s.body >= 0; };
  const auto fruit = static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(), on_fruit));
  CHECK(fruit < 390);
  CHECK(model.area() == Approx(2 * kSurface).epsilon(1e-3));
  for (std::size_t i = 0; i < samples.size(); ++i)
    CHECK(model.areas()[i] == Approx(i < fruit ? kSurface / 200 : 0.03 * 0.01 * 0.01).epsilon(1e-3));
  Rng rng(3);
  std::size_t close = 0, seen = 0;
  for (int view = 0; view < 30; ++view) {
    const Vector3d from = kFruit + rng.uniform(0.08, 0.4) * rng.direction();
    const Pose pose = look_along(from, kFruit + 0.08 * rng.direction() - from);
    const auto shown = model.shown(pose);
    double gain = 0.0;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      const bool is_shown = std::binary_search(shown.begin(), shown.end(), i);
      const int expected = shows(pose, samples[i], model, p);
      if (expected < 0) ++close;
      if (expected >= 0 && is_shown != (expected == 1)) FAIL_CHECK("view " << view << ", sample " << i);
      if (is_shown) ++seen, gain += double(model.areas()[i]);
    }
    CHECK(gain_of(model, pose) == Approx(gain));
  }
  CHECK(close < 200);
  CHECK(seen > 5000);
}

TEST_CASE("expected surface: points of no fruit hide what is behind them, points of the fruit nothing") {
  Scan scan;
  add_fruit(scan, kFruit);
  for (int i = 0; i < 31 * 31; ++i) scan.add_point({-0.045 + 0.003 * (i % 31), 0.4, 0.155 + 0.003 * (i / 31)});
  const ExpectedSurface model = model_of(scan, bare(), camera(32.0));
  REQUIRE(model.bodies().size() == 1);
  CHECK(gain_of(model, look_at(kFruit, {0, 0.1, 0.2})) == 0.0);
  CHECK(model.shown(look_at(kFruit, {0, 0.9, 0.2})).size() > 60);
  CHECK(model.shown(look_at(kFruit, kFruit + Vector3d(0, 0, 0.385))) == first_indices(66));
}

TEST_CASE("expected surface: each view that should have shown a sample lowers its area") {
  ExpectedSurfaceParameters p = bare();
  const double factor = GENERATE(0.35, 0.5, 1.0, 0.0);
  p.missed_factor = factor;
  Scan scan;
  add_fruit(scan, kFruit);
  ExpectedSurface model = model_of(scan, p);
  const Pose above = look_at(kFruit, kFruit + Vector3d(0, 0, 0.385));
  const Pose below = look_at(kFruit, kFruit - Vector3d(0, 0, 0.385));
  scan.images = {flat_image(above, 0.1), flat_image(below, 0.1), flat_image(above, 0.1)};  // something is in the way
  for (int again = 0; again < 2; ++again) {  // the second time changes nothing
    model.update(scan.progress(), {}, {});
    REQUIRE(model.areas().size() == 200);
    for (std::size_t i = 0; i < 200; ++i)
      CHECK(double(model.areas()[i]) == Approx(kSurface / 200 *
                                               (i < 66     ? factor * factor
                                                : i >= 134 ? factor
                                                           : 1.0))
                                            .epsilon(1e-4));
    CHECK(model.area() == Approx(kSurface).epsilon(1e-4));
    // What is not expected any more is not observable either.
    CHECK(model.completeness(std::vector<char>(200, 1)).observable ==
          Approx((66 * factor * factor + 66 * factor + 68) / 200).epsilon(1e-4));
  }
  CHECK(ExpectedSurfaceParameters().missed_factor == 0.35);
}

TEST_CASE("expected surface: a frame that was not taken, or is empty, lowers the gain but not what is observable") {
  Scan scan;
  add_fruit(scan, kFruit);
  const Pose above = look_at(kFruit, kFruit + Vector3d(0, 0, 0.385));
  const double before = gain_of(model_of(scan), above);
  sensor::SurfaceImage discarded;
  discarded.world_T_optical = above;
  const bool empty = GENERATE(false, true);
  scan.images = {empty ? flat_image(above, 0.0, 0.0) : discarded};
  ExpectedSurface model = model_of(scan);
  CHECK(gain_of(model, above) == Approx((empty ? 1.0 - 0.25 * 0.65 : 0.35) * before));
  CHECK(model.completeness(std::vector<char>(200, 1)).observable == Approx(1.0));
  // One that shows something else there does.
  scan.images.push_back(flat_image(above, 0.1));
  model.update(scan.progress(), {}, {});
  CHECK(model.completeness(std::vector<char>(200, 1)).observable == Approx((66 * 0.35 + 134) / 200));
}

TEST_CASE("expected surface: where sight lines pass, the surface is deeper, or not there") {
  Scan scan;
  add_fruit(
      scan, kFruit, [](const Vector3d& d) { return d.y() < 0.0; }, 0.002);  // its rear half is expected
  ExpectedSurfaceParameters p = bare();
  p.cover_radius = 0.004;
  const auto samples = [&](const std::vector<sensor::SurfaceImage>& images) {
    Scan seen = scan;
    seen.images = images;
    const ExpectedSurface model = model_of(seen, p);
    REQUIRE(model.bodies().size() == 1);
    return model.areas().size();
  };
  const std::size_t all = samples({});
  CHECK(all > 70);
  // From above, at the depth of a plane through the fruit: sight lines end below the expected samples that are at least
  // 6 mm higher than it.
  const auto above = [](double height, double fill = 1.0) {
    return flat_image(look_at(kFruit, kFruit + Vector3d(0, 0, 0.385)), height == 0.0 ? 0.0 : 0.385 - height, fill);
  };
  CHECK(samples({above(0.03)}) == all);     // they end above all of it, but for the margin
  CHECK(samples({above(0.02)}) == all);     // the upper cap is where they end
  CHECK(samples({above(-0.2)}) < all / 4);  // they pass through all that lies in the image, on both of its sides
  // Without return, a sight line proves that there is no surface that faces away from it; what faces it may mirror.
  const std::size_t lower_half = samples({above(0.0)});
  CHECK(5 * lower_half > 2 * all);
  CHECK(4 * lower_half < 3 * all);
  CHECK(samples({above(0.0, 0.5)}) == all);  // in a frame that lost many returns it proves nothing
}

TEST_CASE("expected surface: a view that lost a part of its returns lowers areas by less") {
  ExpectedSurfaceParameters p = bare();
  Scan scan;
  add_fruit(scan, kFruit);
  ExpectedSurface model = model_of(scan, p);
  scan.images = {flat_image(look_at(kFruit, kFruit + Vector3d(0, 0, 0.385)), 0.1, 0.4)};
  model.update(scan.progress(), {}, {});
  CHECK(double(model.areas()[0]) == Approx(kSurface / 200 * (1.0 - 0.4 * (1.0 - p.missed_factor))).epsilon(1e-4));
  CHECK(double(model.areas()[199]) == Approx(kSurface / 200).epsilon(1e-4));
}

TEST_CASE("a body that masks alone propose is expected, so that a view of it is worth taking") {
  const Vector3d hidden(0.07, 0.5, 0.2);
  Scan scan;
  add_fruit(scan, kFruit);
  ExpectedSurface without(camera(), box(kFruit, 0.12), bare()), with(camera(), box(kFruit, 0.12), bare());
  const Progress plain = scan.progress();
  without.update(plain, {}, {});
  MaskEvidence masks;
  masks.log_odds = [](const Ellipsoid&) { return 0.0; };
  masks.most = 4.0;
  masks.remaining = [&](const std::vector<Ellipsoid>& known) {
    CHECK(known.size() == 1);  // that of the points
    MaskBody body;
    body.fit.body = Ellipsoid(Sphere{hidden, kRadius});
    body.fit.inliers = 50;
    body.log_odds = 1.5;
    return std::vector<MaskBody>{body};
  };
  Progress told{plain.cloud, plain.images, plain.views, plain.added, plain.observed, plain.kept, &masks};
  for (int i = 0; i < 2; ++i) {  // from scratch, and brought up to date
    with.update(told, {}, {});
    REQUIRE(with.bodies().size() == 2);
    CHECK(with.bodies()[1].by_mask);
    const Pose view = look_at(hidden, hidden + Vector3d(0.05, -0.3, 0.0));
    CHECK(gain_of(with, view) > gain_of(without, view) + 0.2 * kSurface);
  }
}
