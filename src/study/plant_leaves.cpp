// SPDX-License-Identifier: BSD-3-Clause
#include "plant_leaves.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "leaf_sheet.hpp"

namespace agrisee::study {

Mesh thickened(const Mesh& sheet, double thickness) {
  std::vector<Eigen::Vector3d> normals(sheet.vertices.size(), Eigen::Vector3d::Zero());
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : sheet.triangles) {
    const Eigen::Vector3d a = sheet.vertices[t[0]].cast<double>();
    const Eigen::Vector3d n = (sheet.vertices[t[1]].cast<double>() - a).cross(sheet.vertices[t[2]].cast<double>() - a);
    for (std::size_t i = 0; i < 3; ++i) {
      normals[t[i]] += n;
      edges.insert({t[i], t[(i + 1) % 3]});
    }
  }
  Mesh mesh;
  for (const double side : {0.5, -0.5})
    for (std::size_t i = 0; i < normals.size(); ++i)
      mesh.vertices.push_back(
          (sheet.vertices[i].cast<double>() + side * thickness * normals[i].normalized()).cast<float>());
  const auto n = static_cast<std::uint32_t>(normals.size());
  for (const auto& t : sheet.triangles) {
    mesh.triangles.push_back(t);
    mesh.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
  }
  for (const auto& [a, b] : edges) {
    if (edges.count({b, a})) continue;  // inside the sheet
    mesh.triangles.push_back({b, a, a + n});
    mesh.triangles.push_back({b, a + n, b + n});
  }
  return mesh;
}

Mesh draw_leaflet(const LeafStyle& style, double length, Rng& rng) {
  constexpr int kRows = 16, kAcross = 3;  // rows along the midrib, strips on either side of it
  const double width = style.width * length * rng.uniform(0.9, 1.1);
  const double cup = rng.uniform(-0.35, 0.45), droop = rng.uniform(0.05, 0.4) * length;
  const double twist = rng.uniform(-0.7, 0.7), bend = rng.uniform(-0.1, 0.1) * length;
  const double ruffle = rng.uniform(0.0, 0.18), phase = rng.uniform(0.0, kTwoPi);
  Mesh mesh;
  for (int i = 0; i <= kRows; ++i) {
    const double t = static_cast<double>(i) / kRows;
    const double half = leaf_half_width(i, kRows, width, 1.0 - style.teeth);
    for (int j = -kAcross; j <= kAcross; ++j) {
      const double s = static_cast<double>(j) / kAcross;
      const double wave = ruffle * std::abs(s) * std::sin(phase + 14.0 * t + (j < 0 ? 2.0 : 0.0));
      const double y = half * s, z = half * (cup * s * s + wave), turn = twist * t;
      mesh.vertices.push_back(Eigen::Vector3d(length * t * (1.0 - 0.08 * t),
                                              y * std::cos(turn) - z * std::sin(turn) + bend * t * t,
                                              y * std::sin(turn) + z * std::cos(turn) - droop * t * t)
                                  .cast<float>());
    }
  }
  connect_rows(mesh, kRows, 2 * kAcross + 1);
  return mesh;
}

namespace {

/// A polyline with a position and a direction at every share of its length.
class LeafRachis {
 public:
  explicit LeafRachis(const Polyline& path) : path_(path), length_(path.size(), 0.0) {
    for (std::size_t i = 1; i < path.size(); ++i) length_[i] = length_[i - 1] + (path[i] - path[i - 1]).norm();
  }
  Eigen::Vector3d at(double share) const {
    const std::size_t i = piece(share);
    const double piece_length = std::max(1e-12, length_[i + 1] - length_[i]);
    return path_[i] + (share * length_.back() - length_[i]) / piece_length * (path_[i + 1] - path_[i]);
  }
  Eigen::Vector3d along(double share) const {
    const std::size_t i = piece(share);
    return (path_[i + 1] - path_[i]).normalized();
  }

 private:
  std::size_t piece(double share) const {
    std::size_t i = 0;
    while (i + 2 < path_.size() && length_[i + 1] < share * length_.back()) ++i;
    return i;
  }
  const Polyline& path_;
  std::vector<double> length_;
};

/// Appends one leaflet, which grows from `base` along `direction`, its upper side towards `up`.
void append_leaflet(CompoundLeaf& leaf, const LeafStyle& style, const Eigen::Vector3d& base,
                    const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double length, Rng& rng) {
  const Eigen::Vector3d x = direction.normalized();
  Eigen::Vector3d y = up.cross(x);
  y = y.norm() > 1e-3 ? y.normalized() : any_orthogonal(x);
  Pose pose = Pose::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = y;
  pose.linear().col(2) = x.cross(y);
  const double stalk = rng.uniform(0.08, 0.16) * length;
  pose.translation() = base + stalk * x;
  pose.rotate(Eigen::AngleAxisd(rng.uniform(-0.45, 0.45), Eigen::Vector3d::UnitX()));
  append(leaf.blades, transformed(thickened(draw_leaflet(style, length, rng), kBladeThickness), pose));
  append(leaf.stalks, tube_mesh({base, base + (stalk + 0.02 * length) * x}, 0.0008, 0.0006, 5));
}

}  // namespace

CompoundLeaf draw_compound_leaf(const LeafStyle& style, const Polyline& rachis, const Eigen::Vector3d& outward,
                                double scale, Rng& rng) {
  CompoundLeaf leaf;
  const LeafRachis path(rachis);
  int leaflets = style.leaflets_min +
                 static_cast<int>(rng.below(static_cast<std::uint64_t>(style.leaflets_max - style.leaflets_min + 1)));
  if (!style.alternate && leaflets % 2 == 0) --leaflets;
  const int nodes = style.alternate ? leaflets - 1 : (leaflets - 1) / 2;
  const double spread = rng.uniform(deg(50), deg(72)), sag = rng.uniform(0.0, 0.35);
  for (int k = 0; k < nodes; ++k) {
    const double rank = nodes > 1 ? static_cast<double>(k) / (nodes - 1) : 1.0;
    const double share = style.start + (0.96 - style.start) * (nodes > 1 ? 0.88 * rank : 1.0);
    const Eigen::Vector3d t = path.along(share);
    Eigen::Vector3d up = outward + Eigen::Vector3d(0.0, 0.0, 0.7);
    up -= up.dot(t) * t;
    up = up.norm() > 1e-3 ? up.normalized() : any_orthogonal(t);
    const Eigen::Vector3d side = up.cross(t);
    const double size = style.length * scale * (0.7 + 0.45 * std::sin(kPi * (0.2 + 0.6 * rank)));
    for (const double s : {1.0, -1.0}) {
      if (style.alternate && (s > 0.0) != (k % 2 == 0)) continue;
      const double angle = spread + rng.uniform(-0.15, 0.15);
      const Eigen::Vector3d direction =
          std::cos(angle) * t + s * std::sin(angle) * side - sag * Eigen::Vector3d::UnitZ();
      append_leaflet(leaf, style, path.at(share), direction, up, size * rng.uniform(0.85, 1.12), rng);
    }
  }
  const Eigen::Vector3d t = path.along(1.0);
  append_leaflet(leaf, style, rachis.back() - 0.003 * t, t, outward + Eigen::Vector3d(0.0, 0.0, 0.7),
                 style.length * scale * rng.uniform(1.1, 1.35), rng);
  append(leaf.stalks, tube_mesh(rachis, 0.0019, 0.0009, 7));
  return leaf;
}

}  // namespace agrisee::study
