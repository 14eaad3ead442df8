// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Builds the tree of bvh.hpp top down. Each node is split where the surface area heuristic, evaluated between bins
/// along the axes, has the lowest cost (Wald 2007, see bvh.hpp). O(n log n); the result does not depend on the number
/// of threads.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/core/uninitialized.hpp>
#include <agrisee/geometry/triangle.hpp>

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// A node of 32 bytes: an inner node (count 0; its children are the nodes `first` and `first + 1`) or a leaf (with the
/// `count` triangles from `first`).
struct BvhNode {
  Eigen::Vector3f min;
  std::uint32_t first;
  Eigen::Vector3f max;
  std::uint32_t count;
};

/// Below this depth ranges are simply halved, which takes at most 32 more levels.
constexpr int kBvhSahDepth = 60;
/// No tree is deeper than this.
constexpr int kBvhMaxDepth = kBvhSahDepth + 36;

/// A box with corners of four floats, the last unused, so that minima and maxima take one vector instruction.
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
  /// Half of the surface area, with lengths multiplied by `scale`, so that it neither overflows nor underflows.
  float half_area(float scale) const {
    const Eigen::Array4f d = (max - min) * scale;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

/// A triangle while the tree is being built, or none. The default constructor leaves it without a value.
struct BvhItem {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  Eigen::Array4f min, max;  // corners of its box (m)
  std::uint32_t triangle;   // its index in the mesh
  BvhItem() {}
  BvhItem(const Triangle& t, std::uint32_t index) : triangle(index) {
    BvhBox around;
    for (const Eigen::Vector3f& p : t)
      around.extend(Eigen::Array4f(p[0], p[1], p[2], 0.0f) +
                    0.0f);  // turns -0 into 0, since min and max may return either
    min = around.min;
    max = around.max;
  }
  bool empty() const { return triangle == kNone; }
  BvhBox box() const { return {min, max}; }
  Eigen::Array4f center() const { return 0.5f * min + 0.5f * max; }
};

/// A run of items that becomes a node, with the box around them and the box around their centers.
struct BvhRange {
  std::size_t begin = 0, end = 0;
  BvhBox box, centers;

  std::size_t size() const { return end - begin; }
  /// Adds the item at `end`.
  void push(const BvhItem& item) {
    box.extend(item.box());
    centers.extend(item.center());
    ++end;
  }
  /// Adds the items of `other`, which must follow those of this range.
  void add(const BvhRange& other) {
    box.extend(other.box);
    centers.extend(other.centers);
    end += other.size();
  }
};

/// Bins along the three axes of the box around the centers of a range's items.
struct BvhBins {
  static constexpr int kMost = 16;
  struct Bin {
    BvhBox box;
    std::uint32_t n = 0;
  };

  int size;                    ///< number of bins per axis
  Eigen::Array4f from, scale;  ///< bin = (center - from) * scale; the scale is 0 along axes that cannot be split

  explicit BvhBins(const BvhRange& range)
      : size(range.size() < 16   ? 4
             : range.size() < 64 ? 8
                                 : kMost),
        from(Eigen::Array4f::Zero()),
        scale(Eigen::Array4f::Zero()) {
    const Eigen::Array4f extent = range.centers.max - range.centers.min;
    for (int a = 0; a < 3; ++a) {
      const float k = static_cast<float>(size) * (1.0f - 1e-6f) / extent[a];
      if (!(extent[a] > 0.0f) || !std::isfinite(k)) continue;
      from[a] = range.centers.min[a];
      scale[a] = k;  // slightly reduced, so that rounding never gives bin `size`
    }
  }
  bool usable() const { return (scale > 0.0f).any(); }
  /// The bin of a center along an axis.
  int of(const Eigen::Array4f& center, int axis) const {
    return static_cast<int>((center[axis] - from[axis]) * scale[axis]);
  }
};

/// A split of a range: items with a bin below `bin` along `axis` go to the left.
struct BvhSplit {
  int axis = -1;  ///< -1: the heuristic found no split
  int bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

/// The box and the number of a range's items in each bin along each axis.
struct BvhHistogram {
  BvhBins::Bin all[3][BvhBins::kMost];

  void add(const BvhItem& item, const BvhBins& bins) {
    const Eigen::Array4f center = item.center();
    for (int a = 0; a < 3; ++a) {
      BvhBins::Bin& b = all[a][bins.of(center, a)];
      b.box.extend(item.box());
      ++b.n;
    }
  }
  void add(const BvhHistogram& other) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < BvhBins::kMost; ++b) {
        all[a][b].box.extend(other.all[a][b].box);
        all[a][b].n += other.all[a][b].n;
      }
  }
};

/// Adds the items [begin, end) to `total` by add_to(part, begin, end). Large runs are divided among threads, each of
/// which fills a part of its own; the parts are then added to `total` in any order, which must not change the result.
template <typename Part, typename AddTo>
void add_parts(Part& total, std::size_t begin, std::size_t end, int threads, const AddTo& add_to) {
  constexpr std::size_t kChunk = 8192;
  if (threads <= 1 || end - begin <= kChunk) return add_to(total, begin, end);
  std::mutex mutex;
  parallel_chunks(end - begin, threads, kChunk, [&](std::size_t first, std::size_t last) {
    Part part;
    add_to(part, begin + first, begin + last);
    const std::lock_guard<std::mutex> lock(mutex);
    total.add(part);
  });
}

/// The split between bins with the lowest cost by the surface area heuristic.
/// @param scale see BvhBox::half_area()
inline BvhSplit cheapest_split(const Uninitialized<BvhItem>& items, const BvhRange& range, const BvhBins& bins,
                               float scale, int threads) {
  BvhHistogram histogram;
  add_parts(histogram, range.begin, range.end, threads, [&](BvhHistogram& part, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) part.add(items[i], bins);
  });
  const auto& all = histogram.all;
  BvhSplit best;
  for (int a = 0; a < 3; ++a) {
    if (!(bins.scale[a] > 0.0f)) continue;
    float right_cost[BvhBins::kMost];
    BvhBox sweep;
    std::uint32_t count = 0;
    for (int b = bins.size - 1; b > 0; --b) {
      if (all[a][b].n > 0) {
        sweep.extend(all[a][b].box);
        count += all[a][b].n;
      }
      right_cost[b] = count == 0 ? -1.0f : sweep.half_area(scale) * static_cast<float>(count);
    }
    sweep = BvhBox();
    count = 0;
    for (int b = 1; b < bins.size; ++b) {
      if (all[a][b - 1].n == 0) continue;  // the split before this one is the same
      sweep.extend(all[a][b - 1].box);
      count += all[a][b - 1].n;
      if (right_cost[b] < 0.0f) break;
      const float cost = sweep.half_area(scale) * static_cast<float>(count) + right_cost[b];
      if (cost < best.cost) best = {a, b, cost};
    }
  }
  return best;
}

/// Splits a range in two and reorders its items accordingly.
/// @param threads the result does not depend on it
/// @return the left and the right part; the left one is empty if a leaf is better than a split
inline std::pair<BvhRange, BvhRange> split_bvh(Uninitialized<BvhItem>& items, const BvhRange& range, int depth,
                                               int threads = 1) {
  constexpr std::size_t kMinLeaf = 4,
                        kMaxLeaf = 8;  // ranges up to kMinLeaf are never split, those above kMaxLeaf always
  constexpr float kNodeCost = 1.0f;    // cost of visiting a node, in triangle tests
  BvhRange left, right;
  left.begin = left.end = range.begin;
  if (range.size() <= kMinLeaf) return {left, right};
  const float longest = (range.box.max - range.box.min).head<3>().maxCoeff();
  const float scale = std::isfinite(longest) && longest > 0.0f ? 1.0f / longest : 1.0f;
  const BvhBins bins(range);
  const bool by_area = depth < kBvhSahDepth && bins.usable();
  const BvhSplit best = by_area ? cheapest_split(items, range, bins, scale, threads) : BvhSplit();
  const float area = range.box.half_area(scale);
  if (range.size() <= kMaxLeaf && !(best.cost + kNodeCost * area < area * static_cast<float>(range.size())))
    return {left, right};
  if (best.axis >= 0) {
    std::size_t end = range.end;
    while (left.end < end) {
      if (bins.of(items[left.end].center(), best.axis) < best.bin) {
        left.push(items[left.end]);
      } else {
        right.push(items[left.end]);
        std::swap(items[left.end], items[--end]);
      }
    }
  } else {
    // All centers (nearly) coincide or the tree is too deep: halve the range along the longest axis.
    int axis = 0;
    (range.centers.max - range.centers.min).head<3>().maxCoeff(&axis);
    const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t middle = range.begin + range.size() / 2;
    std::nth_element(at(range.begin), at(middle), at(range.end), [&](const BvhItem& a, const BvhItem& b) {
      const float ca = a.center()[axis], cb = b.center()[axis];
      return ca < cb || (ca == cb && a.triangle < b.triangle);
    });
    while (left.end < middle) left.push(items[left.end]);
    for (std::size_t i = middle; i < range.end; ++i) right.push(items[i]);
  }
  right.begin = left.end;
  right.end = range.end;
  return {left, right};
}

/// A range that is still to be turned into a node.
struct BvhTask {
  BvhRange range;
  std::uint32_t node;
  int depth;
};

/// Fills the node of a task. If the range is split, two nodes for the children are appended to `nodes`.
/// @param sides the parts of the range, see split_bvh
/// @param then `void(const BvhTask&)`, called for the right child, then for the left one
template <typename Then>
void make_bvh_node(Uninitialized<BvhNode>& nodes, const BvhTask& task, const std::pair<BvhRange, BvhRange>& sides,
                   Then&& then) {
  const auto& [left, right] = sides;
  const auto children = static_cast<std::uint32_t>(nodes.size());
  BvhNode& node = nodes[task.node];
  node.min = task.range.box.min.head<3>();
  node.max = task.range.box.max.head<3>();
  if (left.size() == 0) {
    node.first = static_cast<std::uint32_t>(task.range.begin);
    node.count = static_cast<std::uint32_t>(task.range.size());
    return;
  }
  node.first = children;
  node.count = 0;
  nodes.resize(nodes.size() + 2);
  then(BvhTask{right, children + 1, task.depth + 1});
  then(BvhTask{left, children, task.depth + 1});
}

/// Builds a separate tree from a range; the depth of its root counts as `depth`.
inline Uninitialized<BvhNode> grow_bvh(Uninitialized<BvhItem>& items, const BvhRange& range, int depth) {
  Uninitialized<BvhNode> nodes;
  nodes.reserve(range.size());
  nodes.emplace_back();
  std::vector<BvhTask> tasks{{range, 0, depth}};
  while (!tasks.empty()) {
    throw_if_cancelled();
    const BvhTask task = tasks.back();
    tasks.pop_back();
    make_bvh_node(nodes, task, split_bvh(items, task.range, task.depth),
                  [&](const BvhTask& child) { tasks.push_back(child); });
  }
  return nodes;
}

/// Builds the nodes of a tree over `items`, and puts the items into the order of the leaves. Without items there are no
/// nodes.
/// @param threads the result does not depend on it
inline Uninitialized<BvhNode> build_bvh(Uninitialized<BvhItem>& items, int threads) {
  // Larger ranges are split level by level; each range of at most this size becomes a subtree, built by one thread.
  const std::size_t subtree = std::max<std::size_t>(8192, items.size() / 6);
  Uninitialized<BvhNode> nodes;
  if (items.empty()) return nodes;
  nodes.emplace_back();
  BvhTask whole{{}, 0, 0};
  add_parts(whole.range, 0, items.size(), threads, [&](BvhRange& part, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) part.push(items[i]);
  });
  std::vector<BvhTask> level, roots;
  const auto add = [&](const BvhTask& task) { (task.range.size() > subtree ? level : roots).push_back(task); };
  add(whole);
  while (!level.empty()) {
    std::vector<std::pair<BvhRange, BvhRange>> sides(level.size());
    const int each = threads / static_cast<int>(level.size());  // number of threads per range
    const auto split = [&](std::size_t i) { sides[i] = split_bvh(items, level[i].range, level[i].depth, each); };
    parallel_for(level.size(), threads, split, 1);
    const std::vector<BvhTask> split_tasks = std::exchange(level, {});
    for (std::size_t i = 0; i < sides.size(); ++i) make_bvh_node(nodes, split_tasks[i], sides[i], add);
  }
  // The largest first, so that all threads finish at about the same time.
  std::stable_sort(roots.begin(), roots.end(),
                   [](const BvhTask& a, const BvhTask& b) { return a.range.size() > b.range.size(); });
  std::vector<Uninitialized<BvhNode>> subtrees(roots.size());
  const auto grow = [&](std::size_t r) { subtrees[r] = grow_bvh(items, roots[r].range, roots[r].depth); };
  parallel_for(roots.size(), threads, grow, 1);
  std::vector<std::size_t> shifts;  // added to the positions of a subtree's nodes; its root has a place already
  std::size_t size = nodes.size();
  for (const auto& tree : subtrees) {
    shifts.push_back(size - 1);
    size += tree.size() - 1;
  }
  nodes.resize(size);
  const auto move = [&](std::size_t r) {
    for (BvhNode& node : subtrees[r])
      if (node.count == 0) node.first += static_cast<std::uint32_t>(shifts[r]);
    nodes[roots[r].node] = subtrees[r].front();
    std::copy(subtrees[r].begin() + 1, subtrees[r].end(), nodes.begin() + static_cast<std::ptrdiff_t>(shifts[r] + 1));
  };
  parallel_for(roots.size(), threads, move, 1);
  return nodes;
}

}  // namespace agrisee::detail
