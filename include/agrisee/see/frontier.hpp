// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The local frame of a frontier point (SEE++; [1], eq. 2): which way the surface faces, and in which direction it
/// continues unseen. World frame, metres. Cost per frame: one query for the k nearest points, and a few steps along the
/// normal.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/neighbors.hpp>
#include <agrisee/see/observation.hpp>
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

/// Memory that is used again from frame to frame. One per thread.
template <typename S = float>
struct FrameScratch {
  Neighbors<S> neighbors;  ///< found so far
  Indices ids;             ///< their indices
};

namespace detail {

/// Indices of the k points nearest to q in no particular order, or of all points if there are fewer. Of points at equal
/// distances those with lower indices are taken. The k-th is expected about `expected` away: for hundreds of neighbors,
/// selecting from all points in a ball is several times faster than a heap.
template <typename S, typename Search>
const Indices& k_nearest(const Search& search, const Vector3<S>& q, std::size_t k, S expected,
                         FrameScratch<S>& scratch) {
  Neighbors<S>& found = scratch.neighbors;
  Indices& ids = scratch.ids;
  for (const S reach : {S(1.1) * expected, S(1.5) * expected, S(2.2) * expected}) {
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
  return ids;
}

/// Principal axes of a frontier's neighbors. If all are on a line, the first axis is the direction across it that is
/// nearest to the line of sight; if all are equal, it is the line of sight.
inline Eigen::Matrix3d frame_axes(const PrincipalAxes<double>& pca, const Eigen::Vector3d& sight) {
  Eigen::Matrix3d axes = pca.axes;
  if (!(pca.variance[2] > 0.0)) {
    axes.col(2) = any_orthogonal<double>(sight);
    axes.col(0) = sight;
  } else if (pca.variance[1] <= 1e-6 * pca.variance[2]) {
    const Eigen::Vector3d line = axes.col(2).normalized();
    const Eigen::Vector3d across = sight - sight.dot(line) * line;
    axes.col(2) = line;
    axes.col(0) = across.norm() > 1e-6 ? across.normalized() : any_orthogonal<double>(line);
  }
  return axes;
}

/// Whether the normal has to be turned round. Two positions move away from the point, along the normal and against it,
/// in steps of upsilon and at most up to psi. The normal points to the one that is in free space first.
inline bool faces_inwards(const Observation& seen, const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
                          const Parameters& parameters) {
  for (int m = 1; m * parameters.upsilon <= parameters.psi; ++m) {
    const Eigen::Vector3d step = (m * parameters.upsilon) * normal;
    if (!seen.hides(p + step)) return false;
    if (!seen.hides(p - step)) return true;
  }
  return false;
}

}  // namespace detail

/// Frame of the frontier point `index`.
///
/// It follows from the principal axes of the k nearest points, the point itself included, or of all points if the cloud
/// is smaller. The normal is the axis of smallest variance, turned towards `seen_from`, and turned round if the free
/// space that `seen` shows is on the other side. `direction` is that of the other two axes along which the point lies
/// farthest from the mean of its neighbors, pointing away from the mean. If all neighbors lie on a line, the normal is
/// the direction across it that is nearest to the line of sight.
///
/// @param cloud any cloud (m, world)
/// @param search a KdTree or Grid over the cloud
/// @param index of the frontier point
/// @param seen_from position of the sensor when it first saw the point (m, world)
/// @param seen the last view
/// @param parameters k, radius, upsilon and psi are used
/// @param scratch memory to use again
/// @param density number of points within `radius`, if known: then the right neighborhood is searched at once; the
///   result does not depend on it but for rounding
/// @return empty if the point is not finite or the sensor is at its place
template <typename C, typename Search>
std::optional<Frontier> frontier_frame(const C& cloud, const Search& search, Index index,
                                       const Eigen::Vector3d& seen_from, const Observation& seen,
                                       const Parameters& parameters, FrameScratch<scalar_t<C>>& scratch,
                                       int density = 0) {
  using S = scalar_t<C>;
  const Vector3<S> q = point(cloud, static_cast<std::size_t>(index));
  Frontier f;
  f.index = index;
  f.point = q.template cast<double>();
  Eigen::Vector3d sight = seen_from - f.point;
  const double range = sight.norm();
  if (!is_finite(q) || !std::isfinite(range) || !(range > 0.0)) return std::nullopt;
  sight /= range;

  // On a surface, the number of points within a distance grows with its square.
  const double share = density > 0 ? static_cast<double>(parameters.k()) / density : 1.0;
  const auto expected = static_cast<S>(parameters.radius * std::sqrt(std::min(share, 16.0)));
  const PrincipalAxes<S> pca =
      principal_axes(cloud, detail::k_nearest<S>(search, q, parameters.k(), expected, scratch));
  const Eigen::Vector3d mean = pca.mean.template cast<double>();
  const Eigen::Matrix3d axes =
      detail::frame_axes({mean, pca.variance.template cast<double>(), pca.axes.template cast<double>()}, sight);
  f.normal = axes.col(0).normalized();
  if (f.normal.dot(sight) < 0.0) f.normal = -f.normal;
  if (detail::faces_inwards(seen, f.point, f.normal, parameters)) f.normal = -f.normal;
  const Eigen::Vector3d t2 = (axes.col(2) - axes.col(2).dot(f.normal) * f.normal).normalized();
  const Eigen::Vector3d t1 = f.normal.cross(t2);
  const Eigen::Vector3d away = f.point - mean;
  f.direction = std::abs(away.dot(t1)) >= std::abs(away.dot(t2)) ? t1 : t2;
  if (f.direction.dot(away) < 0.0) f.direction = -f.direction;
  f.boundary = f.normal.cross(f.direction);
  return f;
}

/// Whether a frontier is valid by [1], eq. 2: its normal points away from the mean `c_o` (m, world) of all points. This
/// discards frontiers that face the gaps of a concave body.
inline bool points_outward(const Frontier& f, const Eigen::Vector3d& c_o) { return f.normal.dot(f.point - c_o) > 0.0; }

}  // namespace agrisee::see
