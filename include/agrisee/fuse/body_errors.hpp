// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The uncertainty of fitted bodies due to errors of the views, estimated from how far the views of a scan disagree.
///
/// Errors of neighboring pixels are correlated, so the mean of a view's points on a body is off, however many points
/// there are. The mean residual of each view on each body, before registration, measures this shared error together
/// with the error of the view's pose. Errors of poses also show as shifts across the sight lines, which give their
/// variance; it is subtracted from the mean square of the residuals, but for what registration leaves of it: the less,
/// the more views there are. What is left is propagated through the least-squares fit view by view, as for clustered
/// errors (Liang & Zeger, Biometrika 1986). An error that is the same in all views causes no disagreement; half of the
/// variance of an L515's correlated noise is of this kind, so the variance is doubled. Errors that only points near
/// each other share are propagated in the same way, patch by patch of 15 degrees; their variance is that of the mean
/// residuals of the patches about that of their view. Where the pose of a view was wrong across its sight lines and
/// registration did not put it right, the patches of the view are off as by one shift of the body: the mean square of
/// that shift, less what the patches' other errors explain of it, is propagated as well. Two terms are added: the
/// scatter of the registration's shifts, divided by the number of views (to centers), and what is the same in all
/// views: uneven skin, and steep surfaces that smoothing flattens, more so the more noise there is. Volumes change most
/// if the whole surface is flattened at once, which is added as well. A body that only one or two views show takes over
/// the variances of the others. Metres, world.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <vector>

namespace agrisee::fuse {

/// A view of a scan with its registered surface.
struct RegisteredView {
  const sensor::SurfaceImage* image = nullptr;  ///< its surface points with normals, registered (m, world)
  Pose reported = Pose::Identity();             ///< world_T_optical as reported
  std::size_t number = 0;                       ///< of the view in the scan, from 0
};

/// Errors of a fitted body due to the sensor, its poses and registration; all zero if they are not known.
struct BodyErrors {
  Eigen::Matrix3d center = Eigen::Matrix3d::Zero();  ///< covariance of the center (m2)
  double volume = 0.0;                               ///< standard error of the volume, relative to it
};

/// The errors of fitted bodies. The uncertainty from the unseen shape (EllipsoidFit::center_covariance_by_shape,
/// VolumeError::by_shape) is not included.
/// @param bodies fitted to the fused points of the views
/// @param views the views of the fused points; others may have images without points
/// @param parameters of the fit of the bodies
/// @return one per body; zero for a body of which no view has points, and for all if no body has points of three views
/// @throws ParameterError; Cancelled. Defined in `agrisee::agrisee`.
std::vector<BodyErrors> body_errors(const std::vector<Ellipsoid>& bodies, const std::vector<RegisteredView>& views,
                                    const FitParameters& parameters);

}  // namespace agrisee::fuse
