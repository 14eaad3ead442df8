// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_normals.hpp"

#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <algorithm>
#include <cmath>

#include "cloud/searches.hpp"

namespace agrisee {
namespace {

using Normals = std::vector<Eigen::Vector3f>;

/// Where a point was seen from (m): its view's sensor, or the one viewpoint; empty when that is not known.
std::optional<Eigen::Vector3d> seen_from(const Cloud& cloud, std::size_t i, const CloudOrigin& origin) {
  if (!origin.sensors.empty() && cloud.views.size() == cloud.size()) {
    const int view = cloud.views[i];
    if (view < 0) return std::nullopt;
    return origin.sensors[static_cast<std::size_t>(view)];
  }
  return origin.viewpoint;
}

/// Neighborhoods for normals that suit the cloud: wider where it is sparse, and wider again where it is noisy.
CloudNoise adapt_to_noise(const Cloud& cloud, double spacing, const Parameters& parameters, NormalParameters& normals) {
  const BodyParameters& bodies = parameters.split.bodies;
  normals.radius = parameters.normal_reach * spacing;
  const double noise = noise_within(cloud, normals.radius, bodies);
  // A slope needs eight standard deviations across; a wider neighborhood would flatten small fruit and mix leaves.
  constexpr double kWidest = 0.117;  // of the largest expected radius
  normals.radius = std::max(normals.radius, std::min(8.0 * noise, kWidest * bodies.radius_max));
  const double across = std::min(normals.radius / spacing, 20.0);
  normals.max_neighbors = std::max(normals.max_neighbors, static_cast<int>(kPi * across * across));
  return {noise, noise / normals.radius};
}

/// Unit normals for a whole cloud. Each is turned to where its point was seen from; where that is not known, so that
/// neighbors agree.
/// @param noise receives that of the cloud, if the neighborhoods are adapted to it
Normals estimated_normals(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                          CloudNoise& noise, int threads) {
  NormalParameters normals = parameters.normals;
  OrientationParameters orientation;
  bool all_known = true;
  for (std::size_t i = 0; i < cloud.size() && all_known; ++i) all_known = seen_from(cloud, i, origin).has_value();
  const double spacing = parameters.adaptive_normals ? estimate_spacing(cloud) : 0.0;
  noise = {};
  if (spacing > 0.0) {
    noise = adapt_to_noise(cloud, spacing, parameters, normals);
    orientation.max_distance = normals.radius;
  }
  Normals estimated;
  if (all_known) {
    estimated = estimate_normals(cloud, normals, threads);
  } else if (normals.max_neighbors <= 64) {  // short lists of neighbors are kept and used twice
    const int k = std::max(normals.max_neighbors, orientation.neighbors + 1);
    const NeighborLists lists = nearest_neighbors(cloud, static_cast<std::size_t>(k), threads);
    estimated = orient_normals_consistently(estimate_normals(cloud, normals, lists, threads), cloud, orientation, lists,
                                            threads);
  } else {
    estimated = orient_normals_consistently(estimate_normals(cloud, normals, threads), cloud, orientation, threads);
  }
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const auto sensor = seen_from(cloud, i, origin))
      estimated[i] = orient_towards(estimated[i], *sensor - cloud.points[i].cast<double>());
  return estimated;
}

/// A normal faces away from its sensor beyond this angle (rad); nearer to 90 degrees either side is possible.
constexpr double kFacingAway = deg(100);

/// Whether a point came with a normal.
bool has_normal(const Cloud& cloud, std::size_t i) {
  return !cloud.normals.empty() && is_finite(cloud.normals[i]) && cloud.normals[i].squaredNorm() > 0.25f;
}

/// Normals that came with the cloud are kept, except those that clearly face away from their sensor. These are turned.
/// Normals that are zero or not finite are replaced by zeros, longer ones than unit normals are shortened.
/// @return indices of the points whose normals are kept
Indices keep_given_normals(Cloud& cloud, const CloudOrigin& origin) {
  const double away = std::cos(kFacingAway);
  Indices known;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Eigen::Vector3f& n = cloud.normals[i];
    if (!has_normal(cloud, i)) {
      n.setZero();
      continue;
    }
    known.push_back(static_cast<Index>(i));
    constexpr float kLongest = 1.02f;  // rounding and averages leave no longer ones
    if (n.squaredNorm() > kLongest * kLongest) n.normalize();
    const auto sensor = seen_from(cloud, i, origin);
    if (!sensor) continue;
    n = orient_towards(n, *sensor - cloud.points[i].cast<double>(), away);
  }
  return known;
}

/// Estimate the normals that a cloud lacks. Where a point's sensor is not known, its normal takes the side of the
/// nearest normal that came with the cloud.
/// @param noise as of estimated_normals; zeros if more than half of the normals came with the cloud
void complete_normals(Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, CloudNoise& noise,
                      int threads) {
  noise = {};
  const Indices known = keep_given_normals(cloud, origin.check_normals ? origin : CloudOrigin{});
  if (known.size() == cloud.size()) return;
  const Normals estimated = estimated_normals(cloud, parameters, origin, noise, threads);
  if (2 * known.size() > cloud.size()) noise = {};  // a few estimates say little about the rest
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

}  // namespace

double noise_within(const Cloud& cloud, double radius, const BodyParameters& bodies) {
  return estimate_noise(cloud, Grid<float>(cloud, static_cast<float>(radius)), radius,
                        std::sqrt(bodies.radius_min * bodies.radius_max));
}

double point_noise(const Cloud& cloud, const Parameters& parameters) {
  const double spacing = parameters.adaptive_normals ? estimate_spacing(cloud) : 0.0;
  return spacing > 0.0 ? noise_within(cloud, parameters.normal_reach * spacing, parameters.split.bodies) : 0.0;
}

CloudNoise provide_normals(Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, int threads) {
  CloudNoise noise;
  if (cloud.normals.empty())
    cloud.normals = estimated_normals(cloud, parameters, origin, noise, threads);
  else
    complete_normals(cloud, parameters, origin, noise, threads);
  return noise;
}

bool has_normals(const Cloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (has_normal(cloud, i)) return true;
  return false;
}

std::size_t normals_facing_away(const Cloud& cloud, const CloudOrigin& origin) {
  check_origin(cloud, origin);
  const double away = std::cos(kFacingAway);
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!has_normal(cloud, i)) continue;
    const auto sensor = seen_from(cloud, i, origin);
    if (!sensor) continue;
    const Eigen::Vector3d sight = *sensor - cloud.points[i].cast<double>(), normal = cloud.normals[i].cast<double>();
    count += normal.dot(sight) < away * normal.norm() * sight.norm();
  }
  return count;
}

}  // namespace agrisee
