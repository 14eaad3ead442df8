// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a frontier is visible from a view and, if not, from which side it is farthest from all occluders (SEE++,
/// view optimization). World frame, metres.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/see/proposal.hpp>

#include <algorithm>
#include <array>

namespace agrisee::see {

/// How far (m) the surface's own points reach at a frontier (SEE++): balls of radius upsilon are tested every upsilon
/// along its normal, from the point on, up to the first that holds no points. The first two hold the frontier itself.
/// Cost: one query for each other.
/// @param search a neighbor search with `count(q, r, cap)`, of scalar S
template <typename S, typename Search>
double surface_depth(const Search& search, const Frontier& f, double upsilon) {
  for (int m = 2;; ++m) {
    const Vector3<S> at = (f.point + (m * upsilon) * f.normal).template cast<S>();
    if (search.count(at, static_cast<S>(upsilon), 1) == 0) return m * upsilon;
  }
}

/// True if the line of sight from the point p to a sensor is free (SEE++).
///
/// Balls of radius upsilon are tested every upsilon along the line, from `start` to `start` + psi. All must be empty.
/// Cost: at most psi / upsilon queries for the points in a ball.
/// @param search a neighbor search with `count(q, r, cap)`, of scalar S
/// @param p the point (m, world)
/// @param start distance of the first ball from p (m): the surface_depth() of the frontier there
/// @param sensor position of the sensor (m, world)
/// @param parameters psi and upsilon are used
/// @param bounds box about the cloud; what is farther than upsilon outside it is known to be free
template <typename S, typename Search>
bool is_visible(const Search& search, const Eigen::Vector3d& p, double start, const Eigen::Vector3d& sensor,
                const Parameters& parameters, const Aabb& bounds) {
  const Eigen::Vector3d line = sensor - p;
  const double range = line.norm();
  if (!(range > 0.0) || !std::isfinite(range)) return false;
  const Eigen::Vector3d u = line / range;
  for (int m = 0; m * parameters.upsilon < parameters.psi; ++m) {
    const Eigen::Vector3d at = p + (start + m * parameters.upsilon) * u;
    if (bounds.distance(at) > parameters.upsilon) return true;  // p is inside, so the line does not enter again
    if (search.count(Vector3<S>(at.cast<S>()), static_cast<S>(parameters.upsilon), 1) > 0) return false;
  }
  return true;
}

/// Unit directions to the points that can occlude a frontier: those at most psi (m) from it, seen from `eye` (m,
/// world).
/// @param points a search with `size()` and `point(i)`: points of the cloud that are about upsilon apart
template <typename Points>
std::vector<Eigen::Vector3f> occluder_directions(const Points& points, const Eigen::Vector3d& frontier,
                                                 const Eigen::Vector3d& eye, double psi) {
  std::vector<Eigen::Vector3f> out;
  out.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points.point(i).template cast<double>();
    if ((p - frontier).squaredNorm() > psi * psi) continue;
    const Eigen::Vector3d d = p - eye;
    const double range = d.norm();
    if (range > 0.0) out.push_back((d / range).cast<float>());
  }
  return out;
}

/// A direction and its clearance: the angle to the nearest occluder.
struct FreeDirection {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  double clearance = kPi;                                ///< angle to the nearest occluder (rad); pi if there is none
};

namespace detail {

/// Angle (rad) between two unit vectors; exact for small angles, too.
inline double angle_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return 2.0 * std::atan2(double((a - b).norm()), double((a + b).norm()));
}

/// Branch and bound over spherical triangles; see freest_direction.
class FreeSearch {
 public:
  FreeSearch(const Eigen::Vector3d& axis, double max_angle, double tolerance)
      : axis_(axis.cast<float>()), max_angle_(max_angle), tolerance_(tolerance) {}

  FreeDirection run(const std::vector<Eigen::Vector3f>& occluders) {
    best_.clearance = -1.0;
    const Eigen::Vector3f x = any_orthogonal<float>(axis_), y = axis_.cross(x);
    std::vector<Patch> roots;  // the faces of an octahedron with a tip on the axis
    const std::array<Eigen::Vector3f, 4> ring{x, y, Eigen::Vector3f(-x), Eigen::Vector3f(-y)};
    for (std::size_t i = 0; i < 4; ++i)
      for (const float tip : {1.0f, -1.0f}) add(roots, {tip * axis_, ring[i], ring[(i + 1) % 4]}, occluders);
    descend(roots, 0);
    return best_;
  }

 private:
  using Triangle = std::array<Eigen::Vector3f, 3>;
  struct Patch {
    Triangle corners;
    std::vector<Eigen::Vector3f> occluders;  // those that may be the nearest one for some direction in it
    double bound;                            // no direction in it has a larger clearance (rad)
    double extent;                           // largest angle from its center to a corner (rad)
  };

  /// Measure the clearance at a triangle's center, and append the triangle if it may hold a better direction.
  void add(std::vector<Patch>& patches, const Triangle& t, const std::vector<Eigen::Vector3f>& candidates) {
    const Eigen::Vector3f center = (t[0] + t[1] + t[2]).normalized();
    double extent = 0.0;
    for (const Eigen::Vector3f& c : t) extent = std::max(extent, angle_between(center, c));
    const double off_axis = angle_between(center, axis_);
    if (off_axis > max_angle_ + extent) return;
    float nearest = -1.0f;
    Eigen::Vector3f occluder = -center;
    for (const Eigen::Vector3f& o : candidates) {
      const float c = o.dot(center);
      if (c > nearest) {
        nearest = c;
        occluder = o;
      }
    }
    const double clearance = candidates.empty() ? kPi : angle_between(center, occluder);
    // A center that is outside the cone by no more than the tolerance counts, too: part of its triangle is inside.
    if (clearance > best_.clearance && off_axis <= max_angle_ + tolerance_) best_ = {center.cast<double>(), clearance};
    // A direction that is turned by some angle changes its clearance by no more than that angle.
    if (extent <= tolerance_ || clearance + extent <= best_.clearance + tolerance_) return;
    Patch patch{t, {}, clearance + extent, extent};
    const double far = clearance + 2.0 * extent + 1e-4;  // occluders farther away are nowhere the nearest
    const float cosine = far >= kPi ? -2.0f : static_cast<float>(std::cos(far));
    for (const Eigen::Vector3f& o : candidates)
      if (o.dot(center) >= cosine) patch.occluders.push_back(o);
    patches.push_back(std::move(patch));
  }

  void descend(std::vector<Patch>& patches, int depth) {
    std::stable_sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.bound > b.bound; });
    for (const Patch& p : patches) {
      if (p.bound <= best_.clearance + tolerance_ || depth > 20) continue;
      const auto& [a, b, c] = p.corners;
      const Eigen::Vector3f ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
      std::vector<Patch> children;
      add(children, {ab, bc, ca}, p.occluders);
      add(children, {a, ab, ca}, p.occluders);
      add(children, {b, bc, ab}, p.occluders);
      add(children, {c, ca, bc}, p.occluders);
      descend(children, depth + 1);
    }
  }

  Eigen::Vector3f axis_;
  double max_angle_, tolerance_;
  FreeDirection best_;
};

}  // namespace detail

/// The direction within `max_angle` of `axis` whose angle to the nearest occluder is largest (SEE++, view
/// optimization).
///
/// SEE++ solves a quadratic program. That has a single optimum only if the occluders leave half of the sphere free.
/// Here a branch and bound over spherical triangles always finds the global optimum to within `tolerance`: the
/// clearance is at most `tolerance` below the best, and the direction at most `tolerance` outside the cone. Cost: about
/// 20 passes over the occluders.
/// @param occluders unit directions; if there are none, the result is the axis with a clearance of pi
/// @param axis of the cone, a unit vector
/// @param max_angle half angle of the cone (rad), in (0, pi]
/// @param tolerance of the result (rad), in [1e-4, 1)
/// @throws InputError if axis or angles are out of range
inline FreeDirection freest_direction(const std::vector<Eigen::Vector3f>& occluders, const Eigen::Vector3d& axis,
                                      double max_angle, double tolerance = deg(0.5)) {
  check_input(std::abs(axis.norm() - 1.0) < 1e-3, "freest_direction: the axis is not a unit vector");
  check_input(max_angle > 0.0 && max_angle <= kPi + 1e-9, "freest_direction: the largest angle is not in (0, pi]");
  check_input(tolerance >= 1e-4 && tolerance < 1.0, "freest_direction: the tolerance is not in [1e-4, 1)");
  if (occluders.empty()) return {axis, kPi};
  return detail::FreeSearch(axis, max_angle, tolerance).run(occluders);
}

/// The view of a frontier from the side that is farthest from all its occluders (SEE++, view optimization). They are
/// seen from a place at the distance `start` in front of the frontier, on the line to `seen_from`: so the surface's own
/// points do not fill all directions. Sides behind the surface are left out: in gaps between its points, rays would
/// pass through it. Even the best view may be blocked.
/// @param points see occluder_directions()
/// @param f the frontier
/// @param start the frontier's surface_depth() (m)
/// @param seen_from position of the sensor that first saw the frontier (m, world)
/// @param parameters view_distance and psi are used
template <typename Points>
ViewProposal propose_around(const Points& points, const Frontier& f, double start, const Eigen::Vector3d& seen_from,
                            const Parameters& parameters) {
  const Eigen::Vector3d line = seen_from - f.point;
  const Eigen::Vector3d first = line.norm() > 0.0 ? Eigen::Vector3d(line.normalized()) : f.normal;
  const auto occluders = occluder_directions(points, f.point, f.point + start * first, parameters.psi);
  const FreeDirection free = freest_direction(occluders, f.normal, 0.5 * kPi);
  return view_of(f.point, f.index, free.direction.normalized(), parameters.view_distance);
}

}  // namespace agrisee::see
