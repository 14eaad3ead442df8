// SPDX-License-Identifier: BSD-3-Clause
#include "report/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/formats/text.hpp"

namespace agrisee::report::svg {
namespace {

constexpr double kLeft = 64.0, kRight = 24.0, kPlotHeight = 210.0;
constexpr const char* kInk = "#222222";
constexpr const char* kSoft = "#555555";
constexpr const char* kGrid = "#dddddd";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  return out;
}

std::string number(double x) { return io::format(std::round(x * 100.0) / 100.0); }

/// An upper estimate of the width of a text (pixels).
double width_of(const std::string& text, double size) {
  double n = 0.0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return 0.58 * size * n;
}

/// A text for a tick of an axis. Of a long text only the end is shown, because names mostly differ there.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 18;
  if (text.size() <= kMost) return text;
  std::size_t from = text.size() - kMost + 1;
  while (from < text.size() && (static_cast<unsigned char>(text[from]) & 0xC0) == 0x80) ++from;
  return "…" + text.substr(from);
}

/// Collects the elements of a drawing.
class Drawing {
 public:
  void rect(double x, double y, double w, double h, const std::string& fill) {
    body_ += "<rect x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(w) + "\" height=\"" + number(h) +
             "\" fill=\"" + fill + "\"/>\n";
  }
  void line(double x1, double y1, double x2, double y2, const char* stroke, double width = 1.0) {
    body_ += "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
             "\" stroke=\"" + stroke + "\" stroke-width=\"" + number(width) + "\"/>\n";
  }
  /// Add a text. @param anchor start, middle or end  @param turn rotation about the anchor (degrees)
  void text(double x, double y, double size, const char* anchor, const std::string& says, const char* fill = kInk,
            double turn = 0.0, bool bold = false) {
    body_ += "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" font-size=\"" + number(size) + "\" text-anchor=\"" +
             anchor + "\" fill=\"" + fill + "\"";
    if (bold) body_ += " font-weight=\"600\"";
    if (turn != 0.0) body_ += " transform=\"rotate(" + number(turn) + " " + number(x) + " " + number(y) + ")\"";
    body_ += ">" + escaped(says) + "</text>\n";
  }
  void raw(const std::string& element) { body_ += element; }
  std::string finish(const std::string& title, double width, double height) const {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(width) + "\" height=\"" + number(height) +
           "\" viewBox=\"0 0 " + number(width) + " " + number(height) +
           "\" role=\"img\" font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\">\n<title>" +
           escaped(title) + "</title>\n<rect width=\"100%\" height=\"100%\" rx=\"6\" fill=\"#fbfbfa\"/>\n" + body_ +
           "</svg>\n";
  }

 private:
  std::string body_;
};

/// The distance of ticks, 1, 2 or 5 times a power of ten, that divides [0, top] into at most about `count` steps.
double tick_step(double top, int count) {
  const double raw = top / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

/// Draw a y axis from 0, at y0 + height, to `top`, at y0, with horizontal grid lines and labels.
void y_axis(Drawing& d, double x0, double x1, double y0, double height, double top) {
  const double step = tick_step(top, 5);
  for (int i = 0; i * step <= top * (1.0 + 1e-9); ++i) {
    const double y = y0 + height * (1.0 - i * step / top);
    d.line(x0, y, x1, y, i == 0 ? kInk : kGrid);
    d.text(x0 - 8, y + 4, 12, "end", number(i * step), kSoft);
  }
}

/// Draw a legend from (x0, y) on, wrapped before x1. @return its height
double legend(Drawing& d, double x0, double x1, double y,
              const std::vector<std::pair<std::string, std::string>>& entries) {
  double x = x0, used = 20.0;
  for (const auto& [name, fill] : entries) {
    const double width = 18.0 + width_of(name, 12) + 18.0;
    if (x > x0 && x + width > x1) x = x0, y += 20.0, used += 20.0;
    d.rect(x, y - 10, 12, 12, fill);
    d.text(x + 18, y, 12, "start", name);
    x += width;
  }
  return used;
}

/// Draw a panel from y on. @return its height
double draw_panel(Drawing& d, const BarPanel& panel, double width, double y) {
  const double begin = y, x0 = kLeft, x1 = width - kRight;
  d.text(x0, y + 14, 14, "start", panel.title, kInk, 0.0, true);
  y += 38.0;
  std::vector<std::pair<std::string, std::string>> entries;
  for (const Bars& s : panel.series) entries.emplace_back(s.name, s.color);
  y += legend(d, x0, x1, y, entries) + 2.0;
  double top = panel.top.value_or(0.0);
  if (!panel.top) {
    for (const Bars& s : panel.series)
      for (const auto& v : s.values)
        if (v && std::isfinite(*v)) top = std::max(top, *v);
    if (!(top > 0.0)) top = 1.0;
    const double step = tick_step(top, 5);
    top = step * std::ceil(top / step * (1.0 - 1e-9));
  }
  y_axis(d, x0, x1, y, kPlotHeight, top);
  const double slot = (x1 - x0) / static_cast<double>(std::max<std::size_t>(1, panel.categories.size()));
  const double bar = std::min(36.0, 0.78 * slot / static_cast<double>(std::max<std::size_t>(1, panel.series.size())));
  const double bottom = y + kPlotHeight;
  double widest = 0.0;
  for (const std::string& c : panel.categories) widest = std::max(widest, width_of(shortened(c), 12));
  const bool turned = widest > slot - 4.0;
  for (std::size_t i = 0; i < panel.categories.size(); ++i) {
    const double middle = x0 + (static_cast<double>(i) + 0.5) * slot;
    double x = middle - 0.5 * bar * static_cast<double>(panel.series.size());
    for (const Bars& s : panel.series) {
      const auto value = i < s.values.size() ? s.values[i] : std::nullopt;
      if (value && std::isfinite(*value)) {
        const double h = std::max(1.5, kPlotHeight * std::clamp(*value / top, 0.0, 1.0));
        d.rect(x + 0.5, bottom - h, bar - 1.0, h, s.color);
      } else {
        d.text(x + 0.5 * bar, bottom - 4, 11, "middle", "–", kSoft);
      }
      x += bar;
    }
    if (turned)
      d.text(middle + 4, bottom + 16, 12, "end", shortened(panel.categories[i]), kInk, -45.0);
    else
      d.text(middle, bottom + 18, 12, "middle", shortened(panel.categories[i]));
  }
  return bottom - begin + (turned ? 22.0 + 0.71 * widest : 30.0);
}

}  // namespace

std::string color(std::size_t index) {
  static constexpr std::array<const char*, 7> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#000000"};
  return kColors[index % kColors.size()];
}

std::string bar_chart(const std::string& title, const std::vector<BarPanel>& panels) {
  double width = 900.0;
  for (const BarPanel& p : panels) {
    const double slot = 14.0 + 8.0 * static_cast<double>(p.series.size());
    width = std::max(width, kLeft + kRight + slot * static_cast<double>(p.categories.size()));
  }
  Drawing d;
  d.text(kLeft, 32, 18, "start", title, kInk, 0.0, true);
  double y = 52.0;
  for (const BarPanel& panel : panels) y += draw_panel(d, panel, width, y) + 14.0;
  return d.finish(title, width, y);
}

std::string line_chart(const std::string& title, const std::string& x_title, const std::string& y_title, double top,
                       const std::vector<Line>& lines) {
  const double width = 900.0, height = 320.0, x0 = kLeft + 10.0, x1 = width - kRight;
  Drawing d;
  d.text(kLeft, 32, 18, "start", title, kInk, 0.0, true);
  std::vector<std::pair<std::string, std::string>> entries;
  double right = 1.0;
  for (const Line& line : lines) {
    entries.emplace_back(line.name, line.color);
    for (const auto& point : line.points) right = std::max(right, point.first);
  }
  const double y0 = 60.0 + legend(d, x0, x1, 60.0, entries) + 2.0, bottom = y0 + height;
  y_axis(d, x0, x1, y0, height, top);
  d.text(20, y0 + 0.5 * height, 12, "middle", y_title, kSoft, -90.0);
  const double step = std::max(1.0, tick_step(right, 12));
  const auto x_of = [&](double x) { return x0 + (x1 - x0) * x / (1.02 * right); };
  for (int i = 0; i * step <= right * (1.0 + 1e-9); ++i) {
    d.line(x_of(i * step), bottom, x_of(i * step), bottom + 5, kInk);
    d.text(x_of(i * step), bottom + 20, 12, "middle", number(i * step), kSoft);
  }
  d.text(0.5 * (x0 + x1), bottom + 42, 12, "middle", x_title, kSoft);
  for (const Line& line : lines) {
    std::string points;
    for (const auto& [x, y] : line.points)
      if (std::isfinite(x) && std::isfinite(y))
        points += number(x_of(x)) + "," + number(bottom - height * std::clamp(y / top, 0.0, 1.0)) + " ";
    if (points.empty()) continue;
    points.pop_back();
    d.raw("<polyline points=\"" + points + "\" fill=\"none\" stroke=\"" + line.color +
          "\" stroke-width=\"2.2\" stroke-linejoin=\"round\"/>\n");
    for (const auto& [x, y] : line.points)
      if (line.points.size() <= 25 && std::isfinite(x) && std::isfinite(y))
        d.raw("<circle cx=\"" + number(x_of(x)) + "\" cy=\"" + number(bottom - height * std::clamp(y / top, 0.0, 1.0)) +
              "\" r=\"3\" fill=\"" + line.color + "\"/>\n");
  }
  return d.finish(title, width, bottom + 58.0);
}

}  // namespace agrisee::report::svg
