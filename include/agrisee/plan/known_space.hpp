// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which part of the scan volume sight lines have reached, as voxels. Metres, world. Cost of a view: linear in the
/// voxels. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/fuse/parameters.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <cstddef>
#include <vector>

namespace agrisee::plan {

/// The voxels of a volume that some sight line has passed, or ended in.
class KnownSpace {
 public:
  /// Nothing is known.
  /// @param volume to be divided
  /// @param edge of a voxel (m); larger in a volume that would have more than two million
  /// @throws ParameterError for an edge that is not positive; InputError for a volume that is not finite
  KnownSpace(const Aabb& volume, double edge);

  /// Mark the voxels that a view's sight lines have reached.
  void add(const sensor::SurfaceImage& image, const fuse::FreeSpaceParameters& free_space);

  /// Whether a sight line has reached the voxel of a point (m); not so outside of the volume.
  bool has(const Eigen::Vector3d& point) const;

  /// Edge of a voxel (m).
  double edge() const { return edge_; }

  /// Calls f(center) for every voxel that is not known, x fastest.
  template <typename F>
  void for_each_unknown(F&& f) const {
    std::size_t i = 0;
    for (int z = 0; z < dims_[2]; ++z)
      for (int y = 0; y < dims_[1]; ++y)
        for (int x = 0; x < dims_[0]; ++x, ++i)
          if (!known_[i]) f(center(x, y, z));
  }

 private:
  Eigen::Vector3d center(int x, int y, int z) const {
    return min_ + edge_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
  }

  Eigen::Vector3d min_;
  double edge_;
  Eigen::Vector3i dims_;     // voxels along x, y, z
  std::vector<char> known_;  // one per voxel
};

}  // namespace agrisee::plan
