// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Surface normals: the axis of least variance of the nearest points within a radius (Hoppe et al., SIGGRAPH 1992;
/// [1], 2.2.3: r_n, k_n), turned to the sensor that saw each point. If that is not known,
/// orient_normals.hpp makes them agree with their neighbors.
///
/// Any frame, metres. Cost: a grid and, for each point, finding some 30 neighbors and the least axis of a 3 x 3 matrix.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

namespace agrisee {

namespace detail {

/// The normal of the points that `moments` sums, or zero if they determine none.
/// @param curvature receives the surface variation, if it is not null
template <typename S>
Vector3<S> normal_of(const Moments& moments, S* curvature) {
  Eigen::Vector3d variance;
  const Eigen::Vector3d axis = least_axis(moments.covariance(), variance);
  const double rounding = 4.0 * double(std::numeric_limits<S>::epsilon()) * moments.mean().cwiseAbs().maxCoeff();
  if (!(variance[1] > 1e-8 * variance[2] + rounding * rounding)) return Vector3<S>::Zero();
  if (curvature) *curvature = static_cast<S>(surface_variation<double>(variance));
  return axis.cast<S>();
}

/// Check that the first finite point of a cloud is where the search has a point: it is not if the search was built over
/// another cloud of the same size.
/// @throws InputError
template <typename C, typename Search>
void check_search_over(const C& cloud, const Search& search) {
  std::size_t first = 0;
  while (first < agrisee::size(cloud) && !is_finite(point(cloud, first))) ++first;
  if (first == agrisee::size(cloud)) return;
  Neighbors<scalar_t<C>> nearest;
  search.knn(point(cloud, first), 1, nearest);
  check_input(!nearest.empty() && nearest.front().distance == 0, "the search was built over another cloud");
}

}  // namespace detail

/// Estimate the normal of each point. It is unknown if the point is not finite, has fewer than three neighbors, or all
/// of them lie on a line or at one place (within the rounding of the coordinates).
/// @param cloud points (m), any cloud type
/// @param parameters see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @param curvatures if given, receives one surface variation per point (0 to 1/3; 0 if the normal is unknown)
/// @return one unit normal per point, of arbitrary sign; zero if it is unknown
/// @throws ParameterError for a bad parameter, InputError if the search is over a cloud of another size, or has no
///   point where the first finite point of `cloud` is
template <typename C, typename Search>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& parameters,
                                                   const Search& search, int threads = 1,
                                                   std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  parameters.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  detail::check_search_over(cloud, search);
  std::vector<Vector3<S>> normals(n, Vector3<S>::Zero());
  if (curvatures) curvatures->assign(n, S(0));
  parallel_chunks(n, threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<S> near;
    Moments moments;
    for (std::size_t i = begin; i < end; ++i) {
      search.knn(point(cloud, i), static_cast<std::size_t>(parameters.max_neighbors), near);
      while (!near.empty() && !(near.back().distance <= static_cast<S>(parameters.radius))) near.pop_back();
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

/// Estimate the normals, up to rounding the same, from neighbor lists that exist already. Lists shorter than
/// `max_neighbors` are used as far as they reach.
template <typename C>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& parameters,
                                                   const NeighborLists& lists, int threads = 1,
                                                   std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  parameters.check();
  const std::size_t n = agrisee::size(cloud),
                    most = std::min(lists.k, static_cast<std::size_t>(parameters.max_neighbors));
  check_input(lists.size() == n, "the neighbor lists and the cloud differ in size");
  std::vector<Vector3<S>> normals(n, Vector3<S>::Zero());
  if (curvatures) curvatures->assign(n, S(0));
  const S reach_sq = static_cast<S>(parameters.radius) * static_cast<S>(parameters.radius);
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

/// Estimate the normals, up to rounding the same, without a ready-made search; several times as fast.
template <typename C>
std::vector<Vector3<scalar_t<C>>> estimate_normals(const C& cloud, const NormalParameters& parameters = {},
                                                   int threads = 1, std::vector<scalar_t<C>>* curvatures = nullptr) {
  using S = scalar_t<C>;
  parameters.check();
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
  for_each_neighborhood<Order::any>(cloud, static_cast<std::size_t>(parameters.max_neighbors),
                                    static_cast<S>(parameters.radius), threads, fit);
  return normals;
}

/// A normal, turned so that it faces the sensor.
/// @param normal unit, or zero
/// @param sight from the normal's point to the sensor (m)
/// @param least_cosine the normal is turned if the cosine of its angle with `sight` is less than this: 0 if nothing is
///   known of its sign, a negative number if it is to be turned only if it clearly faces away
template <typename S>
Vector3<S> orient_towards(const Vector3<S>& normal, const Eigen::Vector3d& sight, double least_cosine = 0.0) {
  const double along = normal.template cast<double>().dot(sight);
  const double least = least_cosine == 0.0 ? 0.0 : least_cosine * sight.norm();
  return along < least ? Vector3<S>(-normal) : normal;
}

/// The normals, each turned so that it faces the sensor that saw its point. Normals of points without a view (-1)
/// become zero, since nothing is known of their side.
/// @param normals one per point
/// @param cloud points (m)
/// @param views for each point an index into `sensors`, or -1
/// @param sensors sensor positions (m, the cloud's frame), one per view
/// @throws InputError if sizes disagree or a view has no sensor position
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
    normals[i] = orient_towards(normals[i], sight);
  }
  return normals;
}

}  // namespace agrisee
