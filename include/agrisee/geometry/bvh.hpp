// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A bounding volume hierarchy over triangles: what a ray meets first, whether it meets anything, and which point of
/// the surface is nearest. Built top down with a binned surface area heuristic (Wald, "On fast Construction of
/// SAH-based Bounding Volume Hierarchies", 2007) in O(n log n); about 70 bytes a triangle; a query is O(log n) on usual
/// scenes.
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

/// A static tree over the triangles of a mesh, in the mesh's own frame. Immutable: queries may run in parallel.
///
/// Every answer equals that of testing all triangles one by one: boxes are tested in single precision with a margin for
/// its rounding (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013), triangles in double. Equal distances go to the
/// lowest triangle index. Triangles without area and triangles with corners that are not finite are never found.
class Bvh {
 public:
  /// What a ray meets.
  struct Hit {
    float t;                 ///< distance in units of the direction's length
    std::uint32_t triangle;  ///< index in the mesh
    float u;                 ///< barycentric coordinates: (1 - u - v) a + u b + v c
    float v;                 ///< the other of them
  };
  /// A point of the surface.
  struct SurfacePoint {
    float distance;          ///< from the query (m)
    std::uint32_t triangle;  ///< index in the mesh
    Eigen::Vector3f point;   ///< where (m)
  };

  /// Nothing to hit.
  Bvh() = default;

  /// @param mesh its triangles
  /// @param threads the tree does not depend on it
  /// @throws InputError when a triangle names a vertex that the mesh does not have
  explicit Bvh(const Mesh& mesh, int threads = 1);

  /// Number of triangles of the mesh, the degenerate ones included.
  std::size_t size() const { return triangles_.size() + degenerate_; }
  /// Number of triangles left out: without area, or with a corner that is not finite.
  std::size_t degenerate() const { return degenerate_; }
  /// Box around all triangles that can be found; empty when there are none.
  Aabb bounds() const;

  /// The first triangle that the ray meets at t in [max(t_min, 0), t_max], seen from either side.
  ///
  /// @param origin, direction any length but zero; a ray that is not finite meets nothing
  /// @param t_min nearest distance along the ray that counts
  /// @param t_max farthest
  std::optional<Hit> closest(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min = 0.0f,
                             float t_max = std::numeric_limits<float>::infinity()) const;

  /// True when the ray meets a triangle at t in [max(t_min, 0), t_max]; faster than closest().
  bool any(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min = 0.0f,
           float t_max = std::numeric_limits<float>::infinity()) const;

  /// The point of the surface nearest to p, if it is within `max_distance` (m); none for a p that is not finite.
  std::optional<SurfacePoint> nearest(const Eigen::Vector3f& p,
                                      float max_distance = std::numeric_limits<float>::infinity()) const;

  /// Visit the triangles of all leaves whose boxes `keep` keeps.
  ///
  /// @param keep `bool(const Eigen::Vector3f& min, const Eigen::Vector3f& max)`; must keep a box that contains one it
  /// keeps
  /// @param f    `bool(std::uint32_t triangle, const Triangle& corners)`; false ends the visit
  template <typename Keep, typename F>
  void visit(Keep&& keep, F&& f) const;

 private:
  using Node = detail::BvhNode;

  /// Calls `hit(Hit)` for triangles met, roughly from near to far; it returns the t beyond which nothing matters any
  /// more.
  template <typename F>
  void traverse(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_min, float t_max,
                F&& hit) const;

  detail::Uninitialized<Node> nodes_;          // the root first, siblings side by side
  detail::Uninitialized<Triangle> triangles_;  // in the order of the leaves
  detail::Uninitialized<std::uint32_t> ids_;   // of triangles_ in the mesh
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

  // Where the ray enters a box, infinity if it does not. A ray that runs within a face of the box gives 0 * inf = NaN,
  // which the order of the comparisons ignores.
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
    return -1.0f;  // nothing matters any more
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
      stack[waiting++] = b;  // the nearer is next
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
