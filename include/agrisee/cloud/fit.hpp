// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fits spheres and ellipsoids to points with normals, robustly.
///
/// An ellipsoid is { p : |A (p - c)| = 1 } with A symmetric positive definite; its distance from a point is taken to
/// first order at the point's radial projection, (g - 1) g / |A A (p - c)| with g = |A (p - c)| (cf. Taubin, PAMI
/// 1991). Gauss-Newton with Tukey's biweight; where the data do not tell, a prior pulls towards a sphere, so that a
/// crescent yields a sphere and a whole fruit its own shape. Units: metres. Cost: linear in the points per iteration.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee {

/// A sphere (m).
struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.0;                               ///< m
};

/// An ellipsoid in the form that the fit works with.
struct Ellipsoid {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();   ///< symmetric; its eigenvalues are the inverse semi-axes (1/m)

  Ellipsoid() = default;
  /// A sphere as an ellipsoid.
  explicit Ellipsoid(const Sphere& s) : center(s.center), A(Eigen::Matrix3d::Identity() / s.radius) {}
  /// A v, written out: general products are not inlined.
  Eigen::Vector3d times(const Eigen::Vector3d& v) const {
    return {A(0, 0) * v.x() + A(0, 1) * v.y() + A(0, 2) * v.z(), A(1, 0) * v.x() + A(1, 1) * v.y() + A(1, 2) * v.z(),
            A(2, 0) * v.x() + A(2, 1) * v.y() + A(2, 2) * v.z()};
  }
  /// How a point lies to the surface.
  struct Foot {
    double distance;         ///< signed (m), to first order, negative inside
    Eigen::Vector3d normal;  ///< unit, outward, at the point's foot
  };
  /// The foot of p (m).
  Foot foot(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d a = times(p - center), n = times(a);
    const double g = a.norm(), slope = n.norm();
    if (!(slope > 0.0)) return {-mean_radius(), Eigen::Vector3d::UnitZ()};
    return {(g - 1.0) * g / slope, n / slope};
  }
  /// Signed distance of p to the surface (m), as of foot().
  double distance(const Eigen::Vector3d& p) const { return foot(p).distance; }
  /// Unit normal at the foot of p, outward.
  Eigen::Vector3d normal(const Eigen::Vector3d& p) const { return foot(p).normal; }
  /// Radius of the sphere whose inverse is the mean of the inverse semi-axes (m).
  double mean_radius() const { return 3.0 / A.trace(); }
  /// Point of the surface in direction `d` (unit) from the centre.
  Eigen::Vector3d surface(const Eigen::Vector3d& d) const { return center + d / (A * d).norm(); }
};

/// Semi-axes (m, largest first) and their directions (columns, right-handed).
inline std::pair<Eigen::Vector3d, Eigen::Matrix3d> semi_axes(const Ellipsoid& e) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(e.A);  // ascending: smallest inverse first
  Eigen::Matrix3d axes = solver.eigenvectors();
  for (int i = 0; i < 2; ++i) {  // signs by a rule, so that equal bodies print alike
    Eigen::Index largest;
    axes.col(i).cwiseAbs().maxCoeff(&largest);
    if (axes(largest, i) < 0.0) axes.col(i) *= -1.0;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {solver.eigenvalues().cwiseInverse(), axes};
}

/// What a fit found.
struct EllipsoidFit {
  Ellipsoid body;                                               ///< as fitted
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();  ///< m2
  /// Of body.A as (xx, yy, zz, xy, xz, yz) (1/m2), what was expected of its shape included.
  Eigen::Matrix<double, 6, 6> shape_covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms = 0.0;         ///< of the inliers (m)
  std::size_t inliers = 0;  ///< points within three noises whose normals agree
};

/// The sphere through points with outward normals: p = c + r n is linear in c and r, so r is the regression of points
/// on normals. Empty for fewer than 4 points or normals that hardly differ.
template <typename S>
std::optional<Sphere> sphere_from_normals(const PointCloud<S>& cloud, const Indices& indices) {
  if (indices.size() < 4) return std::nullopt;
  Eigen::Vector3d p_mean = Eigen::Vector3d::Zero(), n_mean = Eigen::Vector3d::Zero();
  for (Index i : indices) {
    p_mean += cloud.points[static_cast<std::size_t>(i)].template cast<double>();
    n_mean += cloud.normals[static_cast<std::size_t>(i)].template cast<double>();
  }
  const auto n = static_cast<double>(indices.size());
  p_mean /= n;
  n_mean /= n;
  double pn = 0.0, nn = 0.0;
  for (Index i : indices) {
    const Eigen::Vector3d dn = cloud.normals[static_cast<std::size_t>(i)].template cast<double>() - n_mean;
    pn += dn.dot(cloud.points[static_cast<std::size_t>(i)].template cast<double>() - p_mean);
    nn += dn.squaredNorm();
  }
  if (!(nn > 1e-6 * n)) return std::nullopt;
  const double r = pn / nn;
  return Sphere{p_mean - r * n_mean, r};
}

namespace detail {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// What a point says of an ellipsoid, to first order at the point's radial projection: derivatives that saw the point's
/// own error would be correlated with its residual, and crescents turn that into millimetres.
struct EllipsoidRow {
  double residual = 0.0;  ///< distance of the point (m)
  double weight = 0.0;    ///< Tukey's biweight; 0: the point is beyond the gate, or its normal disagrees
  Vector9 derivatives;    ///< of the residual by the centre / size and by size * A as (xx, yy, zz, xy, xz, yz)
};

/// @param size by which the unknowns are scaled (m)
/// @param gate residual at which a point's weight ends (m)
/// @param cos_max cosine of the largest angle between the point's normal and the body's
inline EllipsoidRow ellipsoid_row(const Ellipsoid& body, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  double size, double gate, double cos_max) {
  EllipsoidRow row;
  Eigen::Vector3d d = point - body.center;
  const double g = body.times(d).norm();
  if (!(g > 1e-9)) return row;
  d /= g;
  const Eigen::Vector3d a = body.times(d), slope = body.times(a);
  const double steep = slope.norm();
  row.residual = (g - 1.0) / steep;
  const double t = row.residual / gate;
  if (slope.dot(normal) < cos_max * steep || !(std::abs(t) < 1.0)) return row;
  row.weight = (1.0 - t * t) * (1.0 - t * t);
  const double scale = 1.0 / (steep * size);
  row.derivatives << slope * (-size / steep), a.x() * d.x() * scale, a.y() * d.y() * scale, a.z() * d.z() * scale,
      (a.x() * d.y() + a.y() * d.x()) * scale, (a.x() * d.z() + a.z() * d.x()) * scale,
      (a.y() * d.z() + a.z() * d.y()) * scale;
  return row;
}

/// Information of the prior that the deviatoric part of size * A is small.
inline Matrix9 shape_information(const Ellipsoid& body, double size, double shape_prior) {
  const double relative = body.A.trace() * size / 3.0;  // mean of the inverse semi-axes, in units of 1 / size
  Matrix9 prior = Matrix9::Zero();
  prior.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity() - Eigen::Matrix3d::Constant(1.0 / 3.0);
  prior.diagonal().tail<3>().setConstant(2.0);
  prior /= shape_prior * shape_prior * relative * relative;
  return prior;
}

}  // namespace detail

/// Fit an ellipsoid to the points `indices` of a cloud with normals, starting from `start`.
///
/// Empty when fewer than `parameters.independent / 10 + 4` points support it or the fit degenerates.
/// @throws InputError when the cloud has no normals; ParameterError
template <typename S>
std::optional<EllipsoidFit> fit_ellipsoid(const PointCloud<S>& cloud, const Indices& indices, const Ellipsoid& start,
                                          const FitParameters& parameters = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "fit_ellipsoid: the cloud has no normals");
  const std::size_t least = static_cast<std::size_t>(parameters.independent / 10 + 4);
  if (indices.size() < least) return std::nullopt;
  const double cos_max = std::cos(parameters.max_angle);
  using detail::Matrix9, detail::Vector9;

  // What is used of the cloud, gathered once.
  struct Sample {
    Eigen::Vector3d point, normal;
  };
  const std::size_t used = std::min(indices.size(), std::max(least, static_cast<std::size_t>(parameters.max_points)));
  std::vector<Sample> samples(used);
  for (std::size_t k = 0; k < used; ++k) {
    const auto i = static_cast<std::size_t>(indices[k * indices.size() / used]);
    samples[k] = {cloud.points[i].template cast<double>(), cloud.normals[i].template cast<double>()};
  }

  const double share = static_cast<double>(indices.size()) / static_cast<double>(used);  // points a sample stands for

  EllipsoidFit fit;
  fit.body = start;
  const double size = start.mean_radius();
  double gate = std::max(6.0 * parameters.noise, 0.12 * size);
  Matrix9 information = Matrix9::Zero();  // of the last step
  for (int iteration = 0; iteration < parameters.iterations; ++iteration) {
    // Unknowns: the centre in units of `size`, and B = A * size - I as (xx, yy, zz, xy, xz, yz). The tenth row and
    // column of the products belong to the residual.
    Eigen::Matrix<double, 10, 10> products = Eigen::Matrix<double, 10, 10>::Zero();
    double weights = 0.0, squares = 0.0;
    std::size_t inliers = 0;
    const Ellipsoid body = fit.body;
    const double inlier = 3.0 * std::max(parameters.noise, 0.01 * size);
    for (const Sample& sample : samples) {
      if (((&sample - samples.data()) & 0xFFF) == 0) throw_if_cancelled();
      const auto row = detail::ellipsoid_row(body, sample.point, sample.normal, size, gate, cos_max);
      if (!(row.weight > 0.0)) continue;
      Eigen::Matrix<double, 10, 1> j;
      j << row.derivatives, row.residual;
      products.noalias() += (row.weight * j).lazyProduct(j.transpose());
      weights += row.weight;
      if (std::abs(row.residual) < inlier) ++inliers, squares += row.residual * row.residual;
    }
    Matrix9 normal_matrix = products.topLeftCorner<9, 9>();
    Vector9 rhs = -products.topRightCorner<9, 1>();
    if (share * weights < 0.3 * static_cast<double>(least)) return std::nullopt;
    const double certainty = std::min(share, parameters.independent / weights) / (parameters.noise * parameters.noise);
    normal_matrix *= certainty;
    rhs *= certainty;
    // The prior: the deviatoric part of B is small.
    const Eigen::Matrix3d B = body.A * size - Eigen::Matrix3d::Identity();
    const Matrix9 prior = detail::shape_information(body, size, parameters.shape_prior);
    Vector9 b = Vector9::Zero();
    b.tail<6>() << B(0, 0), B(1, 1), B(2, 2), B(0, 1), B(0, 2), B(1, 2);
    rhs -= prior * b;
    normal_matrix += prior;
    normal_matrix.diagonal().array() += 1e-9 * normal_matrix.diagonal().maxCoeff();
    const Eigen::LDLT<Matrix9> solver(normal_matrix);
    const Vector9 step = solver.solve(rhs);
    if (!step.allFinite()) return std::nullopt;
    const double longest = std::max(step.head<3>().norm(), step.tail<6>().cwiseAbs().maxCoeff());
    const double damp = longest > 0.3 ? 0.3 / longest : 1.0;
    fit.body.center += damp * size * step.head<3>();
    Eigen::Matrix3d dA;
    dA << step[3], step[6], step[7], step[6], step[4], step[8], step[7], step[8], step[5];
    fit.body.A += damp * dA / size;
    const Eigen::Vector3d inverse_axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(fit.body.A).eigenvalues();
    if (!(inverse_axes[0] > 0.2 / size) || !(inverse_axes[2] < 5.0 / size)) return std::nullopt;
    fit.inliers = static_cast<std::size_t>(share * static_cast<double>(inliers));
    fit.rms = inliers ? std::sqrt(squares / static_cast<double>(inliers)) : 0.0;
    information = normal_matrix;
    gate = std::max(0.7 * gate, std::max(4.0 * parameters.noise, 0.05 * size));
    if (iteration > 3 && longest < 1e-4) break;
  }
  if (fit.inliers < least / 2) return std::nullopt;
  const Matrix9 covariance = Eigen::LDLT<Matrix9>(information).solve(Matrix9::Identity());
  fit.center_covariance = covariance.topLeftCorner<3, 3>() * size * size;
  fit.shape_covariance = covariance.bottomRightCorner<6, 6>() / (size * size);
  return fit;
}

}  // namespace agrisee
