// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where each fruit is and how it hangs: centroids, deviations and pose frames ([1], 3.2.4, eq. 16, alg. 3).
/// Metres, world frame. Cost: linear in the points.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <limits>

namespace agrisee {

/// Mean of some points and their standard deviation along each axis.
struct Centroid {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();   ///< m
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< m; the variance is the mean square, not divided by n - 1
};

/// The centroid of the points `indices` of a cloud; zero if there are none.
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

/// Index of the highest point (largest z in world; of equally high ones the first), or -1 for a cloud without finite
/// points.
template <typename C>
Index highest_point(const C& cloud) {
  Index best = -1;
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i)
    if (is_finite(point(cloud, i)) &&
        (best < 0 || point(cloud, i).z() > point(cloud, static_cast<std::size_t>(best)).z()))
      best = static_cast<Index>(i);
  return best;
}

/// The axes (columns x, y, z) of a right-handed frame whose z points along `z` and whose x points along that part of
/// `x_hint` that is orthogonal to z. If `z` has no length, z points up; if that part of `x_hint` has none, x is some
/// direction orthogonal to z.
inline Eigen::Matrix3d frame_from_z_and_x(Eigen::Vector3d z, const Eigen::Vector3d& x_hint) {
  z = z.norm() > 1e-12 ? z.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  Eigen::Vector3d x = x_hint - z * z.dot(x_hint);
  x = x.norm() > 1e-9 * std::max(1.0, x_hint.norm()) ? x.normalized() : any_orthogonal<double>(z);
  Eigen::Matrix3d frame;
  frame << x, z.cross(x), z;
  return frame;
}

/// The one of the points `indices` (m) that has the most others of them within `radius` (m); of several the first. Zero
/// if there are no points.
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

/// The pose frame of [1]: origin at the centroid (not returned), z towards the highest point of the whole cloud, x
/// towards the densest part of the fruit's points, y completing a right-handed frame.
/// @param cloud points (m, world)
/// @param indices the fruit's points
/// @param mean their centroid (m)
/// @param radius see densest_point (m)
/// @return the axes as columns x, y, z
template <typename S>
Eigen::Matrix3d paper_pose_frame(const PointCloud<S>& cloud, const Indices& indices, const Eigen::Vector3d& mean,
                                 double radius = 0.006) {
  const Index top = highest_point(cloud);
  const Eigen::Vector3d z =
      top < 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
              : Eigen::Vector3d(cloud.points[static_cast<std::size_t>(top)].template cast<double>() - mean);
  return frame_from_z_and_x(z, densest_point(cloud, indices, radius) - mean);
}

/// A line through a body's center, and how well its direction is known.
struct BodyAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();       ///< unit; its sign means nothing
  double variance = std::numeric_limits<double>::infinity();  ///< of the direction (rad2)
};

/// The axis about which a body is closest to round: the semi-axis whose length differs most from the other two. Its
/// variance is that of the fit, and grows with the difference between the other two. It is infinite for a sphere and
/// for a body whose covariance is not known.
inline BodyAxis symmetry_axis(const EllipsoidFit& fit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fit.body.A);
  const Eigen::Vector3d& inverse = solver.eigenvalues();  // inverse semi-axes, ascending
  const double below = inverse[1] - inverse[0], above = inverse[2] - inverse[1];
  const int apart = above >= below ? 2 : 0;
  const double gap = std::max(below, above);
  if (!(gap > 1e-9 * inverse[2]) || !(fit.shape_covariance.trace() > 0.0)) return {};  // a sphere, or not measured
  BodyAxis axis;
  axis.direction = solver.eigenvectors().col(apart);
  double tilt =
      0.0;  // (rad2): an eigenvector turns towards another by their entry of A over the gap of the eigenvalues
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

/// Direction (unit, world) from a fruit's center towards its calyx. Fruit are round about their growth axis, so the
/// body's axis gives the line, weighted by its certainty. Its sense follows from unlabeled points just outside the
/// body (calyx, pedicel; nearer ones weigh more) and, weakly, from gravity. If the body is a sphere, these two give the
/// whole direction.
/// @param cloud points (m, world)
/// @param labels one per point; 0: the point belongs to no fruit
/// @param body the fruit's body
/// @param round the axis about which it is round
/// @param parameters see their struct
template <typename S>
Eigen::Vector3d growth_axis(const PointCloud<S>& cloud, const Labels& labels, const Ellipsoid& body,
                            const BodyAxis& round, const GrowthAxisParameters& parameters = {}) {
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
    const double w = near * near * (1.0 + 0.8 * u.z());  // the stem of a hanging fruit is above it
    sum += w * u;
    weights += w;
  }
  Eigen::Vector3d axis = parameters.up_weight * Eigen::Vector3d::UnitZ();
  if (weights > 0.0) axis += std::min(1.0, weights / 10.0) * sum / weights;
  constexpr double kLeastVariance = 1e-3;  // rad2: no fruit's axis is known to better than 2 degrees
  if (std::isfinite(round.variance)) {
    const double certainty = 1.0 / (std::max(round.variance, kLeastVariance) * parameters.stem_certainty);
    const double up = axis.norm() > 1e-9 ? round.direction.dot(axis) : round.direction.z();
    axis += (up < 0.0 ? -certainty : certainty) * round.direction;
  }
  return axis.norm() > 1e-9 ? Eigen::Vector3d(axis.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

/// growth_axis of a fitted body, with its symmetry_axis.
template <typename S>
Eigen::Vector3d growth_axis(const PointCloud<S>& cloud, const Labels& labels, const EllipsoidFit& fit,
                            const GrowthAxisParameters& parameters = {}) {
  return growth_axis(cloud, labels, fit.body, symmetry_axis(fit), parameters);
}

}  // namespace agrisee
