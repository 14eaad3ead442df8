// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/true_ripeness.hpp>
#include <agrisee/study/truss.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include "truss_parts.hpp"
#include "truss_search.hpp"

namespace agrisee::study {

Eigen::Vector3d frontal_eye(const Eigen::Vector3d& truss_center) {
  return truss_center - kViewDistance * Eigen::Vector3d::UnitY();
}

Workcell truss_workcell(const Aabb& truss, const Eigen::Vector3d& center) {
  Workcell cell;
  const Eigen::Vector3d usual(0.015, 0.545, 0.21), shift = center - usual;
  cell.scan_volume.extend(Eigen::Vector3d(-0.17, 0.40, -0.02) + shift);
  cell.scan_volume.extend(Eigen::Vector3d(0.17, 0.72, 0.42) + shift);
  cell.scan_volume.extend(truss.min - Eigen::Vector3d::Constant(0.01));
  cell.scan_volume.extend(truss.max + Eigen::Vector3d::Constant(0.01));
  double reach = 0.0;  // distance of the fruit from the axis of the cylinder, on the robot's side
  for (const double x : {truss.min.x(), truss.max.x()}) reach = std::max(reach, std::abs(x - center.x()));
  reach = std::max(reach, center.y() - truss.min.y());
  constexpr double kArm = 0.18;  // from the robot's axis to the arm's outside where it starts
  const double radius = std::max(0.35, std::min(0.25 + reach, center.head<2>().norm() - kArm));
  const double height = std::max(0.9, truss.size().z() + 0.5);
  cell.keep_out.push_back({"platform", Box{{0.0, -0.1, -0.06}, {0.7, 0.7, 0.1}}});
  cell.keep_out.push_back(
      {"plant", Box{Eigen::Vector3d(0.0, 0.85, 0.3) + Eigen::Vector3d(0.0, shift.y(), 0.0), {1.2, 0.5, 1.6}}});
  cell.keep_out.push_back({"cluster", Cylinder{center, radius, height}});
  return cell;
}

namespace {

/// The ground truth of a layout: what the meshes of the scene tell, and what only the layout knows.
GroundTruth truth_of(const TrussLayout& layout, const Scene& scene) {
  GroundTruth truth = ground_truth(scene);
  const TracedScene traced(scene);
  SampleParameters parameters;
  parameters.area = std::min(parameters.area, 0.001 * area(scene.objects.front().mesh));
  const Samples samples = fruit_samples(scene, parameters);
  const Flags seen = visible_from(traced, samples, layout.eye);
  for (std::size_t i = 0; i < layout.fruits.size(); ++i) {
    TrueFruit& fruit = truth.fruits[i];
    fruit.growth_axis = layout.fruits[i].world_T_body.linear().col(2);
    fruit.hidden = layout.fruits[i].hidden;
    fruit.visible_share = share(samples, seen, fruit.id);
  }
  return truth;
}

/// Makes the meshes, the workcell and the ground truth of a layout.
Truss build(const TrussLayout& layout, const Eigen::Vector3d& center, int leaflets, Rng& rng) {
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
  truss.truth = truth_of(layout, truss.scene);
  return truss;
}

/// The largest amount by which the visible share of a fruit misses what was requested; 0 or less if none does.
double shortfall(const Truss& truss) {
  double worst = 0.0;
  for (const TrueFruit& f : truss.truth.fruits)
    worst = std::max(worst, *f.hidden ? *f.visible_share - (kHiddenBelow - 0.01) : kVisibleAbove - *f.visible_share);
  return worst;
}

}  // namespace

Truss find_truss(const TrussParameters& parameters, const LayoutDraw& draw_layout) {
  constexpr int kAttempts = 60;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Rng rng(parameters.seed, 0x7255, static_cast<std::uint64_t>(attempt));
    const double spread = std::max(0.0, 1.0 - attempt / (0.7 * kAttempts));
    const TrussLayout layout = draw_layout(spread, rng);
    if (layout.deepest() > 6e-4) continue;
    Truss truss = build(layout, parameters.center, parameters.leaflets, rng);
    if (shortfall(truss) <= 0.0) return truss;
  }
  throw ParameterError("total, hidden, leaflets: no truss of " + std::to_string(parameters.total) + " fruit with " +
                       std::to_string(parameters.hidden) + " hidden and " + std::to_string(parameters.leaflets) +
                       " leaflets was found with seed " + std::to_string(parameters.seed));
}

Truss make_truss(const TrussParameters& parameters) {
  parameters.check();
  Truss truss = find_truss(parameters, [&](double spread, Rng& rng) { return herringbone(parameters, spread, rng); });
  ripen(truss.scene, truss.truth, {truss.truth.fruits.size()}, parameters.seed);
  return truss;
}

}  // namespace agrisee::study
