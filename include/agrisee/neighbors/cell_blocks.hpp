// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A table from the cells of an unbounded grid to values, for queries of boxes of cells. It suits points on surfaces:
/// cells that are near one another are stored together, so that a box of 3 x 3 x 3 cells takes three or four look-ups
/// instead of the 27 of a `CellTable`. Memory: about 280 bytes for each block of 4 x 4 x 4 cells with a value.
#pragma once

#include <agrisee/neighbors/hash_grid.hpp>

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

namespace agrisee {

/// Values of cells, in blocks of 4 x 4 x 4 cells.
class CellBlocks {
 public:
  /// Sets the value (>= 0) of a cell and returns the one that it replaces, or -1.
  Index exchange(const CellIndex& cell, Index value) {
    Block& block = block_of(cell.unaryExpr([](std::int32_t c) { return c >> kShift; }));
    const unsigned at = place(cell.x(), cell.y(), cell.z());
    Index& kept = block.values[at];
    const Index old = block.occupied >> at & 1 ? kept : -1;
    block.occupied |= std::uint64_t(1) << at;
    kept = value;
    return old;
  }

  /// Calls f(value) for every cell of a box that has a value, in any order.
  /// @param lo smallest coordinates of the box  @param hi largest; both belong to it
  template <typename F>
  void visit(const CellIndex& lo, const CellIndex& hi, F&& f) const {
    CellIndex c;  // of a block
    for (c.z() = lo.z() >> kShift; c.z() <= hi.z() >> kShift; ++c.z())
      for (c.y() = lo.y() >> kShift; c.y() <= hi.y() >> kShift; ++c.y())
        for (c.x() = lo.x() >> kShift; c.x() <= hi.x() >> kShift; ++c.x()) {
          const Index found = table_.find(c);
          if (found < 0) continue;
          const Block& block = blocks_[static_cast<std::size_t>(found)];
          std::uint64_t cells = block.occupied & inside(lo, hi, c);
          for (; cells != 0; cells &= cells - 1) f(block.values[zeros_below(cells)]);
        }
  }

 private:
  static constexpr int kShift = 2, kEdge = 1 << kShift;  // cells along an edge of a block

  struct Block {
    std::uint64_t occupied = 0;         // a bit for each cell that has a value
    std::array<Index, 64> values = {};  // of these, x fastest
  };

  /// The place of a cell in its block.
  static unsigned place(std::int32_t x, std::int32_t y, std::int32_t z) {
    constexpr std::int32_t kInBlock = kEdge - 1;
    return static_cast<unsigned>((z & kInBlock) * kEdge * kEdge + (y & kInBlock) * kEdge + (x & kInBlock));
  }

  /// A bit for each cell of block c that lies in a box.
  static std::uint64_t inside(const CellIndex& lo, const CellIndex& hi, const CellIndex& c) {
    std::uint64_t line[3];  // for each axis: the places in the block that lie in the box
    for (int a = 0; a < 3; ++a) {
      const int first = std::max(lo[a] - c[a] * kEdge, 0), last = std::min(hi[a] - c[a] * kEdge, kEdge - 1);
      line[a] = ((std::uint64_t(1) << (last + 1)) - 1) >> first << first;
    }
    std::uint64_t layer = 0, all = 0;
    for (int y = 0; y < kEdge; ++y)
      if (line[1] >> y & 1) layer |= line[0] << (kEdge * y);
    for (int z = 0; z < kEdge; ++z)
      if (line[2] >> z & 1) all |= layer << (kEdge * kEdge * z);
    return all;
  }

  /// Number of zero bits below the lowest bit that is set.
  static std::size_t zeros_below(std::uint64_t bits) { return std::bitset<64>(~bits & (bits - 1)).count(); }

  Block& block_of(const CellIndex& c) {
    Index found = table_.find(c);
    if (found < 0) {
      found = static_cast<Index>(blocks_.size());
      blocks_.emplace_back();
      table_.exchange(c, found);
    }
    return blocks_[static_cast<std::size_t>(found)];
  }

  CellTable table_;  // the number of each block
  std::vector<Block> blocks_;
};

}  // namespace agrisee
