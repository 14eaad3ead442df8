// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a consolidated cloud to located fruit: clean, split, locate. Used by scans, and on clouds from elsewhere.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/core/compiled.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <utility>

namespace agrisee {

/// What is known of a ready cloud beside its points.
struct CloudOrigin {
  std::vector<Eigen::Vector3d>
      sensors;  ///< sensor position (m) of each view that `cloud.views` refers to; may be empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< one sensor position (m) for all points, where there are no views
  bool check_normals =
      false;  ///< turn the cloud's own normals, too, where they face away from where they were seen from
  Eigen::Vector3d cluster_origin = Eigen::Vector3d::Zero();  ///< origin of the cluster frame in world (m)
};

namespace detail {
inline namespace AGRISEE_ABI {
/// process() of a cloud whose points are all finite.
AGRISEE_INLINE ScanResult process_finite(Cloud raw, const Parameters& parameters, const CloudOrigin& origin,
                                         const SeenThrough& seen_through, int threads);
}  // namespace AGRISEE_ABI
}  // namespace detail

/// Clean, split and locate (paper: SOR, region growing, DBSCAN, localization).
///
/// Points that are not finite are dropped. Normals that the cloud has are kept, unless `origin.check_normals` asks to
/// turn those that face away from where their points were seen from; missing ones are estimated and turned to the
/// views, to the one viewpoint, or, where neither is known, by consistency. Where normals had to be estimated, the fit
/// of bodies (`split.bodies.fit.noise`) reckons with four times the noise that the cloud shows locally: a ready cloud's
/// errors go on beyond the neighbourhood in which they can be told from the surface. Works for any number of points;
/// too few to be anything give no fruit.
/// @param cloud points (m), any frame; normals and views where it has them
/// @param parameters see their struct
/// @param origin where the points were seen from
/// @param seen_through evidence of free space from the views, or empty
/// @param threads the result does not depend on it
/// @throws ParameterError; Cancelled (core/cancellation.hpp)
inline ScanResult process(const Cloud& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                          const SeenThrough& seen_through = {}, int threads = 1) {
  return detail::process_finite(select(cloud, finite_indices(cloud)), parameters, origin, seen_through, threads);
}

/// The same on any other cloud that meets the contract of core/traits.hpp: vectors and maps of Eigen, or with a header
/// of `interop/` clouds of PCL, Open3D and ROS. It is read where it lies, once, into the `raw` cloud of the result,
/// which every result owns and which holds its finite points. Its views are unknown.
/// @param cloud points (m), any frame
/// @param parameters see their struct
/// @param origin where the points were seen from
/// @param seen_through evidence of free space from the views, or empty
/// @param threads the result does not depend on it
/// @throws ParameterError; Cancelled (core/cancellation.hpp)
template <typename C, typename = scalar_t<C>>
ScanResult process(const C& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                   const SeenThrough& seen_through = {}, int threads = 1) {
  return detail::process_finite(finite_points(cloud), parameters, origin, seen_through, threads);
}

}  // namespace agrisee

#ifndef AGRISEE_COMPILED
#include <agrisee/process_stages.hpp>
#endif
