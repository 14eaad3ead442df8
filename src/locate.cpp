// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/closed_surface.hpp>
#include <agrisee/cloud/fruit_probability.hpp>
#include <agrisee/cloud/growth_axis.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/surface_beyond.hpp>
#include <agrisee/cloud/volume.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/locate.hpp>
#include <agrisee/trusses.hpp>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "cloud/searches.hpp"

namespace agrisee {
namespace {

/// Share (0..1) of a body's surface that its points cover. On a small body they are farther apart than the bins of
/// directions, so a bin also counts if its middle lies between them.
double completeness_of(const Cloud& cloud, const Indices& points, const Eigen::Vector3d& center) {
  constexpr double kBetween = 0.65;  // of their spacing: how far the middle between even points is from the nearest
  const double reach = kBetween * estimate_spacing(select(cloud, points));
  std::bitset<DirectionBins::kCount> covered;
  for (const Index i : points) {
    const Eigen::Vector3d p = cloud.points[static_cast<std::size_t>(i)].cast<double>() - center;
    covered.set(static_cast<std::size_t>(DirectionBins::bin(p)));
    const double least = p.norm() * std::cos(std::min(reach / p.norm(), kPi / 4));
    for (std::size_t b = 0; b < DirectionBins::kCount; ++b)
      if (!covered[b] && p.dot(DirectionBins::directions()[b]) > least) covered.set(b);
  }
  double share = 0.0;
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b)
    if (covered[b]) share += DirectionBins::shares()[b];
  return std::min(share, 1.0);
}

/// Take over, as far as it has weight, what a closed surface says of a fruit that is no ellipsoid. The body becomes the
/// ellipsoid with the surface's center and second moments.
void take_over(const ClosedSurface& surface, const Ellipsoid& ellipsoid, const MassParameters& mass, Body& body,
               Estimate& volume) {
  const double w = surface.weight, v = 1.0 - w;
  if (!(w > 0.0)) return;
  const Eigen::Vector3d apart = surface.center - body.center;
  body.center += w * apart;
  for (Eigen::Matrix3d* covariance : {&body.center_covariance, &body.center_covariance_by_shape})
    *covariance = v * *covariance + w * surface.center_covariance + v * w * apart * apart.transpose();
  // positions inside an ellipsoid with the semi-axes a have the variances a^2 / 5
  const Eigen::Matrix3d inside = (ellipsoid.A * ellipsoid.A).inverse() / 5.0;
  const auto pca = principal_axes<double>(body.center, Eigen::Matrix3d(v * inside + w * surface.spread));
  body.radii = (5.0 * pca.variance).cwiseSqrt();
  body.axes = pca.axes;
  std::tie(body.radii, body.axes) = semi_axes(ellipsoid_of(body));  // in the usual order, with the usual signs
  body.rms = v * body.rms + w * surface.rms;
  const double error = surface.volume * std::hypot(surface.volume_error, mass.shape_error);
  const double between = surface.volume - volume.value;
  for (double* of : {&volume.error, &body.volume_error_by_shape})
    *of = std::sqrt(v * *of * *of + w * error * error + v * w * between * between);
  volume.value = v * volume.value + w * surface.volume;
}

/// The body of a fruit: its size, how much of it was seen, how far it can be trusted, its volume and mass.
/// @param surface its closed surface; null if there is none
Body body_of(const Cloud& cloud, const Indices& points, const FoundBody& found, const ClosedSurface* surface,
             const Parameters& parameters) {
  const Ellipsoid& ellipsoid = found.fit.body;
  Body body;
  body.center = ellipsoid.center;
  std::tie(body.radii, body.axes) = semi_axes(ellipsoid);
  body.center_covariance = found.fit.center_covariance;
  body.center_covariance_by_shape = found.fit.center_covariance_by_shape;
  body.rms = found.fit.rms;
  const VolumeError fit_error = relative_volume_error(cloud, points, ellipsoid, parameters.split.bodies.fit);
  Estimate volume = volume_of(ellipsoid, fit_error.total, parameters.mass);
  body.volume_error_by_shape = volume_of(ellipsoid, fit_error.by_shape, parameters.mass).error;
  if (surface) take_over(*surface, ellipsoid, parameters.mass, body, volume);
  body.completeness = completeness_of(cloud, points, body.center);
  body.confidence = found.confidence;
  const Estimate mass = mass_of(volume, parameters.mass);
  std::tie(body.volume, body.volume_error) = std::tie(volume.value, volume.error);
  std::tie(body.mass, body.mass_error) = std::tie(mass.value, mass.error);
  return body;
}

/// A fruit without its id.
Fruit fruit_of(const Cloud& cloud, const Labels& labels, const Indices& points, const FoundBody& found,
               const ClosedSurface* surface, const Eigen::Vector3d& cluster_origin, const Parameters& parameters) {
  Fruit fruit;
  fruit.points = points.size();
  fruit.found_by = found.found_by;
  const Centroid c = centroid(cloud, points);
  fruit.centroid = c.mean;
  fruit.sigma = c.sigma;
  fruit.centroid_cluster = c.mean - cluster_origin;  // {R} is parallel to world
  if (parameters.split.fit_bodies) fruit.body = body_of(cloud, points, found, surface, parameters);
  if (parameters.growth_axis && parameters.split.fit_bodies) {
    const bool by_surface = surface && surface->weight > 0.5;
    const std::vector<BodyAxis> axes =
        by_surface ? std::vector<BodyAxis>{{surface->axis, surface->axis_variance, 0.0}} : body_axes(found.fit);
    const Eigen::Vector3d stem = stem_direction(cloud, labels, ellipsoid_of(*fruit.body), parameters.axis);
    const GrowthAxis axis = growth_axis(stem, axes, parameters.axis);
    const double near = 0.2 * fruit.body->radii.mean();
    fruit.growth_axis_error = std::sqrt(axis.variance);
    fruit.orientation = frame_from_z_and_x(axis.direction, densest_point(cloud, points, near) - c.mean);
  } else {
    fruit.orientation = paper_pose_frame(cloud, points, c.mean);
  }
  return fruit;
}

/// What the size and shape of a closed surface say of a body.
enum class Likeness {
  fruit,    ///< they are those of an expected fruit
  unsure,   ///< it is somewhat more slender, which may be due to the side that was not seen
  no_fruit  ///< they are those of no fruit
};

/// What the size and shape of a closed surface say of a body. The ellipsoid about a part of a pot, a trough or a trunk
/// can have those of a fruit while the surface, which follows the points further, has not. Its size is that of a ball
/// of its volume, and half its width: its middle semi-axis, of a flat fruit the larger one, of a long one the smaller.
/// @param ellipsoid by which it was found; a fruit that is known to be long may have a surface that is so
Likeness likeness(const ClosedSurface& surface, const Ellipsoid& ellipsoid, const BodyParameters& bodies) {
  constexpr double kSlender = 0.6;  // of the least roundness; a surface that is longer still is no error
  constexpr double kLonger = 0.5;   // the surface of a fruit that was found as a long one may be longer than it
  const Eigen::Vector3d variance = principal_axes<double>(surface.center, surface.spread).variance;  // ascending
  const Eigen::Vector3d radii = (5.0 * variance.reverse()).cwiseSqrt();
  if (!bodies.plausible(std::cbrt(surface.volume / (4.0 / 3.0 * kPi))) || !bodies.plausible(radii[1]) ||
      detail::too_long(radii, bodies))
    return Likeness::no_fruit;
  // In the middle of an ellipsoid the smaller principal curvature is to the larger as its semi-axes squared.
  const Eigen::Vector3d found = semi_axes(ellipsoid).first;
  const double roundness = std::pow(found[2] / found[0], 2);
  const double least = roundness < bodies.min_roundness ? kLonger * roundness : bodies.min_roundness;
  if (variance[0] >= least * variance[2]) return Likeness::fruit;
  return variance[0] >= kSlender * least * variance[2] && bodies.plausible(radii[0]) ? Likeness::unsure
                                                                                     : Likeness::no_fruit;
}

/// The closed surface of each found fruit, empty where there is none, as for bodies by masks, of which few points are
/// seen. Points of no fruit that are on one join it, and the fruit's points far off it leave it; fruit that come later
/// may take these. What has a surface that no fruit has loses its points; what may have one keeps its ellipsoid.
/// @param members the points of each fruit; none for what is no fruit
/// @param labels one per point: the fruit's number from 1, or 0
std::vector<std::optional<ClosedSurface>> closed_surfaces(const Cloud& cloud, const Split& split,
                                                          const Parameters& parameters, const IsFree& is_free,
                                                          std::vector<Indices>& members, Labels& labels) {
  std::vector<std::optional<ClosedSurface>> surfaces(members.size());
  if (!parameters.split.fit_bodies) return surfaces;
  for (std::size_t f = 0; f < members.size(); ++f) {
    if (members[f].empty() || split.found[f].by_mask) continue;
    const EllipsoidFit& fit = split.found[f].fit;
    const Eigen::Vector3d stem = stem_direction(cloud, split.labels, fit.body, parameters.axis);
    const Eigen::Vector3d axis = growth_axis(stem, body_axes(fit), parameters.axis).direction;
    ClosedSurfaceParameters closing;
    closing.noise = std::max(closing.noise, parameters.split.bodies.fit.sensor_noise / fit.body.mean_radius());
    surfaces[f] = closed_surface(cloud, members[f], residual(labels), fit.body, axis, closing, is_free);
    if (!surfaces[f]) continue;
    const Likeness like =
        surfaces[f]->weight > 0.5 ? likeness(*surfaces[f], fit.body, parameters.split.bodies) : Likeness::fruit;
    if (like == Likeness::unsure) {
      surfaces[f].reset();
      continue;
    }
    if (like == Likeness::no_fruit) {
      for (const Index i : members[f]) labels[static_cast<std::size_t>(i)] = 0;
      members[f].clear();
      continue;
    }
    for (const Index i : surfaces[f]->joined) labels[static_cast<std::size_t>(i)] = static_cast<int>(f) + 1;
    for (const Index i : surfaces[f]->left_out) labels[static_cast<std::size_t>(i)] = 0;
    members[f].insert(members[f].end(), surfaces[f]->joined.begin(), surfaces[f]->joined.end());
    std::sort(members[f].begin(), members[f].end());
    members[f].erase(std::remove_if(members[f].begin(), members[f].end(),
                                    [&](Index i) { return labels[static_cast<std::size_t>(i)] == 0; }),
                     members[f].end());
  }
  return surfaces;
}

/// Whether a body is only the end of something longer, such as a post. Then it is longer than wide, unlike a round
/// fruit below which the underside of a shelf shows. The less it is, the more of its surface must go on.
/// @param labels one per point
/// @param label of the body's own points
bool is_part(const Cloud& cloud, const Grid<float>& grid, const Labels& labels, int label, const Body& body) {
  constexpr double kLonger = 1.15, kLong = 1.3;
  // At these. Of 433 fruit that are so long one has more than kPart, none as much as kMost; of 18 parts of posts 13
  // have.
  constexpr double kMost = 0.045, kPart = 0.025;
  const double longer = body.radii[0] / body.radii[1];
  if (longer <= kLonger) return false;
  const double most = kPart + (kMost - kPart) * std::max(0.0, (kLong - longer) / (kLong - kLonger));
  return surface_beyond(cloud, grid, labels, label, ellipsoid_of(body)) > most;
}

/// Whether a body is large and several views have seen too little of it: then it is a leaf that bulges, not a fruit.
bool hardly_seen(const Body& body, const BodyParameters& bodies, double least_seen) {
  constexpr double kLarge = 0.5;  // of the largest expected radius
  return body.completeness < least_seen && body.radii.mean() > kLarge * bodies.radius_max;
}

/// Number fruit truss by truss, each from the top down.
/// @param fruits located; their ids and trusses are set
/// @param truss_gap see Parameters
/// @param source for each fruit the index of its body
/// @param bodies number of bodies
/// @param labels one per point: index of the body + 1, or 0; receives the ids of the fruit, or 0
std::vector<Fruit> numbered_fruits(std::vector<Fruit> fruits, double truss_gap, const std::vector<std::size_t>& source,
                                   std::size_t bodies, Labels& labels) {
  std::vector<std::size_t> order(fruits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fruits[a].centroid.z() > fruits[b].centroid.z(); });
  std::vector<Fruit> sorted;
  for (const std::size_t i : order) sorted.push_back(std::move(fruits[i]));
  const std::vector<int> truss = trusses_of(sorted, truss_gap);
  std::vector<std::size_t> place(sorted.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  std::stable_sort(place.begin(), place.end(), [&](std::size_t a, std::size_t b) { return truss[a] < truss[b]; });
  std::vector<Fruit> numbered;
  std::vector<int> id(bodies + 1, 0);
  for (const std::size_t p : place) {
    numbered.push_back(std::move(sorted[p]));
    numbered.back().id = static_cast<int>(numbered.size());
    numbered.back().truss = truss[p] + 1;
    id[source[order[p]] + 1] = numbered.back().id;
  }
  for (int& l : labels) l = id[static_cast<std::size_t>(l)];
  return numbered;
}

}  // namespace

Ellipsoid ellipsoid_of(const Body& body) {
  Ellipsoid out;
  out.center = body.center;
  out.A = body.axes * body.radii.cwiseInverse().asDiagonal() * body.axes.transpose();
  return out;
}

Eigen::Vector3d cluster_origin(const Aabb& volume, const Eigen::Vector3d& robot) {
  const Eigen::Vector3d sight = volume.center() - robot;
  Eigen::Vector3d corner = volume.min;  // lowest
  const int far_axis = std::abs(sight.x()) > std::abs(sight.y()) ? 0 : 1;
  const double forward = sight[far_axis] < 0.0 ? -1.0 : 1.0;
  corner[far_axis] = forward > 0.0 ? volume.max[far_axis] : volume.min[far_axis];
  // left = up x forward: looking along +y left is -x; looking along +x left is +y
  const int side_axis = 1 - far_axis;
  const double left = far_axis == 1 ? -forward : forward;
  corner[side_axis] = left > 0.0 ? volume.max[side_axis] : volume.min[side_axis];
  return corner;
}

std::vector<Fruit> locate(const Cloud& cloud, const Split& split, const Eigen::Vector3d& cluster_origin,
                          const Parameters& parameters, Labels& labels, const IsFree& is_free, double least_seen,
                          BodyCounts* counts) {
  auto members = indices_by_label(split.labels);
  members.resize(split.found.size());
  Labels with_joined = split.labels;
  const auto surfaces = closed_surfaces(cloud, split, parameters, is_free, members, with_joined);
  std::optional<Grid<float>> grid;
  if (is_free) grid.emplace(cloud, static_cast<float>(parameters.split.bodies.cell()));
  const auto given_up = [counts](std::size_t BodyCounts::*reason) {
    if (counts) --counts->taken, ++(counts->*reason);
  };
  std::vector<Fruit> fruits;
  std::vector<std::size_t> source;  // the entry of split.found that each fruit comes from
  for (std::size_t f = 0; f < members.size(); ++f) {
    if (members[f].empty()) {
      if (surfaces[f])  // that of no fruit
        given_up(&BodyCounts::too_flat);
      else if (counts)
        --counts->taken;
      continue;
    }
    Fruit fruit = fruit_of(cloud, with_joined, members[f], split.found[f], surfaces[f] ? &*surfaces[f] : nullptr,
                           cluster_origin, parameters);
    const bool by_points = fruit.body && !split.found[f].by_mask;
    if (by_points && hardly_seen(*fruit.body, parameters.split.bodies, least_seen)) {
      given_up(&BodyCounts::little_seen);
      continue;
    }
    if (by_points && grid && is_part(cloud, *grid, with_joined, static_cast<int>(f) + 1, *fruit.body)) {
      given_up(&BodyCounts::too_flat);
      continue;
    }
    fruits.push_back(std::move(fruit));
    source.push_back(f);
  }
  labels = std::move(with_joined);
  return numbered_fruits(std::move(fruits), parameters.truss_gap, source, split.found.size(), labels);
}

}  // namespace agrisee
