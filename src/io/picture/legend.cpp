// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/legend.hpp"

#include <agrisee/io/palette.hpp>

#include <algorithm>
#include <string>

namespace agrisee::io {
namespace {

/// The position of a fruit as the legend lists it, and its ripeness where that is known.
std::string legend_text(const Fruit& fruit) {
  if (!fruit.position().allFinite()) return "";
  std::string place;
  for (int a = 0; a < 3; ++a) place += (a ? ", " : "") + std::to_string(std::lround(1000.0 * fruit.position()[a]));
  place += " mm";
  if (!fruit.ripeness) return place;
  std::string grade = to_string(fruit.ripeness->grade);
  std::replace(grade.begin(), grade.end(), '_', ' ');
  return place + ", " + grade;
}

/// How the legend lists the fruit: in as many columns as have room, at most six, and in three rows.
struct LegendGrid {
  std::size_t columns = 6, rows = 0;
  float number = 0.0f;  ///< width of the widest id
};

LegendGrid legend_grid(const std::vector<Fruit>& fruits, float width, float size) {
  LegendGrid grid;
  float text = 0.0f;
  for (const Fruit& fruit : fruits) {
    grid.number = std::max(grid.number, Canvas::text_width(0.8f * size, std::to_string(fruit.id)));
    text = std::max(text, Canvas::text_width(0.8f * size, legend_text(fruit)));
  }
  const float entry = 1.8f * size + std::max(grid.number + 0.6f * size, 1.3f * size) + text + 1.5f * size;
  const auto fit = static_cast<std::size_t>(std::max((width - 4.0f * size) / entry, 1.0f));
  grid.columns = std::min<std::size_t>(fit, 6);
  grid.rows = std::min<std::size_t>((fruits.size() + grid.columns - 1) / grid.columns, 3);
  return grid;
}

}  // namespace

std::size_t legend_rows(const std::vector<Fruit>& fruits, float width, float size) {
  return legend_grid(fruits, width, size).rows;
}

void draw_legend(Canvas& canvas, const std::vector<Fruit>& fruits, int top, float size) {
  const auto w = static_cast<float>(canvas.width());
  const LegendGrid grid = legend_grid(fruits, w, size);
  const std::size_t most = grid.columns * grid.rows;
  const float left = 2.0f * size, column = (w - 2.0f * left) / static_cast<float>(grid.columns), row = 2.15f * size;
  for (std::size_t i = 0; i < fruits.size(); ++i) {
    const Eigen::Vector2f at(left + column * static_cast<float>(i % grid.columns),
                             static_cast<float>(top) + row * (0.95f + static_cast<float>(i / grid.columns)));
    if (i + 1 == most && fruits.size() > most) {
      canvas.text(at + Eigen::Vector2f(0.0f, 0.4f * size), 0.8f * size,
                  "and " + std::to_string(fruits.size() - i) + " more", kFaint);
      return;
    }
    const Fruit& fruit = fruits[i];
    canvas.disc(at + Eigen::Vector2f(0.6f * size, 0.0f), 0.62f * size, color(fruit_color(fruit.id)));
    const Eigen::Vector2f text = at + Eigen::Vector2f(1.8f * size, 0.4f * size);
    canvas.text(text, 0.8f * size, std::to_string(fruit.id), kInk, 0.16f);
    canvas.text({text.x() + std::max(grid.number + 0.6f * size, 1.3f * size), text.y()}, 0.8f * size,
                legend_text(fruit), kFaint);
  }
}

}  // namespace agrisee::io
