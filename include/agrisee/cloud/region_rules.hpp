// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What all ways of growing regions share: which points may join, the order of seeds, the numbers of regions.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/grid.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/sums.hpp>
#include <agrisee/core/uninitialized.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace agrisee {
namespace detail {

/// Labels of regions of at least `min_size` points, renumbered from 1 in order of creation; 0 for the rest.
inline void drop_small_regions(Labels& labels, int regions, int min_size) {
  std::vector<int> sizes(static_cast<std::size_t>(regions) + 1, 0);
  for (const int label : labels) ++sizes[static_cast<std::size_t>(label)];
  std::vector<int> renumbered(sizes.size(), 0);
  int kept = 0;
  for (std::size_t r = 1; r < sizes.size(); ++r)
    if (sizes[r] >= min_size) renumbered[r] = ++kept;
  for (int& label : labels) label = renumbered[static_cast<std::size_t>(label)];
}

/// What seeds are sorted by: rising curvature where that is asked for, points of none last, then the index i.
template <typename Curvatures>
std::pair<typename Curvatures::value_type, Index> seed_key(std::size_t i, bool by_curvature,
                                                           const Curvatures& curvatures) {
  using S = typename Curvatures::value_type;
  const S curvature = by_curvature ? curvatures[i] : S(0);
  return {std::isnan(curvature) ? std::numeric_limits<S>::infinity() : curvature, static_cast<Index>(i)};
}

/// The points in the order in which they may become seeds.
template <typename S>
Indices seed_order(std::size_t n, bool by_curvature, const std::vector<S>& curvatures) {
  Indices order(n);
  std::iota(order.begin(), order.end(), Index(0));
  if (by_curvature)
    sort_cancellably(order.begin(), order.end(), [&](Index a, Index b) {
      return seed_key(static_cast<std::size_t>(a), true, curvatures) <
             seed_key(static_cast<std::size_t>(b), true, curvatures);
    });
  return order;
}

/// The place of each point in that order; empty where it is that of their indices.
template <typename S>
std::vector<Index> seed_ranks(std::size_t n, bool by_curvature, const std::vector<S>& curvatures) {
  std::vector<Index> ranks;
  if (!by_curvature) return ranks;
  ranks.resize(n);
  const Indices order = seed_order<S>(n, true, curvatures);
  for (std::size_t r = 0; r < n; ++r) ranks[static_cast<std::size_t>(order[r])] = static_cast<Index>(r);
  return ranks;
}

/// @throws InputError where normals or curvatures are missing
template <typename C>
void check_growing(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                   const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures) {
  check_input(normals.size() == agrisee::size(cloud), "grow_regions needs one normal a point");
  check_input(!params.needs_curvature() || curvatures.size() == normals.size(),
              "grow_regions needs one curvature a point");
}

/// Whether a point can join a region at all.
template <typename S>
bool can_join(const Vector3<S>& p, const Vector3<S>& normal) {
  return is_finite(p) && is_finite(normal) && normal.squaredNorm() > 0;
}

/// How alike two normals are, the first's coordinates u, v, w: cosine > cos_min for those that differ by less than a
/// limit. One way of summing for all ways of growing.
template <typename S>
S cosine(S u, S v, S w, S other_u, S other_v, S other_w, bool without_sign) {
  const S sum = sum_of_products(v, w, u, other_v, other_w, other_u);
  return without_sign ? std::abs(sum) : sum;
}

/// The points of a grid with their normals, coordinate by coordinate.
template <typename S>
class OrientedPoints {
 public:
  /// @param grid points  @param normals one a point of its cloud
  /// @param params limit of the angle between normals, and whether their sign counts
  /// @param threads the result does not depend on it
  OrientedPoints(const Grid<S>& grid, const std::vector<Vector3<S>>& normals, const RegionGrowingParameters& params,
                 int threads)
      : grid_(grid),
        u_(grid.stored()),
        v_(grid.stored()),
        w_(grid.stored()),
        cos_min_(static_cast<S>(std::cos(params.smoothness))),
        unsigned_(params.unsigned_normals) {
    const auto gather = [&](std::size_t j) {
      Vector3<S> normal = normals[static_cast<std::size_t>(grid.ids()[j])];
      if (!can_join<S>(grid.stored_point(j), normal)) normal.setConstant(std::numeric_limits<S>::quiet_NaN());
      u_[j] = normal.x(), v_[j] = normal.y(), w_[j] = normal.z();
    };
    parallel_for(grid.stored(), threads, gather, 4096);
  }

  /// Whether stored point j can join a region.
  bool member(std::size_t j) const { return !std::isnan(u_[j]); }
  /// Whether stored points i and j are members and their normals differ by less than the limit.
  bool smooth(std::size_t i, std::size_t j) const {
    return cosine(u_[i], v_[i], w_[i], u_[j], v_[j], w_[j], unsigned_) > cos_min_;
  }
  /// is[i - begin] = 1 for the members i of [begin, end) less than sqrt(limit_sq) (m) from j, a member, whose normals
  /// differ from its normal by less than the limit; 0 for others.
  void smooth_within(std::size_t j, S limit_sq, std::size_t begin, std::size_t end, std::uint8_t* is) const {
    unsigned_ ? test<true>(j, limit_sq, begin, end, is) : test<false>(j, limit_sq, begin, end, is);
  }

 private:
  template <bool kUnsigned>
  void test(std::size_t j, S limit_sq, std::size_t begin, std::size_t end, std::uint8_t* is) const {
    const S *x = grid_.x().data(), *y = grid_.y().data(), *z = grid_.z().data();
    const S *u = u_.data(), *v = v_.data(), *w = w_.data(), cos_min = cos_min_;
    const S qx = x[j], qy = y[j], qz = z[j], qu = u[j], qv = v[j], qw = w[j];
    for (std::size_t i = begin; i < end; ++i) {
      const S dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
      const bool near = sum_of_squares(dx, dy, dz) < limit_sq;
      is[i - begin] = static_cast<std::uint8_t>(near & (cosine(u[i], v[i], w[i], qu, qv, qw, kUnsigned) > cos_min));
    }
  }

  const Grid<S>& grid_;
  Uninitialized<S> u_, v_, w_;  // of the normals; NaN for points that cannot join
  S cos_min_;
  bool unsigned_;
};

}  // namespace detail

}  // namespace agrisee
