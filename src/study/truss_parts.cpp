// SPDX-License-Identifier: BSD-3-Clause
#include "truss_parts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace agrisee::study {

namespace {

/// Depth (m) of the deepest of some points below the surface of any fruit other than number `except`; at least 0.
template <typename Points>
double depth_in_fruit(const TrussLayout& layout, const Points& points, int except = -1) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < layout.fruits.size(); ++i) {
    if (static_cast<int>(i) == except) continue;
    for (const auto& p : points)
      deepest = std::max(deepest, layout.fruits[i].depth(Eigen::Vector3d(p.template cast<double>())));
  }
  return deepest;
}

/// Points of the cubic Bezier curve with the control points a, b, c, d.
std::vector<Eigen::Vector3d> bezier(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                    const Eigen::Vector3d& d, int segments) {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i <= segments; ++i) {
    const double t = static_cast<double>(i) / segments, s = 1.0 - t;
    path.emplace_back(s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d);
  }
  return path;
}

/// The path of the pedicel of fruit i: out of the calyx along the growth axis, then over to the rachis.
std::vector<Eigen::Vector3d> pedicel_path(const TrussLayout& layout, int i) {
  const PlacedFruit& fruit = layout.fruits[static_cast<std::size_t>(i)];
  const Eigen::Vector3d axis = fruit.world_T_body.linear().col(2);
  const double size = fruit.shape.equatorial, top = fruit.shape.radius(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d calyx = fruit.center() + top * axis;
  std::vector<Eigen::Vector3d> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double rise : {0.2, 0.5, 0.0, 0.9, -0.3, -0.6})
    for (const double out : {0.35, 0.6, 0.2}) {
      const Eigen::Vector3d node = at_height(layout.rachis, calyx.z() + rise * size);
      const Eigen::Vector3d mid = node + 0.4 * out * (calyx - node) + 0.15 * size * Eigen::Vector3d::UnitZ();
      std::vector<Eigen::Vector3d> path = bezier(calyx, calyx + out * size * axis, mid, node, 14);
      // The pedicel may touch its own fruit where it leaves it, but nowhere else.
      const std::vector<Eigen::Vector3d> rest(path.begin() + 3, path.end());
      double length = 0.0;
      for (std::size_t k = 1; k < path.size(); ++k) length += (path[k] - path[k - 1]).norm();
      const double cost = depth_in_fruit(layout, path, i) + depth_in_fruit(layout, rest) + 0.02 * length;
      if (cost < least) least = cost, best = std::move(path);
    }
  best.insert(best.begin(), calyx - 0.001 * axis);  // it starts inside the fruit, so that no gap is left
  return best;
}

}  // namespace

void append_pedicels(Mesh& stem, const TrussLayout& layout, double radius, bool calyces, Rng& rng) {
  for (std::size_t i = 0; i < layout.fruits.size(); ++i) {
    const PlacedFruit& fruit = layout.fruits[i];
    append(stem, tube_mesh(pedicel_path(layout, static_cast<int>(i)), 0.75 * radius, 0.6 * radius, 8));
    if (!calyces) continue;
    const int sepals = 5 + static_cast<int>(rng.below(2));
    const double length = rng.uniform(0.5, 0.8) * fruit.shape.equatorial, phase = rng.uniform(0.0, kTwoPi);
    const double lift = rng.uniform(0.08, 0.25) * fruit.shape.equatorial;
    Mesh calyx;
    for (const double shrink : {1.0, 0.8, 0.6, 0.45, 0.3}) {
      calyx = transformed(calyx_mesh(fruit.shape, sepals, shrink * length, shrink * lift, phase), fruit.world_T_body);
      if (depth_in_fruit(layout, calyx.vertices, static_cast<int>(i)) < 5e-4) break;
    }
    append(stem, calyx);
  }
}

Mesh stem_mesh(const TrussLayout& layout, Rng& rng) {
  std::vector<Eigen::Vector3d> path = layout.rachis;
  const double size = layout.rachis_radius / 0.07;
  const Eigen::Vector3d top = path.front();
  const auto peduncle = bezier(top + Eigen::Vector3d(0.0, 1.6 * size, 0.5 * size), top + Eigen::Vector3d(0, size, size),
                               top + Eigen::Vector3d(0, 0, 0.8 * size), top, 8);
  path.insert(path.begin(), peduncle.begin(), peduncle.end() - 1);
  Mesh stem = tube_mesh(path, 1.25 * layout.rachis_radius, 0.7 * layout.rachis_radius);
  append_pedicels(stem, layout, layout.rachis_radius, true, rng);
  return stem;
}

Mesh leaflet_mesh(const TrussLayout& layout, double size, Rng& rng) {
  Mesh best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 60 && least > 2e-4; ++i) {
    const double height = rng.uniform(0.0, 0.7);
    const auto node = layout.rachis[static_cast<std::size_t>(height * static_cast<double>(layout.rachis.size() - 1))];
    const double azimuth = rng.uniform(0.0, kTwoPi), pitch = rng.uniform(-0.2, 0.7);
    const double length = rng.uniform(1.6, 2.4) * size, stalk = rng.uniform(0.8, 2.2) * size;
    const Pose pose =
        pose_from_xyz_rpy(node, {rng.uniform(-0.6, 0.6), -pitch, azimuth}) * Eigen::Translation3d(stalk, 0.0, 0.0);
    const double droop = rng.uniform(0.1, 0.45) * length, fold = rng.uniform(0.15, 0.5);
    const double width = rng.uniform(0.5, 0.65) * length;
    Mesh leaf = transformed(leaf_mesh(length, width, fold, droop), pose);
    const Eigen::Vector3d base = pose.translation(), along = pose.linear().col(0);
    append(leaf,
           tube_mesh(bezier(node, node + 0.4 * stalk * Eigen::Vector3d::UnitZ(), base - 0.3 * stalk * along, base, 8),
                     0.5 * layout.rachis_radius, 0.4 * layout.rachis_radius, 6));
    const double depth = depth_in_fruit(layout, leaf.vertices);
    if (depth < least) least = depth, best = std::move(leaf);
  }
  return best;
}

}  // namespace agrisee::study
