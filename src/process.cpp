// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/bodies_alone.hpp>
#include <agrisee/cloud/cut_bodies.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/last_fits.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/fuse/paint.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/locate.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/process.hpp>
#include <agrisee/trusses.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "body_evidence.hpp"
#include "cloud/searches.hpp"
#include "cloud_checks.hpp"
#include "cloud_normals.hpp"
#include "cloud_origin.hpp"
#include "fruit_ripeness.hpp"

namespace agrisee {
namespace {

/// The points that were measured: not those whose coordinates are not finite, nor those at a sensor or, if there are
/// several, at the origin, where cameras put pixels without return.
Indices measured_indices(const Cloud& cloud, const CloudOrigin& origin, std::vector<std::string>& warnings) {
  constexpr float kNear = 0.001f;  // m; no sensor measures as near
  std::vector<Eigen::Vector3f> sensors;
  if (origin.viewpoint) sensors.push_back(origin.viewpoint->cast<float>());
  for (const Eigen::Vector3d& sensor : origin.sensors) sensors.push_back(sensor.cast<float>());
  const auto is_zero = [](const Eigen::Vector3f& p) { return p.isZero(0.0f); };
  const bool zeros = std::count_if(cloud.points.begin(), cloud.points.end(), is_zero) > 1;
  const auto no_return = [&](const Eigen::Vector3f& p) {
    const auto at = [&](const Eigen::Vector3f& sensor) { return (p - sensor).squaredNorm() < kNear * kNear; };
    return (zeros && is_zero(p)) || std::any_of(sensors.begin(), sensors.end(), at);
  };
  Indices kept;
  kept.reserve(cloud.size());
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_finite(cloud.points[i])) continue;
    if (no_return(cloud.points[i]))
      ++left_out;
    else
      kept.push_back(static_cast<Index>(i));
  }
  if (left_out > 0)
    warnings.push_back(std::to_string(left_out) + " of " + std::to_string(cloud.size()) +
                       " points lie at (0, 0, 0) or at the sensor, as pixels without return do; they were left out");
  return kept;
}

/// The origin of the cluster frame where no scan volume is known.
Eigen::Vector3d corner_of(const Cloud& cloud) {
  const Aabb box = bounding_box(cloud.points);
  const Eigen::Vector3d robot = Eigen::Vector3d::Zero();
  return box.empty() ? robot : cluster_origin(box, robot);
}

/// Take the points from some bodies, so that they become no fruit; those that a mask shows stay.
/// @param reason the count to raise for each; locate() takes it off `taken`, as all bodies without points
/// @param falls falls(body, its points): whether the body is one of them
template <typename Falls>
void forget_bodies(Split& split, std::size_t BodyCounts::*reason, Falls&& falls) {
  std::vector<Indices> members = indices_by_label(split.labels);
  members.resize(split.found.size());
  for (std::size_t b = 0; b < members.size(); ++b) {
    if (members[b].empty() || split.found[b].by_mask || !falls(split.found[b], members[b])) continue;
    for (const Index i : members[b]) split.labels[static_cast<std::size_t>(i)] = 0;
    ++(split.bodies.*reason);
  }
}

/// What only a scan of several views, from all sides, tells of its bodies: small ones that hang alone are doubtful at
/// much noise, and small ones can be fitted closely.
void look_closely(const Cloud& cloud, const BodyParameters& bodies, Split& split) {
  doubt_bodies_alone(bodies, split.found);
  forget_bodies(split, &BodyCounts::doubtful,
                [&](const FoundBody& f, const Indices&) { return f.confidence < bodies.min_confidence; });
  fit_closely(cloud, split.labels, bodies, split.found);
}

/// Without the points of surfaces that are seen at a larger angle of incidence than `max_incidence` (rad), or from
/// behind: most of them are flying pixels, which trail from the rim of a fruit along the sight lines and would lengthen
/// it. Only for one viewpoint; where views are merged, the point kept of a place may be the one seen at a slant.
Cloud without_flying_pixels(Cloud&& cloud, double max_incidence, const CloudOrigin& origin) {
  if (!has_one_viewpoint(origin) || !(max_incidence < 0.5 * kPi)) return std::move(cloud);
  const double least = std::cos(max_incidence);
  Indices kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d sight = *origin.viewpoint - cloud.points[i].cast<double>();
    const Eigen::Vector3d normal = cloud.normals[i].cast<double>();
    if (!(normal.dot(sight) < least * normal.norm() * sight.norm())) kept.push_back(static_cast<Index>(i));
  }
  return select(cloud, kept);
}

/// The parameters with the noise of a cloud, for split and location.
/// @param cloud cleaned
/// @param sides_guessed whether nothing told which side of the surfaces was seen
Parameters with_noise(const Parameters& parameters, const CloudNoise& noise, const Cloud& cloud,
                      const CloudOrigin& origin, bool sides_guessed) {
  Parameters out = parameters;
  BodyParameters& bodies = out.split.bodies;
  // Within a view the errors of neighbors are alike, so a body that they carry is off by more than they differ. Where
  // views are merged, they differ by the errors of the views.
  const double alike = is_one_view(origin) ? 5.0 : 1.0;
  bodies.fit.sensor_noise = std::max(bodies.fit.sensor_noise, alike * noise.points);
  // Hollow leaves were turned outwards, too. Of 416 fruit on simulated plants 415 have more, of leaves on trees few.
  constexpr double kSure = 0.8;
  if (sides_guessed) bodies.min_confidence = std::max(bodies.min_confidence, kSure);
  const bool unknown = !(noise.points > 0.0) && has_one_viewpoint(origin);  // its normals came with the cloud
  bodies.point_noise = std::max(bodies.point_noise, unknown ? point_noise(cloud, parameters) : noise.points);
  bodies.normal_noise = std::max(bodies.normal_noise, 1.2 * noise.normals);
  return out;
}

}  // namespace

ScanResult process(Cloud&& cloud, const Parameters& parameters, const CloudOrigin& origin,
                   const SeenThrough& seen_through, int threads) {
  parameters.check();
  check_lengths(cloud);
  ScanResult result;
  Timing& t = result.seconds;
  timed(t.filter, [&] {
    const Indices measured = measured_indices(cloud, origin, result.warnings);
    result.raw = measured.size() == cloud.size() ? std::move(cloud) : select(cloud, measured);
    check_units(result.raw, parameters);
    check_origin(result.raw, origin);
    if (result.raw.views.empty()) result.raw.views.assign(result.raw.size(), -1);
    check_hidden(result.raw, parameters, origin, result.warnings);
  });
  result.cluster_origin = origin.cluster_origin ? *origin.cluster_origin : corner_of(result.raw);

  // Clean: statistical outlier removal.
  timed(t.filter,
        [&] { result.cloud = select(result.raw, remove_statistical_outliers(result.raw, parameters.sor, threads)); });

  // Split: region growing, DBSCAN on the residual, bodies that compete for the points.
  const bool sides_guessed = is_unknown(origin) && !has_normals(result.cloud);
  const CloudNoise noise = timed(t.normals, [&] { return provide_normals(result.cloud, parameters, origin, threads); });
  timed(t.filter, [&] {
    check_side(result.cloud, parameters, origin, result.warnings);
    result.cloud = without_flying_pixels(std::move(result.cloud), parameters.max_incidence, origin);
  });
  const Parameters fitted = with_noise(parameters, noise, result.cloud, origin, sides_guessed);
  Split found = timed(t.segment, [&] {
    const BodyEvidence evidence = evidence_for(result, fitted, origin, seen_through, noise.points);
    return split(result.cloud, fitted.split, evidence, threads);
  });
  if (parameters.split.fit_bodies)
    timed(t.segment, [&] {
      if (origin.volume)
        forget_bodies(found, &BodyCounts::too_flat, [&](const FoundBody& f, const Indices& own) {
          return goes_on_beyond(result.cloud, own, f.fit.body, *origin.volume);
        });
      if (views_with_points(result.raw, origin) >= kSeveralViews)  // not of unknown clouds, which may be of one view
        look_closely(result.cloud, fitted.split.bodies, found);
    });
  result.bodies = found.bodies;
  const auto has_color = [](const fuse::DetectedView& v) { return !v.frame->color.empty(); };
  if (parameters.color_prior.enabled && std::none_of(origin.detected.begin(), origin.detected.end(), has_color))
    result.warnings.push_back("color_prior.enabled is true, but no view has a color image, so it changes nothing");

  // Locate: centroids, pose frames, fitted bodies.
  constexpr double kLeastSeen = 0.25;  // of 7,000 large fruit in scans of several views the least was 0.36
  const double least_seen = is_several_views(result.raw, origin) ? kLeastSeen : 0.0;
  timed(t.locate, [&] {
    result.fruits = locate(result.cloud, found, result.cluster_origin, fitted, result.labels, origin.is_free,
                           least_seen, parameters.split.fit_bodies ? &result.bodies : nullptr);
  });
  result.trusses = found_trusses(result.fruits);
  timed(t.locate, [&] {
    if (result.cloud.colors.empty()) result.cloud.colors = fuse::colors_of(result.cloud, origin.detected);
    add_ripeness(result, parameters.ripeness);
    if (auto doubt = doubt_of_colors(result, parameters.ripeness)) result.warnings.push_back(std::move(*doubt));
  });
  t.total = t.filter + t.normals + t.segment + t.locate;
  return result;
}

ScanResult process(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                   const SeenThrough& seen_through, int threads) {
  return process(select(cloud, finite_indices(cloud)), parameters, origin, seen_through, threads);
}

Cloud thinned(const Cloud& cloud, const Parameters& parameters) {
  Cloud finite = select(cloud, finite_indices(cloud));
  const double separation = parameters.surfels.separation;
  const KdTree<float> search(finite);
  if (!(estimate_spacing(finite, search) < 0.9 * separation)) return finite;
  Cloud out = average_in_voxels(finite, separation);
  if (finite.views.empty() && finite.colors.empty() && finite.instances.empty()) return out;
  Neighbors<float> nearest;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if ((i & 0xFFF) == 0) throw_if_cancelled();
    search.knn(out.points[i], 1, nearest);
    const auto from = static_cast<std::size_t>(nearest.front().index);
    if (!finite.views.empty()) out.views.push_back(finite.views[from]);
    if (!finite.colors.empty()) out.colors.push_back(finite.colors[from]);
    if (!finite.instances.empty()) out.instances.push_back(finite.instances[from]);
  }
  return out;
}

}  // namespace agrisee
