// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Center, size and volume of an object, computed from its mesh: the volume centroid and the ellipsoid with the same
/// second moments. World frame, metres. The cost is linear in the number of triangles.
#pragma once

#include <agrisee/geometry/mesh.hpp>

namespace agrisee::study {

/// Moments of a mesh.
struct MeshMoments {
  double volume = 0.0;                                 ///< enclosed volume (m3); 0 if the mesh is not closed
  double area = 0.0;                                   ///< surface area (m2)
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< centroid of the volume (m)
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();     ///< semi-axes of the equivalent ellipsoid (m), largest first
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: unit directions of `radii`, right-handed
  bool closed = false;                                 ///< whether the mesh is closed, see mesh_moments()
};

/// Computes the moments of the solid that a mesh encloses, as integrals over the tetrahedra between its triangles and
/// one common point (Tonon, "Explicit exact formulas for the 3-D tetrahedron inertia tensor", 2005). A solid ellipsoid
/// with the semi-axes r has the variances r^2 / 5 along its axes, so radii = sqrt(5 lambda) for the eigenvalues lambda
/// of the covariance. A mesh whose triangles face inwards gives the same moments.
///
/// A mesh is not closed if its area vectors add up to more than 1 % of its area, or if it encloses no volume. Center
/// and radii then describe its surface, whose variances are about r^2 / 3.
/// @throws InputError if a triangle refers to a missing vertex, or if the area is zero or not finite
MeshMoments mesh_moments(const Mesh& mesh);

}  // namespace agrisee::study
