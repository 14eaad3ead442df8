// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the camera measured around the fruit (stems, leaves, trays, posts), and how much of it an approach crosses.
/// Geometry cannot tell a leaf, which gives way, from a post, which does not: what is crossed is an area, and it is up
/// to the parameters how much of it is too much. World frame, metres. Cost: about 0.1 us per cell near a fruit and 0.03
/// us per point.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/pick/approach.hpp>

namespace agrisee::pick {

constexpr double kPieceEdge = 0.005;  ///< edge of the cells in which measured surface is counted (m)
/// What is nearer than this (m) to the body of a fruit does not count: most of that is points of the fruit that got no
/// label, and its calyx.
constexpr double kRim = 0.005;

/// A small piece of measured surface.
struct SurfacePiece {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of its points (m)
  double area = 0.0;                                 ///< m2
};

/// The points that belong to no fruit, with their normals if these are known (else zero): of a scan's cloud those
/// without label, and of its raw cloud those that are not in it. Most of the latter were dropped because other views
/// looked through them: rims of leaves, thin stalks, and leaves measured too deep, which each view puts elsewhere. So
/// something is near. Counting them halves the true surface that approaches cross (plants, `l515`).
/// @param cloud points (m, world)
/// @param labels one per point: the id of its fruit, 0 = none
/// @param raw the points from which `cloud` was chosen (m, world); may be empty
/// @throws InputError when the numbers of points, normals and labels differ
Cloud surroundings_of(const Cloud& cloud, const Labels& labels, const Cloud& raw = {});

/// The surface that points show: a piece for every cell, of edge kPieceEdge, that holds finite points. A plane with
/// unit normal n passes through (|n_x| + |n_y| + |n_z|) / edge^2 cells per area, so each stands for edge^2 / (|n_x| +
/// |n_y| + |n_z|); where no normal is known, for its mean over all directions, edge^2 / 1.5. Surface that noise spreads
/// over several layers of cells counts several times. The result does not depend on the order of the points.
/// @param surroundings points (m), their normals if known
/// @throws InputError as check_lengths
std::vector<SurfacePiece> surface_pieces(const Cloud& surroundings);

/// The pieces whose centers are at least `least` (m) from a fruit's body.
std::vector<SurfacePiece> pieces_beyond(double least, const OrientedEllipsoid& fruit,
                                        const std::vector<SurfacePiece>& pieces);

/// Area (m2) of the pieces whose centers are inside the swept gripper, for each direction of approach to a fruit.
/// @param pieces of the surroundings, without those near any fruit
/// @param fruit the space that the fruit takes up
/// @param directions unit vectors, along which the gripper moves
/// @param parameters for the size of the gripper
/// @return one per direction, in their order
/// @throws Cancelled
std::vector<double> crossed_surface(const std::vector<SurfacePiece>& pieces, const OrientedEllipsoid& fruit,
                                    const std::vector<Eigen::Vector3d>& directions,
                                    const PickingParameters& parameters);

}  // namespace agrisee::pick
