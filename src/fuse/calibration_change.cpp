// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_change.hpp"

#include <cmath>
#include <optional>
#include <utility>

namespace agrisee::fuse {
namespace {

/// What all views show of each body after a change.
std::vector<std::vector<Eigen::Vector3d>> points_of_bodies(const std::vector<FruitSample>& samples,
                                                           const CalibrationChange& change, std::size_t bodies) {
  std::vector<std::vector<Eigen::Vector3d>> out(bodies);
  for (std::size_t v = 0; v < samples.size(); ++v) {
    const PlacedSample view = placed(samples[v], change, v >= change.moved_before);
    for (std::size_t i = 0; i < view.points.size(); ++i)
      out[samples[v].bodies[i]].push_back(view.in_world.points[i].cast<double>());
  }
  return out;
}

/// The points of a body's surface in the directions of others from its center.
std::vector<Eigen::Vector3d> on_surface(std::vector<Eigen::Vector3d> points, const Ellipsoid& body) {
  for (Eigen::Vector3d& p : points) p = body.surface((p - body.center).stableNormalized());
  return points;
}

/// The ball whose surface is nearest to the points, by linear least squares of |p - center|^2 - radius^2 (Kasa, IEEE
/// Trans. Instrumentation and Measurement 1976).
/// @return none for fewer than 30 points, or if they tell no ball
std::optional<Sphere> ball_of(const std::vector<Eigen::Vector3d>& points) {
  constexpr std::size_t kFew = 30;
  if (points.size() < kFew) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), rhs = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / count;
  double squares = 0.0;
  for (const Eigen::Vector3d& p : points) squares += (p - mean).squaredNorm() / count;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d d = p - mean;
    moments += d * d.transpose() / count;
    rhs += 0.5 * (d.squaredNorm() - squares) * d / count;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(moments);
  constexpr double kFlat = 1e-3;
  if (!(solver.vectorD().minCoeff() > kFlat * solver.vectorD().maxCoeff())) return std::nullopt;
  const Eigen::Vector3d center = solver.solve(rhs);
  return Sphere{mean + center, std::sqrt(squares + center.squaredNorm())};
}

/// A body, fitted to registered views, where the reported poses put it on average.
Ellipsoid where_reported(Ellipsoid body, const std::vector<RegisteredView>& views) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const RegisteredView& view : views)
    shift += view.reported * (view.image->world_T_optical.inverse(Eigen::Isometry) * body.center) - body.center;
  body.center += shift / static_cast<double>(views.size());
  return body;
}

/// What changes of the calibration, as likely one as another, make of a body; none if too little of it was compared.
/// @param seen what the views show of it
/// @param changed what they show after each change
std::optional<Misplacement> misplaced(const Ellipsoid& body, const std::vector<Eigen::Vector3d>& seen,
                                      const std::vector<std::vector<Eigen::Vector3d>>& changed) {
  const std::optional<Sphere> as_found = ball_of(on_surface(seen, body));
  if (!as_found) return std::nullopt;
  Misplacement out;
  double told = 0.0, growth = 0.0;
  for (const std::vector<Eigen::Vector3d>& points : changed) {
    const std::optional<Sphere> after = ball_of(points);
    if (!after) continue;
    const Eigen::Vector3d shift = after->center - body.center;
    out.shift += shift * shift.transpose();
    growth += std::pow(std::pow(after->radius / as_found->radius, 3) - 1.0, 2);
    told += 1.0;
  }
  if (!(told > 0.0)) return std::nullopt;
  out.shift /= told;
  out.volume = std::sqrt(growth / told);
  return out;
}

}  // namespace

PlacedSample placed(const FruitSample& sample, const CalibrationChange& change, bool moved) {
  PlacedSample out;
  out.moved = moved;
  const Eigen::Matrix3d turned = change.rotation();
  out.rotation = sample.world_T_optical.linear();
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    Eigen::Vector3d p = sample.points[i];
    if (change.along_rays) p *= p.z() / p.norm();
    p *= 1.0 + change.depth();
    p.head<2>() *= 1.0 + change.spread();
    out.points.push_back(turned * p + change.shift());
    out.normals.push_back(turned * sample.normals[i]);
    Eigen::Vector3d in_world = sample.world_T_optical * out.points.back();
    if (moved) in_world -= change.motion();
    out.in_world.points.push_back(in_world.cast<float>());
    out.in_world.normals.push_back((out.rotation * out.normals.back()).cast<float>());
  }
  return out;
}

std::vector<Misplacement> misplaced(const std::vector<FruitSample>& samples,
                                    const std::vector<CalibrationChange>& changes, const std::vector<Ellipsoid>& bodies,
                                    const std::vector<RegisteredView>& views) {
  const auto seen = points_of_bodies(samples, {}, bodies.size());
  std::vector<std::vector<std::vector<Eigen::Vector3d>>> changed(bodies.size());  // of each body, after each change
  for (const CalibrationChange& change : changes) {
    auto points = points_of_bodies(samples, change, bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) changed[b].push_back(std::move(points[b]));
  }
  std::vector<std::optional<Misplacement>> each;
  Misplacement mean;
  double told = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    each.push_back(misplaced(where_reported(bodies[b], views), seen[b], changed[b]));
    if (!each.back()) continue;
    mean.shift += each.back()->shift;
    mean.volume += each.back()->volume;
    told += 1.0;
  }
  if (told > 0.0) mean = {mean.shift / told, mean.volume / told};
  std::vector<Misplacement> out;
  for (const auto& m : each) out.push_back(m.value_or(mean));
  return out;
}

}  // namespace agrisee::fuse
