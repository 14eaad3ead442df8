// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The finite points of a cloud, sorted by the cell of a uniform grid. Cells are ordered with x fastest, so the points
/// of a row of cells lie side by side in memory.
///
/// A table holds where the points of each cell begin. If there are too many cells for a table of all (a few points far
/// away are enough for that), the points are sorted by cell and a hash table holds the occupied cells only. Building is
/// O(n). Memory: the coordinates and an index per point, four bytes per occupied cell and two bits per cell.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/uninitialized.hpp>
#include <agrisee/neighbors/detail/cell_lattice.hpp>
#include <agrisee/neighbors/detail/cell_starts.hpp>
#include <agrisee/neighbors/detail/radix_sort.hpp>
#include <agrisee/neighbors/detail/sparse_cells.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// The stored points of a grid: ordered by cell, and within a cell by their index in the cloud.
template <typename S>
class GridPoints {
 public:
  using Cell = GridCell;                    ///< z, y, x, from 0
  static constexpr std::size_t kBlock = 8;  ///< number of unused elements at the end of x(), y() and z()

  /// @param cloud points (m), any cloud type
  /// @param cell edge length of a cell (m), > 0
  /// @param threads the result does not depend on it
  /// @throws ParameterError if `cell` is not positive and finite; InputError if the width of the cloud is not a finite
  ///         number; Cancelled
  template <typename C>
  GridPoints(const C& cloud, S cell, int threads);

  /// Number of points of the cloud, including those that are not finite.
  std::size_t size() const { return size_; }
  /// Number of stored points.
  std::size_t stored() const { return ids_.size(); }
  /// Index in the cloud of each stored point.
  const Uninitialized<Index>& ids() const { return ids_; }
  /// Coordinates of the stored points (m), followed by kBlock zeros, so that loops may read whole blocks.
  const Uninitialized<S>& x() const { return x_; }
  const Uninitialized<S>& y() const { return y_; }  ///< see x()
  const Uninitialized<S>& z() const { return z_; }  ///< see x()
  /// Stored point j (m).
  Vector3<S> stored_point(std::size_t j) const { return {x_[j], y_[j], z_[j]}; }

  /// Edge length of a cell (m). It is longer than asked for if the cloud is wider than 2^30 cells.
  double cell() const { return lattice_.cell(); }
  /// Center of a cell (m).
  Vector3<S> center(const Cell& c) const { return lattice_.center(c).template cast<S>(); }
  /// Distance (m) from q, which lies in cell c, to the nearest cell of the grid that is more than `rings` cells from c;
  /// infinite if there is none.
  double clearance(const Vector3<S>& q, const Cell& c, int rings) const { return lattice_.clearance(q, c, rings); }

  /// Calls f(cell, begin, end) for the occupied cells whose first stored point is in [first, last).
  template <typename F>
  void cells(std::size_t first, std::size_t last, F&& f) const {
    while (first < last) {
      const Cell c = lattice_.cell_of(stored_point(first));
      const auto [begin, end] = row(c[2], c[2], c[1], c[0]);
      if (begin == first) f(c, begin, end);
      first = end;
    }
  }

  /// The stored points [begin, end) of the cells x0 to x1 of a row. Coordinates outside the grid are allowed.
  std::pair<std::size_t, std::size_t> run(int x0, int x1, int y, int z) const {
    x0 = std::max(x0, 0), x1 = std::min(x1, lattice_.dim(0) - 1);
    if (y < 0 || z < 0 || y >= lattice_.dim(1) || z >= lattice_.dim(2) || x0 > x1) return {0, 0};
    return row(x0, x1, y, z);
  }

 protected:
  const CellLattice& lattice() const { return lattice_; }
  /// As run(), for coordinates inside the grid and x0 <= x1.
  std::pair<std::size_t, std::size_t> row(int x0, int x1, int y, int z) const {
    if (dense_) return {table_[lattice_.key(x0, y, z)], table_[lattice_.key(x1, y, z) + 1]};
    return sparse_.run(x0, x1, y, z);
  }
  /// True if reading all stored points is cheaper than looking up so many rows.
  bool fewer_blocks_than(double rows) const { return !dense_ && rows > double(sparse_.blocks()); }

 private:
  /// The box around the finite points of a part of the cloud, and their number.
  struct Extent {
    Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), max = -min;
    std::size_t count = 0;
  };
  /// Runs of consecutive cells; cell `key` belongs to bucket key >> shift.
  struct Buckets {
    unsigned shift = CellStarts::kShift;
    std::size_t count = 0;
    std::vector<std::uint32_t> begins;  // first stored point of each bucket, then the number of points
  };

  /// Checks for cancellation once in 8,192 points.
  static void check_cancelled(std::size_t i) {
    if ((i & 0x1FFF) == 0) throw_if_cancelled();
  }

  std::vector<std::size_t> parts_of_cloud(int threads) const;
  template <typename C>
  Extent extent(const C& cloud, std::size_t begin, std::size_t end) const;
  template <typename C>
  void build_dense(const C& cloud, std::size_t n, std::size_t cells, const std::vector<std::size_t>& parts,
                   int threads);
  template <typename C>
  void fill_buckets(const C& cloud, const std::vector<std::size_t>& parts, int threads, Buckets& buckets);
  void sort_buckets(const Buckets& buckets, std::size_t cells, int threads);
  template <typename C>
  void build_sparse(const C& cloud, std::size_t n);

  void allocate(std::size_t n) {
    for (auto* c : {&x_, &y_, &z_}) {
      c->resize(n + kBlock);
      std::fill(c->begin() + static_cast<std::ptrdiff_t>(n), c->end(), S(0));
    }
    ids_.resize(n);
  }
  void store(std::size_t j, const Vector3<S>& p, std::size_t i) {
    x_[j] = p.x(), y_[j] = p.y(), z_[j] = p.z();
    ids_[j] = static_cast<Index>(i);
  }
  std::uint32_t key_of(const Vector3<S>& p) const {
    return static_cast<std::uint32_t>(lattice_.key(lattice_.cell_of(p)));
  }

  CellLattice lattice_;
  Uninitialized<S> x_, y_, z_;
  Uninitialized<Index> ids_;
  CellStarts table_;    // if dense_
  SparseCells sparse_;  // if not
  std::size_t size_ = 0;
  bool dense_ = true;
};

template <typename S>
template <typename C>
GridPoints<S>::GridPoints(const C& cloud, S cell, int threads) : size_(agrisee::size(cloud)) {
  check_parameter(std::isfinite(cell) && cell > 0, "grid cell", "positive and finite", cell);
  const std::vector<std::size_t> parts = parts_of_cloud(threads);
  std::vector<Extent> extents(parts.size() - 1);
  parallel_for(
      extents.size(), threads, [&](std::size_t t) { extents[t] = extent(cloud, parts[t], parts[t + 1]); }, 1);
  Extent all = extents[0];
  for (const Extent& e : extents) all.min = all.min.cwiseMin(e.min), all.max = all.max.cwiseMax(e.max);
  std::size_t n = 0;
  for (const Extent& e : extents) n += e.count;
  if (n == 0) all.min.setZero(), all.max.setZero();
  lattice_ = CellLattice(all.min, all.max, static_cast<double>(cell));
  const double cells = lattice_.cells();
  dense_ = cells <= 128.0 * static_cast<double>(n) + 262144.0 && cells < 4294967295.0;  // keys have 32 bits
  dense_ ? build_dense(cloud, n, static_cast<std::size_t>(cells), parts, threads) : build_sparse(cloud, n);
}

/// Divides the cloud among the threads: the first point of each part, then the number of points.
template <typename S>
std::vector<std::size_t> GridPoints<S>::parts_of_cloud(int threads) const {
  constexpr std::size_t kMinPart = 4096;  // smaller parts are not worth a thread
  const std::size_t most = static_cast<std::size_t>(std::max(threads, 1));
  const std::size_t parts = std::clamp<std::size_t>(size_ / kMinPart, 1, most);
  std::vector<std::size_t> out;
  for (std::size_t t = 0; t <= parts; ++t) out.push_back(t * size_ / parts);
  return out;
}

template <typename S>
template <typename C>
typename GridPoints<S>::Extent GridPoints<S>::extent(const C& cloud, std::size_t begin, std::size_t end) const {
  Extent out;
  for (std::size_t i = begin; i < end; ++i) {
    check_cancelled(i);
    const Vector3<S> p = point(cloud, i);
    if (!is_finite(p)) continue;
    const Eigen::Vector3d d = p.template cast<double>();
    out.min = out.min.cwiseMin(d);
    out.max = out.max.cwiseMax(d);
    ++out.count;
  }
  return out;
}

/// Sorts the n finite points into buckets of consecutive cells, then the points of each bucket into their cells. The
/// memory written to at any time then fits into the caches.
template <typename S>
template <typename C>
void GridPoints<S>::build_dense(const C& cloud, std::size_t n, std::size_t cells, const std::vector<std::size_t>& parts,
                                int threads) {
  constexpr std::size_t kMaxBuckets = 1024;
  Buckets buckets;
  while ((cells - 1) >> buckets.shift >= kMaxBuckets) ++buckets.shift;
  buckets.count = ((cells - 1) >> buckets.shift) + 1;
  allocate(n);
  fill_buckets(cloud, parts, threads, buckets);
  sort_buckets(buckets, cells, parts.size() > 2 ? threads : 1);
}

/// Stores the finite points bucket by bucket, those of a bucket in the order of their indices, and notes where the
/// buckets begin.
template <typename S>
template <typename C>
void GridPoints<S>::fill_buckets(const C& cloud, const std::vector<std::size_t>& parts, int threads, Buckets& buckets) {
  const std::size_t n_parts = parts.size() - 1, n_buckets = buckets.count;
  const unsigned shift = buckets.shift;
  // For each part and bucket: first the number of points, then where the next point goes.
  std::vector<std::uint32_t> entries(n_parts * n_buckets, 0);
  const auto for_part = [&](std::size_t t, auto&& f) {  // calls f(entry, point, index)
    for (std::size_t i = parts[t]; i < parts[t + 1]; ++i) {
      check_cancelled(i);
      const Vector3<S> p = point(cloud, i);
      if (is_finite(p)) f(entries[t * n_buckets + (key_of(p) >> shift)], p, i);
    }
  };
  const auto count = [](std::uint32_t& points, const Vector3<S>&, std::size_t) { ++points; };
  parallel_for(
      n_parts, threads, [&](std::size_t t) { for_part(t, count); }, 1);
  buckets.begins.assign(n_buckets + 1, 0);
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < n_buckets; ++b) {
    buckets.begins[b] = sum;
    for (std::size_t t = 0; t < n_parts; ++t) sum += std::exchange(entries[t * n_buckets + b], sum);
  }
  buckets.begins[n_buckets] = sum;
  const auto place = [this](std::uint32_t& next, const Vector3<S>& p, std::size_t i) { store(next++, p, i); };
  parallel_for(
      n_parts, threads, [&](std::size_t t) { for_part(t, place); }, 1);
}

/// Sorts the points of each bucket by cell, keeping the order of their indices, and fills the table of cells.
template <typename S>
void GridPoints<S>::sort_buckets(const Buckets& buckets, std::size_t cells, int threads) {
  const unsigned shift = buckets.shift;
  table_.reset(cells);
  std::vector<std::vector<std::uint32_t>> cell_begins(buckets.count);  // of the occupied cells of each bucket
  parallel_chunks(buckets.count, threads, 16, [&](std::size_t first, std::size_t last) {
    struct Moved {
      Vector3<S> p;
      Index i;
      std::size_t cell;  // within the bucket
    };
    std::vector<Moved> points;
    // For each occupied cell of the bucket: first the number of points, then where the next point goes.
    std::vector<std::uint32_t> next(std::size_t(1) << shift);
    for (std::size_t b = first; b < last; ++b) {
      const std::size_t begin = buckets.begins[b], end = buckets.begins[b + 1], low = b << shift;
      if (begin == end) continue;
      points.clear();
      points.reserve(end - begin);
      for (std::size_t j = begin; j < end; ++j) {
        check_cancelled(j);
        const Vector3<S> p = stored_point(j);
        const std::size_t cell = key_of(p) - low;
        points.push_back({p, ids_[j], cell});
        if (table_.mark(low + cell)) next[cell] = 0;
        ++next[cell];
      }
      auto cell_begin = static_cast<std::uint32_t>(begin);
      table_.marked(low, std::min(low + next.size(), cells), [&](std::size_t cell) {
        cell_begins[b].push_back(cell_begin);
        cell_begin += std::exchange(next[cell - low], cell_begin);
      });
      for (const Moved& m : points) store(next[m.cell]++, m.p, static_cast<std::size_t>(m.i));
    }
  });
  for (const auto& begins : cell_begins) table_.append(begins);
  table_.finish(stored());
}

/// Sorts the n finite points by cell, then by index, and fills the hash table of occupied cells.
template <typename S>
template <typename C>
void GridPoints<S>::build_sparse(const C& cloud, std::size_t n) {
  allocate(n);
  std::size_t j = 0;
  Cell last{-1, -1, -1};
  const auto append = [&](Index index) {
    check_cancelled(j);
    const auto i = static_cast<std::size_t>(index);
    const Vector3<S> p = point(cloud, i);
    const Cell cell = lattice_.cell_of(p);
    if (cell != last) sparse_.append(last = cell, static_cast<std::uint32_t>(j));
    store(j++, p, i);
  };
  const auto for_finite = [&](auto&& f) {  // calls f(cell, index)
    for (std::size_t i = 0; i < size_; ++i) {
      check_cancelled(i);
      const Vector3<S> p = point(cloud, i);
      if (is_finite(p)) f(lattice_.cell_of(p), static_cast<Index>(i));
    }
  };
  if (lattice_.dims().prod() < 9e18) {  // the keys of cells fit into 64 bits
    Uninitialized<Keyed<std::uint64_t>> order;
    order.reserve(n);
    for_finite([&](const Cell& c, Index i) { order.push_back({lattice_.key(c), i}); });
    radix_sort(order);
    for (const auto& item : order) append(item.index);
  } else {
    std::vector<std::pair<Cell, Index>> order;
    order.reserve(n);
    for_finite([&](const Cell& c, Index i) { order.emplace_back(c, i); });
    sort_cancellably(order.begin(), order.end());
    for (const auto& item : order) append(item.second);
  }
  sparse_.finish(n);
}

}  // namespace agrisee::detail
