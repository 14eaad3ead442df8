// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Draws plots as SVG text: grouped bars and lines. They have a light background, so that they are readable on dark
/// pages, too.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace agrisee::report::svg {

/// One of seven colors that color-blind readers can tell apart (Okabe and Ito), as `#rrggbb`; from 7 on they repeat.
std::string color(std::size_t index);
/// The gray of the reference values.
constexpr const char* kReference = "#9a9a9a";

/// A series of bars: one value per category, none where there is no value.
struct Bars {
  std::string name, color;
  std::vector<std::optional<double>> values;
};
/// A panel of grouped bars.
struct BarPanel {
  std::string title;                    ///< what is shown, with its unit
  std::vector<std::string> categories;  ///< labels along x
  std::vector<Bars> series;
  std::optional<double> top;  ///< end of the y axis, which begins at 0; none to choose it by the values
};
/// Draw panels below each other under a common title.
std::string bar_chart(const std::string& title, const std::vector<BarPanel>& panels);

/// A line through points (x, y).
struct Line {
  std::string name, color;
  std::vector<std::pair<double, double>> points;
};
/// Draw lines over axes that begin at 0; the y axis ends at `top`.
std::string line_chart(const std::string& title, const std::string& x_title, const std::string& y_title, double top,
                       const std::vector<Line>& lines);

}  // namespace agrisee::report::svg
