// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fits an ellipsoid to its outlines in images and to the depth of its front. Metres, world frame. Defined in
/// `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <optional>
#include <vector>

namespace agrisee::fuse {

/// A body's outline and front in one view.
struct Silhouette {
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< position (m)
  std::vector<Eigen::Vector3d> rays;                 ///< directions (unit) of sight lines along the outline
  std::vector<double> weights;                       ///< one per ray, 0..1: certainty that it is on the body's outline
  double angle_error = 0.0;                          ///< standard deviation of a ray across the outline (rad)
  double seen = 1.0;                                 ///< share (0..1) of the outline that is not hidden
  std::vector<Eigen::Vector3d> front;                ///< points (m), most of which lie on the front
};

/// Fit an ellipsoid by Gauss-Newton with Tukey's biweight, like fit_ellipsoid. A sight line along the outline touches
/// the body, so its point that is nearest in the body's metric lies on the surface. The rays of one outline count as 16
/// independent ones, fewer if part of it is hidden. Of the front only the mean distance from the surface is used, with
/// a standard deviation of 0.4 % of the distance from the sensor, because time-of-flight cameras flatten round objects.
/// A prior pulls the shape towards a sphere.
/// @param outlines at least one, each from a different view
/// @param start    first guess
/// @param expected prior on the radius; empty: none
/// @param shape_prior standard deviation of the semi-axes from those of a sphere, relative
/// @return empty if the fit degenerates; `rms` is of the rays' distances from the surface
std::optional<EllipsoidFit> fit_silhouettes(const std::vector<Silhouette>& outlines, const Ellipsoid& start,
                                            const std::optional<SizePrior>& expected, double shape_prior = 0.06);

}  // namespace agrisee::fuse
