// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence for and against a body from the points and sight lines near it. Metres. Cost: linear in the points near it.
#pragma once

#include <agrisee/cloud/body_evidence.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/outside_surface.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <optional>
#include <vector>

namespace agrisee::detail {

/// Points near a body are looked up within this multiple of its mean radius from its center.
constexpr double kNearBody = 1.35;

/// Distance (m) from a body's center within which points are near it: 1.35 mean radii, of a long body more.
inline double near_radius(const Ellipsoid& body) {
  constexpr double kLong = 1.15;  // of the largest semi-axis
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(body.A, Eigen::EigenvaluesOnly);
  return std::max(kNearBody * body.mean_radius(), kLong / solver.eigenvalues()[0]);
}

/// Calls f(index) for the points near a body.
template <typename S, typename F>
void visit_near(const Grid<S>& grid, const Ellipsoid& body, F&& f) {
  grid.visit(body.center.cast<S>(), static_cast<S>(near_radius(body)), [&](Index i, S) { f(i); });
}

/// Points within this share of the radius from the surface that do not lie on it are clutter.
constexpr double kClutter = 0.3;

/// A body on which fewer points lie is not looked at closely.
constexpr std::size_t kLeastSupport = 8;

/// Cosine of the largest angle between a point's normal and the body's for points that count as nearly on the body.
inline double loose_cosine(const BodyParameters& parameters) {
  return std::cos(std::min(kPi / 2, 1.6 * parameters.max_angle));
}

/// Hardly a larger share of a fruit's surface goes on outside of its body.
constexpr double kGoesOn = 0.02;
/// A body of which more than this share is covered was seen nearly from end to end.
constexpr double kMostly = 0.5;

/// The evidence for a body from the points that are still free, and from sight lines.
struct Verdict {
  double coverage = 0.0;       ///< share of the surface covered by points on it
  double inside = 0.0;         ///< share of the directions in which there are points inside the body
  double seen_through = 0.0;   ///< share of the surface that sight lines pass through
  double roundness = 0.0;      ///< smallest over largest curvature of the points on the surface
  double normal_spread = 0.0;  ///< root mean square sine of the angle between the normals of points on it and its own
  double clutter = 0.0;        ///< points close to the surface that do not lie on it, for each that does
  double turned = 0.0;         ///< those of them that lie on it but for their normals, for each that does
  double beyond = 0.0;         ///< share of the directions in which a surface goes on outside of the body, as it would
                               ///< if the body were the end of something longer
  std::size_t support = 0;     ///< points on the surface
  std::optional<double> seen_on = {};  ///< see SeenOn; empty if not known
  double score() const { return coverage - 2.0 * inside - 1.5 * seen_through; }
  /// Sight lines through the surface, as a share of these and of what is covered.
  double through_share() const { return seen_through / (coverage + seen_through); }
  /// Whether several views show a long body from end to end: a cucumber, not a piece of a post.
  bool closed() const { return beyond < 0.5 * kGoesOn && coverage > kMostly; }
  /// How far the roundness is below that of nearly all fruit, as several views show it.
  double flatness() const { return std::max(0.0, 0.5 - roundness); }
};

/// Sums over the points on a body's surface or nearly so; positions are relative to the body's center.
struct SupportSums {
  Eigen::Vector3d p_mean = Eigen::Vector3d::Zero(), n_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d pp = Eigen::Matrix3d::Zero(), np = Eigen::Matrix3d::Zero();
  double count = 0.0;

  void add(const Eigen::Vector3d& q, const Eigen::Vector3d& normal) {
    count += 1.0;
    p_mean += q;
    n_mean += normal;
    pp += q.lazyProduct(q.transpose());
    np += normal.lazyProduct(q.transpose());
  }

  /// Smallest over largest curvature, 0 where the smallest is not positive. The normals are taken as a linear function
  /// of position. Its eigenvalues in the plane of the points' two longest directions are the principal curvatures of a
  /// patch. Of points seen from several sides there is a third curvature, across that plane: that of a ring of points
  /// around a post is zero. Where the points hardly spread across the plane, the mean of the other two stands for it.
  /// @param radius of the body (m)
  /// @param single_view whether all points were seen from one side, so that there are but two curvatures
  double roundness(double radius, bool single_view) {
    constexpr double kAcross = 0.2;  // points that spread across the plane by this share of the radius count half
    p_mean /= count;
    n_mean /= count;
    pp -= count * p_mean * p_mean.transpose();
    np -= count * n_mean * p_mean.transpose();
    const Eigen::Matrix3d axes = principal_axes<double>(p_mean, pp).axes;  // the shortest first
    const Eigen::Matrix<double, 3, 2> plane = axes.rightCols<2>();
    const Eigen::Matrix2d spread = plane.transpose() * pp * plane + 1e-12 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d k = plane.transpose() * np * plane * spread.inverse();
    const double mean = 0.5 * (k(0, 0) + k(1, 1));  // eigenvalues of the symmetric part: mean -+ half
    const double half = std::hypot(0.5 * (k(0, 0) - k(1, 1)), 0.5 * (k(0, 1) + k(1, 0)));
    const Eigen::Vector3d across = axes.col(0);
    const double variance = across.dot(pp * across) / count, half_known = std::pow(kAcross * radius, 2);
    const double known = single_view ? 0.0 : variance * variance / (variance * variance + half_known * half_known);
    const double third = known > 0.0 ? mean + known * (across.dot(np * across) / (count * variance) - mean) : mean;
    const double least = std::min(mean - half, third), most = std::max(mean + half, third);
    return least > 0.0 ? least / most : 0.0;
  }
};

/// The evidence from the points that `visit` shows.
/// @param visit visit(f) calls f(index) for points within near_radius of the body's center
/// @param each number of points that each of these represents
/// @param taken whether a point belongs to a body that has won already
/// @param single_view whether all points were seen from one side
/// @param look_beyond whether to look for a surface that goes on outside
template <typename S, typename Visit>
Verdict judge_points(const PointCloud<S>& cloud, Visit&& visit, std::size_t each, const std::vector<char>& taken,
                     const Ellipsoid& body, const BodyParameters& parameters, bool single_view, bool look_beyond) {
  Verdict v;
  const double r = body.mean_radius();
  const double near = parameters.near(r);
  const double cos_max = std::cos(parameters.max_angle), cos_loose = loose_cosine(parameters);
  constexpr double kNoise = 3.0;  // standard deviations
  std::bitset<DirectionBins::kCount> covered, filled;
  OutsideSurface outside;
  SupportSums sums;
  double sines_sq = 0.0;        // of the angles between the normals of the points and the body's
  std::size_t on = 0, off = 0;  // points on the surface; points near it, but not on it
  std::size_t turned = 0;       // of the latter, those that are on it but for their normals
  visit([&](Index index) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector3d p = cloud.points[i].template cast<double>(), q = p - body.center;
    const auto foot = body.foot(p);
    if (foot.distance < -std::max(0.2 * r, 2.0 * near)) {
      filled.set(static_cast<std::size_t>(DirectionBins::bin(q)));
      return;
    }
    const double distance = std::abs(foot.distance);
    if (distance > std::max(kClutter * r, 2.0 * near)) return;
    const Eigen::Vector3d normal = cloud.normals[i].template cast<double>();
    const double cosine = foot.normal.dot(normal);
    if (look_beyond && cosine > OutsideSurface::kFollows) {
      if (foot.distance > 0.0)
        outside.add(DirectionBins::bin(q), foot.distance);
      else
        outside.add_noise(distance);
    }
    if (taken[i]) return;
    if (distance <= 2.0 * near && cosine >= cos_loose) sums.add(q, normal);
    if (distance <= near && cosine >= cos_max) {
      covered.set(static_cast<std::size_t>(DirectionBins::bin(q)));
      ++on;
      sines_sq += 1.0 - cosine * cosine;
    } else if (distance < kClutter * r) {
      ++off;
      if (distance <= near) ++turned;
    }
  });
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b) {
    if (covered[b]) v.coverage += DirectionBins::shares()[b];
    if (filled[b]) v.inside += DirectionBins::shares()[b];
  }
  if (look_beyond) v.beyond = outside.share(covered, r, near, kNoise);
  v.support = each * on;
  if (v.support < kLeastSupport) return v;
  v.roundness = sums.roundness(r, single_view);
  v.normal_spread = std::sqrt(std::max(sines_sq, 0.0) / static_cast<double>(on));
  v.clutter = static_cast<double>(off) / static_cast<double>(on);
  v.turned = static_cast<double>(turned) / static_cast<double>(on);
  return v;
}

/// Judge a body by all points near it and by sight lines.
/// @param taken whether a point belongs to a body that has won already
template <typename S>
Verdict judge(const PointCloud<S>& cloud, const Grid<S>& grid, const std::vector<char>& taken, const Ellipsoid& body,
              const BodyParameters& parameters, const BodyEvidence& evidence) {
  const auto visit = [&](auto&& f) { visit_near(grid, body, f); };
  Verdict v = judge_points(cloud, visit, 1, taken, body, parameters, evidence.single_view(), true);
  if (v.support < kLeastSupport) return v;
  if (evidence.seen_through) v.seen_through = evidence.seen_through(body);
  if (evidence.seen_on) v.seen_on = evidence.seen_on(body);
  return v;
}

/// Judge a body quickly, by at most kQuick of the points near it, evenly picked.
/// @param near points within near_radius of about its center
/// @param single_view whether all points were seen from one side
template <typename S>
Verdict judge_quickly(const PointCloud<S>& cloud, const Indices& near, const std::vector<char>& taken,
                      const Ellipsoid& body, const BodyParameters& parameters, bool single_view) {
  constexpr std::size_t kQuick = 600;
  const std::size_t step = (near.size() + kQuick - 1) / kQuick;
  const auto visit = [&](auto&& f) {
    for (std::size_t k = 0; k < near.size(); k += step) f(near[k]);
  };
  // A better fit may take in what goes on outside.
  Verdict v = judge_points(cloud, visit, step, taken, body, parameters, single_view, false);
  if (single_view) v.seen_on = 1.0;  // at most; the sensor is asked only about bodies that are worth it
  return v;
}

}  // namespace agrisee::detail
