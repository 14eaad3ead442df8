// SPDX-License-Identifier: BSD-3-Clause
#include "cloud/searches.hpp"

namespace agrisee {

template class detail::GridPoints<float>;
template detail::GridPoints<float>::GridPoints(const Cloud&, float, int);
template class detail::CellTree<float>;
template class detail::CellTreeNearest<float>;
template KdTree<float>::KdTree(const Cloud&);
template NeighborLists nearest_neighbors(const Cloud&, std::size_t, int);
template double estimate_spacing(const Cloud&);
template PrincipalAxes<double> principal_axes(const Eigen::Vector3d&, const Eigen::Matrix3d&);
template Cloud select(const Cloud&, const Indices&);

}  // namespace agrisee
