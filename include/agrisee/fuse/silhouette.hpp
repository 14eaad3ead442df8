// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fits an ellipsoid to its outlines in images and to the depth of its front. Metres, world frame. Defined in
/// `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <optional>
#include <vector>

namespace agrisee::fuse {

/// What one view shows of a body's outline and front.
struct Silhouette {
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< position (m)
  std::vector<Eigen::Vector3d> rays;                 ///< directions (unit) of sight lines along the outline
  std::vector<double> weights;                       ///< of these, 0..1: how surely they are on the body's own outline
  double angle_error = 0.0;                          ///< standard deviation of a ray across the outline (rad)
  double seen = 1.0;                                 ///< share (0..1) of the outline that is not hidden
  std::vector<Eigen::Vector3d> front;                ///< points (m) on the front, or most of them
};

/// What is expected of the radius.
struct ExpectedRadius {
  double radius = 0.0;  ///< m
  double spread = 0.0;  ///< standard deviation, relative
};

/// Fit an ellipsoid: Gauss-Newton with Tukey's biweight, as fit_ellipsoid. A sight line along the outline touches the
/// body, so the point on it that is nearest in the body's metric lies on the surface. The rays of one outline count as
/// 16 independent ones, fewer where part of it is hidden. Of the front only the mean distance from the surface counts,
/// with a standard deviation of 0.4 % of the distance from the sensor: time-of-flight cameras flatten round things. A
/// prior pulls the shape towards a sphere.
/// @param outlines at least one, of one view each
/// @param start    the first guess
/// @param expected what is known of the radius beforehand; empty: nothing
/// @param shape_prior standard deviation of the semi-axes about those of a sphere, relative
/// @return empty if the fit degenerates; `rms` is that of the rays' distances from the surface
std::optional<EllipsoidFit> fit_silhouettes(const std::vector<Silhouette>& outlines, const Ellipsoid& start,
                                            const std::optional<ExpectedRadius>& expected, double shape_prior = 0.06);

}  // namespace agrisee::fuse
