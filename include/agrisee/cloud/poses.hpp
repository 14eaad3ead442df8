// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where each fruit is and how it hangs: centroids, deviations and pose frames (paper, "Localization").
/// Metres, world frame. Cost: linear in the points.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/grid.hpp>
#include <agrisee/core/pose.hpp>

#include <limits>

namespace agrisee {

/// Mean and standard deviation per axis of some points (m).
struct Centroid {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();   ///< m
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< divided by n
};

/// Of the points `indices` of a cloud; zero when there are none.
template <typename C>
Centroid centroid(const C& cloud, const Indices& indices) {
  Centroid out;
  if (indices.empty()) return out;
  const Eigen::Vector3d origin = point(cloud, static_cast<std::size_t>(indices[0])).template cast<double>();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (Index i : indices) {
    const Eigen::Vector3d d = point(cloud, static_cast<std::size_t>(i)).template cast<double>() - origin;
    sum += d;
    squares += d.cwiseAbs2();
  }
  const double n = static_cast<double>(indices.size());
  out.mean = origin + sum / n;
  out.sigma = (squares / n - (sum / n).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return out;
}

/// Indices of the points of each label 1..count; element 0 holds label 1.
inline std::vector<Indices> indices_by_label(const Labels& labels) {
  std::vector<Indices> out;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] <= 0) continue;
    const auto l = static_cast<std::size_t>(labels[i]);
    if (out.size() < l) out.resize(l);
    out[l - 1].push_back(static_cast<Index>(i));
  }
  return out;
}

/// Index of the highest point (largest z in world; ties: the first), or -1 for an empty cloud.
template <typename C>
Index highest_point(const C& cloud) {
  Index best = -1;
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i)
    if (is_finite(point(cloud, i)) &&
        (best < 0 || point(cloud, i).z() > point(cloud, static_cast<std::size_t>(best)).z()))
      best = static_cast<Index>(i);
  return best;
}

/// The axes (columns x, y, z) of a frame whose z points along `z` and whose x points towards `x_hint`, made orthogonal
/// to z; y completes a right-handed frame. Directions of no length fall back: z to up, x to any direction at right
/// angles.
inline Eigen::Matrix3d frame_from_z_and_x(Eigen::Vector3d z, const Eigen::Vector3d& x_hint) {
  z = z.norm() > 1e-12 ? z.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  Eigen::Vector3d x = x_hint - z * z.dot(x_hint);
  x = x.norm() > 1e-9 * std::max(1.0, x_hint.norm()) ? x.normalized() : any_orthogonal<double>(z);
  Eigen::Matrix3d frame;
  frame << x, z.cross(x), z;
  return frame;
}

/// The densest part of some points: the one with the most others of them within `radius` (m; ties: the lowest index).
template <typename S>
Eigen::Vector3d densest_point(const PointCloud<S>& cloud, const Indices& indices, double radius) {
  if (indices.empty()) return Eigen::Vector3d::Zero();
  const PointCloud<S> part = select(cloud, indices);
  const Grid<S> grid(part, static_cast<S>(radius));
  std::size_t best = 0, most = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if ((i & 0xFF) == 0) throw_if_cancelled();
    const std::size_t count = grid.count(part.points[i], static_cast<S>(radius));
    if (count > most) {
      most = count;
      best = i;
    }
  }
  return part.points[best].template cast<double>();
}

/// The paper's pose frame: origin at the centroid (not returned), z towards the highest point of the whole cloud, x
/// towards the densest part (within `radius`, m) of the fruit's points, y completing a right-handed frame.
template <typename S>
Eigen::Matrix3d paper_pose_frame(const PointCloud<S>& cloud, const Indices& indices, const Eigen::Vector3d& mean,
                                 double radius = 0.006) {
  const Index top = highest_point(cloud);
  const Eigen::Vector3d z =
      top < 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
              : Eigen::Vector3d(cloud.points[static_cast<std::size_t>(top)].template cast<double>() - mean);
  return frame_from_z_and_x(z, densest_point(cloud, indices, radius) - mean);
}

/// A line through a body's centre, and how well it is known.
struct BodyAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();       ///< unit; its sign means nothing
  double variance = std::numeric_limits<double>::infinity();  ///< of its direction (rad2)
};

/// The axis about which a body is closest to round: that of the semi-axis that stands apart from the other two. Its
/// variance is that of the fit, and grows as the other two differ; a sphere, and a body of unknown covariance, has
/// none.
inline BodyAxis symmetry_axis(const EllipsoidFit& fit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fit.body.A);
  const Eigen::Vector3d& inverse = solver.eigenvalues();  // of the semi-axes, ascending
  const double below = inverse[1] - inverse[0], above = inverse[2] - inverse[1];
  const int apart = above >= below ? 2 : 0;
  const double gap = std::max(below, above);
  if (!(gap > 1e-9 * inverse[2]) || !(fit.shape_covariance.trace() > 0.0)) return {};  // a sphere, or not measured
  BodyAxis axis;
  axis.direction = solver.eigenvectors().col(apart);
  double tilt = 0.0;  // an eigenvector turns towards another by their entry of A over the gap
  for (int other = 0; other < 3; ++other) {
    if (other == apart) continue;
    const Eigen::Vector3d u = axis.direction, v = solver.eigenvectors().col(other);
    Eigen::Matrix<double, 6, 1> entry;
    entry << u.x() * v.x(), u.y() * v.y(), u.z() * v.z(), u.x() * v.y() + u.y() * v.x(), u.x() * v.z() + u.z() * v.x(),
        u.y() * v.z() + u.z() * v.y();
    const double between = inverse[apart] - inverse[other];
    tilt = std::max(tilt, entry.dot(fit.shape_covariance * entry) / (between * between));
  }
  const double oblong = std::min(below, above) / gap;
  axis.variance = tilt + oblong * oblong;
  return axis;
}

/// Direction (unit, world) from a fruit's centre towards its calyx, from what can be measured: fruit are round about
/// their growth axis, so the body tells the line; the points that belong to no fruit and lie just outside the body
/// (calyx, pedicel), which weigh by their nearness, and gravity, a weak prior, tell which way, and more where the body
/// is a sphere.
/// @param cloud points (m, world)
/// @param labels 0: of no fruit
/// @param fit of the fruit's body
/// @param parameters see their struct
template <typename S>
Eigen::Vector3d growth_axis(const PointCloud<S>& cloud, const Labels& labels, const EllipsoidFit& fit,
                            const GrowthAxisParameters& parameters = {}) {
  const Ellipsoid& body = fit.body;
  const double r = body.mean_radius();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (labels[i] != 0) continue;
    const Eigen::Vector3d p = cloud.points[i].template cast<double>();
    if ((p - body.center).squaredNorm() > 4.0 * r * r) continue;
    const double d = body.distance(p);
    if (d < -0.3 * r || d > parameters.shell * r) continue;
    const double near = 1.0 - std::max(d, 0.0) / (parameters.shell * r);
    const Eigen::Vector3d u = (p - body.center).normalized();
    const double w = near * near * (1.0 + 0.8 * u.z());  // what hangs, hangs from above
    sum += w * u;
    weights += w;
  }
  Eigen::Vector3d axis = parameters.up_weight * Eigen::Vector3d::UnitZ();
  if (weights > 0.0) axis += std::min(1.0, weights / 10.0) * sum / weights;
  const BodyAxis round = symmetry_axis(fit);
  constexpr double kLeastVariance = 1e-3;  // rad2: no fruit is round to better than 2 degrees
  if (std::isfinite(round.variance)) {
    const double certainty = 1.0 / (std::max(round.variance, kLeastVariance) * parameters.stem_certainty);
    const double up = axis.norm() > 1e-9 ? round.direction.dot(axis) : round.direction.z();
    axis += (up < 0.0 ? -certainty : certainty) * round.direction;
  }
  return axis.norm() > 1e-9 ? Eigen::Vector3d(axis.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

}  // namespace agrisee
