// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the tree of bvh.hpp is built: top down, each node split where the surface area heuristic over 16 bins an axis is
/// lowest (Wald 2007). O(n log n); deterministic.
#pragma once

#include <agrisee/geometry/triangle.hpp>

#include <algorithm>
#include <limits>

namespace agrisee::detail {

/// A node: inner (count 0, children `first` and `first + 1`) or a leaf (`count` triangles from `first`). 32 bytes.
struct BvhNode {
  Eigen::Vector3f min;
  std::uint32_t first;
  Eigen::Vector3f max;
  std::uint32_t count;
};

/// Deeper than this the heuristic gives way to halving, which needs at most 32 more levels.
constexpr int kBvhSahDepth = 60;
/// Bound of the depth of every tree.
constexpr int kBvhMaxDepth = kBvhSahDepth + 36;

/// A box of four floats (the last unused), so that its minima and maxima are single instructions.
struct BvhBox {
  Eigen::Array4f min = Eigen::Array4f::Constant(std::numeric_limits<float>::max());
  Eigen::Array4f max = Eigen::Array4f::Constant(std::numeric_limits<float>::lowest());
  void extend(const BvhBox& b) {
    min = min.min(b.min);
    max = max.max(b.max);
  }
  void extend(const Eigen::Array4f& p) {
    min = min.min(p);
    max = max.max(p);
  }
  /// Half of the surface area, in units of the largest box (1 / scale), so that it neither overflows nor vanishes.
  float half_area(float scale) const {
    const Eigen::Array4f d = (max - min) * scale;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

/// A triangle while the tree is built.
struct BvhItem {
  BvhBox box;
  std::uint32_t triangle;
  BvhItem(const Triangle& t, std::uint32_t index) : triangle(index) {
    for (const Eigen::Vector3f& p : t) box.extend(Eigen::Array4f(p[0], p[1], p[2], 0.0f));
  }
  Eigen::Array4f center() const { return 0.5f * box.min + 0.5f * box.max; }
};

/// Where to split the items [begin, end): they are reordered and the first of the right side is returned, or `begin`
/// when a leaf is better.
inline std::size_t split_bvh(std::vector<BvhItem>& items, std::size_t begin, std::size_t end, const BvhBox& box,
                             const BvhBox& centers, int depth) {
  constexpr int kBins = 16;
  constexpr std::size_t kMaxLeaf = 8;
  constexpr float kNodeCost = 1.0f;  // of a step down, in triangle tests
  const std::size_t n = end - begin;
  if (n <= 2) return begin;
  const Eigen::Array4f extent = centers.max - centers.min;
  const auto first = items.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = items.begin() + static_cast<std::ptrdiff_t>(end);
  const float longest = (box.max - box.min).head<3>().maxCoeff();
  const float scale = std::isfinite(longest) && longest > 0.0f ? 1.0f / longest : 1.0f;

  float best_cost = std::numeric_limits<float>::infinity();
  int best_axis = -1, best_bin = 0;
  Eigen::Array4f to_bin = Eigen::Array4f::Zero();
  for (int a = 0; a < 3; ++a) {
    const float k = float(kBins) * (1.0f - 1e-6f) / extent[a];
    if (extent[a] > 0.0f && std::isfinite(k)) to_bin[a] = k;
  }
  const auto bin = [&](const BvhItem& item, int a) {
    return std::clamp(static_cast<int>((item.center()[a] - centers.min[a]) * to_bin[a]), 0, kBins - 1);
  };
  if (depth < kBvhSahDepth && (to_bin > 0.0f).any()) {
    struct Bin {
      BvhBox box;
      std::size_t n = 0;
    };
    Bin bins[3][kBins];
    for (auto item = first; item != last; ++item)
      for (int a = 0; a < 3; ++a) {
        Bin& b = bins[a][bin(*item, a)];
        b.box.extend(item->box);
        ++b.n;
      }
    for (int a = 0; a < 3; ++a) {
      if (!(to_bin[a] > 0.0f)) continue;
      float right_cost[kBins];
      BvhBox sweep;
      std::size_t count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        sweep.extend(bins[a][b].box);
        count += bins[a][b].n;
        right_cost[b] = count == 0 ? -1.0f : sweep.half_area(scale) * float(count);
      }
      sweep = BvhBox();
      count = 0;
      for (int b = 1; b < kBins; ++b) {
        sweep.extend(bins[a][b - 1].box);
        count += bins[a][b - 1].n;
        if (count == 0 || right_cost[b] < 0.0f) continue;
        const float cost = sweep.half_area(scale) * float(count) + right_cost[b];
        if (cost < best_cost) {
          best_cost = cost;
          best_axis = a;
          best_bin = b;
        }
      }
    }
  }
  const float area = box.half_area(scale);
  if (n <= kMaxLeaf && !(best_cost + kNodeCost * area < area * float(n))) return begin;
  if (best_axis >= 0) {
    const auto middle = std::partition(first, last, [&](const BvhItem& i) { return bin(i, best_axis) < best_bin; });
    return static_cast<std::size_t>(middle - items.begin());
  }
  // All centres (nearly) coincide, or the tree is too deep: halve along the longest axis.
  int axis = 0;
  (centers.max - centers.min).head<3>().maxCoeff(&axis);
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [&](const BvhItem& a, const BvhItem& b) {
    const float ca = a.center()[axis], cb = b.center()[axis];
    return ca < cb || (ca == cb && a.triangle < b.triangle);
  });
  return static_cast<std::size_t>(middle - items.begin());
}

/// The nodes of a tree over `items`, which are put into the order of the leaves. No items: no nodes.
inline std::vector<BvhNode> build_bvh(std::vector<BvhItem>& items) {
  std::vector<BvhNode> nodes;
  if (items.empty()) return nodes;
  nodes.reserve(items.size());
  nodes.emplace_back();
  struct Task {
    std::size_t begin, end;
    std::uint32_t node;
    int depth;
  };
  std::vector<Task> tasks{{0, items.size(), 0, 0}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    BvhBox box, centers;
    for (std::size_t i = task.begin; i < task.end; ++i) {
      box.extend(items[i].box);
      centers.extend(items[i].center());
    }
    BvhNode& node = nodes[task.node];
    node.min = box.min.head<3>();
    node.max = box.max.head<3>();
    const std::size_t middle = split_bvh(items, task.begin, task.end, box, centers, task.depth);
    if (middle == task.begin) {
      node.first = static_cast<std::uint32_t>(task.begin);
      node.count = static_cast<std::uint32_t>(task.end - task.begin);
      continue;
    }
    const auto children = static_cast<std::uint32_t>(nodes.size());
    node.first = children;
    node.count = 0;
    nodes.resize(nodes.size() + 2);
    tasks.push_back({middle, task.end, children + 1, task.depth + 1});
    tasks.push_back({task.begin, middle, children, task.depth + 1});
  }
  return nodes;
}

}  // namespace agrisee::detail
