// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The colors that fruit have in cloud files, pictures and the page of a scan.
#pragma once

#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::io {

using agrisee::Rgb;

/// The color of the fruit `id`, counted from 1; gray for 0 and below. There are ten colors that are easy to tell
/// apart; after them come darker and lighter versions of the same ten.
inline Rgb fruit_color(int id) {
  static constexpr Rgb kPalette[] = {{226, 61, 50},  {42, 127, 204}, {245, 166, 35}, {46, 160, 84}, {142, 84, 190},
                                     {23, 178, 188}, {226, 93, 160}, {150, 176, 36}, {155, 96, 62}, {92, 104, 214}};
  if (id <= 0) return {160, 163, 166};
  const auto index = static_cast<std::size_t>(id - 1);
  Rgb color = kPalette[index % std::size(kPalette)];
  const std::size_t round = index / std::size(kPalette);
  if (round == 0) return color;
  const bool darker = round % 2 == 1;
  const double share = 0.25 + 0.1 * static_cast<double>((round - 1) / 2 % 4);
  for (std::uint8_t& c : color) c = static_cast<std::uint8_t>(std::lround(c + share * ((darker ? 0 : 255) - c)));
  return color;
}

}  // namespace agrisee::io
