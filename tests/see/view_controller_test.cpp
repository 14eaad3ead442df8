// SPDX-License-Identifier: BSD-3-Clause
// The view controller by hand: three adjustments, the switch, and when nothing helps. The frontier's frame is that of
// the axes: direction x, boundary y, normal z.
#include <agrisee/see/view_controller.hpp>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::see;
using Eigen::Vector3d;

namespace {

constexpr double kDistance = 0.4;
const Vector3d kFirst(0.1, -0.3, 0.3);  // where the frontier was first seen from

struct Case {
  Frontier f;
  ViewProposal view;
  ControllerState state;

  Case() {
    f.index = 7;
    f.point = {0.1, 0.2, 0.3};
    view = propose(f, kDistance);
  }
  ControllerAction look(const Vector3d& centroid) { return control_view(f, centroid, kFirst, kDistance, state, view); }
  void check_at(const Vector3d& position) const {
    CHECK((view.position - position).norm() < 2e-6);
    CHECK((view.position - f.point).norm() == Approx(kDistance));
    CHECK((view.position + kDistance * view.direction - f.point).norm() < 1e-12);
    CHECK(view.frontier == 7);
  }
};

}  // namespace

TEST_CASE("controller: the view after one, two and three adjustments", "[see]") {
  Case c;
  // o = (0.03, -0.02, 0.04), s = 1: 0.06 along x, turned about x by atan(0.012 / 0.1618); then -0.04 along y, turned
  // about y by atan(-0.008 / 0.1608).
  REQUIRE(c.look({0.07, 0.22, 0.26}) == ControllerAction::adjusted);
  c.check_at({0.139188, 0.132004, 0.692226});
  CHECK(c.state.scale == 2.0);
  CHECK(c.state.offset == Approx(std::sqrt(0.0029)));
  // o = (0.02, -0.01, 0.03), s = 2: three offsets along each axis.
  REQUIRE(c.look({0.08, 0.21, 0.27}) == ControllerAction::adjusted);
  c.check_at({0.176314, 0.069791, 0.670435});
  CHECK(c.state.scale == 4.0);
  // o = (0.01, -0.005, 0.01), s = 4: five offsets.
  REQUIRE(c.look({0.09, 0.205, 0.29}) == ControllerAction::adjusted);
  c.check_at({0.202473, 0.019162, 0.641756});
  CHECK(c.state.scale == 8.0);
  CHECK(c.state.offset == Approx(0.015));
  CHECK_FALSE(c.state.switched);
}

TEST_CASE("controller: along both axes a larger scale moves the view farther, and never round the frontier", "[see]") {
  const Frontier f = Case().f;
  const Vector3d from = f.point + kDistance * f.normal;
  for (const double offset : {0.05, -0.1})
    for (const Vector3d& axis : {f.direction, f.boundary})
      for (const double s : {1.0, 2.0, 4.0, 8.0}) {
        const Vector3d side = (adjusted_position(f, from, offset * axis, s, kDistance) - f.point).normalized();
        // Turned about the axis, it is as far from the plane across it as the move took it.
        CHECK(std::asin(side.dot(axis)) == Approx(std::atan((s + 1.0) * offset / kDistance)));
        CHECK(side.dot(f.normal) > 0.0);
      }
}

TEST_CASE("controller: an offset along the normal alone moves nothing", "[see]") {
  Case c;
  REQUIRE(c.look({0.1, 0.2, 0.25}) == ControllerAction::adjusted);
  c.check_at({0.1, 0.2, 0.7});
  CHECK(c.state.offset == Approx(0.05));
}

TEST_CASE("controller: when the offset no longer shrinks, the view is switched once, then nothing helps", "[see]") {
  Case c;
  REQUIRE(c.look({0.08, 0.2, 0.3}) == ControllerAction::adjusted);
  REQUIRE(c.look({0.125, 0.2, 0.3}) == ControllerAction::switched);  // 2.5 cm, on the other side
  c.check_at(c.f.point + kDistance * (kFirst - c.f.point).normalized());
  CHECK(c.state.scale == 1.0);
  CHECK(c.state.switched);
  // After the switch it begins anew: even a larger offset adjusts.
  REQUIRE(c.look({0.05, 0.2, 0.3}) == ControllerAction::adjusted);
  CHECK(c.state.offset == Approx(0.05));
  CHECK(c.state.scale == 2.0);
  const Vector3d before = c.view.position;
  REQUIRE(c.look({0.04, 0.2, 0.3}) == ControllerAction::nothing_helps);
  CHECK(c.view.position == before);
  REQUIRE(c.look({0.06, 0.2, 0.3}) == ControllerAction::adjusted);  // a smaller one still would
}
