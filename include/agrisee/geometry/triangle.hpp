// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A single triangle: intersection with a ray, and the nearest point. Metres. Corners have single precision,
/// computations double precision, so that rounding in the differences and products of corners is negligible.
#pragma once

#include <agrisee/core/types.hpp>

#include <array>

namespace agrisee {

/// The corners (m), counter-clockwise as seen from outside.
using Triangle = std::array<Eigen::Vector3f, 3>;

/// Normal of a triangle by the right-hand rule; its length is twice the area (m2).
inline Eigen::Vector3d area_normal(const Triangle& t) {
  const Eigen::Vector3d a = t[0].cast<double>();
  return (t[1].cast<double>() - a).cross(t[2].cast<double>() - a);
}

/// Where a ray hits a triangle.
struct TriangleHit {
  double t;  ///< distance along the ray, in units of the length of its direction
  double u;  ///< barycentric coordinate: the point is (1 - u - v) a + u b + v c for the corners a, b, c
  double v;  ///< barycentric coordinate, see u
};

/// A triangle prepared for rays from one origin.
///
/// A ray hits the triangle if the signed volumes that its direction spans with the three edges have the same sign
/// (Plücker coordinates; e.g. Shevtsov et al., "Ray-triangle intersection algorithm for modern CPU architectures",
/// 2007). Two triangles that share an edge compute the same volume for it, up to the sign, so no ray passes between
/// them (watertight, as in Woop et al., JCGT 2(1), 2013). Edges belong to the triangle, and rays hit it from either
/// side.
///
/// Exact to 1e-6 of the triangle's size as long as this size is above 1e-5 of its distance from the origin; much
/// smaller triangles cannot be represented in single precision.
struct SeenTriangle {
  Eigen::Vector3d bc;      ///< cross product of corners b and c, relative to the origin (m2)
  Eigen::Vector3d ca;      ///< cross product of corners c and a (m2)
  Eigen::Vector3d ab;      ///< cross product of corners a and b (m2)
  Eigen::Vector3d normal;  ///< see area_normal (m2)
  double offset;           ///< of the plane from the origin: a . normal (m3)

  SeenTriangle() = default;
  /// Prepares a triangle for rays from `origin` (m).
  SeenTriangle(const Triangle& t, const Eigen::Vector3d& origin) {
    const Eigen::Vector3d a = t[0].cast<double>() - origin;
    const Eigen::Vector3d b = t[1].cast<double>() - origin;
    const Eigen::Vector3d c = t[2].cast<double>() - origin;
    bc = b.cross(c);
    ca = c.cross(a);
    ab = a.cross(b);
    normal = area_normal(t);
    offset = a.dot(normal);
  }

  /// True if the line through the origin along `d` hits the triangle; hit.t is negative if it does so behind the
  /// origin.
  bool meets(const Eigen::Vector3d& d, TriangleHit& hit) const {
    const double wa = bc.dot(d), wb = ca.dot(d), wc = ab.dot(d);
    const bool inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
    if (!inside) return false;
    const double sum = wa + wb + wc, slope = normal.dot(d);
    if (sum == 0.0 || slope == 0.0) return false;  // the line lies in the plane of the triangle
    hit = {offset / slope, wb / sum, wc / sum};
    return true;
  }
};

/// The point of a triangle nearest to p (m) (Ericson, Real-Time Collision Detection, 5.1.5).
inline Eigen::Vector3d nearest_point(const Triangle& t, const Eigen::Vector3d& p) {
  const Eigen::Vector3d a = t[0].cast<double>(), b = t[1].cast<double>(), c = t[2].cast<double>();
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + (d1 / (d1 - d3)) * ab;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + (d2 / (d2 - d6)) * ac;
  const double va = d3 * d6 - d5 * d4;
  const double e1 = d4 - d3, e2 = d5 - d6;
  if (va <= 0.0 && e1 >= 0.0 && e2 >= 0.0) return b + (e1 / (e1 + e2)) * (c - b);
  const double scale = 1.0 / (va + vb + vc);
  return a + (vb * scale) * ab + (vc * scale) * ac;
}

}  // namespace agrisee
