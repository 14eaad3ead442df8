// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/base_search.hpp>
#include <agrisee/study/greedy.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace agrisee::study {
namespace {

/// True for a point inside a solid; its surface does not count.
bool inside(const KeepOut& space, const Eigen::Vector3d& p) {
  constexpr double kSurface = 1e-9;  // m
  if (const Box* box = std::get_if<Box>(&space.shape))
    return ((p - box->center).cwiseAbs() - 0.5 * box->size).maxCoeff() < -kSurface;
  const Cylinder& c = std::get<Cylinder>(space.shape);
  const Eigen::Vector3d d = p - c.center;
  return std::hypot(d.x(), d.y()) < c.radius - kSurface && std::abs(d.z()) < 0.5 * c.height - kSurface;
}

/// The solid that a base moved to `base` would stand in; null if there is none. What the robot stands on moves along.
const KeepOut* blocking(const Workcell& cell, const Eigen::Vector3d& base) {
  for (const KeepOut& space : cell.keep_out)
    if (!stands_on(cell, space) && inside(space, base)) return &space;
  return nullptr;
}

/// The figures of one place.
/// @param moved the workcell with the robot there
BasePlace judge_place(const TracedScene& scene, const Samples& samples, const Workcell& cell, const Workcell& moved,
                      const BaseSearchParameters& parameters) {
  BasePlace place;
  place.base = moved.world_T_base.translation();
  if (const KeepOut* solid = blocking(cell, place.base)) {
    place.blocked = true;
    place.blocked_by = solid->name;
    return place;
  }
  const Observability seen = observable(scene, samples, moved, parameters.limit);
  if (seen.views.empty()) return place;
  place.poses = seen.views.size();
  place.observable = share(samples, seen.observable);
  place.least = 1.0;
  for (const FruitShare& fruit : fruit_shares(samples, seen.observable))
    place.least = std::min(place.least, fruit.observable);
  place.views = frontal_order(seen, samples, moved, parameters.limit.cover_radius).views_for(parameters.share);
  return place;
}

/// Sort places best first, see base_search().
void sort_places(std::vector<BasePlace>& places, const Eigen::Vector3d& present) {
  std::stable_sort(places.begin(), places.end(), [&](const BasePlace& a, const BasePlace& b) {
    if (a.blocked != b.blocked) return b.blocked;
    if (a.observable != b.observable) return a.observable > b.observable;
    if (a.least != b.least) return a.least > b.least;
    const double near_a = (a.base - present).squaredNorm(), near_b = (b.base - present).squaredNorm();
    if (near_a != near_b) return near_a < near_b;
    return a.base.x() != b.base.x() ? a.base.x() < b.base.x() : a.base.y() < b.base.y();
  });
}

}  // namespace

bool stands_on(const Workcell& cell, const KeepOut& space) {
  return distance(space, cell.world_T_base * Eigen::Vector3d(0.0, 0.0, -0.05)) == 0.0 ||
         inside(space, cell.world_T_base.translation());
}

Workcell with_base_moved(const Workcell& cell, const Eigen::Vector3d& shift) {
  Workcell out = cell;
  for (KeepOut& space : out.keep_out)
    if (stands_on(cell, space)) std::visit([&](auto& shape) { shape.center += shift; }, space.shape);
  out.world_T_base.translation() += shift;
  return out;
}

std::vector<BasePlace> base_search(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                                   const BaseSearchParameters& parameters, int threads) {
  parameters.check();
  plan::mount_of(cell).check();
  const int n = static_cast<int>(std::floor(parameters.range / parameters.step + 1e-9)), side = 2 * n + 1;
  std::vector<BasePlace> places(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  parallel_for(
      places.size(), threads,
      [&](std::size_t i) {
        const int ix = static_cast<int>(i) % side - n, iy = static_cast<int>(i) / side - n;
        const Workcell moved = with_base_moved(cell, {ix * parameters.step, iy * parameters.step, 0.0});
        places[i] = judge_place(scene, samples, cell, moved, parameters);
        places[i].present = ix == 0 && iy == 0;
      },
      1);
  sort_places(places, cell.world_T_base.translation());
  return places;
}

}  // namespace agrisee::study
