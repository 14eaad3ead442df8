// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fuses the surfaces of many views into one: surfels at a minimum separation, each the weighted average of all
/// measurements at its place (point-based fusion, cf. Keller et al., 3DV 2013).
///
/// A sample within the separation of a surfel, across the surface, whose normal agrees moves that surfel along its
/// normal, weighted by inverse variance. Along the normal it may be off by the agreement and three standard deviations;
/// the latter count as far as the cells next to the sample's reach (one to two separations), so that noisy samples of a
/// leaf do not join those of a fruit behind it. Any other sample creates a new surfel. The density therefore stays
/// even, however often a place is seen, and independent noise averages out. Metres, world. Cost: a few cells per
/// sample; about 80 bytes of memory per surfel. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/neighbors/cell_blocks.hpp>

#include <vector>

namespace agrisee::fuse {

/// A small piece of measured surface.
struct Surfel {
  Eigen::Vector3f position;  ///< m, world
  Eigen::Vector3f normal;    ///< unit, towards the sensors that saw it
  /// Sum of 1 / sigma^2 of its samples (1/m2): the inverse variance of its position along the normal.
  float weight = 0.0f;
  int view = -1;       ///< the view that created it
  int seen_by = 0;     ///< number of views with a sample
  int last_view = -1;  ///< the last view with a sample
};

/// The growing set of surfels.
class SurfelMap {
 public:
  /// @throws ParameterError
  explicit SurfelMap(const SurfelParameters& parameters = {});

  /// All surfels, in the order in which they were created.
  const std::vector<Surfel>& surfels() const { return surfels_; }
  /// Number of surfels.
  std::size_t size() const { return surfels_.size(); }

  /// Add a sample; one that is not finite is ignored.
  /// @param p position (m, world)
  /// @param n unit normal
  /// @param sigma standard deviation along the normal (m), > 0
  /// @param view the view of the sample
  /// @return true if the sample created a new surfel
  bool add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float sigma, int view);

  /// The surfels as a cloud: points, normals and the views that created them.
  Cloud cloud() const;

 private:
  Index surfel_of(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float sigma) const;

  SurfelParameters parameters_;
  double inverse_cell_ = 1.0;
  float cos_max_ = 1.0f;  // of the angle between the normals of a surfel and its samples
  std::vector<Surfel> surfels_;
  CellBlocks cells_;         // the last surfel created in each cell
  std::vector<Index> next_;  // the one created there before, or -1
};

}  // namespace agrisee::fuse
