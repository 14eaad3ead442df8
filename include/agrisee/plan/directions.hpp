// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Directions to look along, and the first view of a scan. World frame.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/plan/planner.hpp>

#include <algorithm>

namespace agrisee::plan {

/// n directions spread evenly over the unit sphere (spherical Fibonacci lattice).
inline std::vector<Eigen::Vector3d> spread_directions(int n) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(static_cast<std::size_t>(std::max(n, 0)));
  constexpr double kGoldenAngle = 2.399963229728653;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    const double s = std::sqrt(1.0 - z * z);
    out.emplace_back(s * std::cos(kGoldenAngle * i), s * std::sin(kGoldenAngle * i), z);
  }
  return out;
}

/// The frontal direction: from `eye` (the arm's base) to the volume's centre, level.
inline Eigen::Vector3d frontal_direction(const Aabb& volume, const Eigen::Vector3d& eye) {
  Eigen::Vector3d d = volume.center() - eye;
  d.z() = 0.0;
  return d.norm() > 1e-9 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitY());
}

/// The reachable view of the volume's centre nearest to frontal: directions in rising angle from it.
/// @param volume to be scanned (world)
/// @param eye where the robot stands (m, world)
/// @param current joints (rad)
/// @param reach answers for the arm
/// @param band distance and its limits; target and direction are filled in
/// @param skip how many of the reachable ones to pass over
inline std::optional<ReachableView> first_view(const Aabb& volume, const Eigen::Vector3d& eye, const Joints& current,
                                               const Reach& reach, ViewRequest band, int skip = 0) {
  const Eigen::Vector3d frontal = frontal_direction(volume, eye);
  std::vector<Eigen::Vector3d> directions = spread_directions(600);
  directions.push_back(frontal);
  std::stable_sort(directions.begin(), directions.end(),
                   [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.dot(frontal) > b.dot(frontal); });
  band.target = volume.center();
  for (const Eigen::Vector3d& d : directions) {
    throw_if_cancelled();
    band.direction = d;
    auto view = reach(band, current);
    if (view && skip-- == 0) return view;
  }
  return std::nullopt;
}

}  // namespace agrisee::plan
