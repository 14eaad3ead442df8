// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds the fruit in a ready cloud: clean, segment, locate ([1], 3.2.3 and 3.2.4).
///
/// Pipeline::result() calls it on the map of a scan; call it yourself on any other cloud. Metres, the cloud's frame:
/// positions and sizes may be in any, but growth axes and the order of the fruit need its z axis to point up. The
/// command `agrisee process` also calls thinned() and sets CloudOrigin::check_normals. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/fuse/masks.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace agrisee {

/// Where the points of a ready cloud were seen from, and its images.
struct CloudOrigin {
  std::vector<Eigen::Vector3d> sensors;  ///< sensor position (m) of each view that `cloud.views` names; may be empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< one sensor position (m) for all points, for a cloud of a single view
  bool check_normals = false;                ///< also turn the cloud's own normals where they face away from the sensor
  bool trust_viewpoint = false;              ///< use `viewpoint` even if the points contradict it
  /// Views with masks or colors, and their poses. Masks propose bodies and change the probability of bodies
  /// (fuse/masks.hpp); a cloud without colors takes theirs (fuse/paint.hpp). May be empty.
  std::vector<fuse::DetectedView> detected = {};
  fuse::MaskOrder mask_order = fuse::MaskOrder::masks_first;  ///< points_first if several views show each fruit
  /// Origin of the cluster frame {R} in world (m); empty: that of the box around the cloud, seen from the origin.
  std::optional<Eigen::Vector3d> cluster_origin;
  /// The box that the cloud was cut to (m); what goes on beyond it is no fruit (cloud/cut_bodies.hpp). Empty: unknown.
  std::optional<Aabb> volume;
  /// Whether sight lines of the views passed through a place; empty: unknown. It bounds closed surfaces, and only with
  /// it bodies that are parts of something larger are left out (locate.hpp).
  IsFree is_free = {};
};

/// Check that a cloud can have been seen from its origin. `process` calls it.
/// @throws InputError if a sensor is more than 20 m from the cloud (and from `origin.volume`, if that is known): then
///   its position must be in millimetres; if there are sensor positions, but the points have neither views nor normals;
///   if there are sensor positions, but none for a point's view; if `origin` has a viewpoint and no sensors, but
///   `cloud.views` names more than one view, as correct normals would be turned; if a position is not finite, or a
///   detected view has no frame
void check_origin(const Cloud& cloud, const CloudOrigin& origin);

/// The number of a cloud's own normals that face away from their sensors; `process` would turn them with
/// `origin.check_normals`.
/// @param cloud points (m), with normals or without
/// @param origin where the points were seen from
/// @throws InputError as check_origin
std::size_t normals_facing_away(const Cloud& cloud, const CloudOrigin& origin);

/// Check that a cloud can be in metres, and near the origin. One that is more than 10 m across, with points farther
/// apart than the largest expected fruit, cannot be in metres; more than 1 km away single precision is too coarse.
/// `process` calls it.
/// @param cloud points (m), any frame
/// @param parameters only the expected radii are used
/// @throws InputError that names the size and spacing of the cloud, or its distance, and what to do
void check_units(const Cloud& cloud, const Parameters& parameters = {});

/// Find the fruit in a cloud: clean, segment and locate.
///
/// Points that are not finite are dropped, and so are several at the origin, or any at a sensor, where cameras put
/// pixels without return; the result then has a warning. The cloud's own normals are kept; with `origin.check_normals`,
/// those that face away from their sensor are turned. Missing normals are estimated and turned towards the sensors or
/// the viewpoint; without either, so that they face outwards where the surface bulges, and neighbors agree elsewhere;
/// then bodies need a confidence of 0.8, as hollow leaves bulge as well. If normals had to be estimated, bodies are
/// fitted with the local noise of the cloud (`split.bodies.fit.sensor_noise`), for a single view with five times that,
/// because its errors are correlated beyond the neighborhood in which they can be told from the surface. Any number of
/// points is accepted; too few to form a body give no fruit.
///
/// A viewpoint is refused if the points contradict it: if more than 3 % of them are hidden behind others
/// (cloud/hidden_points.hpp), so that they were seen from elsewhere, or if less than a third of the surface that is
/// curved like fruit bulges towards it (cloud/convexity.hpp), so that it is on the wrong side. With
/// `origin.trust_viewpoint`, or if the doubt is smaller, the result has a warning instead.
/// @param cloud points (m), z up; normals and views if it has them
/// @param parameters of all stages
/// @param origin where the points were seen from
/// @param seen_through evidence of free space from the views, or empty
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError; InputError for arrays of different lengths (check_lengths), for a cloud that cannot be in
///   metres (check_units), for one viewpoint of several views, a point's view without sensor position or a detection
///   without frame (check_origin), or if the points contradict the viewpoint; Cancelled (core/cancellation.hpp)
ScanResult process(const Cloud& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1);

/// Like process(const Cloud&, ...), for a cloud that may be consumed; it becomes the result's `raw` cloud without a
/// copy.
/// @param cloud points (m)
/// @param parameters, origin, seen_through, threads as above
/// @throws as above
ScanResult process(Cloud&& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1);

/// Like process(const Cloud&, ...), for any other cloud that meets the contract of core/traits.hpp: vectors and maps of
/// Eigen or, with a header of `interop/`, clouds of PCL, Open3D and ROS. Its finite points are copied once, into the
/// result's `raw` cloud. Its views are unknown.
/// @param cloud points (m), z up
/// @param parameters, origin, seen_through, threads as above
/// @throws as above
template <typename C, typename = scalar_t<C>>
ScanResult process(const C& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1) {
  return process(finite_points(cloud), parameters, origin, seen_through, threads);
}

/// A ready cloud, thinned to the spacing of fused surfaces.
///
/// A cloud that is denser than `surfels.separation` is averaged in voxels of that size, which removes noise and saves
/// time; each mean keeps the view, color and detection of the point nearest to it. A sparser cloud is returned
/// unchanged. Points that are not finite are dropped.
/// @param cloud points (m); normals and views where it has them
/// @param parameters only `surfels.separation` is used
/// @throws InputError for arrays of different lengths (check_lengths); Cancelled
Cloud thinned(const Cloud& cloud, const Parameters& parameters);

}  // namespace agrisee
