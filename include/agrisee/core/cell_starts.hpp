// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the points of each cell of a box begin, in two bits a cell: a bit tells whether a cell is occupied, a count
/// per block how many occupied cells come before (rank; Jacobson, FOCS 1989), and only these have an entry. A table of
/// all cells is tens of bytes a point for a surface in space, and a cache miss a look.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace agrisee {

namespace detail {

/// Cells side by side: which are occupied, and how many occupied ones come before.
struct CellBlock {
  static constexpr unsigned kShift = 5;  ///< 2^kShift cells a block

  std::uint32_t occupied = 0;  ///< a bit a cell
  std::uint32_t before = 0;    ///< occupied cells in the blocks before

  /// The bit of the cell of that key, of which the block's number is all but the last kShift bits.
  static std::uint32_t bit(std::size_t key) { return std::uint32_t(1) << (key & ((1u << kShift) - 1)); }
  /// Occupied cells before the one of that key, of this block and the blocks before.
  std::uint32_t rank(std::size_t key) const { return before + ones(occupied & (bit(key) - 1)); }
  /// Occupied cells before the next block.
  std::uint32_t end() const { return before + ones(occupied); }
  /// The number of the lowest of some bits.
  static std::uint32_t lowest(std::uint32_t bits) { return ones((bits & (0u - bits)) - 1); }

 private:
  /// Bits that are set; processors without an instruction for it are the rule in what compilers target.
  static std::uint32_t ones(std::uint32_t x) {
    x -= (x >> 1) & 0x55555555u;
    x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
    return (((x + (x >> 4)) & 0x0F0F0F0Fu) * 0x01010101u) >> 24;
  }
};

}  // namespace detail

/// The first stored point of cells that are numbered by keys from 0. Fill it in this order: reset, mark, append,
/// finish.
class CellStarts {
 public:
  /// Cells 2^kShift k to 2^kShift (k + 1) - 1 share a block: threads that mark cells keep to blocks of their own.
  static constexpr unsigned kShift = detail::CellBlock::kShift;

  /// So many cells, all empty.
  void reset(std::size_t cells) {
    blocks_.assign((cells >> kShift) + 1, {});
    starts_.clear();
  }
  /// Cell `key` is occupied. @return whether that was not known
  bool mark(std::size_t key) {
    std::uint32_t& occupied = blocks_[key >> kShift].occupied;
    const std::uint32_t before = occupied;
    return (occupied |= detail::CellBlock::bit(key)) != before;
  }
  /// f(key) for the marked cells of [first, last), both multiples of 2^kShift or the number of cells, in ascending
  /// order.
  template <typename F>
  void marked(std::size_t first, std::size_t last, F&& f) const {
    for (std::size_t b = first >> kShift; b << kShift < last; ++b)
      for (std::uint32_t rest = blocks_[b].occupied; rest != 0; rest &= rest - 1)
        f((b << kShift) + detail::CellBlock::lowest(rest));
  }
  /// Where the points of occupied cells begin. May be called again and again, in the order of the cells' keys.
  void append(const std::vector<std::uint32_t>& starts) { starts_.insert(starts_.end(), starts.begin(), starts.end()); }
  /// All cells are marked and have their starts.
  /// @param points where the last cell's points end
  void finish(std::size_t points) {
    starts_.push_back(static_cast<std::uint32_t>(points));
    std::uint32_t sum = 0;
    for (detail::CellBlock& block : blocks_) {
      block.before = sum;
      sum = block.end();
    }
  }

  /// Where the points of cell `key` begin or, where there are none, those of the next occupied cell; the number of
  /// cells is a key, too.
  std::uint32_t operator[](std::size_t key) const { return starts_[blocks_[key >> kShift].rank(key)]; }

 private:
  std::vector<detail::CellBlock> blocks_;
  std::vector<std::uint32_t> starts_;  // of the occupied cells, and the end
};

}  // namespace agrisee
