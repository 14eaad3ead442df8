// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reconstructs the closed surface of a fruit that is not an ellipsoid, with its center of volume, volume and moments.
///
/// Peppers have lobes, pears a neck, strawberries a point, but all have an axis about which they look the same after a
/// turn by a fraction of a circle. The unseen side therefore follows from the seen ones. The surface is
/// r(u) = exp(sum of c_k Y_k(u)): the logarithm of its distance from the center, in real spherical harmonics about that
/// axis. The c_k have normal priors with mean 0 and variances that describe fruit: large for order 0, the profile of a
/// body of revolution; large for the orders n and 2 n, if the fruit has n lobes; small for all others. This is Gaussian
/// process regression with a covariance that depends on the axis (Rasmussen & Williams, Gaussian Processes for Machine
/// Learning, 2006, 2.1 and 5.4.1). n is chosen by the evidence. Shift and tilt of the axis are unknowns of the same
/// least-squares problem and are applied after each step. Points far from the surface, or with other normals, lose
/// their weight (Tukey's biweight). Points inside may lie farther off than points outside: other things may lie in
/// front of a fruit, but nothing behind its surface can be seen. Where many points lie deep inside, as beside a leaf
/// that looks like a neck of the fruit, the surface is drawn back to them. Evidence is robust as well: a sepal that
/// lies on a round fruit is no reason to give up the ellipsoid. Unlabeled points on the surface join the fruit: the
/// neck of a pear is too far from any ellipsoid to be labeled before. Where no point was seen, sight lines can show
/// that the surface lies farther inside.
///
/// Metres, any frame. Cost: 5 to 20 ms; points are thinned, so it hardly grows with them.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/cloud/surface_fit.hpp>
#include <agrisee/cloud/surface_search.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee {

/// A fruit's closed surface.
struct ClosedSurface {
  /// 0: the ellipsoid explains the points; 1: only this surface does; in between according to the evidence.
  double weight = 0.0;
  double evidence = 0.0;                             ///< logarithm of its probability over the ellipsoid's (nats)
  int lobes = 0;                                     ///< how many, 3 to 9; 0: a body of revolution
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of symmetry, unit; its sign means nothing
  double axis_variance = 0.0;                        ///< of its direction (rad2)
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the volume (m)
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();  ///< m2
  double volume = 0.0;                                          ///< m3
  double volume_error = 0.0;                                    ///< its standard error, relative
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();             ///< covariance of the positions inside it (m2)
  double rms = 0.0;                                             ///< root mean square distance of its points (m)
  Indices joined;    ///< unlabeled points on it, ascending; none if the weight is 0
  Indices left_out;  ///< points of the fruit far outside it, as on a leaf, in their order; none unless weight > 0.5
};

namespace detail {

/// Evidence for an ellipsoid with small, even deviations, from the same bins.
inline double ellipsoid_evidence(const Ellipsoid& body, const SurfaceFit& fit, const std::vector<RadialBin>& bins,
                                 double noise, double uneven) {
  static const SphericalHarmonics basis({4, 4, 4, 4, 4});
  const auto n = static_cast<Eigen::Index>(bins.size()), terms = static_cast<Eigen::Index>(basis.size());
  LinearModel model{Eigen::MatrixXd(terms, n), Eigen::VectorXd(n), SurfaceFit::variances(bins, noise),
                    Eigen::VectorXd(terms)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const RadialBin& bin = bins[static_cast<std::size_t>(i)];
    basis.values(bin.direction, model.B.col(i).data());
    model.y[i] = bin.logarithm - log_distance(body, fit.center(), fit.turn().transpose() * bin.direction);
  }
  for (Eigen::Index k = 0; k < terms; ++k) {
    const int l = basis.terms()[static_cast<std::size_t>(k)].degree;
    const double deviation = l == 0 ? 0.02 : uneven * 2.0 / std::max(2, l);
    model.prior[k] = deviation * deviation;
  }
  return robust_evidence(std::move(model));
}

/// Integrate the surface: center, volume and moments with their standard errors.
inline void integrate(const SurfaceModel& model, const SurfaceFit& fit, const LinearPosterior& posterior,
                      double error_scale, ClosedSurface& out) {
  constexpr int kDirections = 800;
  const Eigen::Index terms = posterior.mean.size();
  double volume = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Eigen::VectorXd values(terms), by_volume = Eigen::VectorXd::Zero(terms);  // of the volume by the coefficients
  Eigen::MatrixXd by_first = Eigen::MatrixXd::Zero(terms, 3);
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3d u = spiral_direction(i, kDirections);
    fit.values(model, u, values.data());
    const double r = std::exp(fit.size() + values.dot(posterior.mean)), r3 = r * r * r;
    volume += r3 / 3.0;
    first += r3 * r / 4.0 * u;
    second += r3 * r * r / 5.0 * u * u.transpose();
    by_volume += r3 * values;
    by_first += values * (r3 * r * u).transpose();
  }
  const Eigen::Vector3d mean = first / volume;
  const Eigen::Matrix3d& turn = fit.turn();
  out.volume = volume * 2.0 * kTwoPi / kDirections;
  out.center = fit.center() + turn.transpose() * mean;
  out.spread = turn.transpose() * (second / volume - mean * mean.transpose()) * turn;
  by_volume /= volume;
  by_first = (by_first / volume - by_volume * mean.transpose()).eval();
  const double scale = error_scale * error_scale;
  const Eigen::Matrix3d covariance = by_first.transpose() * posterior.information.solve(by_first);
  out.center_covariance = scale * turn.transpose() * (0.5 * (covariance + covariance.transpose())) * turn;
  out.volume_error = std::sqrt(scale * by_volume.dot(posterior.information.solve(by_volume)));
  Eigen::MatrixXd tilt = Eigen::MatrixXd::Zero(terms, 2);
  tilt(terms - 2, 0) = tilt(terms - 1, 1) = 1.0;
  out.axis_variance = scale * (tilt.transpose() * posterior.information.solve(tilt)).diagonal().maxCoeff();
  out.axis = turn.row(2);
}

/// Where the surface lies in space that sight lines passed through, and no point was seen: the distance up to which
/// they leave room for it.
/// @return in the axis' frame; their weights are small, since free space is known with an error of some millimetres
inline std::vector<RadialBin> free_space_limits(const SurfaceFit& fit, const SurfaceModel& model,
                                                const IsFree& is_free) {
  constexpr int kDirections = 200;
  constexpr double kSeen = 0.96;  // cosine of the angle from a bin with points within which the surface was seen
  constexpr double kStep = 0.03, kDeepest = 0.5;  // of the surface's distance
  constexpr double kWeight = 0.1;                 // in points
  const std::vector<RadialBin> bins = fit.radial_bins(fit.weights());
  std::vector<RadialBin> out;
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3d u = spiral_direction(i, kDirections);
    if (std::any_of(bins.begin(), bins.end(),
                    [&](const RadialBin& b) { return b.weight > 0.5 && b.direction.dot(u) > kSeen; }))
      continue;
    const double distance = fit.distance(model, u);
    const Eigen::Vector3d out_there = fit.turn().transpose() * u;
    double room = distance;
    while (room > kDeepest * distance && is_free(fit.center() + room * out_there)) room -= kStep * distance;
    if (room < distance && room > kDeepest * distance) out.push_back({u, std::log(room), kWeight});
  }
  return out;
}

/// What a closed surface is fitted to: the fruit's points, evenly picked, then points near it that belong to no fruit.
struct SurfacePoints {
  SurfaceFit::Samples samples;
  Indices near;  ///< the points that belong to no fruit, in the order of the samples
};

/// @param reach points of `others` farther than this from the body's center are not used (m)
/// @param max_points of `own` that are used
template <typename S>
SurfacePoints surface_points(const PointCloud<S>& cloud, const Indices& own, const Indices& others,
                             const Ellipsoid& body, double reach, std::size_t max_points) {
  SurfacePoints out;
  const auto add = [&](Index index) {
    const auto i = static_cast<std::size_t>(index);
    out.samples.points.push_back(cloud.points[i].template cast<double>());
    out.samples.normals.push_back(cloud.normals[i].template cast<double>());
  };
  const std::size_t used = std::min(own.size(), max_points);
  for (std::size_t k = 0; k < used; ++k) add(own[k * own.size() / used]);
  out.samples.own = used;
  for (const Index i : others) {
    const Eigen::Vector3d p = cloud.points[static_cast<std::size_t>(i)].template cast<double>();
    if (!((p - body.center).squaredNorm() < reach * reach)) continue;
    add(i);
    out.near.push_back(i);
  }
  return out;
}

/// Evidence (nats) for a closed surface over the ellipsoid, from the points that either of the two explains.
inline double evidence_over(const Ellipsoid& body, const SurfaceFit& fit, const SurfaceModel& model,
                            const SurfaceFit::Samples& samples, double uneven) {
  constexpr double kNear = 0.05;  // of the radius
  std::vector<double> explained(samples.points.size(), 0.0);
  for (std::size_t i = 0; i < samples.own; ++i)
    explained[i] =
        std::abs(fit.residuals()[i]) < kNear || std::abs(body.distance(samples.points[i])) < kNear * body.mean_radius();
  const std::vector<RadialBin> common = fit.radial_bins(explained);
  const double noise = std::max(kEvidenceNoise, fit.noise());
  return robust_evidence(fit.problem(model, common, noise, kNear)) -
         ellipsoid_evidence(body, fit, common, noise, uneven);
}

/// Set the misfit of a closed surface and, if it counts at all, the points of no fruit that it explains.
inline void explain_points(const SurfaceFit& fit, const SurfacePoints& points, ClosedSurface& out) {
  double squares = 0.0, weights = 0.0;
  const SurfaceFit::Samples& samples = points.samples;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const double weight = fit.weights()[i];
    const double distance = fit.residuals()[i] * (samples.points[i] - fit.center()).norm();
    squares += weight * distance * distance;
    weights += weight;
    if (out.weight > 0.0 && i >= samples.own && weight > 0.0) out.joined.push_back(points.near[i - samples.own]);
  }
  out.rms = weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
  std::sort(out.joined.begin(), out.joined.end());
}

}  // namespace detail

/// Reconstructs the closed surface of a fruit.
/// @param cloud points (m) with normals
/// @param own the fruit's points
/// @param others points that belong to no fruit; those far away are not used
/// @param body the fitted ellipsoid
/// @param axis first guess of the axis of symmetry, towards the stem; the ellipsoid's own axes are tried too
/// @param parameters see their struct
/// @param is_free evidence of free space; empty if nothing is known
/// @return empty if the points are too few or fit no closed surface
/// @throws InputError if the cloud has no normals; ParameterError; Cancelled
template <typename S>
std::optional<ClosedSurface> closed_surface(const PointCloud<S>& cloud, const Indices& own, const Indices& others,
                                            const Ellipsoid& body, const Eigen::Vector3d& axis,
                                            const ClosedSurfaceParameters& parameters = {},
                                            const IsFree& is_free = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "closed_surface: the cloud has no normals");
  constexpr std::size_t kLeast = 30;
  if (own.size() < kLeast) return std::nullopt;
  const Eigen::Vector3d radii = semi_axes(body).first;

  constexpr double kReach = 2.2;  // of the largest semi-axis
  const detail::SurfacePoints points = detail::surface_points(cloud, own, others, body, kReach * radii[0],
                                                              static_cast<std::size_t>(parameters.max_points));
  std::vector<detail::SurfaceModel> models;
  for (const int n : detail::kLobes) models.emplace_back(n, parameters);
  auto found = detail::best_fit(detail::first_guesses(cloud, own, body, axis), points.samples, models, parameters);
  if (!found) return std::nullopt;
  const std::size_t number = found->model;
  const detail::SurfaceModel& model = models[number];
  detail::SurfaceFit fit = detail::without_neighbors(std::move(*found), model).fit;

  constexpr int kLimited = 3;  // steps with the limits by free space
  for (int k = 0; is_free && k < kLimited; ++k) {
    fit.set_limits(detail::free_space_limits(fit, model, is_free));
    if (!fit.step(model, detail::last_gates())) return std::nullopt;
  }

  ClosedSurface out;
  out.lobes = detail::kLobes[number];
  std::vector<detail::RadialBin> bins = fit.radial_bins(fit.weights());
  if (bins.size() < 12) return std::nullopt;
  bins.insert(bins.end(), fit.limits().begin(), fit.limits().end());
  detail::integrate(model, fit, detail::linear_posterior(fit.problem(model, bins, fit.noise(), 1.0)),
                    parameters.error_scale, out);
  const double ratio = out.volume / (4.0 / 3.0 * kPi * radii.prod());
  if (!(ratio > 0.4) || !(ratio < 2.5) || !((out.center - body.center).norm() < 0.6 * radii[0])) return std::nullopt;

  out.evidence = detail::evidence_over(body, fit, model, points.samples, parameters.uneven);
  const double t =
      std::clamp((out.evidence - parameters.doubtful) / (parameters.certain - parameters.doubtful), 0.0, 1.0);
  out.weight = t * t * (3.0 - 2.0 * t);
  detail::explain_points(fit, points, out);
  if (out.weight > 0.5) {
    Eigen::VectorXd values;
    const double far_outside = std::max(0.1, 4.0 * fit.noise());  // relative; closer points shape the surface
    for (std::size_t k = 0; k < own.size(); ++k) {
      if ((k & 0xFF) == 0) throw_if_cancelled();
      const Eigen::Vector3d p = cloud.points[static_cast<std::size_t>(own[k])].template cast<double>();
      if (fit.foot(model, p, values).distance > far_outside) out.left_out.push_back(own[k]);
    }
  }
  return out;
}

}  // namespace agrisee
