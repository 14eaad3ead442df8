// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds which numbers of an array are at most a limit. Compilers do not vectorise this loop of the neighbor searches,
/// so there is a version with SSE2 instructions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace agrisee::detail {

/// Writes the indices i with values[i] <= limit to `out`, ascending.
/// @param values n numbers
/// @param n a multiple of four
/// @param limit the largest value to find
/// @param out room for n indices
/// @return number of indices written
template <typename S>
std::size_t indices_within(const S* values, std::size_t n, S limit, std::uint32_t* out) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < n; ++i) {  // without a branch, which would often be mispredicted
    out[found] = static_cast<std::uint32_t>(i);
    found += values[i] <= limit ? 1u : 0u;
  }
  return found;
}

#ifdef __SSE2__
/// The version for floats: compares four at a time and looks up in a table which of the four passed.
inline std::size_t indices_within(const float* values, std::size_t n, float limit, std::uint32_t* out) {
  struct Pattern {
    alignas(16) std::array<std::uint32_t, 4> lanes{};
    std::uint32_t count = 0;
  };
  static constexpr auto kPatterns = [] {
    std::array<Pattern, 16> patterns{};
    for (std::uint32_t p = 0; p < 16; ++p)
      for (std::uint32_t lane = 0; lane < 4; ++lane)
        if (p >> lane & 1u) patterns[p].lanes[patterns[p].count++] = lane;
    return patterns;
  }();
  const __m128 most = _mm_set1_ps(limit);
  std::size_t found = 0;
  for (std::size_t i = 0; i < n; i += 4) {
    const __m128 within = _mm_cmple_ps(_mm_loadu_ps(values + i), most);
    const Pattern& pattern = kPatterns[static_cast<std::size_t>(_mm_movemask_ps(within))];
    const __m128i lanes = _mm_load_si128(reinterpret_cast<const __m128i*>(pattern.lanes.data()));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + found),
                     _mm_add_epi32(lanes, _mm_set1_epi32(static_cast<int>(i))));
    found += pattern.count;
  }
  return found;
}
#endif

}  // namespace agrisee::detail
