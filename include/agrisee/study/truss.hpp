// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Procedural tomato trusses with their ground truth and a workcell to scan them in. World frame (z up, the robot at
/// the origin looks along +y), metres. Cost: usually below half a second.
#pragma once

#include <agrisee/study/truss_parts.hpp>
#include <agrisee/study/visibility.hpp>
#include <agrisee/workcell.hpp>

namespace agrisee::study {

/// A truss, ready to be scanned.
struct Truss {
  Workcell workcell;  ///< robot, sensor, scan volume and keep-out; unnamed
  Scene scene;        ///< fruit with ids 1.. , then stem, then leaflets
  GroundTruth truth;  ///< of every fruit, in the order of ids
};

/// What makes a fruit hidden or not, as a share of its surface seen from straight in front (any incidence).
constexpr double kHiddenBelow = 0.15;
constexpr double kVisibleAbove = 0.27;  ///< what is not hidden shows at least this share

/// The sensor position from which fruit count as hidden or not: 0.38 m straight in front of the middle of the truss,
/// reachable or not (m, world).
inline Eigen::Vector3d frontal_eye(const Eigen::Vector3d& truss_center) {
  return truss_center - kFrontalDistance * Eigen::Vector3d::UnitY();
}

/// The place in which a truss is scanned: robot at the origin; a scan volume around the objects, at least 0.34 x 0.32 x
/// 0.44 m about the truss's usual place; keep-out for platform, plant and a cylinder that keeps the sensor 0.25 m off
/// the truss.
/// @param truss box around the fruit (m)  @param center middle of the truss (m)
inline Workcell truss_workcell(const Aabb& truss, const Eigen::Vector3d& center) {
  Workcell cell;
  const Eigen::Vector3d usual(0.015, 0.545, 0.21), shift = center - usual;
  cell.scan_volume.extend(Eigen::Vector3d(-0.17, 0.40, -0.02) + shift);
  cell.scan_volume.extend(Eigen::Vector3d(0.17, 0.72, 0.42) + shift);
  cell.scan_volume.extend(truss.min - Eigen::Vector3d::Constant(0.01));
  cell.scan_volume.extend(truss.max + Eigen::Vector3d::Constant(0.01));
  double reach = 0.0;  // of the fruit from the axis of the cylinder, on the robot's side
  for (const double x : {truss.min.x(), truss.max.x()}) reach = std::max(reach, std::abs(x - center.x()));
  reach = std::max(reach, center.y() - truss.min.y());
  const double radius = std::max(0.35, 0.25 + reach);
  const double height = std::max(0.9, truss.size().z() + 0.5);
  cell.keep_out.push_back({"platform", Box{{0.0, -0.1, -0.06}, {0.7, 0.7, 0.1}}});
  cell.keep_out.push_back(
      {"plant", Box{Eigen::Vector3d(0.0, 0.85, 0.3) + Eigen::Vector3d(0.0, shift.y(), 0.0), {1.2, 0.5, 1.6}}});
  cell.keep_out.push_back({"cluster", Cylinder{center, radius, height}});
  return cell;
}

namespace detail {

/// Meshes and truth of a layout.
inline Truss build(const TrussLayout& layout, const Eigen::Vector3d& center, int leaflets, Rng& rng) {
  Truss truss;
  Aabb box;
  for (std::size_t i = 0; i < layout.fruits.size(); ++i) {
    const PlacedFruit& fruit = layout.fruits[i];
    const Mesh mesh = transformed(fruit_mesh(fruit.shape), fruit.world_T_body);
    for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v.cast<double>());
    truss.scene.objects.push_back({static_cast<int>(i) + 1, ObjectClass::fruit, mesh});
  }
  truss.scene.objects.push_back({0, ObjectClass::stem, stem_mesh(layout, rng)});
  const double size = layout.rachis_radius / 0.07;
  for (int i = 0; i < leaflets; ++i)
    truss.scene.objects.push_back({0, ObjectClass::leaf, leaflet_mesh(layout, size, rng)});
  truss.workcell = truss_workcell(box, center);
  truss.truth = ground_truth(truss.scene);
  const TracedScene traced(truss.scene);
  SampleParameters params;
  params.area = std::min(params.area, 0.001 * area(truss.scene.objects.front().mesh));
  const Samples samples = fruit_samples(truss.scene, params);
  const Flags seen = visible_from(traced, samples, layout.eye);
  for (std::size_t i = 0; i < layout.fruits.size(); ++i) {
    TrueFruit& fruit = truss.truth.fruits[i];
    fruit.growth_axis = layout.fruits[i].world_T_body.linear().col(2);
    fruit.hidden = layout.fruits[i].hidden;
    fruit.visible_share = share(samples, seen, fruit.id);
  }
  return truss;
}

/// How far a truss is from what was asked for; 0 = it is as asked.
inline double shortfall(const Truss& truss) {
  double worst = 0.0;
  for (const TrueFruit& f : truss.truth.fruits)
    worst = std::max(worst, *f.hidden ? *f.visible_share - (kHiddenBelow - 0.01) : kVisibleAbove - *f.visible_share);
  return worst;
}

/// Draw layouts until one is as asked, each less varied than the one before.
template <typename Draw>
Truss draw_until_good(const TrussParameters& params, Draw&& draw_layout) {
  constexpr int kAttempts = 60;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Rng rng(params.seed, 0x7255, static_cast<std::uint64_t>(attempt));
    const double spread = std::max(0.0, 1.0 - attempt / (0.7 * kAttempts));
    const TrussLayout layout = draw_layout(spread, rng);
    if (layout.deepest() > 6e-4) continue;
    Truss truss = build(layout, params.center, params.leaflets, rng);
    if (shortfall(truss) <= 0.0) return truss;
  }
  throw ParameterError("total, hidden, leaflets: no truss of " + std::to_string(params.total) + " fruit with " +
                       std::to_string(params.hidden) + " hidden and " + std::to_string(params.leaflets) +
                       " leaflets was found with seed " + std::to_string(params.seed));
}

}  // namespace detail

/// A truss from a seed: `hidden` of its fruit show less than 15 % of their surface from frontal_eye(), the others at
/// least 27 %; no two interpenetrate by more than 1 mm. Ids run from top to bottom, the hidden ones last.
/// @throws ParameterError for parameters out of range, or that no truss could be found for
inline Truss make_truss(const TrussParameters& params) {
  params.check();
  return detail::draw_until_good(params, [&](double spread, Rng& rng) { return herringbone(params, spread, rng); });
}

}  // namespace agrisee::study
