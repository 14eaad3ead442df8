// SPDX-License-Identifier: BSD-3-Clause
// How far promises of the planner's model can be relied on.
#include <agrisee/plan/expected_surface.hpp>

#include "plan/fruit_cases.hpp"

using namespace cases;

namespace reliability_test {

TEST_CASE("expected surface: how far it can be relied on follows from what views showed of what they promised") {
  // Half of a fruit is known. A view of the other half promises much of it.
  ExpectedSurfaceParameters p = bare();
  p.cover_radius = 0.005;
  const auto front = [](const Vector3d& d) { return d.y() < 0.0; };
  const auto model_after = [&](auto&& shown, std::size_t points = 1000, bool discarded = false) {
    Scan scan;
    add_fruit(scan, kFruit, front, 0.002);
    ExpectedSurface model = model_of(scan, p);
    CHECK(model.reliability() == 1.0);
    add_fruit(scan, kFruit, shown, 0.002);
    View behind;
    behind.world_T_optical = look_at(kFruit, {0, 0.885, 0.2});
    REQUIRE(gain_of(model, behind.world_T_optical) > 0.2 * kSurface);
    behind.points_in = points;
    behind.discarded = discarded;
    scan.views.push_back(behind);
    model.update(scan.progress(), {}, {});
    return model.reliability();
  };
  CHECK(model_after([](const Vector3d& d) { return d.y() >= 0.0; }) == Approx(1.0));
  const auto nothing = [](const Vector3d&) { return false; };
  CHECK(model_after(nothing) < 0.02);
  // A frame without returns and a view that was discarded say nothing of what can be seen.
  CHECK(model_after(nothing, 0) == 1.0);
  CHECK(model_after(nothing, 1000, true) == 1.0);
  const double half = model_after([](const Vector3d& d) { return d.y() >= 0.0 && d.x() > 0.0; });
  CHECK(half > 0.45);
  CHECK(half < 0.65);
}

TEST_CASE("expected surface: less can be expected close to a view that showed hardly any of what it promised") {
  ExpectedSurfaceParameters p = bare();
  p.cover_radius = 0.005;
  const Vector3d eye(0, 0.885, 0.2);
  const auto clearness_after = [&](auto&& shown, const Pose& of, bool discarded = false) {
    Scan scan;
    add_fruit(
        scan, kFruit, [](const Vector3d& d) { return d.y() < 0.0; }, 0.002);
    ExpectedSurface model = model_of(scan, p);
    CHECK(model.clearness(of) == 1.0);
    add_fruit(scan, kFruit, shown, 0.002);
    View behind;
    behind.world_T_optical = look_at(kFruit, eye);
    behind.discarded = discarded;
    for (int again = 0; again < 2; ++again) {
      scan.views.push_back(behind);
      model.update(scan.progress(), {}, {});
    }
    return model.clearness(of);
  };
  const auto nothing = [](const Vector3d&) { return false; };
  const auto half = [](const Vector3d& d) { return d.y() >= 0.0 && d.x() > 0.0; };
  const Pose there = look_at(kFruit, eye), beside = look_at(kFruit, eye + Vector3d(0.05, 0, 0));
  CHECK(clearness_after(nothing, there) < 0.1);
  CHECK(clearness_after(nothing, beside) < 0.1);
  CHECK(clearness_after(nothing, look_at(kFruit, eye + Vector3d(0.15, 0, 0))) == 1.0);  // elsewhere
  CHECK(clearness_after(nothing, look_at(eye + Vector3d(0.3, 0, 0), eye)) == 1.0);      // turned away
  CHECK(clearness_after(nothing, there, true) == 1.0);  // a discarded view says nothing of what can be seen
  CHECK(clearness_after(half, there) > 0.2);            // the first showed half, the second nothing more
}

TEST_CASE("expected surface: older views count less for how far it can be relied on") {
  // The fronts of two fruit are known. Of two views from behind one shows all of its fruit, the other nothing.
  const Vector3d fruit[] = {kFruit, kFruit + Vector3d(0.6, 0.0, 0.0)};
  const auto after = [&](bool first, bool second) {
    ExpectedSurfaceParameters p = bare();
    p.cover_radius = 0.005;
    Scan scan;
    for (const Vector3d& f : fruit)
      add_fruit(
          scan, f, [](const Vector3d& d) { return d.y() < 0.0; }, 0.002);
    ExpectedSurface model = model_of(scan, p);
    for (const int i : {0, 1}) {
      View behind;
      behind.world_T_optical = look_at(fruit[i], fruit[i] + Vector3d(0.0, 0.385, 0.0));
      behind.points_in = 1000;
      CHECK(gain_of(model, behind.world_T_optical) == Approx(0.3286 * kSurface).epsilon(0.05));
      if (i == 0 ? first : second)
        add_fruit(
            scan, fruit[i], [](const Vector3d& d) { return d.y() >= 0.0; }, 0.002);
      scan.views.push_back(behind);
      model.update(scan.progress(), {}, {});
    }
    return model.reliability();
  };
  CHECK(after(true, true) == Approx(1.0));
  const double before = after(true, false), now = after(false, true);
  CHECK(before > 0.1);
  CHECK(before < 0.45);
  CHECK(now > 0.55);
  CHECK(now < 0.9);
}

TEST_CASE("expected surface: a body of which little is seen counts half with every view that looked at it in vain") {
  // A tenth of a fruit is known, or a third.
  const bool little = GENERATE(true, false);
  const double height = little ? -0.8 : -0.35;
  const auto front = [&](const Vector3d& d) { return d.y() < height; };
  ExpectedSurfaceParameters p = bare();
  p.missed_factor = 1.0;
  Scan scan;
  add_fruit(scan, kFruit, front, 0.002);
  ExpectedSurface model = model_of(scan, p);
  REQUIRE(model.bodies().size() == 1);
  REQUIRE(model.bodies()[0].confidence > 0.5);
  REQUIRE((model.bodies()[0].coverage < 0.25) == little);
  const double whole = model.area(), seen = model.completeness(std::vector<char>(200, 1)).seen;
  View behind, past;
  behind.world_T_optical = look_at(kFruit, {0, 0.885, 0.2});
  past.world_T_optical = look_along({0, 0.885, 0.2}, Vector3d::UnitY());  // away from the fruit
  const auto area_after = [&](View view, std::size_t points = 1000) {
    view.points_in = points;
    scan.views.push_back(view);
    model.update(scan.progress(), {}, {});
    return model.area() / whole;
  };
  const double half = little ? 0.5 : 1.0;
  CHECK(area_after(behind) == Approx(half));
  CHECK(area_after(past) == Approx(half));
  CHECK(area_after(behind, 0) == Approx(half));  // a frame without returns says nothing
  CHECK(area_after(behind) == Approx(half * half));
  CHECK(model.completeness(std::vector<char>(200, 1)).seen == Approx(seen));
  CHECK(model.completeness(std::vector<char>(200, 1)).observable == Approx(1.0));
  // What is well seen counts in full, however long it was doubted.
  add_fruit(
      scan, kFruit, [](const Vector3d& d) { return d.y() > 0.0; }, 0.002);
  CHECK(area_after(past) == Approx(1.0).epsilon(0.02));
}

}  // namespace reliability_test
