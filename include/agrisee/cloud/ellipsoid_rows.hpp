// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The rows of the least squares that fit an ellipsoid to points: residuals, weights and derivatives, of one point or
/// of several at once.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/robust.hpp>

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace agrisee {
namespace detail {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// One row of the least squares: a point's residual from an ellipsoid, with its derivatives. Derivatives are taken at
/// the point's radial projection, not at the point: there they would be correlated with the point's own error, and
/// crescents would come out millimetres too large or too small.
struct EllipsoidRow {
  double residual = 0.0;  ///< distance of the point (m)
  double weight = 0.0;    ///< Tukey's biweight; 0: the point is beyond the gate, or its normal disagrees
  Vector9 derivatives;    ///< of the residual by the center / size and by size * A as (xx, yy, zz, xy, xz, yz); not
                          ///< set where the weight is 0
};

/// What the rows of points consist of. A `Real` is a number, or an Eigen array with one for each of several points:
/// then the compiler can use vector instructions.
template <typename Real>
struct RowTerms {
  Real g;                           ///< |A (p - c)|
  Real steep;                       ///< length of the gradient of g at the radial projection (1/m)
  Real along;                       ///< the gradient times the point's normal (1/m)
  Real residual;                    ///< distance of the point (m)
  std::array<Real, 9> derivatives;  ///< as in EllipsoidRow

  /// A derivative, or the residual as number 9.
  const Real& operator[](std::size_t i) const { return i < 9 ? derivatives[i] : residual; }
};

/// The terms of points (x, y, z), relative to the body's center (m), with normals (nx, ny, nz).
/// @tparam Real,S what the terms are of: a number, or an Eigen array of numbers, and the type of the numbers
/// @param size the unknowns are scaled by this length (m)
template <typename Real, typename S = double>
RowTerms<Real> row_terms(const Ellipsoid& body, Real x, Real y, Real z, const Real& nx, const Real& ny, const Real& nz,
                         double size) {
  using std::sqrt;
  const Eigen::Matrix<S, 3, 3> A = body.A.template cast<S>();
  const S one = 1, length = static_cast<S>(size);
  const auto row_of_A = [&A](int i, const Real& u, const Real& v, const Real& w) -> Real {
    return A(i, 0) * u + A(i, 1) * v + A(i, 2) * w;
  };
  RowTerms<Real> out;
  Real ax = row_of_A(0, x, y, z), ay = row_of_A(1, x, y, z), az = row_of_A(2, x, y, z);
  out.g = sqrt(ax * ax + ay * ay + az * az);
  x /= out.g, y /= out.g, z /= out.g;
  ax = row_of_A(0, x, y, z), ay = row_of_A(1, x, y, z), az = row_of_A(2, x, y, z);
  const Real sx = row_of_A(0, ax, ay, az), sy = row_of_A(1, ax, ay, az), sz = row_of_A(2, ax, ay, az);
  out.steep = sqrt(sx * sx + sy * sy + sz * sz);
  out.along = sx * nx + sy * ny + sz * nz;
  out.residual = (out.g - one) / out.steep;
  const Real scale = one / (out.steep * length), inward = -length / out.steep;
  out.derivatives = {Real(sx * inward),
                     Real(sy * inward),
                     Real(sz * inward),
                     Real(ax * x * scale),
                     Real(ay * y * scale),
                     Real(az * z * scale),
                     Real((ax * y + ay * x) * scale),
                     Real((ax * z + az * x) * scale),
                     Real((ay * z + az * y) * scale)};
  return out;
}

/// Tukey's biweight of a point with these terms; 0 if it is at the center, beyond the gate, or its normal disagrees.
/// @param gate from this residual (m) on the weight is 0
/// @param cos_max cosine of the largest angle between the point's normal and the body's
inline double row_weight(const RowTerms<double>& terms, double gate, double cos_max) {
  const double t = terms.residual / gate;
  return terms.g > 1e-9 && terms.along >= cos_max * terms.steep ? biweight(t) : 0.0;
}

/// The same of several points, none of which is at the center.
template <typename S, int N>
Eigen::Array<S, N, 1> row_weight(const RowTerms<Eigen::Array<S, N, 1>>& terms, double gate, double cos_max) {
  const Eigen::Array<S, N, 1> t = terms.residual / static_cast<S>(gate), near = S(1) - t * t;
  return (near > S(0) && terms.along >= static_cast<S>(cos_max) * terms.steep).select(near * near, S(0));
}

/// The row of a point.
/// @param size the unknowns are scaled by this length (m)
/// @param gate, cos_max as of row_weight
inline EllipsoidRow ellipsoid_row(const Ellipsoid& body, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  double size, double gate, double cos_max) {
  const Eigen::Vector3d d = point - body.center;
  const RowTerms<double> terms = row_terms<double>(body, d.x(), d.y(), d.z(), normal.x(), normal.y(), normal.z(), size);
  EllipsoidRow row;
  if (terms.g > 1e-9) row.residual = terms.residual;
  row.weight = row_weight(terms, gate, cos_max);
  if (row.weight > 0.0) row.derivatives = Eigen::Map<const Vector9>(terms.derivatives.data());
  return row;
}

}  // namespace detail
}  // namespace agrisee
