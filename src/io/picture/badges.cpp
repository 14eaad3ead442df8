// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/badges.hpp"

#include <agrisee/geometry/spiral.hpp>

#include <cmath>

namespace agrisee::io {
namespace {

constexpr int kPlaces = 24000;   // places tried for a badge
constexpr float kSpread = 2.0f;  // pixels; place k is kSpread * sqrt(k) from the wanted one

bool overlap(const Badge& a, const Badge& b) { return (a.center - b.center).norm() < a.radius + b.radius; }

bool overlap(const Badge& badge, const Rectangle& r) {
  const Eigen::Vector2f nearest = badge.center.cwiseMax(r.min).cwiseMin(r.max);
  return (badge.center - nearest).norm() < badge.radius;
}

bool inside(const Badge& badge, const Rectangle& r) {
  return (badge.center.array() - badge.radius >= r.min.array()).all() &&
         (badge.center.array() + badge.radius <= r.max.array()).all();
}

bool is_free(const Badge& badge, const std::vector<Badge>& others, const std::vector<Rectangle>& taken,
             const Rectangle& within) {
  for (const Badge& other : others)
    if (overlap(badge, other)) return false;
  for (const Rectangle& r : taken)
    if (overlap(badge, r)) return false;
  return inside(badge, within);
}

}  // namespace

std::vector<Badge> place_badges(const std::vector<Badge>& wanted, const std::vector<Rectangle>& taken,
                                const Rectangle& within) {
  std::vector<Badge> placed;
  placed.reserve(wanted.size());
  for (const Badge& badge : wanted) {
    Badge best = badge;
    for (int k = 0; k < kPlaces; ++k) {  // the places of Vogel's spiral fill the plane evenly, the nearest first
      const float distance = kSpread * std::sqrt(static_cast<float>(k)),
                  angle = static_cast<float>(kGoldenAngle) * static_cast<float>(k);
      const Badge at{badge.center + distance * Eigen::Vector2f(std::cos(angle), std::sin(angle)), badge.radius};
      if (!is_free(at, placed, taken, within)) continue;
      best = at;
      break;
    }
    placed.push_back(best);
  }
  return placed;
}

}  // namespace agrisee::io
