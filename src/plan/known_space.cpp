// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/plan/known_space.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::plan {

KnownSpace::KnownSpace(const Aabb& volume, double edge) : min_(volume.min), edge_(edge) {
  check_parameter(edge > 0.0 && std::isfinite(edge), "edge", "positive", edge);
  check_input(volume.min.allFinite() && volume.max.allFinite(), "known space: the volume is not finite");
  constexpr double kMost = 2e6;
  const Eigen::Vector3d size = volume.size();
  while ((size / edge_).array().ceil().max(1.0).prod() > kMost) edge_ *= 1.3;
  dims_ = (size / edge_).array().ceil().max(1.0).cast<int>();
  known_.assign(std::size_t(dims_[0]) * std::size_t(dims_[1]) * std::size_t(dims_[2]), 0);
}

void KnownSpace::add(const sensor::SurfaceImage& image, const fuse::FreeSpaceParameters& free_space) {
  std::size_t i = 0;
  for (int z = 0; z < dims_[2]; ++z)
    for (int y = 0; y < dims_[1]; ++y)
      for (int x = 0; x < dims_[0]; ++x, ++i)
        if (!known_[i] && fuse::sight(image, center(x, y, z), free_space) != Sight::unknown) known_[i] = 1;
}

bool KnownSpace::has(const Eigen::Vector3d& point) const {
  const Eigen::Array3d at = ((point - min_) / edge_).array();
  if (!((at >= 0.0).all() && (at < dims_.cast<double>().array()).all())) return false;
  const Eigen::Vector3i v = at.cast<int>();
  return known_[(std::size_t(v.z()) * std::size_t(dims_[1]) + std::size_t(v.y())) * std::size_t(dims_[0]) +
                std::size_t(v.x())] != 0;
}

}  // namespace agrisee::plan
