// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What many sources do with a Cloud, for which the compiler takes long: compiled once, in searches.cpp. A source
/// that does not include this compiles its own.
#pragma once

#include <agrisee/cloud/spacing.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/all_neighbors.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

namespace agrisee {

extern template class detail::GridPoints<float>;
extern template detail::GridPoints<float>::GridPoints(const Cloud&, float, int);
extern template class detail::CellTree<float>;
extern template class detail::CellTreeNearest<float>;
extern template KdTree<float>::KdTree(const Cloud&);
extern template NeighborLists nearest_neighbors(const Cloud&, std::size_t, int);
extern template double estimate_spacing(const Cloud&);
extern template PrincipalAxes<double> principal_axes(const Eigen::Vector3d&, const Eigen::Matrix3d&);
extern template Cloud select(const Cloud&, const Indices&);

}  // namespace agrisee
