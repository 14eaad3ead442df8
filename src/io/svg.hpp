// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Plain plots as SVG text: grouped bars and lines. Light background, so that they read on dark pages too.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace agrisee::io::svg {

/// Colour-blind-safe colours (Okabe and Ito), `#rrggbb`; the eighth is the first again.
std::string color(std::size_t index);
/// The grey of what is compared with.
constexpr const char* kReference = "#9a9a9a";

/// Bars of one colour: a value a category, none where there is none.
struct Bars {
  std::string name, color;
  std::vector<std::optional<double>> values;
};
/// A panel of grouped bars.
struct BarPanel {
  std::string title;                    ///< what is shown, with its unit
  std::vector<std::string> categories;  ///< along x
  std::vector<Bars> series;
  std::optional<double> top;  ///< end of the y axis, which begins at 0; none = from the values
};
/// Panels below each other under one title; series of one name and colour share an entry of a panel's legend.
std::string bar_chart(const std::string& title, const std::vector<BarPanel>& panels);

/// A line through points (x, y).
struct Line {
  std::string name, color;
  std::vector<std::pair<double, double>> points;
};
/// Lines over axes that begin at 0; y ends at `top`.
std::string line_chart(const std::string& title, const std::string& x_title, const std::string& y_title, double top,
                       const std::vector<Line>& lines);

}  // namespace agrisee::io::svg
