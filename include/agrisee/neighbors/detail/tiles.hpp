// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Processes the points of a grid cell by cell. The points near a cell, the candidates of all points in the cell, are
/// copied into one contiguous "tile" once per cell; compilers can then vectorise the loops over the candidates.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/neighbors/detail/grid_points.hpp>
#include <agrisee/neighbors/detail/indices_within.hpp>
#include <agrisee/neighbors/detail/stencil.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// The candidates near a cell, as a structure of arrays. Each thread needs its own.
template <typename S>
struct Tile {
  static constexpr std::size_t kLanes = 16;  ///< candidates per block

  std::vector<S> x;               ///< m; at least padded() long, infinite from `size` to padded()
  std::vector<S> y;               ///< m; as long as x, with arbitrary numbers after the last candidate
  std::vector<S> z;               ///< m; as y
  std::vector<std::uint32_t> at;  ///< position of each candidate among the stored points of the grid
  std::size_t size = 0;           ///< number of candidates
  std::size_t inside = 0;         ///< number of points left out because they are within reach of the whole cell

  /// Fills the tile with the points of the stencil's cells around the cell `c`.
  void gather(const GridPoints<S>& grid, const GridCell& c, const Stencil& stencil) {
    clear();
    for (const StencilRow& row : stencil) {
      const int cy = c[1] + row.dy, cz = c[0] + row.dz;
      const auto [begin, end] = grid.run(c[2] - row.outer, c[2] + row.outer, cy, cz);
      if (begin == end) continue;
      auto within = std::make_pair(end, end);
      if (row.inner >= 0) within = grid.run(c[2] - row.inner, c[2] + row.inner, cy, cz);
      if (within.first == within.second) {
        append(grid, begin, end);
      } else {
        append(grid, begin, within.first);
        append(grid, within.second, end);
        inside += within.second - within.first;
      }
    }
    pad();
  }

  /// The size rounded up to whole blocks. Loops over whole blocks have few different lengths, which helps the branch
  /// prediction.
  std::size_t padded() const { return (size + kLanes - 1) / kLanes * kLanes; }

  /// Writes the squared distances (m2) from q to the candidates, then infinity up to padded(), to `out`.
  void distances_sq(const Vector3<S>& q, S* out) const {
    const auto distance_sq = distance_sq_from(q, x.data(), y.data(), z.data());
    for (std::size_t j = 0; j < size; j += kLanes)
      for (std::size_t l = j; l < j + kLanes; ++l) out[l] = distance_sq(l);
  }

  /// Counts the candidates within a distance.
  /// @param sq sq(j) is the squared distance (m2) of candidate j, infinite from `size` to padded()
  /// @param limit_sq largest squared distance to count (m2)
  template <typename Sq>
  std::size_t count_within(const Sq& sq, S limit_sq) const {
    std::uint32_t in[kLanes] = {};
    for (std::size_t j = 0; j < size; j += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) in[l] += sq(j + l) <= limit_sq ? 1u : 0u;
    std::size_t sum = 0;
    for (const std::uint32_t n : in) sum += n;
    return std::min(sum, size);  // an infinite limit counts the padding as well
  }

  /// Writes the candidates j with distances_sq[j] <= limit_sq (m2) to `out`, ascending; `out` has room for padded().
  /// @return number of candidates written
  std::size_t list_within(const S* distances_sq, S limit_sq, std::uint32_t* out) const {
    return std::min(indices_within(distances_sq, padded(), limit_sq, out), size);  // see count_within
  }

 private:
  void clear() { size = inside = 0; }

  /// Appends the stored points [begin, end). Runs are short, and copying whole blocks is faster than copying the exact
  /// number; the surplus is overwritten later.
  void append(const GridPoints<S>& grid, std::size_t begin, std::size_t end) {
    constexpr std::size_t kBlock = GridPoints<S>::kBlock;
    const std::size_t more = end - begin;
    if (size + more + kBlock + kLanes > x.size()) {
      const std::size_t room = 2 * (size + more) + 64;
      x.resize(room), y.resize(room), z.resize(room), at.resize(room);
    }
    for (std::size_t i = 0; i < more; i += kBlock) {
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

/// Calls body(cell, begin, end) for each occupied cell of the grid and its stored points [begin, end), on up to
/// `threads` threads. Each chunk of cells has a body of its own, made by make(). A body may write only what belongs to
/// the points of its cells.
template <typename S, typename Make>
void for_cells(const GridPoints<S>& grid, int threads, Make&& make) {
  // About sixteen chunks per thread, so that no thread waits long for the last chunk of another.
  const std::size_t chunk =
      std::clamp<std::size_t>(grid.stored() / (16 * std::size_t(std::max(threads, 1))), 256, 2048);
  parallel_chunks(grid.stored(), threads, chunk, [&](std::size_t begin, std::size_t end) {
    auto body = make();
    grid.cells(begin, end, [&](const GridCell& cell, std::size_t first, std::size_t last) {
      throw_if_cancelled();  // per cell, since a cell may hold many points
      body(cell, first, last);
    });
  });
}

}  // namespace agrisee::detail
