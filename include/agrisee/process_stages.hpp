// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What process() does, stage by stage: clean, split, locate. process.hpp includes it, unless the stages come compiled.
#pragma once

#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/cloud_origin.hpp>
#include <agrisee/core/neighbor_lists.hpp>
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/locate.hpp>

namespace agrisee {

/// A ready cloud at the spacing that fused surfaces have: denser ones are averaged in voxels of `surfels.separation`,
/// which takes off noise and time (a mean keeps the view of the point nearest to it); others are returned as they are,
/// without the points that are not finite.
inline Cloud thinned(const Cloud& cloud, const Parameters& parameters) {
  Cloud finite = select(cloud, finite_indices(cloud));
  const double separation = parameters.surfels.separation;
  const KdTree<float> search(finite);
  if (!(estimate_spacing(finite, search) < 0.9 * separation)) return finite;
  Cloud out = average_in_voxels(finite, separation);
  if (finite.views.empty()) return out;
  Neighbors<float> nearest;
  for (const auto& p : out.points) {
    if ((out.views.size() & 0xFFF) == 0) throw_if_cancelled();
    search.knn(p, 1, nearest);
    out.views.push_back(finite.views[static_cast<std::size_t>(nearest.front().index)]);
  }
  return out;
}

namespace detail {

/// Where a point was seen from (m): its view's sensor or the one viewpoint; empty when that is not known.
inline std::optional<Eigen::Vector3d> seen_from(const Cloud& cloud, std::size_t i, const CloudOrigin& origin) {
  if (!origin.sensors.empty() && cloud.views.size() == cloud.size()) {
    const int view = cloud.views[i];
    if (view < 0) return std::nullopt;
    check_input(static_cast<std::size_t>(view) < origin.sensors.size(), "a point's view has no sensor position");
    return origin.sensors[static_cast<std::size_t>(view)];
  }
  return origin.viewpoint;
}

/// Unit normals for a whole cloud, turned to where its points were seen from; those of points of which that is not
/// known agree with their neighbours. A cloud that is noisy for its spacing gets wider neighbourhoods.
/// @param noise receives the standard deviation (m) of the points about their own surface, 0 when it is not adaptive
inline std::vector<Eigen::Vector3f> estimated_normals(const Cloud& cloud, const Parameters& parameters,
                                                      const CloudOrigin& origin, double& noise, int threads) {
  NormalParameters normals = parameters.normals;
  OrientationParameters orientation;
  bool all_known = true;
  for (std::size_t i = 0; i < cloud.size() && all_known; ++i) all_known = seen_from(cloud, i, origin).has_value();
  const double spacing = parameters.adaptive_normals ? estimate_spacing(cloud) : 0.0;
  noise = 0.0;
  if (spacing > 0.0) {
    const BodyParameters& bodies = parameters.split.bodies;
    normals.radius = parameters.normal_reach * spacing;
    noise = estimate_noise(cloud, Grid<float>(cloud, static_cast<float>(normals.radius)), normals.radius,
                           std::sqrt(bodies.radius_min * bodies.radius_max));
    // Eight deviations across tell a slope; more than half a fruit's radius would round it off.
    normals.radius = std::max(normals.radius, std::min(8.0 * noise, 0.5 * bodies.radius_min));
    const double across = std::min(normals.radius / spacing, 20.0);
    normals.max_neighbors = std::max(normals.max_neighbors, static_cast<int>(kPi * across * across));
    orientation.max_distance = normals.radius;
  }
  std::vector<Eigen::Vector3f> estimated;
  if (all_known) {
    estimated = estimate_normals(cloud, normals, threads);
  } else if (normals.max_neighbors <= 64) {  // lists of neighbours serve twice, as long as they are short
    const int k = std::max(normals.max_neighbors, orientation.neighbors + 1);
    const NeighborLists lists = nearest_neighbors(cloud, static_cast<std::size_t>(k), threads);
    estimated = orient_normals_consistently(estimate_normals(cloud, normals, lists, threads), cloud, orientation, lists,
                                            threads);
  } else {
    estimated = orient_normals_consistently(estimate_normals(cloud, normals, threads), cloud, orientation, threads);
  }
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const auto eye = seen_from(cloud, i, origin))
      if (estimated[i].cast<double>().dot(*eye - cloud.points[i].cast<double>()) < 0.0) estimated[i] = -estimated[i];
  return estimated;
}

/// Normals that came with a cloud: kept, but for those that clearly face away from where their point was seen from (by
/// more than `beyond` (rad); at grazing incidence either side is possible), which are turned. Those that are zero or
/// not finite are estimated and take the side of the nearest normal that is known.
/// @param noise as of estimated_normals; 0 when nothing had to be estimated
inline void complete_normals(Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, double& noise,
                             int threads, double beyond = deg(100)) {
  noise = 0.0;
  const double away = std::cos(beyond);
  Indices known;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Eigen::Vector3f& n = cloud.normals[i];
    if (!is_finite(n) || !(n.squaredNorm() > 0.25f)) {
      n.setZero();
      continue;
    }
    known.push_back(static_cast<Index>(i));
    const auto eye = seen_from(cloud, i, origin);
    if (!eye) continue;
    const Eigen::Vector3d sight = *eye - cloud.points[i].cast<double>();
    if (n.cast<double>().dot(sight) < away * sight.norm()) n = -n;
  }
  if (known.size() == cloud.size()) return;
  const auto estimated = estimated_normals(cloud, parameters, origin, noise, threads);
  if (2 * known.size() > cloud.size()) noise = 0.0;  // what is estimated here and there says little of the rest
  const Cloud sure = select(cloud, known);
  const KdTree<float> search(sure);
  Neighbors<float> nearest;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if ((i & 0xFFF) == 0) throw_if_cancelled();
    if (cloud.normals[i].squaredNorm() > 0.0f) continue;
    cloud.normals[i] = estimated[i];
    if (seen_from(cloud, i, origin) || sure.empty()) continue;
    search.knn(cloud.points[i], 1, nearest);
    if (estimated[i].dot(sure.normals[static_cast<std::size_t>(nearest.front().index)]) < -0.5f)
      cloud.normals[i] = -estimated[i];
  }
}

/// process() of a cloud whose points are all finite.
inline ScanResult run_stages(Cloud raw, const Parameters& parameters, const CloudOrigin& origin,
                             const SeenThrough& seen_through, int threads) {
  parameters.check();
  ScanResult result;
  result.raw = std::move(raw);
  if (result.raw.views.empty()) result.raw.views.assign(result.raw.size(), -1);
  Timing& t = result.seconds;
  {
    const Stopwatch watch(t.filter);
    const Indices kept = remove_statistical_outliers(result.raw, parameters.sor, threads);
    result.cloud = select(result.raw, kept);
  }
  Cloud& clean = result.cloud;
  double noise = 0.0;
  {
    const Stopwatch watch(t.normals);
    if (clean.normals.empty()) {
      clean.normals = detail::estimated_normals(clean, parameters, origin, noise, threads);
    } else {
      detail::complete_normals(clean, parameters, origin.check_normals ? origin : CloudOrigin{}, noise, threads);
    }
  }
  Split found;
  {
    const Stopwatch watch(t.segment);
    SplitParameters fitted = parameters.split;
    fitted.bodies.fit.noise = std::max(fitted.bodies.fit.noise, 4.0 * noise);
    found = split(clean, fitted, seen_through);
  }
  {
    const Stopwatch watch(t.locate);
    result.fruits = locate(clean, found, origin.cluster_origin, parameters, result.labels);
  }
  t.total = t.filter + t.normals + t.segment + t.locate;
  return result;
}

}  // namespace detail

}  // namespace agrisee
