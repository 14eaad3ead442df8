// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The canvas of the renderer, with antialiased lines and text.
#pragma once

#include <agrisee/io/png.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace agrisee::io {

/// Red, green, blue, 0..1.
using Color = Eigen::Vector3f;

inline Color color(const Rgb& rgb) { return Color(rgb[0], rgb[1], rgb[2]) / 255.0f; }
inline Color mix(const Color& a, const Color& b, float share) { return a + share * (b - a); }

/// Colors of texts.
inline const Color kInk(0.13f, 0.16f, 0.20f), kFaint(0.45f, 0.49f, 0.54f);

/// Shape of the ends of a line.
enum class Cap { round, butt };

/// An image to draw on. Coordinates and sizes are in pixels, x to the right and y down.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), Color::Ones()) {}

  int width() const { return width_; }
  int height() const { return height_; }
  Color& at(int x, int y) {
    return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }
  /// Mix a color into a pixel; pixels outside of the canvas are ignored.
  void blend(int x, int y, const Color& c, float alpha) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_ || alpha <= 0.0f) return;
    Color& p = at(x, y);
    p += std::min(alpha, 1.0f) * (c - p);
  }

  /// Fill the rectangle [x0, x1) x [y0, y1) with a vertical gradient from `top` to `bottom`.
  void fill(int x0, int y0, int x1, int y1, const Color& top, const Color& bottom);
  void disc(const Eigen::Vector2f& center, float radius, const Color& c, float alpha = 1.0f);
  /// Draw a text whose baseline begins at `at`. @param size height of capitals  @return x at which the next letter
  /// would begin
  float text(const Eigen::Vector2f& at, float size, std::string_view text, const Color& c, float weight = 0.125f);
  /// Width of a text.
  static float text_width(float size, std::string_view text);

  void line(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float line_width, const Color& c, float alpha = 1.0f,
            Cap cap = Cap::round) {
    line(a, b, line_width, c, cap, [alpha](float, int, int) { return alpha; });
  }
  /// Draw a line whose opacity is alpha(t, x, y): t is 0 at a and 1 at b, and x, y is the pixel.
  template <typename Alpha>
  void line(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float line_width, const Color& c, Cap cap,
            Alpha&& alpha);

  /// The image, in colors of eight bits a channel.
  Image image() const;

 private:
  int width_, height_;
  std::vector<Color> pixels_;
};

template <typename Alpha>
void Canvas::line(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float line_width, const Color& c, Cap cap,
                  Alpha&& alpha) {
  const Eigen::Vector2f d = b - a;
  const float length_sq = d.squaredNorm(), half = 0.5f * line_width;
  if (!std::isfinite(length_sq) || !a.allFinite() || !std::isfinite(half)) return;
  // Step along the axis in which the line is longer, and visit a few pixels across it at each step.
  const int along = std::abs(d.x()) >= std::abs(d.y()) ? 0 : 1, across = 1 - along;
  const float limit = static_cast<float>(along == 0 ? width_ : height_);
  const float slope = d[along] == 0.0f ? 0.0f : d[across] / d[along];
  const float reach = half + 1.0f;
  const float thickness = reach * std::sqrt(1.0f + slope * slope);
  const float from = std::clamp(std::min(a[along], b[along]) - reach, -1.0f, limit);
  const float to = std::clamp(std::max(a[along], b[along]) + reach, -1.0f, limit);
  for (int i = static_cast<int>(std::floor(from)); i <= static_cast<int>(to); ++i) {
    const float middle = a[across] + slope * (static_cast<float>(i) - a[along]);
    if (std::abs(middle) > 1e6f) continue;
    for (int j = static_cast<int>(std::floor(middle - thickness)); j <= static_cast<int>(middle + thickness + 1.0f);
         ++j) {
      Eigen::Vector2f p;
      p[along] = static_cast<float>(i);
      p[across] = static_cast<float>(j);
      float t = length_sq > 0.0f ? (p - a).dot(d) / length_sq : 0.0f;
      if (cap == Cap::butt && !(t >= 0.0f && t < 1.0f)) continue;
      t = std::clamp(t, 0.0f, 1.0f);
      const float coverage = std::clamp(half + 0.5f - (p - a - t * d).norm(), 0.0f, 1.0f);
      if (coverage <= 0.0f) continue;
      const int x = along == 0 ? i : j, y = along == 0 ? j : i;
      if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
      blend(x, y, c, coverage * alpha(t, x, y));
    }
  }
}

}  // namespace agrisee::io
