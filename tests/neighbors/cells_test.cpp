// SPDX-License-Identifier: BSD-3-Clause
// Where the points of cells begin, in a table and hashed, equals a look at all cells.
#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/detail/sparse_cells.hpp>

#include <algorithm>
#include <set>

#include "catch.hpp"

using namespace agrisee;

namespace {

using detail::CellStarts;
using detail::SparseCells;
using Cell = detail::GridCell;

/// Occupied cells in a few rows, in clumps and alone, in ascending order; cell number i holds i % 4 + 1 points.
std::vector<Cell> some_cells(int length, int cells) {
  Rng rng(3);
  std::set<Cell> out;
  while (static_cast<int>(out.size()) < cells) {
    const auto below = [&](int n) { return static_cast<int>(rng.below(static_cast<std::uint64_t>(n))); };
    const Cell c{below(3), below(4), below(length)};
    for (int x = 0; x < (below(2) ? 1 : 40) && c[2] + x < length; ++x) out.insert({c[0], c[1], c[2] + x});
  }
  return {out.begin(), out.end()};
}

}  // namespace

TEST_CASE("runs of cells, hashed, in a table and counted one by one, are the same") {
  constexpr int kLength = 1100;
  const std::vector<Cell> cells = some_cells(kLength, 700);
  SparseCells sparse;
  CellStarts table;
  const auto key = [](const Cell& c) { return static_cast<std::size_t>((c[0] * 4 + c[1]) * kLength + c[2]); };
  table.reset(key({2, 3, kLength - 1}) + 1);
  std::vector<std::uint32_t> starts;
  std::uint32_t points = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sparse.append(cells[i], points);
    REQUIRE(table.mark(key(cells[i])));
    REQUIRE_FALSE(table.mark(key(cells[i])));
    starts.push_back(points);
    points += static_cast<std::uint32_t>(i % 4 + 1);
  }
  table.append(starts);
  sparse.finish(points);
  table.finish(points);
  starts.push_back(points);
  std::vector<std::size_t> keys, marked;
  for (const Cell& c : cells) keys.push_back(key(c));
  const std::size_t middle = 37u << CellStarts::kShift, all = key({2, 3, kLength - 1}) + 1;
  for (const auto& [first, last] : {std::make_pair(std::size_t(0), middle), std::make_pair(middle, all)})
    table.marked(first, last, [&](std::size_t cell) { marked.push_back(cell); });
  CHECK(marked == keys);
  Rng rng(4);
  for (int trial = 0; trial < 20000; ++trial) {
    const int z = trial % 3, y = trial / 3 % 4, x0 = static_cast<int>(rng.below(kLength));
    const int length = trial % 2 ? 4 : kLength;  // rows of one block or two, and of many
    const int x1 = std::min(kLength - 1, x0 + static_cast<int>(rng.below(static_cast<std::uint64_t>(length))));
    const auto first = std::lower_bound(cells.begin(), cells.end(), Cell{z, y, x0}) - cells.begin();
    const auto last = std::upper_bound(cells.begin(), cells.end(), Cell{z, y, x1}) - cells.begin();
    const std::size_t begin = starts[static_cast<std::size_t>(first)], end = starts[static_cast<std::size_t>(last)];
    REQUIRE(table[key({z, y, x0})] == begin);
    REQUIRE(table[key({z, y, x1}) + 1] == end);
    const auto [from, to] = sparse.run(x0, x1, y, z);
    INFO("row " << y << ", " << z << ", cells " << x0 << " to " << x1);
    if (begin == end)
      REQUIRE(from == to);
    else
      REQUIRE((from == begin && to == end));
  }
}

TEST_CASE("no cells hold no points") {
  SparseCells sparse;
  sparse.finish(0);
  const auto [from, to] = sparse.run(0, 1000000, 5, 7);
  CHECK(from == to);
}
