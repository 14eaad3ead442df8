// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which cells of a grid lie near a cell: rows along x, each with the cells that must be looked into and those that are
/// near as a whole. Lengths in cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace agrisee {

/// One row of cells about a cell: the cells x - outer .. x + outer at y + dy, z + dz; of these x - inner .. x + inner
/// lie wholly within reach, none where `inner` is negative.
struct StencilRow {
  int dy;     ///< cells along y
  int dz;     ///< cells along z
  int outer;  ///< cells along x, either way
  int inner;  ///< of which so many lie wholly within reach; negative: none
};

/// The cells about a cell, row by row.
using Stencil = std::vector<StencilRow>;

/// All cells at most `rings` away on every axis, none taken to be inside. 2 rings: 25 rows.
inline Stencil box_stencil(int rings) {
  Stencil out;
  for (int dz = -rings; dz <= rings; ++dz)
    for (int dy = -rings; dy <= rings; ++dy) out.push_back({dy, dz, rings, -1});
  return out;
}

/// The cells that hold points within `reach` of some point of a cell, and those that hold no others. Both with a margin
/// of 1e-5 cells, for coordinates that are rounded.
inline Stencil ball_stencil(double reach) {
  Stencil out;
  const double far = reach + 1e-5, near = reach - 1e-5;
  const int rings = static_cast<int>(std::ceil(far));
  for (int dz = -rings; dz <= rings; ++dz)
    for (int dy = -rings; dy <= rings; ++dy) {
      const auto sq = [](int d) { return static_cast<double>(d) * static_cast<double>(d); };
      const double gap_sq = sq(std::max(std::abs(dy) - 1, 0)) + sq(std::max(std::abs(dz) - 1, 0));
      const double span_sq = sq(std::abs(dy) + 1) + sq(std::abs(dz) + 1);
      if (gap_sq > far * far) continue;
      StencilRow row{dy, dz, -1, -1};
      while (gap_sq + sq(std::max(row.outer, 0)) <= far * far) ++row.outer;  // cell d begins d - 1 cells away
      if (near > 0.0)
        while (span_sq + sq(row.inner + 2) <= near * near) ++row.inner;  // and ends d + 1 away
      out.push_back(row);
    }
  return out;
}

}  // namespace agrisee
