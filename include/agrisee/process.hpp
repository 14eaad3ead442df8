// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a consolidated cloud to located fruit: clean, split, locate. Used by scans, and on clouds from elsewhere.
#pragma once

#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/locate.hpp>

#include <chrono>

namespace agrisee {

/// Adds the seconds of its own lifetime to a counter.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// What is known of a ready cloud beside its points.
struct CloudOrigin {
  std::vector<Eigen::Vector3d> sensors;      ///< sensor position (m) of each view that `cloud.views` refers to; may be empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< one sensor position (m) for all points, where there are no views
  Eigen::Vector3d cluster_origin = Eigen::Vector3d::Zero();  ///< origin of the cluster frame in world (m)
};

/// A ready cloud at the spacing that fused surfaces have: denser ones are averaged in voxels of `surfels.separation`, which
/// takes off noise and time; others are returned as they are, without the points that are not finite.
inline Cloud thinned(const Cloud& cloud, const Parameters& parameters) {
  Cloud finite = select(cloud, finite_indices(cloud));
  const double separation = parameters.surfels.separation;
  return estimate_spacing(finite) < 0.9 * separation && finite.views.empty() ? average_in_voxels(finite, separation) : finite;
}

/// Clean, split and locate (paper: SOR, region growing, DBSCAN, localization).
///
/// Points that are not finite are dropped. Normals are those of the cloud where it has them and surfaces were fused;
/// otherwise they are estimated and turned to the views, to the one viewpoint, or, where neither is known, by consistency.
/// Works for any number of points; too few to be anything give no fruit.
/// @param seen_through evidence of free space from the views, or empty
/// @throws ParameterError
inline ScanResult process(const Cloud& cloud, const Parameters& parameters = {}, const CloudOrigin& origin = {},
                          const SeenThrough& seen_through = {}, int threads = 1) {
  parameters.check();
  ScanResult result;
  result.raw = select(cloud, finite_indices(cloud));
  if (result.raw.views.empty()) result.raw.views.assign(result.raw.size(), -1);
  Timing& t = result.seconds;
  {
    const Stopwatch watch(t.filter);
    const Indices kept = remove_statistical_outliers(result.raw, parameters.sor, threads);
    result.cloud = select(result.raw, kept);
  }
  Cloud& clean = result.cloud;
  {
    const Stopwatch watch(t.normals);
    if (clean.normals.empty()) {
      NormalParameters normals = parameters.normals;
      const double spacing = parameters.adaptive_normals ? estimate_spacing(clean) : 0.0;
      if (spacing > 0.0) normals.radius = parameters.normal_reach * spacing;
      auto estimated = estimate_normals(clean, normals, threads);
      if (!origin.sensors.empty()) {
        clean.normals = orient_normals_to_views(std::move(estimated), clean, clean.views, origin.sensors);
      } else if (origin.viewpoint) {
        clean.normals = orient_normals_to_viewpoint(std::move(estimated), clean, *origin.viewpoint);
      } else {
        OrientationParameters orientation;
        if (spacing > 0.0) orientation.max_distance = parameters.normal_reach * spacing;
        clean.normals = orient_normals_consistently(std::move(estimated), clean, orientation, threads);
      }
    }
  }
  Split found;
  {
    const Stopwatch watch(t.segment);
    found = split(clean, parameters.split, seen_through);
  }
  {
    const Stopwatch watch(t.locate);
    result.fruits = locate(clean, found, origin.cluster_origin, parameters, result.labels);
  }
  t.total = t.filter + t.normals + t.segment + t.locate;
  return result;
}

}  // namespace agrisee
