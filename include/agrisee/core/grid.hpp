// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbour search by a uniform grid (cell list): points sorted by cell, x fastest, so that the cells of a row lie
/// side by side in memory and a query reads a few runs. Fastest for radii near the cell size. Build O(n), by
/// a table of cells or, where these are too many for one (far outliers), by a sort and hashing; memory the coordinates
/// and an index a point, four bytes an occupied cell and two bits a cell.
/// Queries for all points at once are several times as fast through tiles.hpp.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cell_starts.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/neighbors.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/radix_sort.hpp>
#include <agrisee/core/sparse_cells.hpp>
#include <agrisee/core/stencil.hpp>
#include <agrisee/core/sums.hpp>
#include <agrisee/core/uninitialized.hpp>

#include <array>
#include <cmath>
#include <utility>

namespace agrisee {

/// A cell list over the finite points of a cloud; see neighbors.hpp for the interface.
template <typename S>
class Grid {
 public:
  /// @param cloud points (m), any cloud type
  /// @param cell edge length of a cell (m), > 0; half to one times the usual query radius serves best
  /// @param threads the result does not depend on it
  /// @throws ParameterError when `cell` is not positive and finite; InputError for finite points whose distance is no
  ///         finite number; Cancelled
  template <typename C>
  Grid(const C& cloud, S cell, int threads = 1) : size_(agrisee::size(cloud)) {
    check_parameter(std::isfinite(cell) && cell > 0, "grid cell", "positive and finite", cell);
    const std::vector<std::size_t> parts = split(threads);
    std::vector<Extent> extents(parts.size() - 1);
    parallel_for(
        extents.size(), threads, [&](std::size_t t) { extents[t] = extent(cloud, parts[t], parts[t + 1]); }, 1);
    Extent all = extents[0];
    for (const Extent& e : extents) all.min = all.min.cwiseMin(e.min), all.max = all.max.cwiseMax(e.max);
    std::size_t n = 0;
    for (const Extent& e : extents) n += e.count;
    if (n == 0) all.min.setZero(), all.max.setZero();
    min_ = all.min;
    const double longest = 2.0 * (0.5 * all.max - 0.5 * min_).maxCoeff();
    check_input(std::isfinite(longest), "a grid takes no cloud so wide that its width is no finite number");
    cell_ = std::max({static_cast<double>(cell), longest / kMaxCells, kSmallest});
    inverse_ = 1.0 / cell_;
    for (int a = 0; a < 3; ++a) dims_[a] = static_cast<int>((all.max[a] - min_[a]) * inverse_) + 1;
    const double cells = double(dims_[0]) * double(dims_[1]) * double(dims_[2]);
    dense_ = cells <= 128.0 * static_cast<double>(n) + 262144.0 && cells < 4294967295.0;  // keys have 32 bits
    dense_ ? build_dense(cloud, n, static_cast<std::size_t>(cells), parts, threads) : build_sparse(cloud, n);
  }

  /// Number of points of the cloud.
  std::size_t size() const { return size_; }

  /// All points within r; see neighbors.hpp.
  void radius(const Vector3<S>& q, S r, Neighbors<S>& out) const {
    out.clear();
    visit(q, r, [&](Index i, S d_sq) { out.push_back({i, d_sq}); });
    std::sort(out.begin(), out.end(), detail::Nearest<S>::before);
    for (Neighbor<S>& n : out) n.distance = std::sqrt(n.distance);
  }

  /// How many points are within r; see neighbors.hpp.
  std::size_t count(const Vector3<S>& q, S r, std::size_t cap = kNoCap) const {
    if (!(r >= 0) || cap == 0) return 0;
    std::size_t found = 0;
    const S r_sq = r * r;
    rows(q, r, [&](std::size_t begin, std::size_t end) {
      unsigned in = 0;
      for (std::size_t j = begin; j < end; ++j) in += distance_sq(j, q) <= r_sq ? 1u : 0u;
      found += in;
      return found < cap;
    });
    return std::min(found, cap);
  }

  /// Calls f for all points within r; see neighbors.hpp.
  template <typename F>
  void visit(const Vector3<S>& q, S r, F&& f) const {
    if (!(r >= 0)) return;
    const S r_sq = r * r;
    rows(q, r, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const S d_sq = distance_sq(j, q);
        if (d_sq <= r_sq) f(ids_[j], d_sq);
      }
      return true;
    });
  }

  /// The k nearest points; see neighbors.hpp.
  void knn(const Vector3<S>& q, std::size_t k, Neighbors<S>& out) const {
    k = std::min(k, ids_.size());
    detail::Nearest<S> nearest(out, k);
    if (k > 0 && is_finite(q)) {
      // Boxes of growing size around q; once the k-th is nearer than the box's border, nothing outside can enter.
      // Doubling re-reads a few cells, and is bounded where q is far away or the cloud is thin.
      const Eigen::Vector3d d = q.template cast<double>();
      Eigen::Vector3d outside = (min_ - d).cwiseMax(d - (min_ + cell_ * dims_vector())).cwiseMax(0.0);
      for (double reach = outside.norm() + cell_;; reach *= 2.0) {
        out.clear();
        rows(q, static_cast<S>(reach), [&](std::size_t begin, std::size_t end) {
          for (std::size_t j = begin; j < end; ++j) nearest.offer(distance_sq(j, q), ids_[j]);
          return true;
        });
        if (nearest.full() && std::sqrt(static_cast<double>(nearest.worst_sq())) <= reach) break;
        if (reach > outside.norm() + 2.0 * cell_ * dims_vector().norm()) break;  // everything has been seen
      }
    }
    nearest.finish();
  }

  // What tiles.hpp reads: the finite points in the order in which they are stored, cell by cell.

  using Cell = SparseCells::Cell;  ///< z, y, x: the order of the points

  /// Number of stored points.
  std::size_t stored() const { return ids_.size(); }
  /// Their index in the cloud and their coordinates.
  const detail::Uninitialized<Index>& ids() const { return ids_; }
  /// Coordinates of the stored points (m), and kBlock numbers of no meaning, that all can be copied block by block.
  const detail::Uninitialized<S>& x() const { return x_; }
  /// Likewise.
  const detail::Uninitialized<S>& y() const { return y_; }
  /// Likewise.
  const detail::Uninitialized<S>& z() const { return z_; }
  static constexpr std::size_t kBlock = 8;  ///< coordinates a block
  /// Stored point j (m).
  Vector3<S> stored_point(std::size_t j) const { return {x_[j], y_[j], z_[j]}; }
  /// Edge length of a cell (m); longer than asked for where the cloud is wider than 2^30 cells.
  double cell() const { return cell_; }

  /// Middle of a cell (m).
  Vector3<S> center(const Cell& c) const {
    return (min_ + cell_ * (Eigen::Vector3d(c[2], c[1], c[0]).array() + 0.5).matrix()).template cast<S>();
  }

  /// f(cell, begin, end) for the occupied cells whose first stored point is one of [first, last).
  template <typename F>
  void cells(std::size_t first, std::size_t last, F&& f) const {
    while (first < last) {
      const Cell c = cell_of(stored_point(first));
      const auto [begin, end] = row(c[2], c[2], c[1], c[0]);
      if (begin == first) f(c, begin, end);
      first = end;
    }
  }

  /// The stored points [begin, end) of the cells x0 to x1 of a row, or none; any coordinates may be out of the grid.
  std::pair<std::size_t, std::size_t> run(int x0, int x1, int y, int z) const {
    x0 = std::max(x0, 0), x1 = std::min(x1, dims_[0] - 1);
    if (y < 0 || z < 0 || y >= dims_[1] || z >= dims_[2] || x0 > x1) return {0, 0};
    return row(x0, x1, y, z);
  }

  /// Distance (m) from q to the nearest cell that may hold points beyond the `rings` rings of cells about q's cell c.
  double clearance(const Vector3<S>& q, const Cell& c, int rings) const {
    double out = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      const int i = c[static_cast<std::size_t>(2 - a)];
      const double d = double(q[a]) - min_[a];
      if (i - rings > 0) out = std::min(out, d - cell_ * double(i - rings));
      if (i + rings < dims_[a] - 1) out = std::min(out, cell_ * double(i + rings + 1) - d);
    }
    return out - 4e-6 * cell_;
  }

 private:
  static constexpr double kMaxCells = 1 << 30;
  static constexpr double kSmallest = 1e-290;  // m, a cell, that cells a metre are a finite number

  /// Whether this is to be stopped, asked once in some thousand points.
  static void look_up(std::size_t i) {
    if ((i & 0x1FFF) == 0) throw_if_cancelled();
  }

  S distance_sq(std::size_t j, const Vector3<S>& q) const {
    const S dx = x_[j] - q.x(), dy = y_[j] - q.y(), dz = z_[j] - q.z();
    return detail::sum_of_squares(dx, dy, dz);
  }

  void reserve(std::size_t n) {
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

  Eigen::Vector3d dims_vector() const { return dims_.cast<double>(); }

  int clamp_cell(double x, int axis) const {
    const double c = (x - min_[axis]) * inverse_;  // rounded down by the cast
    return c <= 0.0 ? 0 : c >= double(dims_[axis]) ? dims_[axis] - 1 : static_cast<int>(c);
  }
  Cell cell_of(const Vector3<S>& p) const {
    return {clamp_cell(double(p.z()), 2), clamp_cell(double(p.y()), 1), clamp_cell(double(p.x()), 0)};
  }
  std::size_t key(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(dims_[1]) + std::size_t(y)) * std::size_t(dims_[0]) + std::size_t(x);
  }
  std::uint32_t key_of(const Vector3<S>& p) const {
    const Cell c = cell_of(p);
    return static_cast<std::uint32_t>(key(c[2], c[1], c[0]));
  }

  struct Extent {
    Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), max = -min;
    std::size_t count = 0;  // finite points
  };
  template <typename C>
  Extent extent(const C& cloud, std::size_t begin, std::size_t end) const {
    Extent out;
    for (std::size_t i = begin; i < end; ++i) {
      look_up(i);
      const Vector3<S> p = point(cloud, i);
      if (!is_finite(p)) continue;
      const Eigen::Vector3d d = p.template cast<double>();
      out.min = out.min.cwiseMin(d);
      out.max = out.max.cwiseMax(d);
      ++out.count;
    }
    return out;
  }

  /// Where the cloud is divided for the threads: the first point of each part, and the end.
  std::vector<std::size_t> split(int threads) const {
    constexpr std::size_t kWorthIt = 4096;
    const std::size_t most = static_cast<std::size_t>(std::max(threads, 1));
    const std::size_t parts = std::clamp<std::size_t>(size_ / kWorthIt, 1, most);
    std::vector<std::size_t> out;
    for (std::size_t t = 0; t <= parts; ++t) out.push_back(t * size_ / parts);
    return out;
  }

  /// Points are brought to buckets of consecutive cells, then each bucket's to their cells, in the order of their
  /// indices: what is written at a time fits into the caches.
  template <typename C>
  void build_dense(const C& cloud, std::size_t n, std::size_t cells, const std::vector<std::size_t>& parts,
                   int threads) {
    constexpr std::size_t kBuckets = 1024;
    unsigned shift = CellStarts::kShift;
    while ((cells - 1) >> shift >= kBuckets) ++shift;
    const std::size_t buckets = ((cells - 1) >> shift) + 1, count = parts.size() - 1;
    std::vector<std::uint32_t> at(count * buckets, 0);    // per part and bucket: points, then where the next one goes
    const auto for_part = [&](std::size_t t, auto&& f) {  // f(bucket's entry, point, index)
      for (std::size_t i = parts[t]; i < parts[t + 1]; ++i) {
        look_up(i);
        const Vector3<S> p = point(cloud, i);
        if (is_finite(p)) f(at[t * buckets + (key_of(p) >> shift)], p, i);
      }
    };
    const auto count_in = [](std::uint32_t& points, const Vector3<S>&, std::size_t) { ++points; };
    parallel_for(
        count, threads, [&](std::size_t t) { for_part(t, count_in); }, 1);
    std::vector<std::uint32_t> begins(buckets + 1, 0);  // of the buckets
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      begins[b] = sum;
      for (std::size_t t = 0; t < count; ++t) sum += std::exchange(at[t * buckets + b], sum);
    }
    begins[buckets] = sum;
    reserve(n);
    const auto bring = [this](std::uint32_t& next, const Vector3<S>& p, std::size_t i) { store(next++, p, i); };
    parallel_for(
        count, threads, [&](std::size_t t) { for_part(t, bring); }, 1);
    table_.reset(cells);
    std::vector<std::vector<std::uint32_t>> cell_begins(buckets);  // of the occupied cells
    parallel_chunks(buckets, count > 1 ? threads : 1, 16, [&](std::size_t first, std::size_t last) {
      struct Moved {
        Vector3<S> p;
        Index i;
        std::size_t cell;  // of the bucket's
      };
      std::vector<Moved> points;
      std::vector<std::uint32_t> next(std::size_t(1) << shift);  // per occupied cell: points, then where the next goes
      for (std::size_t b = first; b < last; ++b) {
        const std::size_t begin = begins[b], end = begins[b + 1], low = b << shift;
        if (begin == end) continue;
        points.clear();
        points.reserve(end - begin);
        for (std::size_t j = begin; j < end; ++j) {
          look_up(j);
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
    for (const auto& some : cell_begins) table_.append(some);
    table_.finish(n);
  }

  /// The finite points in the order of their cells, then of their indices.
  template <typename C>
  void build_sparse(const C& cloud, std::size_t n) {
    reserve(n);
    std::size_t j = 0;
    Cell last{-1, -1, -1};
    const auto next = [&](Index index) {
      look_up(j);
      const auto i = static_cast<std::size_t>(index);
      const Vector3<S> p = point(cloud, i);
      const Cell cell = cell_of(p);
      if (cell != last) sparse_.append(last = cell, static_cast<std::uint32_t>(j));
      store(j++, p, i);
    };
    const auto for_finite = [&](auto&& f) {  // f(cell, index)
      for (std::size_t i = 0; i < size_; ++i) {
        look_up(i);
        const Vector3<S> p = point(cloud, i);
        if (is_finite(p)) f(cell_of(p), static_cast<Index>(i));
      }
    };
    if (dims_.cast<double>().prod() < 9e18) {  // a number tells a cell
      detail::Uninitialized<Keyed<std::uint64_t>> order;
      order.reserve(n);
      for_finite([&](const Cell& c, Index i) { order.push_back({key(c[2], c[1], c[0]), i}); });
      radix_sort(order);
      for (const auto& one : order) next(one.index);
    } else {
      std::vector<std::pair<Cell, Index>> order;
      order.reserve(n);
      for_finite([&](const Cell& c, Index i) { order.emplace_back(c, i); });
      detail::sort_cancellably(order.begin(), order.end());
      for (const auto& one : order) next(one.second);
    }
    sparse_.finish(n);
  }

  /// body(begin, end) for each run of stored points that may lie within r of q, until it returns false.
  template <typename Body>
  void rows(const Vector3<S>& q, S r, Body&& body) const {
    if (ids_.empty() || !is_finite(q)) return;
    const Eigen::Vector3d d = q.template cast<double>();
    // A margin for the rounding of q - p in S.
    const double reach =
        double(r) + 4.0 * double(std::numeric_limits<S>::epsilon()) * (d.cwiseAbs().maxCoeff() + double(r));
    const double reach_sq = reach * reach;
    Eigen::Vector3i lo, hi;
    for (int a = 0; a < 3; ++a) {
      if (d[a] + reach < min_[a] || d[a] - reach > min_[a] + cell_ * double(dims_[a])) return;
      lo[a] = clamp_cell(d[a] - reach, a);
      hi[a] = clamp_cell(d[a] + reach, a);
    }
    const auto gap = [&](int c, int a) {  // distance along axis a from q to the slab of cells c
      const double low = min_[a] + cell_ * double(c), high = low + cell_;
      const double slack = 1e-9 * cell_;
      return std::max({low - slack - d[a], d[a] - high - slack, 0.0});
    };
    const auto try_row = [&](int y, int z) {
      const auto [begin, end] = row(lo[0], hi[0], y, z);
      return begin == end || body(begin, end);
    };
    if (!dense_ && double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1) > double(sparse_.blocks())) {
      body(std::size_t(0), ids_.size());  // fewer blocks than rows: read them all
      return;
    }
    for (int z = lo[2]; z <= hi[2]; ++z) {
      const double gz = gap(z, 2);
      for (int y = lo[1]; y <= hi[1]; ++y) {
        const double gy = gap(y, 1);
        if (gz * gz + gy * gy > reach_sq) continue;
        if (!try_row(y, z)) return;
      }
    }
  }

  std::pair<std::size_t, std::size_t> row(int x0, int x1, int y, int z) const {
    if (dense_) return {table_[key(x0, y, z)], table_[key(x1, y, z) + 1]};
    return sparse_.run(x0, x1, y, z);
  }

  detail::Uninitialized<S> x_, y_, z_;  // the points, sorted by cell, then by index
  detail::Uninitialized<Index> ids_;    // their index in the cloud
  CellStarts table_;                    // where the cells begin,
  SparseCells sparse_;                  // or, where these are too many, the occupied ones
  Eigen::Vector3d min_;
  double cell_ = 1.0, inverse_ = 1.0;
  Eigen::Vector3i dims_ = Eigen::Vector3i::Ones();
  std::size_t size_ = 0;
  bool dense_ = true;
};

/// The scalar of a grid is that of its cloud.
template <typename C, typename T>
Grid(const C&, T) -> Grid<scalar_t<C>>;
/// The same.
template <typename C, typename T>
Grid(const C&, T, int) -> Grid<scalar_t<C>>;

}  // namespace agrisee
