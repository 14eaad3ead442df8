// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which cells of a grid lie near a given cell, as rows along x. Each row says which cells must be searched and which
/// of them are so near that all their points are within reach. Lengths are in cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace agrisee::detail {

/// One row of cells near the cell (x, y, z): the cells x - outer to x + outer at y + dy, z + dz. All points of the
/// cells x - inner to x + inner are within reach of all points of the cell; there are none of these if `inner` is
/// negative.
struct StencilRow {
  int dy;     ///< offset along y
  int dz;     ///< offset along z
  int outer;  ///< number of cells to search on either side along x
  int inner;  ///< number of cells on either side that lie wholly within reach; negative: none
};

/// The cells near a cell, row by row.
using Stencil = std::vector<StencilRow>;

/// All cells that are at most `rings` cells away along every axis; none is marked as wholly within reach.
inline Stencil box_stencil(int rings) {
  Stencil out;
  for (int dz = -rings; dz <= rings; ++dz)
    for (int dy = -rings; dy <= rings; ++dy) out.push_back({dy, dz, rings, -1});
  return out;
}

/// The cells that may hold points within `reach` (in cells) of some point of the cell, and those whose points all are.
/// Both with a margin of 1e-5 cells for rounded coordinates.
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
      // Along x, points of the cell d cells away are between d - 1 and d + 1 cells from those of the cell itself.
      while (gap_sq + sq(std::max(row.outer, 0)) <= far * far) ++row.outer;
      if (near > 0.0)
        while (span_sq + sq(row.inner + 2) <= near * near) ++row.inner;
      out.push_back(row);
    }
  return out;
}

}  // namespace agrisee::detail
