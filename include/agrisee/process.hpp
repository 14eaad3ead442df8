// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a ready cloud to located fruit: clean, split, locate ([1], "Segmentation" and "Localization").
///
/// Pipeline::result() calls it on the map of a scan; call it yourself on a cloud from elsewhere. Metres, the cloud's
/// frame. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/fuse/masks.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace agrisee {

/// What is known of a ready cloud beside its points.
struct CloudOrigin {
  std::vector<Eigen::Vector3d> sensors;  ///< sensor position (m) of each view that `cloud.views` names; may be empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< one sensor position (m) for all points, for a cloud of a single view
  bool check_normals = false;                ///< also turn the cloud's own normals where they face away from the sensor
  bool trust_viewpoint = false;              ///< use `viewpoint` although the points speak against it
  /// Views with masks or colours, and where they were taken: masks propose bodies and change how far bodies are
  /// believed (fuse/masks.hpp); a cloud without colours takes theirs (fuse/paint.hpp). May be empty.
  std::vector<fuse::DetectedView> detected = {};
  fuse::MaskOrder mask_order = fuse::MaskOrder::masks_first;  ///< points first where several views show each fruit
  /// Origin of the cluster frame {R} in world (m); empty: that of the box around the cloud, seen from the origin.
  std::optional<Eigen::Vector3d> cluster_origin;
};

/// Refuse what cannot be where a cloud was seen from. `process` calls it.
/// @throws InputError when a sensor stood more than 20 m from the cloud (it must be in millimetres); when there are
///   positions of sensors, but neither views nor normals of the points; when `origin` has a viewpoint and no sensors,
///   but `cloud.views` names more than one view, as this would turn normals that are right
void check_origin(const Cloud& cloud, const CloudOrigin& origin);

/// Number of normals that came with a cloud and that `process` would turn with `origin.check_normals`, because they
/// face away from where their points were seen from.
/// @param cloud points (m), with normals or without
/// @param origin where the points were seen from
/// @throws InputError as check_origin, or when a point's view has no sensor position
std::size_t normals_facing_away(const Cloud& cloud, const CloudOrigin& origin);

/// Refuse a cloud that cannot be in metres: one that is more than 10 m across and whose points are farther apart than
/// the largest expected fruit. `process` calls it.
/// @param cloud points (m), any frame
/// @param parameters only the expected radii are used
/// @throws InputError that names the size and spacing of the cloud and the likely cause
void check_units(const Cloud& cloud, const Parameters& parameters = {});

/// Clean, split and locate.
///
/// Points that are not finite are dropped. Normals that come with the cloud are kept; with `origin.check_normals`,
/// those that face away from their sensor are turned. Missing normals are estimated. They are turned towards the views,
/// or the one viewpoint, or, if neither is known, so that neighbors agree. If normals had to be estimated, bodies are
/// fitted with four times the noise that the cloud shows locally (`split.bodies.fit.noise`), because the errors of a
/// ready cloud extend beyond the neighborhood in which they can be told from the surface. Any number of points is
/// accepted; too few to form a body give no fruit.
///
/// One viewpoint is refused where the points speak against it: where more than 3 % of them lie hidden behind others
/// (cloud/hidden_points.hpp), so that they were seen from elsewhere, or where less than a third of what is curved as
/// fruit bulges towards it (cloud/convexity.hpp), so that it is on the wrong side. With `origin.trust_viewpoint`, and
/// where the doubt is smaller, that is a warning of the result.
/// @param cloud points (m), any frame; normals and views where it has them
/// @param parameters of all stages
/// @param origin where the points were seen from
/// @param seen_through evidence of free space from the views, or empty
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError; InputError for a cloud that cannot be in metres (check_units), for one viewpoint of several
///   views (check_origin), when a point's view has no sensor position, or when the points speak against the viewpoint;
///   Cancelled (core/cancellation.hpp)
ScanResult process(const Cloud& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1);

/// The same for a cloud that may be consumed; it becomes the result's `raw` cloud without a copy.
/// @param cloud points (m); all finite
/// @param parameters, origin, seen_through, threads as above
/// @throws as above
ScanResult process(Cloud&& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1);

/// The same for any other cloud that meets the contract of core/traits.hpp: vectors and maps of Eigen, or, with a
/// header of `interop/`, clouds of PCL, Open3D and ROS. Its finite points are copied once, into the result's `raw`
/// cloud. Its views are unknown.
/// @param cloud points (m), any frame
/// @param parameters, origin, seen_through, threads as above
/// @throws as above
template <typename C, typename = scalar_t<C>>
ScanResult process(const C& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1) {
  return process(finite_points(cloud), parameters, origin, seen_through, threads);
}

/// A ready cloud, thinned to the spacing that fused surfaces have.
///
/// A cloud that is denser than `surfels.separation` is averaged in voxels of that size, which removes noise and saves
/// time; each mean keeps the view, colour and detection of the point nearest to it. A sparser cloud is returned
/// unchanged. Points that are not finite are dropped.
/// @param cloud points (m); normals and views where it has them
/// @param parameters only `surfels.separation` is used
/// @throws Cancelled
Cloud thinned(const Cloud& cloud, const Parameters& parameters);

}  // namespace agrisee
