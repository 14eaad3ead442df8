// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where each fruit is and how it hangs: centroids, deviations and pose frames ([1], 3.2.4, eq. 16, alg. 3).
/// Metres, world frame. Cost: linear in the points.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/neighbors/grid.hpp>

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

}  // namespace agrisee
