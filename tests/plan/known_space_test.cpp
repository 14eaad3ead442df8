// SPDX-License-Identifier: BSD-3-Clause
// Which voxels of a volume sight lines have reached.
#include <agrisee/plan/known_space.hpp>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace {

std::size_t unknown_in(const KnownSpace& space) {
  std::size_t count = 0;
  space.for_each_unknown([&](const Vector3d&) { ++count; });
  return count;
}

}  // namespace

TEST_CASE("known space: a view makes known what lies before its surface") {
  KnownSpace space(box({0.0, 0.5, 0.25}, 0.125), 0.03125);
  REQUIRE(unknown_in(space) == 512);
  CHECK_FALSE(space.has({0.01, 0.45, 0.26}));
  space.add(flat_image(look_along({0.0, 0.0, 0.25}, Vector3d::UnitY()), 0.5), {});
  CHECK(unknown_in(space) == 256);
  CHECK(space.has({0.01, 0.45, 0.26}));
  CHECK_FALSE(space.has({0.01, 0.55, 0.26}));
  CHECK_FALSE(space.has({0.01, 0.35, 0.26}));  // outside of the volume
  space.for_each_unknown([&](const Vector3d& p) {
    CHECK(p.y() > 0.5);
    CHECK_FALSE(space.has(p));
  });
  space.add(flat_image(look_along({0.0, 1.0, 0.25}, -Vector3d::UnitY()), 0.5), {});
  CHECK(unknown_in(space) == 0);
}

TEST_CASE("known space: the voxels of a large volume are larger") {
  CHECK(KnownSpace(box({0.0, 0.5, 0.2}, 0.1), 0.02).edge() == 0.02);
  const double edge = KnownSpace(box(Vector3d::Zero(), 5.0), 0.02).edge();
  CHECK_THROWS_AS(KnownSpace(box(Vector3d::Zero(), 1.0), 0.0), ParameterError);
  CHECK_THROWS_AS(KnownSpace(Aabb{}, 0.1), InputError);
  CHECK(std::pow(std::ceil(10.0 / edge), 3) <= 2e6);
  CHECK(std::pow(std::ceil(10.0 / (edge / 1.3)), 3) > 2e6);
}
