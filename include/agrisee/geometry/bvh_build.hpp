// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the tree of bvh.hpp is built: top down, each node split where the surface area heuristic over bins along
/// the axes is lowest (Wald 2007). O(n log n); deterministic.
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

/// A triangle while the tree is built, or none. It has no value to begin with.
struct BvhItem {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  Eigen::Array4f min, max;  // of its box
  std::uint32_t triangle;   // its index
  BvhItem() {}
  BvhItem(const Triangle& t, std::uint32_t index) : triangle(index) {
    BvhBox around;
    for (const Eigen::Vector3f& p : t)
      around.extend(Eigen::Array4f(p[0], p[1], p[2], 0.0f) + 0.0f);  // no -0, which is no less than 0
    min = around.min;
    max = around.max;
  }
  bool empty() const { return triangle == kNone; }
  BvhBox box() const { return {min, max}; }
  Eigen::Array4f center() const { return 0.5f * min + 0.5f * max; }
};

/// A run of items that becomes a node, and the boxes around them and around their centers.
struct BvhRange {
  std::size_t begin = 0, end = 0;
  BvhBox box, centers;

  std::size_t size() const { return end - begin; }
  /// Take in the item at `end`.
  void push(const BvhItem& item) {
    box.extend(item.box());
    centers.extend(item.center());
    ++end;
  }
  /// Take in as many items as `other` has, which are those that follow.
  void add(const BvhRange& other) {
    box.extend(other.box);
    centers.extend(other.centers);
    end += other.size();
  }
};

/// Bins along the three axes of the box around the centers of a range.
struct BvhBins {
  static constexpr int kMost = 16;
  struct Bin {
    BvhBox box;
    std::uint32_t n = 0;
  };

  int size;                    ///< bins an axis
  Eigen::Array4f from, scale;  ///< of bin coordinates; the scale is 0 along axes that cannot be split

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
      scale[a] = k;  // small enough for rounding never to reach bin `size`
    }
  }
  bool usable() const { return (scale > 0.0f).any(); }
  /// The bin of a center along an axis.
  int of(const Eigen::Array4f& center, int axis) const {
    return static_cast<int>((center[axis] - from[axis]) * scale[axis]);
  }
};

/// Items with a bin below `bin` along `axis` are the left side.
struct BvhSplit {
  int axis = -1;  ///< -1 = the heuristic found none
  int bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

/// What a range's items are in each bin along each axis.
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

/// `total`, with which the parts of items [begin, end) that `add_to(part, begin, end)` makes are joined by part.add.
/// Large runs are divided among threads; the order of the parts must not matter.
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

/// The split between bins that the surface area heuristic takes to be cheapest.
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
      if (all[a][b - 1].n == 0) continue;  // a split here puts the same items on either side as the one before
      sweep.extend(all[a][b - 1].box);
      count += all[a][b - 1].n;
      if (right_cost[b] < 0.0f) break;
      const float cost = sweep.half_area(scale) * static_cast<float>(count) + right_cost[b];
      if (cost < best.cost) best = {a, b, cost};
    }
  }
  return best;
}

/// Split a range: its items are reordered.
/// @param threads the result does not depend on it
/// @return the two sides; the left one is empty when a leaf is better
inline std::pair<BvhRange, BvhRange> split_bvh(Uninitialized<BvhItem>& items, const BvhRange& range, int depth,
                                               int threads = 1) {
  constexpr std::size_t kMinLeaf = 4, kMaxLeaf = 8;  // fewer are not split, more always are
  constexpr float kNodeCost = 1.0f;                  // of a step down, in triangle tests
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
    // All centers (nearly) coincide, or the tree is too deep: halve along the longest axis.
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

/// A node that is still to be made of a range.
struct BvhTask {
  BvhRange range;
  std::uint32_t node;
  int depth;
};

/// Split a task's range and make its node: a leaf, or an inner one whose children's nodes are added behind the others.
/// @param sides of the range, see split_bvh
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

/// A tree of its own of a range, whose root stands at `depth`.
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

/// The nodes of a tree over `items`, which are put into the order of the leaves. No items: no nodes.
/// @param threads the result does not depend on it
inline Uninitialized<BvhNode> build_bvh(Uninitialized<BvhItem>& items, int threads) {
  // Ranges of at most so many grow trees of their own; those above are split level by level.
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
    const int each = threads / static_cast<int>(level.size());  // threads
    const auto split = [&](std::size_t i) { sides[i] = split_bvh(items, level[i].range, level[i].depth, each); };
    parallel_for(level.size(), threads, split, 1);
    const std::vector<BvhTask> split_tasks = std::exchange(level, {});
    for (std::size_t i = 0; i < sides.size(); ++i) make_bvh_node(nodes, split_tasks[i], sides[i], add);
  }
  // The largest first, that all threads end at about the same time.
  std::stable_sort(roots.begin(), roots.end(),
                   [](const BvhTask& a, const BvhTask& b) { return a.range.size() > b.range.size(); });
  std::vector<Uninitialized<BvhNode>> subtrees(roots.size());
  const auto grow = [&](std::size_t r) { subtrees[r] = grow_bvh(items, roots[r].range, roots[r].depth); };
  parallel_for(roots.size(), threads, grow, 1);
  std::vector<std::size_t> shifts;  // where a subtree's nodes go, but for its root, whose place is there
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
