// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Is a frontier visible from a view, and if not, from which side is it freest? (SEE++, view optimisation). World,
/// metres.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/see/proposal.hpp>

#include <algorithm>
#include <array>

namespace agrisee::see {

/// True when the sight line from the point p to a sensor is free.
///
/// Balls of radius upsilon are tested every upsilon along the line, to the sensor or up to psi, whichever is nearer.
/// Those before the first empty one belong to the surface of p itself; every later one must be empty too. A line along
/// which no ball is empty is blocked. Where `bounds` is given, the part of the line outside it (plus upsilon) is known
/// to be free. Cost: at most psi / upsilon ball queries.
/// @param search a neighbour search with `count(q, r, cap)`, of scalar S
/// @param p the point (m)
/// @param sensor position of the sensor (m)
/// @param params see their struct
/// @param bounds box about the cloud; nothing beyond it occludes
template <typename S, typename Search>
bool is_visible(const Search& search, const Eigen::Vector3d& p, const Eigen::Vector3d& sensor, const Parameters& params,
                const Aabb& bounds) {
  const Eigen::Vector3d line = sensor - p;
  const double range = line.norm();
  if (!(range > 0.0) || !std::isfinite(range)) return false;
  const Eigen::Vector3d u = line / range;
  const double length = std::min(params.psi, range);
  bool left_surface = false;
  for (int m = 1; m * params.upsilon <= length; ++m) {
    const Eigen::Vector3d at = p + (m * params.upsilon) * u;
    if (bounds.distance(at) > params.upsilon) return true;  // p lies within: the line does not come back
    const bool occupied = search.count(Vector3<S>(at.cast<S>()), static_cast<S>(params.upsilon), 1) > 0;
    if (occupied && left_surface) return false;
    left_surface = left_surface || !occupied;
  }
  return left_surface || length < params.upsilon;
}

/// Unit directions from p to the points that can occlude it: those farther than upsilon and within psi.
template <typename C>
std::vector<Eigen::Vector3f> occluder_directions(const C& cloud, const Eigen::Vector3d& p, double upsilon, double psi) {
  std::vector<Eigen::Vector3f> out;
  out.reserve(agrisee::size(cloud));
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
    const Eigen::Vector3f d = (point(cloud, i).template cast<double>() - p).template cast<float>();
    const float range = d.norm();
    if (range > static_cast<float>(upsilon) && range <= static_cast<float>(psi)) out.push_back(d / range);
  }
  return out;
}

/// A direction and its angle (rad) to the nearest occluder, pi where there is none.
struct FreeDirection {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  double clearance = kPi;                                ///< angle to the nearest occluder (rad)
};

namespace detail {

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
    std::vector<Patch> roots;  // an octahedron with its tip on the axis; its far half where that is allowed
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
    std::vector<Eigen::Vector3f> occluders;  // those that may be nearest somewhere in it
    double bound;                            // no direction in it has a larger clearance
    double extent;                           // from its centre to its corners (rad)
  };

  /// Measure a triangle at its centre and keep it if it may hold something better.
  void add(std::vector<Patch>& patches, const Triangle& t, const std::vector<Eigen::Vector3f>& candidates) {
    const Eigen::Vector3f centre = (t[0] + t[1] + t[2]).normalized();
    double extent = 0.0;
    for (const Eigen::Vector3f& c : t) extent = std::max(extent, angle_between(centre, c));
    const double off_axis = angle_between(centre, axis_);
    if (off_axis > max_angle_ + extent) return;
    float nearest = -1.0f;
    Eigen::Vector3f occluder = -centre;
    for (const Eigen::Vector3f& o : candidates) {
      const float c = o.dot(centre);
      if (c > nearest) {
        nearest = c;
        occluder = o;
      }
    }
    const double clearance = candidates.empty() ? kPi : angle_between(centre, occluder);
    // The centre itself, also when it is outside by no more than the tolerance: the patch it stands for is not.
    if (clearance > best_.clearance && off_axis <= max_angle_ + tolerance_) best_ = {centre.cast<double>(), clearance};
    // Clearance changes by no more than the angle moved.
    if (extent <= tolerance_ || clearance + extent <= best_.clearance + tolerance_) return;
    Patch patch{t, {}, clearance + extent, extent};
    const double far = clearance + 2.0 * extent + 1e-4;  // farther ones are nearest nowhere in the patch
    const float cosine = far >= kPi ? -2.0f : static_cast<float>(std::cos(far));
    for (const Eigen::Vector3f& o : candidates)
      if (o.dot(centre) >= cosine) patch.occluders.push_back(o);
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

/// The direction within `max_angle` of `axis` whose smallest angle to all occluders is largest (SEE++, view
/// optimisation).
///
/// SEE++ solves a quadratic programme, which has one optimum only where the occluders leave half of the sphere free.
/// Here a branch and bound over spherical triangles finds the global one to `tolerance`, in any case: the clearance
/// found is at most `tolerance` below the best, and the direction at most `tolerance` outside the cone.
/// @param occluders unit directions; none = the axis itself with a clearance of pi
/// @param axis unit; @param max_angle (rad) in (0, pi]; @param tolerance (rad), >= 1e-4
/// Cost: about 20 passes over the occluders.
/// @throws InputError when axis or angles are out of range
inline FreeDirection freest_direction(const std::vector<Eigen::Vector3f>& occluders, const Eigen::Vector3d& axis,
                                      double max_angle, double tolerance = deg(0.5)) {
  check_input(std::abs(axis.norm() - 1.0) < 1e-3, "freest_direction: the axis is not a unit vector");
  check_input(max_angle > 0.0 && max_angle <= kPi + 1e-9, "freest_direction: the largest angle is not in (0, pi]");
  check_input(tolerance >= 1e-4 && tolerance < 1.0, "freest_direction: the tolerance is not in [1e-4, 1)");
  if (occluders.empty()) return {axis, kPi};
  return detail::FreeSearch(axis, max_angle, tolerance).run(occluders);
}

/// The proposal for a frontier: along its normal where that sight is free, else from the freest side within
/// `max_incidence` of the normal (which may still be blocked).
/// @param cloud any cloud (m, world); @param search a search over it with `count(q, r, cap)`
/// @param f the frontier
/// @param params see their struct
/// @param bounds a box that holds the cloud
template <typename C, typename Search>
ViewProposal propose_visible(const C& cloud, const Search& search, const Frontier& f, const Parameters& params,
                             const Aabb& bounds) {
  ViewProposal v = propose(f, params.view_distance);
  if (is_visible<scalar_t<C>>(search, f.point, v.position, params, bounds)) return v;
  const auto occluders = occluder_directions(cloud, f.point, params.upsilon, params.psi);
  const FreeDirection free = freest_direction(occluders, f.normal, params.max_incidence);
  return view_of(f.point, f.index, free.direction.normalized(), params.view_distance);
}

}  // namespace agrisee::see
