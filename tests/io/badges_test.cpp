// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/badges.hpp"

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::io;

namespace {

const Rectangle kPanel{{0.0f, 0.0f}, {800.0f, 600.0f}};

/// How far a badge is from a rectangle; negative where it covers it.
float gap(const Badge& badge, const Rectangle& r) {
  return (badge.center - badge.center.cwiseMax(r.min).cwiseMin(r.max)).norm() - badge.radius;
}

}  // namespace

TEST_CASE("badges that have room stand where they should") {
  const std::vector<Badge> wanted{{{100.0f, 100.0f}, 20.0f}, {{141.0f, 100.0f}, 20.0f}};
  const std::vector<Badge> placed = place_badges(wanted, {}, kPanel);
  REQUIRE(placed.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) CHECK(placed[i].center == wanted[i].center);
}

TEST_CASE("badges cover neither one another nor the legend, and stay near and inside") {
  Rng rng(3);
  const std::vector<Rectangle> taken{{{0.0f, 560.0f}, {200.0f, 600.0f}}, {{700.0f, 500.0f}, {800.0f, 600.0f}}};
  for (int round = 0; round < 20; ++round) {
    std::vector<Badge> wanted;
    for (int i = 0; i < 30; ++i)  // crowded; some in the corners
      wanted.push_back({{static_cast<float>(rng.uniform() * (i % 3 ? 150.0 : 800.0)),
                         static_cast<float>(450.0 + rng.uniform() * 150.0)},
                        static_cast<float>(12.0 + 10.0 * rng.uniform())});
    const std::vector<Badge> placed = place_badges(wanted, taken, kPanel);
    REQUIRE(placed.size() == wanted.size());
    float farthest = 0.0f;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Badge& a = placed[i];
      CHECK(a.radius == wanted[i].radius);
      for (const Rectangle& r : taken) CHECK(gap(a, r) >= 0.0f);
      CHECK((a.center.x() >= a.radius && a.center.y() >= a.radius && a.center.x() <= 800.0f - a.radius &&
             a.center.y() <= 600.0f - a.radius));
      for (std::size_t k = 0; k < i; ++k)
        CHECK((a.center - placed[k].center).norm() >= a.radius + placed[k].radius - 1e-3f);
      farthest = std::max(farthest, (a.center - wanted[i].center).norm());
    }
    CHECK(farthest < 300.0f);
  }
}

TEST_CASE("a badge without any room stays where it should stand") {
  const std::vector<Badge> wanted{{{400.0f, 300.0f}, 500.0f}};
  CHECK(place_badges(wanted, {}, kPanel)[0].center == wanted[0].center);
}
