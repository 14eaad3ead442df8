// SPDX-License-Identifier: BSD-3-Clause
// Boxes of cells show the values that were set last in them, whatever blocks they touch.
#include <agrisee/neighbors/cell_blocks.hpp>

#include <map>
#include <tuple>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("cell blocks show the cells of a box", "[cell_blocks]") {
  CellBlocks blocks;
  std::map<std::tuple<int, int, int>, Index> expected;
  Rng rng(3);
  const auto coordinate = [&] { return static_cast<std::int32_t>(rng.uniform(-11.0, 11.0)); };
  const auto box = [&](int half) {
    const CellIndex middle(coordinate(), coordinate(), coordinate());
    return std::pair<CellIndex, CellIndex>{middle.array() - half, middle.array() + half};
  };
  for (Index value = 0; value < 2000; ++value) {
    const CellIndex cell(coordinate(), coordinate(), coordinate());
    const auto [at, is_new] = expected.try_emplace({cell.x(), cell.y(), cell.z()}, -1);
    REQUIRE(blocks.exchange(cell, value) == at->second);
    at->second = value;
    if (value % 10 != 0) continue;
    const auto [lo, hi] = box(value % 4);
    Indices shown, inside;
    blocks.visit(lo, hi, [&](Index i) { shown.push_back(i); });
    for (const auto& [key, kept] : expected) {
      const auto [x, y, z] = key;
      const CellIndex c(x, y, z);
      if ((c.array() >= lo.array()).all() && (c.array() <= hi.array()).all()) inside.push_back(kept);
    }
    std::sort(shown.begin(), shown.end());
    std::sort(inside.begin(), inside.end());
    REQUIRE(shown == inside);
  }
}

TEST_CASE("cell blocks at the limits of coordinates", "[cell_blocks]") {
  CellBlocks blocks;
  const CellIndex far = CellIndex::Constant(CellTable::kLimit), one = CellIndex::Ones();
  REQUIRE(blocks.exchange(far, 1) == -1);
  REQUIRE(blocks.exchange(-far, 2) == -1);
  Indices shown;
  blocks.visit(far - one, far + one, [&](Index i) { shown.push_back(i); });
  blocks.visit(-far - one, -far + one, [&](Index i) { shown.push_back(i); });
  blocks.visit(-one, one, [&](Index i) { shown.push_back(i); });
  CHECK(shown == Indices{1, 2});
}
