// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What all ways of growing regions share: which points may join a region, and the order in which points become seeds.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/detail/sums.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/uninitialized.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace agrisee {
namespace detail {

/// Seeds are sorted by this key of point i: by rising curvature if `by_curvature` (NaN comes last), then by index.
template <typename Curvatures>
std::pair<typename Curvatures::value_type, Index> seed_key(std::size_t i, bool by_curvature,
                                                           const Curvatures& curvatures) {
  using S = typename Curvatures::value_type;
  const S curvature = by_curvature ? curvatures[i] : S(0);
  return {std::isnan(curvature) ? std::numeric_limits<S>::infinity() : curvature, static_cast<Index>(i)};
}

/// All points in the order in which they may become seeds.
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

/// The position of each point in seed_order; empty if that is simply the order of the indices.
template <typename S>
std::vector<Index> seed_ranks(std::size_t n, bool by_curvature, const std::vector<S>& curvatures) {
  std::vector<Index> ranks;
  if (!by_curvature) return ranks;
  ranks.resize(n);
  const Indices order = seed_order<S>(n, true, curvatures);
  for (std::size_t r = 0; r < n; ++r) ranks[static_cast<std::size_t>(order[r])] = static_cast<Index>(r);
  return ranks;
}

/// @throws InputError if normals or curvatures are missing
template <typename C>
void check_growing(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                   const RegionGrowingParameters& parameters, const std::vector<scalar_t<C>>& curvatures) {
  check_input(normals.size() == agrisee::size(cloud), "grow_regions needs one normal a point");
  check_input(!parameters.needs_curvature() || curvatures.size() == normals.size(),
              "grow_regions needs one curvature a point");
}

/// Whether a point can join a region at all.
template <typename S>
bool can_join(const Vector3<S>& p, const Vector3<S>& normal) {
  return is_finite(p) && is_finite(normal) && normal.squaredNorm() > 0;
}

/// Cosine of the angle between two normals, (u, v, w) and the other; its absolute value if their signs do not matter.
/// All ways of growing use this one sum, so that they agree on angles at the very limit.
template <typename S>
S cosine(S u, S v, S w, S other_u, S other_v, S other_w, bool without_sign) {
  const S sum = sum_of_products(v, w, u, other_v, other_w, other_u);
  return without_sign ? std::abs(sum) : sum;
}

/// The stored points of a grid with their normals, one array per coordinate.
template <typename S>
class OrientedPoints {
 public:
  /// @param grid the points
  /// @param normals one per point of the grid's cloud
  /// @param parameters give the largest angle between normals, and whether their sign counts
  /// @param threads the result does not depend on it
  OrientedPoints(const Grid<S>& grid, const std::vector<Vector3<S>>& normals, const RegionGrowingParameters& parameters,
                 int threads)
      : grid_(grid),
        u_(grid.stored()),
        v_(grid.stored()),
        w_(grid.stored()),
        cos_min_(static_cast<S>(std::cos(parameters.smoothness))),
        unsigned_(parameters.unsigned_normals) {
    const auto gather = [&](std::size_t j) {
      Vector3<S> normal = normals[static_cast<std::size_t>(grid.ids()[j])];
      if (!can_join<S>(grid.stored_point(j), normal)) normal.setConstant(std::numeric_limits<S>::quiet_NaN());
      u_[j] = normal.x(), v_[j] = normal.y(), w_[j] = normal.z();
    };
    parallel_for(grid.stored(), threads, gather, 4096);
  }

  /// Whether stored point j can join a region; such a point is called a member.
  bool member(std::size_t j) const { return !std::isnan(u_[j]); }
  /// Whether stored points i and j are members whose normals differ by less than the limit.
  bool smooth(std::size_t i, std::size_t j) const {
    return cosine(u_[i], v_[i], w_[i], u_[j], v_[j], w_[j], unsigned_) > cos_min_;
  }
  /// Mark the neighbors of member j among the stored points [begin, end): is[i - begin] = 1 if point i is a member,
  /// less than sqrt(limit_sq) (m) away, and its normal differs by less than the limit; otherwise 0.
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
