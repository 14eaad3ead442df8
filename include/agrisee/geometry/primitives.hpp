// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The solids of collision checks: boxes and upright cylinders to keep out of, capsules for the arm's links.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace agrisee {

/// An axis-aligned solid box (m).
struct Box {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< full edge lengths
};

/// A solid cylinder (m) whose axis is parallel to world's z.
struct Cylinder {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
  double height = 0.0;  ///< full height, half of it on either side of the centre
};

/// A space that neither arm nor sensor may enter; it does not hide anything from the sensor.
struct KeepOut {
  std::string name;
  std::variant<Box, Cylinder> shape;
};

/// All points within `radius` (m) of the segment from a to b.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// Distance (m) from a point to a solid, 0 inside.
inline double distance(const Box& box, const Eigen::Vector3d& p) {
  return ((p - box.center).cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm();
}
inline double distance(const Cylinder& c, const Eigen::Vector3d& p) {
  const Eigen::Vector3d d = p - c.center;
  return std::hypot(std::max(std::hypot(d.x(), d.y()) - c.radius, 0.0),
                    std::max(std::abs(d.z()) - 0.5 * c.height, 0.0));
}
inline double distance(const KeepOut& k, const Eigen::Vector3d& p) {
  return std::visit([&](const auto& shape) { return distance(shape, p); }, k.shape);
}

/// Distance (m) from a solid to the segment from a to b, 0 where they touch; exact to 1e-9 of the segment's length.
///
/// The distance to a convex solid is a convex function along a segment, so golden-section search finds its minimum.
template <typename Solid>
double distance(const Solid& solid, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  constexpr double kGolden = 0.6180339887498949;
  const auto at = [&](double t) { return distance(solid, Eigen::Vector3d(a + t * (b - a))); };
  double lo = 0.0, hi = 1.0;
  double t1 = hi - kGolden * (hi - lo), t2 = lo + kGolden * (hi - lo);
  double f1 = at(t1), f2 = at(t2);
  double best = std::min({at(0.0), at(1.0), f1, f2});
  for (int i = 0; i < 44 && best > 0.0; ++i) {
    if (f1 <= f2) {
      hi = t2, t2 = t1, f2 = f1;
      t1 = hi - kGolden * (hi - lo), f1 = at(t1);
    } else {
      lo = t1, t1 = t2, f1 = f2;
      t2 = lo + kGolden * (hi - lo), f2 = at(t2);
    }
    best = std::min({best, f1, f2});
  }
  return best;
}

/// Distance (m) between the segments p1 q1 and p2 q2 (Ericson, Real-Time Collision Detection, 5.1.9).
inline double segment_distance(const Eigen::Vector3d& p1, const Eigen::Vector3d& q1, const Eigen::Vector3d& p2,
                               const Eigen::Vector3d& q2) {
  const auto clamp01 = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const Eigen::Vector3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  constexpr double kTiny = 1e-18;
  double s = 0.0, t = 0.0;
  if (a <= kTiny && e <= kTiny) return r.norm();
  if (a <= kTiny) {
    t = clamp01(f / e);
  } else if (e <= kTiny) {
    s = clamp01(-c / a);
  } else {
    const double denominator = a * e - b * b;
    s = denominator > kTiny ? clamp01((b * f - c * e) / denominator) : 0.0;
    t = (b * s + f) / e;
    if (t < 0.0) {
      t = 0.0;
      s = clamp01(-c / a);
    } else if (t > 1.0) {
      t = 1.0;
      s = clamp01((b - c) / a);
    }
  }
  return (p1 + s * d1 - p2 - t * d2).norm();
}

}  // namespace agrisee
