// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a split cloud to located fruit: centroids, pose frames, bodies (paper, "Localization").
#pragma once

#include <agrisee/cloud/measured_volume.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/volume.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <bitset>
#include <numeric>

namespace agrisee {

namespace detail {

/// The fitted body of a fruit, with the share of its surface that its points cover and how far it can be trusted.
inline Body body_of(const Cloud& cloud, const Indices& points, const FoundBody& found, const BodyParameters& parameters,
                    const MassParameters& mass_parameters) {
  Body body;
  body.center = found.fit.body.center;
  std::tie(body.radii, body.axes) = semi_axes(found.fit.body);
  body.center_covariance = found.fit.center_covariance;
  body.rms = found.fit.rms;
  std::bitset<DirectionBins::kCount> covered;
  for (Index i : points)
    covered.set(static_cast<std::size_t>(
        DirectionBins::bin(cloud.points[static_cast<std::size_t>(i)].cast<double>() - body.center)));
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b)
    if (covered[b]) body.completeness += DirectionBins::shares()[b];
  body.completeness = std::min(body.completeness, 1.0);
  // Confidence grows with what was seen beyond the least that is accepted, and falls with the misfit.
  const double seen = std::clamp((found.score - parameters.min_coverage) / 0.25, 0.0, 1.0);
  const double misfit = body.rms / (parameters.tolerance * found.fit.body.mean_radius());
  body.confidence = (0.5 + 0.5 * seen) * std::exp(-misfit * misfit);
  const double fit_error = relative_volume_error(cloud, points, found.fit.body, parameters.fit);
  Estimate volume = volume_of(found.fit.body, fit_error, mass_parameters);
  if (const auto measured = measured_volume(cloud, points, found.fit.body.center))
    volume = {*measured, volume.error * *measured / volume.value};
  const Estimate mass = mass_of(volume, mass_parameters);
  std::tie(body.volume, body.volume_error) = std::tie(volume.value, volume.error);
  std::tie(body.mass, body.mass_error) = std::tie(mass.value, mass.error);
  return body;
}

}  // namespace detail

/// The fruit of a split cloud, numbered from the top of the truss down, and the labels renumbered alike.
/// @param cloud points (m, world) with normals
/// @param split of that cloud
/// @param cluster_origin the origin of the cluster frame {R} in world (aabb.hpp)
/// @param parameters see their struct
/// @param labels in: those of `split`; out: the fruit's ids
inline std::vector<Fruit> locate(const Cloud& cloud, const Split& split, const Eigen::Vector3d& cluster_origin,
                                 const Parameters& parameters, Labels& labels) {
  auto members = indices_by_label(split.labels);
  members.resize(split.found.size());
  std::vector<Fruit> fruits;
  std::vector<std::size_t> source;
  for (std::size_t f = 0; f < members.size(); ++f) {
    if (members[f].empty()) continue;
    const FoundBody& found = split.found[f];
    Fruit fruit;
    fruit.points = members[f].size();
    fruit.found_by = found.found_by;
    const Centroid c = centroid(cloud, members[f]);
    fruit.centroid = c.mean;
    fruit.sigma = c.sigma;
    fruit.centroid_cluster = c.mean - cluster_origin;  // {R} is parallel to world
    if (parameters.split.fit_bodies)
      fruit.body = detail::body_of(cloud, members[f], found, parameters.split.bodies, parameters.mass);
    if (parameters.growth_axis && parameters.split.fit_bodies) {
      const Eigen::Vector3d z = growth_axis(cloud, split.labels, found.fit, parameters.axis);
      const double near = 0.3 * parameters.split.bodies.radius_min;  // a length of the fruit's, so that it scales
      fruit.orientation = frame_from_z_and_x(z, densest_point(cloud, members[f], near) - c.mean);
    } else {
      fruit.orientation = paper_pose_frame(cloud, members[f], c.mean);
    }
    fruits.push_back(std::move(fruit));
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
