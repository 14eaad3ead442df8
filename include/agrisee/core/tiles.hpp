// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One cell of a grid after another together with the points near it, copied side by side: what all points of the cell
/// have in common is gathered once, and the loops over the candidates are straight, so that compilers vectorise them.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/core/indices_within.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/sums.hpp>

#include <algorithm>
#include <cstring>
#include <limits>

namespace agrisee {

/// Candidates as a structure of arrays; not to be shared between threads.
template <typename S>
struct Tile {
  static constexpr std::size_t kLanes = 16;  ///< candidates a block

  std::vector<S> x;               ///< coordinates (m), padded() long at least; infinite after the last one
  std::vector<S> y;               ///< likewise, but any number after the last one
  std::vector<S> z;               ///< like y
  std::vector<std::uint32_t> at;  ///< position among the grid's stored points
  std::size_t size = 0;           ///< candidates
  std::size_t inside = 0;         ///< points that are not listed because they lie within reach of the whole cell

  /// The points of the stencil's cells about `c`.
  void gather(const Grid<S>& grid, const typename Grid<S>::Cell& c, const Stencil& stencil) {
    clear();
    for (const StencilRow& row : stencil) {
      const int cy = c[1] + row.dy, cz = c[0] + row.dz;
      const auto [begin, end] = grid.run(c[2] - row.outer, c[2] + row.outer, cy, cz);
      if (begin == end) continue;
      auto hole = std::make_pair(end, end);
      if (row.inner >= 0) hole = grid.run(c[2] - row.inner, c[2] + row.inner, cy, cz);
      if (hole.first == hole.second) {
        append(grid, begin, end);
      } else {
        append(grid, begin, hole.first);
        append(grid, hole.second, end);
        inside += hole.second - hole.first;
      }
    }
    pad();
  }

  /// The end of the last one's block, for loops over whole blocks: few lengths, which processors foresee.
  std::size_t padded() const { return (size + kLanes - 1) / kLanes * kLanes; }

  /// Squared distances (m2) from q to the candidates, then infinity: padded() numbers in all.
  void distances_sq(const Vector3<S>& q, S* out) const {
    const S qx = q.x(), qy = q.y(), qz = q.z();
    for (std::size_t j = 0; j < size; j += kLanes)
      for (std::size_t l = j; l < j + kLanes; ++l) {
        const S dx = x[l] - qx, dy = y[l] - qy, dz = z[l] - qz;
        out[l] = detail::sum_of_squares(dx, dy, dz);
      }
  }

  /// How many candidates are near.
  /// @param sq sq(j), the squared distance (m2) of candidate j, infinite from `size` to padded()
  /// @param limit_sq that of the farthest that counts (m2)
  template <typename Sq>
  std::size_t count_within(const Sq& sq, S limit_sq) const {
    std::uint32_t in[kLanes] = {};
    for (std::size_t j = 0; j < size; j += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) in[l] += sq(j + l) <= limit_sq ? 1u : 0u;
    std::size_t sum = 0;
    for (const std::uint32_t some : in) sum += some;
    return std::min(sum, size);  // within infinity is what is no candidate, too
  }

  /// Write the candidates with distances_sq[j] <= limit_sq (m2), ascending, to `out`, which has room for padded().
  /// @return how many there are
  std::size_t list_within(const S* distances_sq, S limit_sq, std::uint32_t* out) const {
    return std::min(detail::indices_within(distances_sq, padded(), limit_sq, out), size);  // see count_within
  }

 private:
  /// Empty it; its memory stays.
  void clear() { size = inside = 0; }

  /// Add stored points [begin, end).
  void append(const Grid<S>& grid, std::size_t begin, std::size_t end) {
    constexpr std::size_t kBlock = Grid<S>::kBlock;
    const std::size_t more = end - begin;
    if (size + more + kBlock + kLanes > x.size()) {
      const std::size_t room = 2 * (size + more) + 64;
      x.resize(room), y.resize(room), z.resize(room), at.resize(room);
    }
    for (std::size_t i = 0; i < more; i += kBlock) {  // runs are short: blocks are faster than copies of a length
      std::memcpy(x.data() + size + i, grid.x().data() + begin + i, kBlock * sizeof(S));
      std::memcpy(y.data() + size + i, grid.y().data() + begin + i, kBlock * sizeof(S));
      std::memcpy(z.data() + size + i, grid.z().data() + begin + i, kBlock * sizeof(S));
      for (std::size_t l = 0; l < kBlock; ++l) at[size + i + l] = static_cast<std::uint32_t>(begin + i + l);
    }
    size += more;
  }

  void pad() {
    for (std::size_t l = size; l < padded(); ++l) x[l] = std::numeric_limits<S>::infinity();
  }
};

/// make() a body a chunk, then body(cell, begin, end) for each occupied cell of the grid and its stored points
/// [begin, end), on up to `threads` threads. A body writes only what belongs to its own points.
template <typename S, typename Make>
void for_cells(const Grid<S>& grid, int threads, Make&& make) {
  // Some sixteen chunks a thread: the last ones to end are short.
  const std::size_t chunk =
      std::clamp<std::size_t>(grid.stored() / (16 * std::size_t(std::max(threads, 1))), 256, 2048);
  parallel_chunks(grid.stored(), threads, chunk, [&](std::size_t begin, std::size_t end) {
    auto body = make();
    grid.cells(begin, end, [&](const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) {
      throw_if_cancelled();  // a cell may be crowded
      body(cell, first, last);
    });
  });
}

}  // namespace agrisee
