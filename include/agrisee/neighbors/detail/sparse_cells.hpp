// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the points of each grid cell begin, for boxes that have far more cells than points, such as one around a plant
/// and the wall behind it. Only blocks of cells that hold points have an entry; entries are found by hashing.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/detail/cell_lattice.hpp>
#include <agrisee/neighbors/detail/cell_starts.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// The occupied cells of a grid. Append them in ascending order, then call finish.
class SparseCells {
 public:
  /// Adds the next occupied cell, whose points begin at `start`.
  void append(const GridCell& cell, std::uint32_t start) {
    const GridCell name{cell[0], cell[1], cell[2] >> kShift};
    if (names_.empty() || names_.back() != name) {
      names_.push_back(name);
      blocks_.push_back({0, static_cast<std::uint32_t>(starts_.size())});
    }
    blocks_.back().occupied |= CellBlock::bit(static_cast<std::size_t>(cell[2]));
    starts_.push_back(start);
  }
  /// Completes the table after all cells have been appended.
  /// @param points total number of points
  void finish(std::size_t points) {
    starts_.push_back(static_cast<std::uint32_t>(points));
    std::size_t slots = 16;
    while (slots < 2 * names_.size()) slots *= 2;
    slots_.assign(slots, kNone);
    for (std::size_t b = 0; b < names_.size(); ++b) {
      std::size_t s = hash(names_[b]) & (slots - 1);
      while (slots_[s] != kNone) s = (s + 1) & (slots - 1);
      slots_[s] = static_cast<std::uint32_t>(b);
    }
  }

  /// Number of blocks that hold points.
  std::size_t blocks() const { return names_.size(); }

  /// The points [begin, end) of the cells x0 to x1 >= x0 of a row; begin = end if these cells are empty.
  std::pair<std::size_t, std::size_t> run(int x0, int x1, int y, int z) const {
    const auto first = static_cast<std::size_t>(x0), last = static_cast<std::size_t>(x1);
    const int b0 = x0 >> kShift, b1 = x1 >> kShift;
    std::size_t from = names_.size(), to = 0;  // first and last block found
    if (b1 - b0 < 8) {
      for (int b = b0; b <= b1; ++b) {
        const std::size_t found = find({z, y, b});
        if (found == names_.size()) continue;
        from = std::min(from, found);
        to = found;
      }
    } else {
      const auto begin = std::lower_bound(names_.begin(), names_.end(), GridCell{z, y, b0});
      const auto end = std::upper_bound(begin, names_.end(), GridCell{z, y, b1});
      if (begin != end) {
        from = static_cast<std::size_t>(begin - names_.begin());
        to = static_cast<std::size_t>(end - names_.begin()) - 1;
      }
    }
    if (from == names_.size()) return {0, 0};
    const std::size_t begin = names_[from][2] == b0 ? blocks_[from].rank(first) : blocks_[from].before;
    const bool whole = names_[to][2] != b1 || ((last + 1) & ((1u << kShift) - 1)) == 0;
    const std::size_t end = whole ? blocks_[to].end() : blocks_[to].rank(last + 1);
    return {starts_[begin], starts_[end]};
  }

 private:
  static constexpr unsigned kShift = CellBlock::kShift;
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  static std::size_t hash(const GridCell& name) {
    const auto part = [&](std::size_t i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(name[i])); };
    return static_cast<std::size_t>(mix(mix(part(0) << 32 | part(1)) ^ part(2)));
  }
  /// Position of the block with this name; the number of blocks if there is none.
  std::size_t find(const GridCell& name) const {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t s = hash(name) & mask; slots_[s] != kNone; s = (s + 1) & mask)
      if (names_[slots_[s]] == name) return slots_[s];
    return names_.size();
  }

  std::vector<GridCell> names_;        // z, y, x / 2^kShift of the blocks that hold points, ascending
  std::vector<CellBlock> blocks_;      // in the order of names_
  std::vector<std::uint32_t> starts_;  // of the occupied cells, then the number of points
  std::vector<std::uint32_t> slots_;   // hash table of positions in blocks_: linear probing, at most half full
};

}  // namespace agrisee::detail
