// SPDX-License-Identifier: BSD-3-Clause
#include "plan/body_surface.hpp"

#include <agrisee/fuse/free_space.hpp>

#include <algorithm>

namespace agrisee::plan {

std::optional<Eigen::Vector3d> carved(const Eigen::Vector3d& surface, const Eigen::Vector3d& normal,
                                      const Eigen::Vector3d& center, const std::vector<sensor::SurfaceImage>& images,
                                      const fuse::FreeSpaceParameters& free_space) {
  constexpr double kLeast = 0.5, kStep = 0.07;  // shares of the way from the center
  const auto looked_through = [&](const sensor::SurfaceImage& image, const Eigen::Vector3d& p) {
    if (fuse::sight(image, p, free_space) != Sight::through) return false;
    // Surface that faces the sensor may mirror its light: a sight line without return proves nothing there.
    return image.depth[static_cast<std::size_t>(image.cell(p))] > 0.0f ||
           normal.dot(image.world_T_optical.translation() - p) < 0.0;
  };
  for (double share = 1.0; share > kLeast; share -= kStep) {
    const Eigen::Vector3d p = center + share * (surface - center);
    if (std::none_of(images.begin(), images.end(), [&](const auto& image) { return looked_through(image, p); }))
      return p;
  }
  return std::nullopt;
}

bool is_below_lobe(const Cloud& cloud, const Grid<float>& grid, const Eigen::Vector3d& point,
                   const Eigen::Vector3d& outward, double radius, float cover) {
  constexpr float kFarthest = 0.25f, kFaces = 0.5f;  // share of the radius; cosine
  if (cloud.normals.empty()) return false;
  const Eigen::Vector3f u = outward.cast<float>();
  const float half = 0.5f * kFarthest * static_cast<float>(radius);
  const Eigen::Vector3f middle = point.cast<float>() + half * u;
  bool found = false;
  grid.visit(middle, half + cover, [&](Index index, float) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector3f q = cloud.points[i] - middle;
    const float along = std::clamp(q.dot(u), -half, half);
    found = found || ((q - along * u).squaredNorm() <= cover * cover && cloud.normals[i].dot(u) > kFaces);
  });
  return found;
}

}  // namespace agrisee::plan
