// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/measured_volume.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/volume.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/locate.hpp>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace agrisee {
namespace {

/// Share (0..1) of a body's surface that its points cover.
double completeness_of(const Cloud& cloud, const Indices& points, const Eigen::Vector3d& center) {
  std::bitset<DirectionBins::kCount> covered;
  for (Index i : points)
    covered.set(static_cast<std::size_t>(
        DirectionBins::bin(cloud.points[static_cast<std::size_t>(i)].cast<double>() - center)));
  double share = 0.0;
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b)
    if (covered[b]) share += DirectionBins::shares()[b];
  return std::min(share, 1.0);
}

/// The fitted body of a fruit: its size, how much of it was seen, how far it can be trusted, its volume and mass.
Body body_of(const Cloud& cloud, const Indices& points, const FoundBody& found, const Parameters& parameters) {
  const BodyParameters& bodies = parameters.split.bodies;
  const Ellipsoid& ellipsoid = found.fit.body;
  Body body;
  body.center = ellipsoid.center;
  std::tie(body.radii, body.axes) = semi_axes(ellipsoid);
  body.center_covariance = found.fit.center_covariance;
  body.rms = found.fit.rms;
  body.completeness = completeness_of(cloud, points, body.center);
  // Confidence grows with what was seen beyond the least that is accepted, and falls with the misfit.
  const double seen = std::clamp((found.score - bodies.min_coverage) / 0.25, 0.0, 1.0);
  const double misfit = body.rms / (bodies.tolerance * ellipsoid.mean_radius());
  body.confidence = (0.5 + 0.5 * seen) * std::exp(-misfit * misfit);
  const double fit_error = relative_volume_error(cloud, points, ellipsoid, bodies.fit);
  Estimate volume = volume_of(ellipsoid, fit_error, parameters.mass);
  if (const auto measured = measured_volume(cloud, points, ellipsoid.center))
    volume = {*measured, volume.error * *measured / volume.value};
  const Estimate mass = mass_of(volume, parameters.mass);
  std::tie(body.volume, body.volume_error) = std::tie(volume.value, volume.error);
  std::tie(body.mass, body.mass_error) = std::tie(mass.value, mass.error);
  return body;
}

/// A fruit without its id.
Fruit fruit_of(const Cloud& cloud, const Labels& labels, const Indices& points, const FoundBody& found,
               const Eigen::Vector3d& cluster_origin, const Parameters& parameters) {
  Fruit fruit;
  fruit.points = points.size();
  fruit.found_by = found.found_by;
  const Centroid c = centroid(cloud, points);
  fruit.centroid = c.mean;
  fruit.sigma = c.sigma;
  fruit.centroid_cluster = c.mean - cluster_origin;  // {R} is parallel to world
  if (parameters.split.fit_bodies) fruit.body = body_of(cloud, points, found, parameters);
  if (parameters.growth_axis && parameters.split.fit_bodies) {
    const Eigen::Vector3d z = growth_axis(cloud, labels, found.fit, parameters.axis);
    const double near = 0.3 * parameters.split.bodies.radius_min;  // scales with the fruit
    fruit.orientation = frame_from_z_and_x(z, densest_point(cloud, points, near) - c.mean);
  } else {
    fruit.orientation = paper_pose_frame(cloud, points, c.mean);
  }
  return fruit;
}

}  // namespace

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
                          const Parameters& parameters, Labels& labels) {
  auto members = indices_by_label(split.labels);
  members.resize(split.found.size());
  std::vector<Fruit> fruits;
  std::vector<std::size_t> source;  // the entry of split.found that each fruit comes from
  for (std::size_t f = 0; f < members.size(); ++f) {
    if (members[f].empty()) continue;
    fruits.push_back(fruit_of(cloud, split.labels, members[f], split.found[f], cluster_origin, parameters));
    source.push_back(f);
  }
  std::vector<std::size_t> order(fruits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fruits[a].centroid.z() > fruits[b].centroid.z(); });
  std::vector<Fruit> sorted;
  std::vector<int> id(split.found.size() + 1, 0);
  for (std::size_t i : order) {
    sorted.push_back(std::move(fruits[i]));
    sorted.back().id = static_cast<int>(sorted.size());
    id[source[i] + 1] = sorted.back().id;
  }
  labels = split.labels;
  for (int& l : labels) l = id[static_cast<std::size_t>(l)];
  return sorted;
}

}  // namespace agrisee
