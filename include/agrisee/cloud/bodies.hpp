// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds the round bodies in a cloud: candidates compete for its points.
///
/// Regions, clusters, voted centers and masks propose bodies. Every proposal is fitted (fit.hpp). Its score is the
/// share of its surface that points cover, minus contradictions: points inside it, and sight lines through it. The best
/// body is taken together with its points, the others are scored again on the points that are left, and so on until no
/// body scores enough. Bodies may touch but not penetrate each other deeply. Leaves and stems are rejected because the
/// points on them are flat or ridge-like: one of their principal curvatures is much smaller than the other. Metres;
/// most limits are shares of the body's radius. Cost: linear in the points near each candidate.
#pragma once

#include <agrisee/cloud/competition.hpp>

#include <limits>
#include <vector>

namespace agrisee {

namespace detail {

/// find_bodies with the grid of the cloud's points, whose cells are `parameters.cell()`.
template <typename S>
std::vector<FoundBody> find_bodies_near(const PointCloud<S>& cloud, const Grid<S>& grid,
                                        const std::vector<BodyCandidate>& candidates, const BodyParameters& parameters,
                                        const BodyEvidence& evidence, BodyCounts* counts) {
  Competition<S> competition(cloud, grid, parameters, evidence);
  competition.enter(candidates);
  std::vector<FoundBody> found;
  if (parameters.alike > 0.0) competition.remember();
  competition.decide(found);
  if (parameters.alike > 0.0) competition.decide_by_size(found);
  if (evidence.masks.remaining) competition.fill_gaps(found);
  competition.close();
  if (counts) *counts = competition.counts();
  return found;
}

/// assign_to_bodies with the grid of the cloud's points, whose cells are `parameters.cell()`.
template <typename S>
Labels assign_to_bodies_near(const PointCloud<S>& cloud, const Grid<S>& grid, const std::vector<FoundBody>& bodies,
                             const BodyParameters& parameters) {
  Labels labels(cloud.size(), 0);
  std::vector<double> best(cloud.size(), std::numeric_limits<double>::infinity());
  const double cos_loose = loose_cosine(parameters);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    throw_if_cancelled();
    const Ellipsoid& body = bodies[b].fit.body;
    const double r = body.mean_radius();
    grid.visit(body.center.cast<S>(), static_cast<S>(std::max(1.4 * r, near_radius(body))), [&](Index index, S) {
      const auto i = static_cast<std::size_t>(index);
      const Eigen::Vector3d p = cloud.points[i].template cast<double>();
      const auto foot = body.foot(p);
      const double d = std::abs(foot.distance);
      if (d > parameters.near(r) || d >= best[i]) return;
      if (foot.normal.dot(cloud.normals[i].template cast<double>()) < cos_loose) return;
      best[i] = d;
      labels[i] = static_cast<int>(b) + 1;
    });
  }
  return labels;
}

}  // namespace detail

/// Let candidates compete for the points of a cloud with outward normals.
///
/// @param cloud points (m) with normals
/// @param candidates of equally good ones the first wins
/// @param parameters see their struct
/// @param evidence of sight lines and masks
/// @param counts if not null, receives the numbers of candidates by outcome
/// @return the bodies that won, best first; assign_to_bodies gives them their points
/// @throws ParameterError; InputError if the cloud has no normals
template <typename S>
std::vector<FoundBody> find_bodies(const PointCloud<S>& cloud, const std::vector<BodyCandidate>& candidates,
                                   const BodyParameters& parameters = {}, const BodyEvidence& evidence = {},
                                   BodyCounts* counts = nullptr) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "find_bodies: the cloud has no normals");
  const Grid<S> grid(cloud, static_cast<S>(parameters.cell()));
  return detail::find_bodies_near(cloud, grid, candidates, parameters, evidence, counts);
}

/// Label each point with the body (counted from 1) on whose surface it lies, 0 for none. That is the nearest body whose
/// surface is near enough (`tolerance`) and whose normal there differs from the point's by at most 1.6 times
/// `max_angle`; of equally near ones the first.
/// @param cloud points (m) with normals
/// @param bodies in the order of their labels
/// @param parameters see their struct
template <typename S>
Labels assign_to_bodies(const PointCloud<S>& cloud, const std::vector<FoundBody>& bodies,
                        const BodyParameters& parameters = {}) {
  if (bodies.empty()) return Labels(cloud.size(), 0);
  return detail::assign_to_bodies_near(cloud, Grid<S>(cloud, static_cast<S>(parameters.cell())), bodies, parameters);
}

}  // namespace agrisee
