// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Surface normals: the axis of least variance of the nearest points within a radius (Hoppe et al., SIGGRAPH 1992;
/// paper, "Segmentation via Region Growing": r_n, k_n), turned to the view that saw each point or to one viewpoint.
/// Where neither is known, orient_normals.hpp makes them agree with their neighbours.
///
/// Any frame, metres. Cost: a grid, the picking of some 30 neighbours and the least axis of a 3 x 3 matrix a point.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/neighbor_lists.hpp>
#include <agrisee/geometry/pca.hpp>

namespace agrisee {

namespace detail {

/// The normal of the points that `moments` sums, or zero where there is none to be told.
/// @param curvature receives the surface variation where it is not null
template <typename S>
Vector3<S> normal_of(const Moments& moments, S* curvature) {
  Eigen::Vector3d variance;
  const Eigen::Vector3d axis = least_axis(moments.covariance(), variance);
  const double rounding = 4.0 * double(std::numeric_limits<S>::epsilon()) * moments.mean().cwiseAbs().maxCoeff();
  if (!(variance[1] > 1e-8 * variance[2] + rounding * rounding)) return Vector3<S>::Zero();
  if (curvature) *curvature = static_cast<S>(surface_variation<double>(variance));
  return axis.cast<S>();
}

}  // namespace detail

/// One unit normal a point, its sign arbitrary; zero where the normal is unknown: fewer than three neighbours, all of
/// them on a line or at one place (within the rounding of the coordinates), or a point that is not finite.
/// @param cloud points (m), any cloud type
/// @param params see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @param curvatures if given, receives one surface variation (0 to 1/3; 0 where the normal is unknown) a point
/// @throws ParameterError for a bad parameter, InputError when the search is over a cloud of another size
template <typename C, typename Search>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& params, const Search& search,
                                                   int threads = 1, std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  std::vector<Vector3<S>> normals(n, Vector3<S>::Zero());
  if (curvatures) curvatures->assign(n, S(0));
  parallel_chunks(n, threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<S> near;
    Moments moments;
    for (std::size_t i = begin; i < end; ++i) {
      search.knn(point(cloud, i), static_cast<std::size_t>(params.max_neighbors), near);
      while (!near.empty() && !(near.back().distance <= static_cast<S>(params.radius))) near.pop_back();
      if (near.size() < 3) continue;
      const auto at = [&](const Neighbor<S>& found) -> Eigen::Vector3d {
        return point(cloud, static_cast<std::size_t>(found.index)).template cast<double>();
      };
      moments.reset(at(near[0]));
      for (const auto& neighbor : near) moments.add(at(neighbor));
      normals[i] = detail::normal_of<S>(moments, curvatures ? &(*curvatures)[i] : nullptr);
    }
  });
  return normals;
}

/// The same, but for rounding, from neighbour lists that are there already, as far as they reach: `max_neighbors` of
/// them within `radius`.
template <typename C>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& params,
                                                   const NeighborLists& lists, int threads = 1,
                                                   std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud), most = std::min(lists.k, static_cast<std::size_t>(params.max_neighbors));
  check_input(lists.size() == n, "the neighbour lists and the cloud differ in size");
  std::vector<Vector3<S>> normals(n, Vector3<S>::Zero());
  if (curvatures) curvatures->assign(n, S(0));
  const S reach_sq = static_cast<S>(params.radius) * static_cast<S>(params.radius);
  parallel_for(n, threads, [&](std::size_t i) {
    const Vector3<S> q = point(cloud, i);
    Moments moments;
    moments.reset(q.template cast<double>());
    std::size_t used = 0;
    const Index* ids = lists.ids.data() + i * lists.k;
    for (; used < most && ids[used] >= 0; ++used) {
      const Vector3<S> p = point(cloud, static_cast<std::size_t>(ids[used]));
      if (distance_sq<S>(p, q) > reach_sq) break;
      moments.add(p.template cast<double>());
    }
    if (used >= 3) normals[i] = detail::normal_of<S>(moments, curvatures ? &(*curvatures)[i] : nullptr);
  });
  return normals;
}

/// The same, but for rounding, without a search; several times as fast.
template <typename C>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& params = {}, int threads = 1,
                                                   std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  std::vector<Vector3<S>> normals(n, Vector3<S>::Zero());
  if (curvatures) curvatures->assign(n, S(0));
  const auto fit = [&](Index index, const Neighborhood<S>& near) {
    if (near.size < 3) return;
    const auto i = static_cast<std::size_t>(index);
    Moments moments;
    moments.reset(point(cloud, i).template cast<double>());
    for (std::size_t j = 0; j < near.size; ++j) moments.add(near.point(j).template cast<double>());
    normals[i] = detail::normal_of<S>(moments, curvatures ? &(*curvatures)[i] : nullptr);
  };
  for_each_neighborhood<Order::any>(cloud, static_cast<std::size_t>(params.max_neighbors),
                                    static_cast<S>(params.radius), threads, fit);
  return normals;
}

/// The normals, each turned so that it faces `viewpoint` (m, the cloud's frame).
/// @throws InputError when the sizes disagree
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_to_viewpoint(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const Eigen::Vector3d& viewpoint) {
  check_input(normals.size() == agrisee::size(cloud), "orienting normals needs one a point");
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Eigen::Vector3d sight = viewpoint - point(cloud, i).template cast<double>();
    if (normals[i].template cast<double>().dot(sight) < 0.0) normals[i] = -normals[i];
  }
  return normals;
}

/// The normals, each turned so that it faces the sensor that saw its point; those of points without a view (-1) are
/// zero, since nothing is known of their side.
/// @param normals one per point
/// @param cloud points (m)
/// @param views one index into `sensors` a point, or -1
/// @param sensors sensor positions (m, the cloud's frame), one a view
/// @throws InputError when sizes disagree or a view has no sensor position
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_to_views(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                          const std::vector<int>& views,
                                                          const std::vector<Eigen::Vector3d>& sensors) {
  check_input(normals.size() == agrisee::size(cloud) && views.size() == normals.size(),
              "orienting normals needs one, and one view, a point");
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (views[i] < 0) {
      normals[i].setZero();
      continue;
    }
    check_input(static_cast<std::size_t>(views[i]) < sensors.size(), "a point's view has no sensor position");
    const Eigen::Vector3d sight = sensors[static_cast<std::size_t>(views[i])] - point(cloud, i).template cast<double>();
    if (normals[i].template cast<double>().dot(sight) < 0.0) normals[i] = -normals[i];
  }
  return normals;
}

}  // namespace agrisee
