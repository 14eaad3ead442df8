// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_sheet.hpp"

#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::study {

double leaf_half_width(int i, int rows, double width, double tooth) {
  const double t = static_cast<double>(i) / rows;
  const double outline = std::pow(std::sin(kPi * std::pow(t, 0.75)), 0.8);
  return 0.5 * width * (outline * (i % 3 == 2 ? tooth : 1.0) + 0.02);
}

void connect_rows(Mesh& mesh, std::uint32_t rows, std::uint32_t columns) {
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t a = i * columns + j, b = a + columns;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
}

}  // namespace agrisee::study
