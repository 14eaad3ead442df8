// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far the centers of bodies may be off because the views of a scan err, told from how far the views disagree.
///
/// Neighbouring pixels of a real sensor err alike, so the mean of a view's points on a body is off, too, however many
/// points there are. The mean residual of each view on each body, before registration, shows by how much: the mean of
/// their squares is the variance of that shared error. It is carried through the least squares of the fit view by view,
/// as for errors in clusters (Liang & Zeger, Biometrika 1986). What a sensor does alike in all views shows in no
/// disagreement; half of the variance of an L515's waves is of this kind, so the variance counts twice. The scatter of
/// the shifts by which registration laid the views on each other is added, divided by the number of views. Metres,
/// world.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <vector>

namespace agrisee::fuse {

/// A view of a scan.
struct RegisteredView {
  const sensor::SurfaceImage* image = nullptr;  ///< its surface points with normals, registered (m, world)
  Pose reported = Pose::Identity();             ///< world_T_optical as reported
};

/// The covariances (m2) of the centers of fitted bodies by the errors of the sensor, of its poses and of registration.
/// What the shape of the unseen part adds (EllipsoidFit::center_covariance_by_shape) is not in them.
/// @param bodies as fitted to the fused points of the views
/// @param views those that the fused points are of; others may have images without points
/// @param parameters of the fit that gave the bodies
/// @return one a body; zero for a body of which fewer than three views have points
/// @throws ParameterError; Cancelled. Defined in `agrisee::agrisee`.
std::vector<Eigen::Matrix3d> center_errors(const std::vector<Ellipsoid>& bodies,
                                           const std::vector<RegisteredView>& views, const FitParameters& parameters);

}  // namespace agrisee::fuse
