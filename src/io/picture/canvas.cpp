// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/canvas.hpp"

#include "io/picture/stroke_font.hpp"

namespace agrisee::io {

void Canvas::fill(int x0, int y0, int x1, int y1, const Color& top, const Color& bottom) {
  for (int y = std::max(y0, 0); y < std::min(y1, height_); ++y) {
    const Color c = mix(top, bottom, static_cast<float>(y - y0) / static_cast<float>(std::max(y1 - y0 - 1, 1)));
    for (int x = std::max(x0, 0); x < std::min(x1, width_); ++x) at(x, y) = c;
  }
}

void Canvas::disc(const Eigen::Vector2f& center, float radius, const Color& c, float alpha) {
  line(center, center, 2.0f * radius, c, alpha);
}

float Canvas::text(const Eigen::Vector2f& at, float size, std::string_view text, const Color& c, float weight) {
  float advance = 0.0f;
  for (const Stroke& stroke : text_strokes(text, advance)) {
    for (std::size_t i = 1; i < stroke.size(); ++i)
      line(at + size * stroke[i - 1], at + size * stroke[i], weight * size, c);
  }
  return at.x() + size * advance;
}

float Canvas::text_width(float size, std::string_view text) {
  float advance = 0.0f;
  text_strokes(text, advance);
  return size * std::max(advance - 0.26f, 0.0f);  // without the gap after the last letter
}

Image Canvas::image() const {
  Image out;
  out.width = width_;
  out.height = height_;
  out.pixels.resize(pixels_.size());
  static_assert(sizeof(Color) == 3 * sizeof(float) && sizeof(Rgb) == 3, "channels are packed");
  const auto* const from = reinterpret_cast<const float*>(pixels_.data());
  auto* const to = reinterpret_cast<std::uint8_t*>(out.pixels.data());
  const std::size_t channels = 3 * pixels_.size();
  for (std::size_t i = 0; i < channels; ++i) {
    const float level = 255.0f * from[i] + 0.5f;
    to[i] = static_cast<std::uint8_t>(static_cast<int>(level > 0.0f ? (level < 255.0f ? level : 255.0f) : 0.0f));
  }
  return out;
}

}  // namespace agrisee::io
