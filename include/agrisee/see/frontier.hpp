// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The local frame of a frontier point (SEE++; [1], AgriSEE): which way the surface faces, and in which direction it
/// continues unseen. World frame, metres. Cost per frame: one query for the k nearest points and, if the point was seen
/// at a grazing angle, at most 2 r / upsilon queries for the points in a ball.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/neighbors.hpp>
#include <agrisee/see/parameters.hpp>

#include <algorithm>
#include <optional>

namespace agrisee::see {

/// A frontier point and its right-handed frame (direction, boundary, normal).
struct Frontier {
  Index index = -1;                                      ///< of the point in its cloud
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< m, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     ///< unit, towards free space
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, along the surface towards its unseen part
  Eigen::Vector3d boundary = Eigen::Vector3d::UnitY();   ///< unit, along the edge of the seen part: normal x direction
};

/// If the cosine of the angle of incidence is below this, the line of sight does not tell which side of the surface is
/// outside: a normal may well be wrong by 12 degrees.
constexpr double kGrazing = 0.2;

namespace detail {

/// A position in the scalar type of a search.
template <typename S>
Vector3<S> cast_to(const Eigen::Vector3d& p) {
  return p.template cast<S>();
}

/// Number of balls that hold points, among balls of radius upsilon whose centers lie every upsilon from p along the
/// unit vector `u`, up to `length`.
template <typename S, typename Search>
int occupied_balls(const Search& search, const Eigen::Vector3d& p, const Eigen::Vector3d& u, double upsilon,
                   double length) {
  int occupied = 0;
  for (int m = 1; m * upsilon <= length; ++m)
    if (search.count(cast_to<S>(p + (m * upsilon) * u), static_cast<S>(upsilon), 1) > 0) ++occupied;
  return occupied;
}

/// Indices of the k points nearest to q in no particular order, or of all points if there are fewer. Of points at equal
/// distances those with lower indices are taken. The k-th is expected about `radius` away: for hundreds of neighbors,
/// selecting from all points in a ball is several times faster than a heap.
template <typename S, typename Search>
void k_nearest(const Search& search, const Vector3<S>& q, std::size_t k, S radius, Neighbors<S>& found, Indices& ids) {
  for (const S reach : {S(1.25) * radius, S(2) * radius}) {
    found.clear();
    search.visit(q, reach, [&](Index i, S d_sq) { found.push_back({i, d_sq}); });
    if (found.size() >= k) break;
  }
  if (found.size() < k) search.knn(q, k, found);
  if (found.size() > k) {
    std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(k), found.end(),
                     agrisee::detail::Nearest<S>::before);
    found.resize(k);
  }
  ids.clear();
  for (const Neighbor<S>& n : found) ids.push_back(n.index);
}

}  // namespace detail

/// Frame of the frontier point `index`.
///
/// It follows from the principal axes of the k nearest points, the point itself included, or of all points if the cloud
/// is smaller. The normal is the axis of smallest variance, turned towards `seen_from`. If the point was seen at a
/// grazing angle (kGrazing), free space decides instead: balls of radius upsilon are tested every upsilon, up to r, on
/// both sides, and the normal points to the side on which fewer of them hold points. `direction` is that of the other
/// two axes along which the point lies farthest from the mean of its neighbors, pointing away from the mean. If all
/// neighbors lie on a line, the normal is the direction across it that is nearest to the line of sight.
///
/// @param cloud any cloud (m, world)
/// @param search a KdTree or Grid over the cloud
/// @param near a search with `count(q, r, cap)` for small radii over the same points (may be the same object)
/// @param index of the frontier point
/// @param seen_from position of the sensor when it first saw the point (m, world)
/// @param parameters k, radius and upsilon are used
/// @return empty if the point is not finite or the sensor is at its place
template <typename C, typename Search, typename Near>
std::optional<Frontier> frontier_frame(const C& cloud, const Search& search, const Near& near, Index index,
                                       const Eigen::Vector3d& seen_from, const Parameters& parameters) {
  using S = scalar_t<C>;
  const Vector3<S> q = point(cloud, static_cast<std::size_t>(index));
  Frontier f;
  f.index = index;
  f.point = q.template cast<double>();
  Eigen::Vector3d sight = seen_from - f.point;
  const double range = sight.norm();
  if (!is_finite(q) || !std::isfinite(range) || !(range > 0.0)) return std::nullopt;
  sight /= range;

  thread_local Neighbors<S> neighbors;
  thread_local Indices ids;
  detail::k_nearest<S>(search, q, parameters.k(), static_cast<S>(parameters.radius), neighbors, ids);
  const PrincipalAxes<S> pca = principal_axes(cloud, ids);
  Eigen::Matrix3d axes = pca.axes.template cast<double>();
  const Eigen::Vector3d variance = pca.variance.template cast<double>();
  const double tiny = 1e-6 * variance[2];
  if (!(variance[2] > 0.0)) {  // all points are equal
    axes.col(2) = any_orthogonal<double>(sight);
    axes.col(0) = sight;
  } else if (variance[1] <= tiny) {  // on a line
    const Eigen::Vector3d line = axes.col(2).normalized();
    const Eigen::Vector3d across = sight - sight.dot(line) * line;
    axes.col(2) = line;
    axes.col(0) = across.norm() > 1e-6 ? across.normalized() : any_orthogonal<double>(line);
  }
  f.normal = axes.col(0).normalized();
  const double cosine = f.normal.dot(sight);
  if (cosine < 0.0) f.normal = -f.normal;
  if (std::abs(cosine) < kGrazing) {
    const int ahead = detail::occupied_balls<S>(near, f.point, f.normal, parameters.upsilon, parameters.radius);
    const int behind = detail::occupied_balls<S>(near, f.point, -f.normal, parameters.upsilon, parameters.radius);
    if (ahead > behind) f.normal = -f.normal;
  }
  const Eigen::Vector3d t2 = (axes.col(2) - axes.col(2).dot(f.normal) * f.normal).normalized();
  const Eigen::Vector3d t1 = f.normal.cross(t2);
  const Eigen::Vector3d away = f.point - pca.mean.template cast<double>();
  f.direction = std::abs(away.dot(t1)) >= std::abs(away.dot(t2)) ? t1 : t2;
  if (f.direction.dot(away) < 0.0) f.direction = -f.direction;
  f.boundary = f.normal.cross(f.direction);
  return f;
}

/// Whether a frontier is valid by [1], eq. 2: its normal points away from the mean `c_o` (m, world) of all points. This
/// discards frontiers that face the gaps of a concave body.
inline bool points_outward(const Frontier& f, const Eigen::Vector3d& c_o) { return f.normal.dot(f.point - c_o) > 0.0; }

}  // namespace agrisee::see
