// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A bounding volume hierarchy over triangles. It finds what a ray hits first, whether a ray hits anything, and the
/// point of the surface nearest to a given point. It is built top down with a binned surface area heuristic (Wald, "On
/// fast Construction of SAH-based Bounding Volume Hierarchies", 2007) in O(n log n). Memory: about 70 bytes per
/// triangle. A query is O(log n) in usual scenes.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/geometry/bvh_build.hpp>
#include <agrisee/geometry/mesh.hpp>
#include <agrisee/geometry/triangle.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

namespace agrisee {

/// A tree over the triangles of a mesh, in the mesh's own frame. It never changes, so queries may run in parallel.
///
/// Every answer equals that of testing all triangles one by one. Boxes are tested in single precision with a margin for
/// rounding (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013), triangles in double precision. Of triangles at equal
/// distances, the one with the smallest index is reported. Triangles without area and triangles with corners that are
/// not finite are never found.
class Bvh {
 public:
  /// Where a ray hits the surface.
  struct Hit {
    float t;                 ///< distance along the ray, in units of the length of its direction
    std::uint32_t triangle;  ///< index in the mesh
    float u;                 ///< barycentric coordinate: the point is (1 - u - v) a + u b + v c
    float v;                 ///< barycentric coordinate, see u
  };
  /// A point of the surface, and how far it is from the query.
  struct SurfacePoint {
    float distance;          ///< m
    std::uint32_t triangle;  ///< index in the mesh
    Eigen::Vector3f point;   ///< m
  };

  /// A tree without triangles.
  Bvh() = default;

  /// @param mesh the triangles; it is not needed afterwards
  /// @param threads the tree does not depend on it
  /// @throws InputError if a triangle refers to a vertex that the mesh does not have
  explicit Bvh(const Mesh& mesh, int threads = 1);

  /// Number of triangles of the mesh, including degenerate ones.
  std::size_t size() const { return triangles_.size() + degenerate_; }
  /// Number of degenerate triangles: without area, or with a corner that is not finite. They are left out.
  std::size_t degenerate() const { return degenerate_; }
  /// The box around all triangles that are not degenerate.
  Aabb bounds() const;

  /// The first triangle that the ray hits, from either side, at a t in [max(t_min, 0), t_max].
  ///
  /// @param origin of the ray (m); a ray that is not finite hits nothing
  /// @param direction of any length but zero
  /// @param t_min smallest t that counts, in units of the length of `direction`
  /// @param t_max largest t that counts
  std::optional<Hit> closest(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min = 0.0f,
                             float t_max = std::numeric_limits<float>::infinity()) const;

  /// True if the ray hits a triangle at a t in [max(t_min, 0), t_max]. Faster than closest().
  bool any(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min = 0.0f,
           float t_max = std::numeric_limits<float>::infinity()) const;

  /// The point of the surface nearest to p (m), if it is within `max_distance` (m); none if p is not finite.
  std::optional<SurfacePoint> nearest(const Eigen::Vector3f& p,
                                      float max_distance = std::numeric_limits<float>::infinity()) const;

  /// Calls f for the triangles of all leaves whose boxes `keep` accepts.
  ///
  /// @param keep `bool(const Eigen::Vector3f& min, const Eigen::Vector3f& max)`; if it accepts a box, it must accept
  ///   every box that contains it
  /// @param f `bool(std::uint32_t triangle, const Triangle& corners)`; the visit ends when it returns false
  template <typename Keep, typename F>
  void visit(Keep&& keep, F&& f) const;

 private:
  using Node = detail::BvhNode;

  /// Calls `hit(Hit)` for the triangles that the ray hits, roughly from near to far. `hit` returns the largest t that
  /// is still of interest.
  template <typename F>
  void traverse(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min, float t_max,
                F&& hit) const;

  detail::Uninitialized<Node> nodes_;          // the root first; siblings are adjacent
  detail::Uninitialized<Triangle> triangles_;  // in the order of the leaves
  detail::Uninitialized<std::uint32_t> ids_;   // index in the mesh of each of triangles_
  std::size_t degenerate_ = 0;
};

inline Bvh::Bvh(const Mesh& mesh, int threads) {
  const std::size_t n = mesh.triangles.size();
  check_input(n < std::numeric_limits<std::uint32_t>::max(), "bvh: too many triangles");
  const auto corners = [&](std::size_t i) -> Triangle {
    const auto& t = mesh.triangles[i];
    return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  };
  for (std::size_t i = 0; i < n; ++i)
    for (const std::uint32_t vertex : mesh.triangles[i])
      if (vertex >= mesh.vertices.size())
        throw InputError("bvh: triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) + " of " +
                         std::to_string(mesh.vertices.size()));
  constexpr std::size_t kChunk = 4096;
  detail::Uninitialized<detail::BvhItem> items(n);
  const auto make_item = [&](std::size_t i) {
    const Triangle t = corners(i);
    const bool found = is_finite(t[0]) && is_finite(t[1]) && is_finite(t[2]) && !area_normal(t).isZero(0.0);
    items[i] = detail::BvhItem(t, found ? static_cast<std::uint32_t>(i) : detail::BvhItem::kNone);
  };
  parallel_for(n, threads, make_item, kChunk);
  items.erase(std::remove_if(items.begin(), items.end(), [](const auto& item) { return item.empty(); }), items.end());
  degenerate_ = n - items.size();
  nodes_ = detail::build_bvh(items, threads);
  triangles_.resize(items.size());
  ids_.resize(items.size());
  const auto place = [&](std::size_t i) { triangles_[i] = corners(ids_[i] = items[i].triangle); };
  parallel_for(items.size(), threads, place, kChunk);
}

inline Aabb Bvh::bounds() const {
  Aabb box;
  if (nodes_.empty()) return box;
  box.min = nodes_[0].min.cast<double>();
  box.max = nodes_[0].max.cast<double>();
  return box;
}

template <typename F>
void Bvh::traverse(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min, float t_max,
                   F&& hit) const {
  t_min = std::max(t_min, 0.0f);
  if (nodes_.empty() || !is_finite(origin) || !is_finite(direction) || direction.isZero(0.0f) || !(t_min <= t_max))
    return;
  constexpr float kMargin = 1.0f + 8.0f * std::numeric_limits<float>::epsilon();
  const Eigen::Vector3f inverse = direction.cwiseInverse();
  const Eigen::Vector3d o = origin.cast<double>(), d = direction.cast<double>();
  float limit = t_max * kMargin;

  // The t at which the ray enters a box, or infinity. A ray that lies in the plane of a face gives 0 * inf = NaN; the
  // comparisons are written such that NaN changes nothing.
  constexpr float kMiss = std::numeric_limits<float>::infinity();
  const auto enter = [&](const Node& node) {
    float near = t_min, far = limit;
    for (int a = 0; a < 3; ++a) {
      const float t0 = (node.min[a] - origin[a]) * inverse[a];
      const float t1 = (node.max[a] - origin[a]) * inverse[a];
      const float first = inverse[a] < 0.0f ? t1 : t0, last = (inverse[a] < 0.0f ? t0 : t1) * kMargin;
      near = first > near ? first : near;
      far = last < far ? last : far;
    }
    return near <= far ? near : kMiss;
  };

  struct Waiting {
    std::uint32_t node;
    float near;
  };
  Waiting stack[detail::kBvhMaxDepth];
  int waiting = 0;
  const Node* node = &nodes_[0];
  if (enter(*node) == kMiss) return;
  for (;;) {
    if (node->count > 0) {
      for (std::uint32_t i = node->first; i < node->first + node->count; ++i) {
        TriangleHit met;
        if (!SeenTriangle(triangles_[i], o).meets(d, met)) continue;
        const auto t = static_cast<float>(met.t);
        if (t >= t_min && t <= t_max && std::isfinite(t))
          limit = hit(Hit{t, ids_[i], static_cast<float>(met.u), static_cast<float>(met.v)}) * kMargin;
      }
    } else {
      const std::uint32_t left = node->first;
      const float near_left = enter(nodes_[left]), near_right = enter(nodes_[left + 1]);
      if (near_left != kMiss || near_right != kMiss) {
        const bool left_first = near_left <= near_right;
        const float second = left_first ? near_right : near_left;
        if (second != kMiss) stack[waiting++] = {left_first ? left + 1 : left, second};
        node = &nodes_[left_first ? left : left + 1];
        continue;
      }
    }
    do {
      if (waiting == 0) return;
      --waiting;
    } while (!(stack[waiting].near <= limit));
    node = &nodes_[stack[waiting].node];
  }
}

[[gnu::noinline]] inline std::optional<Bvh::Hit> Bvh::closest(const Eigen::Vector3f& origin,
                                                              const Eigen::Vector3f& direction, float t_min,
                                                              float t_max) const {
  std::optional<Hit> best;
  traverse(origin, direction, t_min, t_max, [&](const Hit& hit) {
    if (!best || hit.t < best->t || (hit.t == best->t && hit.triangle < best->triangle)) best = hit;
    return best->t;
  });
  return best;
}

[[gnu::noinline]] inline bool Bvh::any(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min,
                                       float t_max) const {
  bool found = false;
  traverse(origin, direction, t_min, t_max, [&](const Hit&) {
    found = true;
    return -1.0f;  // ends the search
  });
  return found;
}

[[gnu::noinline]] inline std::optional<Bvh::SurfacePoint> Bvh::nearest(const Eigen::Vector3f& p,
                                                                       float max_distance) const {
  if (nodes_.empty() || !is_finite(p) || !(max_distance >= 0.0f)) return std::nullopt;
  constexpr double kMargin = 1.0 + 1e-6;
  const Eigen::Vector3d q = p.cast<double>();
  const auto distance_sq = [&](const Node& node) {
    return (node.min - p).cwiseMax(p - node.max).cwiseMax(0.0f).cast<double>().squaredNorm();
  };
  std::optional<SurfacePoint> best;
  double limit_sq = double(max_distance) * double(max_distance) * kMargin;
  struct Waiting {
    std::uint32_t node;
    double distance_sq;
  };
  Waiting stack[detail::kBvhMaxDepth + 1];
  int waiting = 0;
  stack[waiting++] = {0, distance_sq(nodes_[0])};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (!(next.distance_sq <= limit_sq)) continue;
    const Node& node = nodes_[next.node];
    if (node.count == 0) {
      Waiting a{node.first, distance_sq(nodes_[node.first])};
      Waiting b{node.first + 1, distance_sq(nodes_[node.first + 1])};
      if (a.distance_sq < b.distance_sq) std::swap(a, b);
      stack[waiting++] = a;
      stack[waiting++] = b;  // the nearer one is taken first
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Eigen::Vector3d on = nearest_point(triangles_[i], q);
      const auto distance = static_cast<float>((on - q).norm());
      if (!(distance <= max_distance)) continue;
      if (!best || distance < best->distance || (distance == best->distance && ids_[i] < best->triangle)) {
        best = SurfacePoint{distance, ids_[i], on.cast<float>()};
        limit_sq = double(distance) * double(distance) * kMargin;
      }
    }
  }
  return best;
}

template <typename Keep, typename F>
void Bvh::visit(Keep&& keep, F&& f) const {
  if (nodes_.empty() || !keep(nodes_[0].min, nodes_[0].max)) return;
  std::uint32_t stack[detail::kBvhMaxDepth + 1];
  int waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = nodes_[stack[--waiting]];
    if (node.count == 0) {
      for (std::uint32_t child = node.first; child < node.first + 2; ++child)
        if (keep(nodes_[child].min, nodes_[child].max)) stack[waiting++] = child;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (!f(ids_[i], triangles_[i])) return;
  }
}

}  // namespace agrisee
