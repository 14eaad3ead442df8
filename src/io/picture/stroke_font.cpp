// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/stroke_font.hpp"

#include <algorithm>

namespace agrisee::io {
namespace {

// The strokes of the characters from blank on, separated by blanks. A point is a digit (x) and a letter (y: a is the
// top of capitals, d the top of small letters, k the baseline, n the lowest line). A stroke that begins with ~ is a
// smooth curve through its points.
constexpr const char* kGlyphs[] = {
    "",                                     // blank
    "1a1g 1j1k",                            // !
    "0a0c 2a2c",                            // "
    "2a1k 5a4k 0d6d 0h6h",                  // #
    "~5c3b1c1e4g5h4j2j0i 3a3k",             // $
    "5a0k ~1a0c1d2c1a ~4h3i4k5i4h",         // %
    "~6k2d2b3a4b4d0g0i1k3k6g",              // &
    "0a0c",                                 // '
    "~2a0d0i2l",                            // (
    "~0a2d2i0l",                            // )
    "2a2g 0b4f 4b0f",                       // *
    "3d3j 0g6g",                            // +
    "1j0m",                                 // ,
    "0g3g",                                 // -
    "0j0k",                                 // .
    "4a0l",                                 // /
    "~3a1b0d0h1j3k5j6h6d5b3a",              // 0
    "0c2a2k",                               // 1
    "~0d1b3a5b6d5f0k 0k6k",                 // 2
    "~0b2a4a5c4e2e ~2e5e6h5j3k1k0j",        // 3
    "4k4a0h6h",                             // 4
    "5a1a0e ~0e2d4d6f6i4k2k0j",             // 5
    "~5a2b0e0h1j3k5j6h5f3e1f0h",            // 6
    "0a6a2k",                               // 7
    "~3a1b1d3e5f6h5j3k1j0h1f3e5d5b3a",      // 8
    "~1k4j6g6d5b3a1b0d1f3g5f6d",            // 9
    "0e0f 0j0k",                            // :
    "1e1f 1j0m",                            // ;
    "5d0g5j",                               // <
    "0e5e 0h5h",                            // =
    "0d5g0j",                               // >
    "~0c1a3a5c4e2h 2j2k",                   // ?
    "~4i2h2e4e5h6h6d4a1b0f1j3k5k",          // @
    "0k3a6k 1g5g",                          // A
    "0e0a3a ~3a5b5d3e 3e0e0k3k ~3e6f6j3k",  // B
    "~6c5b3a1b0d0h1j3k5j6i",                // C
    "0a0k2k ~2k5j6g6e5b2a 2a0a",            // D
    "5a0a0k5k 0e4e",                        // E
    "5a0a0k 0e4e",                          // F
    "~6c5b3a1b0d0h1j3k5j6h 6h6f4f",         // G
    "0a0k 6a6k 0e6e",                       // H
    "0a0k",                                 // I
    "4a4h ~4h3k1k0i",                       // J
    "0a0k 5a0g 2e6k",                       // K
    "0a0k5k",                               // L
    "0k0a3h6a6k",                           // M
    "0k0a6k6a",                             // N
    "~3a1b0d0h1j3k5j6h6d5b3a",              // O
    "0k0a3a ~3a5b5e3f 3f0f",                // P
    "~3a1b0d0h1j3k5j6h6d5b3a 4h6k",         // Q
    "0k0a3a ~3a5b5e3f 3f0f 3f6k",           // R
    "~6b4a2a0c1e5f6h5j3k1k0j",              // S
    "0a6a 3a3k",                            // T
    "0a0h ~0h1j3k5j6h 6h6a",                // U
    "0a3k6a",                               // V
    "0a2k4d6k8a",                           // W
    "0a6k 6a0k",                            // X
    "0a3f6a 3f3k",                          // Y
    "0a6a0k6k",                             // Z
    "2a0a0l2l",                             // [
    "0a4l",                                 // backslash
    "0a2a2l0l",                             // ]
    "0d2a4d",                               // ^
    "0l6l",                                 // _
    "0a1c",                                 // `
    "~5f3d1e0g0i1k3k5i 5d5k",               // a
    "0a0k ~0f2d4e5g5i4k2k0i",               // b
    "~5e3d1e0g0i1k3k5j",                    // c
    "5a5k ~5f3d1e0g0i1k3k5i",               // d
    "0g5g ~5g4e2d1e0g0i1k3k5j",             // e
    "~4a3a2c 2c2k 0d4d",                    // f
    "5d5l ~5l4n2n0m ~5f3d1e0g0i1k3k5i",     // g
    "0a0k ~0f2d4d5f 5f5k",                  // h
    "0d0k 0a0b",                            // i
    "2d2l ~2l1n0n 2a2b",                    // j
    "0a0k 4d0h 2g5k",                       // k
    "0a0k",                                 // l
    "0d0k ~0f2d3d4f 4f4k ~4f6d7d8f 8f8k",   // m
    "0d0k ~0f2d4d5f 5f5k",                  // n
    "~2d1e0g0i1k3k4k5i5g4e3d2d",            // o
    "0d0n ~0f2d4e5g5i4k2k0i",               // p
    "5d5n ~5f3d1e0g0i1k3k5i",               // q
    "0d0k ~0g1e3d4d",                       // r
    "~5e3d1d0f2g4h5i4k2k0j",                // s
    "2b2i ~2i3k4k 0d4d",                    // t
    "0d0i ~0i1k3k5i 5d5k",                  // u
    "0d2k4d",                               // v
    "0d2k4e6k8d",                           // w
    "0d5k 5d0k",                            // x
    "0d3k 5d3k1n",                          // y
    "0d5d0k5k",                             // z
    "~3a1c2f0g2h1j3l",                      // {
    "0a0l",                                 // |
    "~0a2c1f3g1h2j0l",                      // }
    "~0g2f4h6g",                            // ~
};
constexpr const char* kBox = "0b0k5k5b0b";

constexpr float kUnit = 0.1f;  // capitals are ten units high

/// Catmull-Rom curve through the points, closed where the last is the first.
Stroke smooth(const Stroke& points) {
  constexpr int kSteps = 6;
  const auto n = static_cast<int>(points.size());
  const bool closed = n > 3 && points.front() == points.back();
  const auto at = [&](int i) -> Eigen::Vector2f {
    if (closed) return points[static_cast<std::size_t>((i + n - 1) % (n - 1))];
    return points[static_cast<std::size_t>(std::clamp(i, 0, n - 1))];
  };
  Stroke out{points.front()};
  for (int i = 0; i + 1 < n; ++i) {
    const Eigen::Vector2f p0 = at(i - 1), p1 = at(i), p2 = at(i + 1), p3 = at(i + 2);
    for (int s = 1; s <= kSteps; ++s) {
      const float t = static_cast<float>(s) / kSteps;
      out.push_back(0.5f * (2.0f * p1 + (p2 - p0) * t + (2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3) * t * t +
                            (3.0f * p1 - p0 - 3.0f * p2 + p3) * t * t * t));
    }
  }
  return out;
}

}  // namespace

std::vector<Stroke> text_strokes(std::string_view text, float& advance) {
  std::vector<Stroke> strokes;
  advance = 0.0f;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // the rest of a UTF-8 character
    const char* at = c >= ' ' && c <= '~' ? kGlyphs[c - ' '] : kBox;
    float width = c == ' ' ? 1.6f : 0.0f;
    while (*at) {
      const bool curve = *at == '~';
      if (curve) ++at;
      Stroke stroke;
      for (; *at && *at != ' '; at += 2) {
        const auto x = static_cast<float>(at[0] - '0'), y = static_cast<float>(at[1] - 'k');
        width = std::max(width, x);
        stroke.emplace_back(advance + kUnit * x, kUnit * y);
      }
      strokes.push_back(curve ? smooth(stroke) : stroke);
      if (*at == ' ') ++at;
    }
    advance += kUnit * (width + 2.6f);
  }
  return strokes;
}

}  // namespace agrisee::io
