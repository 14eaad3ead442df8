// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/ellipsoid.hpp>

namespace agrisee {

bool contains(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  return (e.axes.transpose() * (p - e.center)).cwiseQuotient(e.radii).squaredNorm() <= 1.0;
}

Eigen::Vector3d nearest_point(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  const Eigen::Vector3d y = e.axes.transpose() * (p - e.center), squares = e.radii.cwiseAbs2();
  if (y.cwiseQuotient(e.radii).squaredNorm() <= 1.0) return p;
  const Eigen::Vector3d moments = squares.cwiseProduct(y.cwiseAbs2());
  double t = 0.0;
  for (int i = 0; i < 60; ++i) {
    double value = -1.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double s = t + squares[k], term = moments[k] / (s * s);
      value += term;
      slope -= 2.0 * term / s;
    }
    const double step = -value / slope;
    if (!(step > 1e-14 * squares[0])) break;
    t += step;
  }
  return e.center + e.axes * squares.cwiseProduct(y).cwiseQuotient((squares.array() + t).matrix());
}

double support(const OrientedEllipsoid& e, const Eigen::Vector3d& v) {
  return v.dot(e.center) + e.radii.cwiseProduct(e.axes.transpose() * v).norm();
}

double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& p) { return (p - nearest_point(e, p)).norm(); }

double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  double lo = 0.0, hi = 1.0, least = std::min(distance(e, a), distance(e, b));
  for (int i = 0; i < 30 && least > 0.0; ++i) {
    const double t = 0.5 * (lo + hi);
    const Eigen::Vector3d p = a + t * d, away = p - nearest_point(e, p);
    least = std::min(least, away.norm());
    const double slope = away.dot(d);
    if (slope == 0.0) break;
    (slope < 0.0 ? lo : hi) = t;
  }
  return least;
}

}  // namespace agrisee
