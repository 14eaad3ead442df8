// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where to put the arm: what it could observe from places around the one where it stands. World frame, metres. Cost:
/// about a third of a second a place on one core, nearly all of it rays.
#pragma once

#include <agrisee/study/greedy_planner.hpp>

namespace agrisee::study {

/// Which places are tried, and how thoroughly.
struct BaseSearchParameters {
  double range = 0.3;              ///< farthest that the base is moved along world's x and y, either way (m)
  double step = 0.1;               ///< between the places (m)
  double share = 0.95;             ///< of what can be observed, for which the views are counted
  LimitParameters limit = {1000};  ///< how densely poses are tried at each place: less so than where there is one

  /// The paper searches no place; the defaults.
  static BaseSearchParameters paper() { return {}; }
  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(std::isfinite(range) && range >= 0.0, "range", "not negative and finite", range);
    check_parameter(std::isfinite(step) && step > 0.0, "step", "positive and finite", step);
    check_parameter(range <= 50.0 * step, "step", "at least a fiftieth of the range", step);
    check_parameter(share > 0.0 && share <= 1.0, "share", "in (0, 1]", share);
    limit.check();
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("range", p.range);
    f("step", p.step);
    f("share", p.share);
    f("limit", p.limit);
  }
};

/// What the arm could observe from one place.
struct BasePlace {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< the base's origin (m, world)
  bool present = false;                            ///< where the arm stands now
  std::string blocked_by;                          ///< name of the solid that the base would stand in
  bool blocked = false;                            ///< it would; nothing else was asked then
  std::size_t poses = 0;                           ///< sensor poses within reach that see any of the fruit
  double observable = 0.0;                         ///< share of the samples that any of them sees
  double least = 0.0;                              ///< least such share of a fruit
  std::optional<std::size_t> views;  ///< how many greedy views, the first frontal, cover `share` of the observable;
                                     ///< none where nothing can be observed
};

namespace detail {

/// True inside a solid, its surface excluded.
inline bool inside(const KeepOut& space, const Eigen::Vector3d& p) {
  constexpr double kSurface = 1e-9;  // m
  if (const Box* box = std::get_if<Box>(&space.shape))
    return ((p - box->center).cwiseAbs() - 0.5 * box->size).maxCoeff() < -kSurface;
  const Cylinder& c = std::get<Cylinder>(space.shape);
  const Eigen::Vector3d d = p - c.center;
  return std::hypot(d.x(), d.y()) < c.radius - kSurface && std::abs(d.z()) < 0.5 * c.height - kSurface;
}

}  // namespace detail

/// True for a solid that the arm of a workcell stands on: it holds the point 5 cm below the base, along the base's z,
/// or the base's very origin (a thin plate).
inline bool stands_on(const Workcell& cell, const KeepOut& space) {
  return distance(space, cell.world_T_base * Eigen::Vector3d(0.0, 0.0, -0.05)) == 0.0 ||
         detail::inside(space, cell.world_T_base.translation());
}

/// A workcell whose arm is moved, with all that it stands on (see stands_on); everything else stays.
/// @param cell as it is
/// @param shift m, world
inline Workcell with_base_moved(const Workcell& cell, const Eigen::Vector3d& shift) {
  Workcell out = cell;
  for (KeepOut& space : out.keep_out)
    if (stands_on(cell, space)) std::visit([&](auto& shape) { shape.center += shift; }, space.shape);
  out.world_T_base.translation() += shift;
  return out;
}

/// What the arm could observe from places on a grid around the present one, along world's x and y; z and rotation stay,
/// the scan volume too. A place is blocked when the base's origin would fall inside a solid that stays. The figures of
/// the present place are those of `observable` with the same parameters.
/// @param scene what is seen
/// @param samples of the fruit's surface
/// @param cell arm, sensor and spaces to keep out of
/// @param params see their struct
/// @param threads  places are shared among them; results do not depend on their number
/// @return the best first: by observable share, least share of a fruit, nearness to the present place, then x and y;
/// blocked ones last
/// @throws ParameterError for unusable parameters or an unsound mounting
inline std::vector<BasePlace> base_search(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                                          const BaseSearchParameters& params = {}, int threads = 1) {
  params.check();
  plan::mount_of(cell).check();
  const int n = static_cast<int>(std::floor(params.range / params.step + 1e-9)), side = 2 * n + 1;
  std::vector<BasePlace> places(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  parallel_for(
      places.size(), threads,
      [&](std::size_t i) {
        const int ix = static_cast<int>(i) % side - n, iy = static_cast<int>(i) / side - n;
        const Workcell moved = with_base_moved(cell, {ix * params.step, iy * params.step, 0.0});
        BasePlace& place = places[i];
        place.base = moved.world_T_base.translation();
        place.present = ix == 0 && iy == 0;
        for (std::size_t k = 0; k < cell.keep_out.size() && !place.blocked; ++k) {
          if (stands_on(cell, cell.keep_out[k]) || !detail::inside(cell.keep_out[k], place.base)) continue;
          place.blocked = true;
          place.blocked_by = cell.keep_out[k].name;
        }
        if (place.blocked) return;
        const Observability seen = observable(scene, samples, moved, params.limit);
        if (seen.views.empty()) return;
        place.poses = seen.views.size();
        place.observable = share(samples, seen.observable);
        place.least = 1.0;
        for (const FruitShare& fruit : fruit_shares(samples, seen.observable))
          place.least = std::min(place.least, fruit.observable);
        place.views = frontal_order(seen, samples, moved, params.limit.cover_radius).views_for(params.share);
      },
      1);
  const Eigen::Vector3d present = cell.world_T_base.translation();
  std::stable_sort(places.begin(), places.end(), [&](const BasePlace& a, const BasePlace& b) {
    if (a.blocked != b.blocked) return b.blocked;
    if (a.observable != b.observable) return a.observable > b.observable;
    if (a.least != b.least) return a.least > b.least;
    const double near_a = (a.base - present).squaredNorm(), near_b = (b.base - present).squaredNorm();
    if (near_a != near_b) return near_a < near_b;
    return a.base.x() != b.base.x() ? a.base.x() < b.base.x() : a.base.y() < b.base.y();
  });
  return places;
}

}  // namespace agrisee::study
