// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A compact table of where the points of each grid cell begin. It takes two bits per cell and four bytes per occupied
/// cell: one bit says whether the cell is occupied, and one counter per block of cells holds the number of occupied
/// cells before the block, which gives the position of the cell's entry (a rank structure; Jacobson, FOCS 1989). For
/// points on a surface, a plain table of all cells would take tens of bytes per point and cause a cache miss per
/// access.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace agrisee::detail {

/// A block of consecutive cells: which of them are occupied, and how many occupied cells come before the block.
struct CellBlock {
  static constexpr unsigned kShift = 5;  ///< a block has 2^kShift cells

  std::uint32_t occupied = 0;  ///< one bit per cell
  std::uint32_t before = 0;    ///< number of occupied cells in the blocks before this one

  /// The bit of the cell with this key; the key >> kShift is the number of the block.
  static std::uint32_t bit(std::size_t key) { return std::uint32_t(1) << (key & ((1u << kShift) - 1)); }
  /// Number of occupied cells before the cell with this key, in this block and the blocks before.
  std::uint32_t rank(std::size_t key) const { return before + ones(occupied & (bit(key) - 1)); }
  /// Number of occupied cells before the next block.
  std::uint32_t end() const { return before + ones(occupied); }
  /// Position of the lowest bit that is set.
  static std::uint32_t lowest(std::uint32_t bits) { return ones((bits & (0u - bits)) - 1); }

 private:
  /// Number of bits that are set. Computed by hand, because the default targets of compilers have no popcount
  /// instruction.
  static std::uint32_t ones(std::uint32_t x) {
    x -= (x >> 1) & 0x55555555u;
    x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
    return (((x + (x >> 4)) & 0x0F0F0F0Fu) * 0x01010101u) >> 24;
  }
};

/// The first stored point of every cell, for cells that are numbered by keys from 0. It is built in these steps: reset,
/// mark, append, finish.
class CellStarts {
 public:
  /// The cells 2^kShift k to 2^kShift (k + 1) - 1 share a block. Threads may mark cells at the same time if each marks
  /// cells in blocks of its own.
  static constexpr unsigned kShift = CellBlock::kShift;

  /// Starts with `cells` empty cells.
  void reset(std::size_t cells) {
    blocks_.assign((cells >> kShift) + 1, {});
    starts_.clear();
  }
  /// Marks a cell as occupied.
  /// @return true if the cell was not marked before
  bool mark(std::size_t key) {
    std::uint32_t& occupied = blocks_[key >> kShift].occupied;
    const std::uint32_t before = occupied;
    return (occupied |= CellBlock::bit(key)) != before;
  }
  /// Calls f(key) for the marked cells of [first, last) in ascending order. `first` must be a multiple of 2^kShift;
  /// `last` must be one too, or the number of cells.
  template <typename F>
  void marked(std::size_t first, std::size_t last, F&& f) const {
    for (std::size_t b = first >> kShift; b << kShift < last; ++b)
      for (std::uint32_t rest = blocks_[b].occupied; rest != 0; rest &= rest - 1)
        f((b << kShift) + CellBlock::lowest(rest));
  }
  /// Appends where the points of the next occupied cells begin, in the order of the cells' keys.
  void append(const std::vector<std::uint32_t>& starts) { starts_.insert(starts_.end(), starts.begin(), starts.end()); }
  /// Completes the table after all cells have been marked and their starts appended.
  /// @param points total number of points
  void finish(std::size_t points) {
    starts_.push_back(static_cast<std::uint32_t>(points));
    std::uint32_t sum = 0;
    for (CellBlock& block : blocks_) {
      block.before = sum;
      sum = block.end();
    }
  }

  /// Where the points of a cell begin; for an empty cell, where those of the next occupied cell begin. The number of
  /// cells is a valid key, too, and gives the number of points.
  std::uint32_t operator[](std::size_t key) const { return starts_[blocks_[key >> kShift].rank(key)]; }

 private:
  std::vector<CellBlock> blocks_;
  std::vector<std::uint32_t> starts_;  // of the occupied cells, then the number of points
};

}  // namespace agrisee::detail
