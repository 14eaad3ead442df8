// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decides which round bodies a cloud holds: candidates compete for its points.
///
/// Regions, clusters and voted centres each propose bodies. Every proposal is fitted (fit.hpp) and judged by the share
/// of its surface that points cover, less what contradicts it: points inside it, and sight lines that went through it.
/// The best is taken with its points, the rest are judged anew on what is left, until nothing is worth taking. Bodies
/// may touch but not interpenetrate. Flat or ridge-like supports (leaves, stems) are told from round ones by their two
/// curvatures. Lengths scale with the radius of the body; metres. Cost: linear in the points near each candidate.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/core/grid.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/geometry/pca.hpp>

#include <bitset>
#include <string>

namespace agrisee {

/// A proposal of a body and what proposed it.
struct BodyCandidate {
  Ellipsoid body;        ///< to begin with
  std::string found_by;  ///< what proposes it
};

/// A body that won.
struct FoundBody {
  EllipsoidFit fit;       ///< the body, and how well it is known
  std::string found_by;   ///< the stage that found it; see Fruit::found_by
  double coverage = 0.0;  ///< share of its surface covered by its points
  double score = 0.0;     ///< coverage less contradictions
};

namespace detail {

/// How a body fares against the points that are still free.
struct Verdict {
  double coverage = 0.0, inside = 0.0, seen_through = 0.0, roundness = 0.0;
  std::size_t support = 0;  ///< points on its surface
  double score() const { return coverage - 2.0 * inside - 1.5 * seen_through; }
};

template <typename S>
Verdict judge(const PointCloud<S>& cloud, const Grid<S>& grid, const std::vector<char>& taken, const Ellipsoid& body,
              const BodyParameters& parameters, const SeenThrough& seen_through) {
  Verdict v;
  const double r = body.mean_radius();
  const double near = parameters.tolerance * r;
  const double cos_max = std::cos(parameters.max_angle),
               cos_loose = std::cos(std::min(kPi / 2, 1.6 * parameters.max_angle));
  std::bitset<DirectionBins::kCount> covered, filled;
  // Sums over the points on the surface or nearly so, for the support's curvatures; positions from the centre.
  Eigen::Vector3d p_mean = Eigen::Vector3d::Zero(), n_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d pp = Eigen::Matrix3d::Zero(), np = Eigen::Matrix3d::Zero();
  double count = 0.0;
  grid.visit(body.center.cast<S>(), static_cast<S>(1.35 * r), [&](Index index, S) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector3d p = cloud.points[i].template cast<double>(), q = p - body.center;
    const auto foot = body.foot(p);
    if (foot.distance < -std::max(0.2 * r, 2.0 * near)) {
      filled.set(static_cast<std::size_t>(DirectionBins::bin(q)));
      return;
    }
    if (taken[i] || std::abs(foot.distance) > 2.0 * near) return;
    const Eigen::Vector3d normal = cloud.normals[i].template cast<double>();
    const double cosine = foot.normal.dot(normal);
    if (cosine >= cos_loose) {
      count += 1.0;
      p_mean += q;
      n_mean += normal;
      pp += q.lazyProduct(q.transpose());
      np += normal.lazyProduct(q.transpose());
    }
    if (std::abs(foot.distance) <= near && cosine >= cos_max) {
      covered.set(static_cast<std::size_t>(DirectionBins::bin(q)));
      ++v.support;
    }
  });
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b) {
    if (covered[b]) v.coverage += DirectionBins::shares()[b];
    if (filled[b]) v.inside += DirectionBins::shares()[b];
  }
  if (v.support < 8) return v;
  // Principal curvatures: normals as a linear function of position, in the plane of the support's two longest
  // directions.
  p_mean /= count;
  n_mean /= count;
  pp -= count * p_mean * p_mean.transpose();
  np -= count * n_mean * p_mean.transpose();
  const Eigen::Matrix<double, 3, 2> plane = principal_axes<double>(p_mean, pp).axes.rightCols<2>();
  const Eigen::Matrix2d spread = plane.transpose() * pp * plane + 1e-12 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d k = plane.transpose() * np * plane * spread.inverse();
  const double mean = 0.5 * (k(0, 0) + k(1, 1));  // eigenvalues of the symmetric part: mean -+ half
  const double half = std::hypot(0.5 * (k(0, 0) - k(1, 1)), 0.5 * (k(0, 1) + k(1, 0)));
  v.roundness = mean + half > 0.0 ? std::max(mean - half, 0.0) / (mean + half) : 0.0;
  if (seen_through) v.seen_through = seen_through(body);
  return v;
}

/// How deep two bodies go into each other along the line of their centres (m); negative when apart.
inline double overlap(const Ellipsoid& a, const Ellipsoid& b) {
  const Eigen::Vector3d d = b.center - a.center;
  const double length = d.norm();
  if (!(length > 1e-9)) return a.mean_radius() + b.mean_radius();
  const Eigen::Vector3d u = d / length;
  return (a.surface(u) - a.center).norm() + (b.surface(-u) - b.center).norm() - length;
}

}  // namespace detail

/// Let candidates compete for the points of a cloud with outward normals.
///
/// @param cloud points (m) with normals
/// @param candidates in the order that decides ties
/// @param parameters see their struct
/// @param seen_through evidence of free space, or empty
/// @return the bodies that won, best first; their points are those that `assign_to_bodies` gives them
/// @throws ParameterError; InputError when the cloud has no normals
template <typename S>
std::vector<FoundBody> find_bodies(const PointCloud<S>& cloud, const std::vector<BodyCandidate>& candidates,
                                   const BodyParameters& parameters = {}, const SeenThrough& seen_through = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "find_bodies: the cloud has no normals");
  const Grid<S> grid(cloud, static_cast<S>(0.5 * parameters.radius_min));
  std::vector<char> taken(cloud.size(), 0);
  const auto plausible = [&](double r) { return parameters.plausible(r); };
  FitParameters rough = parameters.fit;  // enough to see where a proposal ends up
  rough.max_points = std::min(120, rough.max_points);
  Indices near;
  const auto refine = [&](const Ellipsoid& start, const FitParameters& fit) {
    near.clear();
    grid.visit(start.center.cast<S>(), static_cast<S>(1.35 * start.mean_radius()), [&](Index i, S) {
      if (!taken[static_cast<std::size_t>(i)]) near.push_back(i);
    });
    return fit_ellipsoid(cloud, near, start, fit);
  };
  const auto alike = [](const Ellipsoid& a, const Ellipsoid& b) {
    const double r = a.mean_radius(), gate = 0.05 * r;
    return (a.center - b.center).norm() < gate && std::abs(b.mean_radius() - r) < gate;
  };

  struct Entry {
    EllipsoidFit fit;
    const std::string* found_by;
    detail::Verdict verdict;
    bool alive = true;
  };
  const auto assess = [&](Entry& e) {
    e.verdict = detail::judge(cloud, grid, taken, e.fit.body, parameters, seen_through);
    e.alive = plausible(e.fit.body.mean_radius()) && e.verdict.score() >= parameters.min_coverage &&
              e.verdict.roundness >= parameters.min_roundness;
  };
  std::vector<Entry> entries;
  std::vector<Ellipsoid> known;  // where proposals ended up; most of them meet
  for (const BodyCandidate& c : candidates) {
    throw_if_cancelled();
    if (!plausible(c.body.mean_radius())) continue;
    // Not worth a fit where hardly anything supports even the first guess.
    if (detail::judge(cloud, grid, taken, c.body, parameters, {}).coverage < 0.3 * parameters.min_coverage) continue;
    const auto first = refine(c.body, rough);
    if (!first || std::any_of(known.begin(), known.end(), [&](const Ellipsoid& k) { return alike(k, first->body); }))
      continue;
    known.push_back(first->body);
    const auto fit = refine(first->body, parameters.fit);
    if (!fit) continue;
    Entry e{*fit, &c.found_by, {}, true};
    assess(e);
    if (e.alive) entries.push_back(std::move(e));
  }
  std::vector<FoundBody> found;
  const auto area = [](const Entry& e) {
    const double r = e.fit.body.mean_radius();
    return e.verdict.score() * r * r;
  };
  while (true) {
    Entry* best = nullptr;
    for (Entry& e : entries)
      if (e.alive && (!best || area(e) > area(*best))) best = &e;
    if (!best) break;
    best->alive = false;
    const bool clashes = std::any_of(found.begin(), found.end(), [&](const FoundBody& f) {
      const double smaller = std::min(f.fit.body.mean_radius(), best->fit.body.mean_radius());
      return detail::overlap(f.fit.body, best->fit.body) > parameters.max_overlap * smaller;
    });
    if (clashes) continue;
    found.push_back({best->fit, *best->found_by, best->verdict.coverage, best->verdict.score()});
    // What the new body explains is no longer free, its calyx end and a margin included.
    const Ellipsoid& body = best->fit.body;
    const double margin = 1.5 * parameters.tolerance * body.mean_radius();
    const double cos_loose = std::cos(std::min(kPi / 2, 1.6 * parameters.max_angle));
    grid.visit(body.center.cast<S>(), static_cast<S>(1.35 * body.mean_radius()), [&](Index index, S) {
      const auto i = static_cast<std::size_t>(index);
      const Eigen::Vector3d p = cloud.points[i].template cast<double>();
      const auto foot = body.foot(p);
      if (foot.distance < margin &&
          (foot.distance < -margin || foot.normal.dot(cloud.normals[i].template cast<double>()) >= cos_loose))
        taken[i] = 1;
    });
    for (Entry& e : entries) {
      throw_if_cancelled();
      if (!e.alive) continue;
      const double gap = (e.fit.body.center - body.center).norm() - e.fit.body.mean_radius() - body.mean_radius();
      if (gap > 0.5 * body.mean_radius()) continue;
      const std::size_t support = e.verdict.support;
      assess(e);  // most end here: their points are taken
      if (!e.alive || e.verdict.support == support) continue;
      if (const auto again = refine(e.fit.body, parameters.fit)) {
        e.fit = *again;
        assess(e);
      } else {
        e.alive = false;
      }
    }
  }
  return found;
}

/// Label each point with the body (counted from 1) on whose surface it lies, 0 for none: the nearest body within
/// `tolerance` of its radius whose normal agrees to within 1.6 `max_angle`.
template <typename S>
Labels assign_to_bodies(const PointCloud<S>& cloud, const std::vector<FoundBody>& bodies,
                        const BodyParameters& parameters = {}) {
  Labels labels(cloud.size(), 0);
  if (bodies.empty()) return labels;
  const Grid<S> grid(cloud, static_cast<S>(0.5 * parameters.radius_min));
  std::vector<float> best(cloud.size(), std::numeric_limits<float>::infinity());
  const double cos_loose = std::cos(std::min(kPi / 2, 1.6 * parameters.max_angle));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    throw_if_cancelled();
    const Ellipsoid& body = bodies[b].fit.body;
    const double r = body.mean_radius();
    grid.visit(body.center.cast<S>(), static_cast<S>(1.4 * r), [&](Index index, S) {
      const auto i = static_cast<std::size_t>(index);
      const Eigen::Vector3d p = cloud.points[i].template cast<double>();
      const auto foot = body.foot(p);
      const double d = std::abs(foot.distance);
      if (d > parameters.tolerance * r || d >= double(best[i])) return;
      if (foot.normal.dot(cloud.normals[i].template cast<double>()) < cos_loose) return;
      best[i] = static_cast<float>(d);
      labels[i] = static_cast<int>(b) + 1;
    });
  }
  return labels;
}

}  // namespace agrisee
