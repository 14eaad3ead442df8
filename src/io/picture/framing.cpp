// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/framing.hpp"

#include <agrisee/core/median.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::io {
namespace {

/// A box around the points (only around those of fruit, if labels are given), with a margin. Along each axis the
/// outermost hundredth of the points at either end is ignored.
Aabb extent(const Cloud& cloud, const Labels* labels) {
  Aabb box;
  std::vector<float> values;
  for (int a = 0; a < 3; ++a) {
    values.clear();
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (is_finite(cloud.points[i]) && (!labels || (*labels)[i] > 0)) values.push_back(cloud.points[i][a]);
    if (values.empty()) return {};
    const std::size_t cut = values.size() / 100;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cut), values.end());
    box.min[a] = double(values[cut]);
    std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(cut), values.end());
    box.max[a] = double(values[values.size() - 1 - cut]);
  }
  const double margin = 0.04 * box.size().norm() + 1e-3;
  box.min.array() -= margin;
  box.max.array() += margin;
  return box;
}

/// The mean direction of the normals (unit); zero without normals.
Eigen::Vector3f mean_normal(const Cloud& cloud) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& n : cloud.normals)
    if (n.allFinite()) sum += n;
  return sum.normalized();
}

}  // namespace

std::vector<Eigen::Vector3d> corners(const Aabb& box) {
  std::vector<Eigen::Vector3d> out;
  for (int i = 0; i < 8; ++i)
    out.emplace_back(i & 1 ? box.max.x() : box.min.x(), i & 2 ? box.max.y() : box.min.y(),
                     i & 4 ? box.max.z() : box.min.z());
  return out;
}

Framing frame(const ScanResult& result, const Workcell& workcell) {
  Framing framing;
  const bool volume = !workcell.scan_volume.empty();
  Aabb box = extent(result.cloud, volume && !result.labels.empty() ? &result.labels : nullptr);
  if (box.empty()) box = extent(result.cloud, nullptr);
  if (volume) {
    framing.forward = workcell.scan_volume.center() - workcell.world_T_base.translation();
    framing.forward.z() = 0.0;
    if (box.empty()) box = workcell.scan_volume;
  } else {
    if (box.empty()) box.min.setConstant(-0.2), box.max.setConstant(0.2);
    const Eigen::Vector3f direction = mean_normal(result.cloud);
    if (std::abs(direction.z()) > 0.8f) {  // probably a cloud in the frame of a sensor: z forward, y down
      framing.forward = Eigen::Vector3d(0.0, 0.0, direction.z() < 0.0f ? 1.0 : -1.0);
      framing.up = -Eigen::Vector3d::UnitY();
    } else {
      framing.forward = Eigen::Vector3d(-double(direction.x()), -double(direction.y()), 0.0);
    }
  }
  if (!(framing.forward.norm() > 1e-6)) framing.forward = Eigen::Vector3d::UnitY();
  framing.forward.normalize();
  framing.subjects = corners(box);
  for (const Fruit& fruit : result.fruits)
    if (fruit.body && fruit.body->radii.allFinite() && fruit.body->center.allFinite() && fruit.body->radii.norm() < 0.5)
      for (int k = 0; k < 6; ++k) {
        const Eigen::Vector3d axis = (k < 3 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(k % 3);
        framing.subjects.push_back(fruit.body->center + 1.15 * fruit.body->radii[0] * axis);
      }
  return framing;
}

float splat_radius(const Cloud& cloud) {
  constexpr std::size_t kSample = 400;
  if (cloud.size() < 2) return 0.003f;
  const KdTree<float> tree(cloud);
  Neighbors<float> near;
  std::vector<float> distances;
  const std::size_t step = std::max<std::size_t>(cloud.size() / kSample, 1);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    tree.knn(cloud.points[i], 6, near);
    if (near.size() > 1) distances.push_back(near.back().distance);
  }
  if (distances.empty()) return 0.003f;
  return std::clamp(1.15f * median(distances), 0.00005f, 0.006f);
}

}  // namespace agrisee::io
