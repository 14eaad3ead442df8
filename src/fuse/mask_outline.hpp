// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the pixels of one mask to the outline and the front of the body under it.
#pragma once

#include <agrisee/fuse/silhouette.hpp>

#include <cstddef>
#include <utility>
#include <vector>

#include "fuse/mask_image.hpp"

namespace agrisee::fuse {

/// The range of values, `length` long, that holds most of some items.
/// @param items in ascending order of value_of(item)
/// @return its first index and the one behind its last, the first of equals; both 0 without items
template <typename T, typename F>
std::pair<std::size_t, std::size_t> densest(const std::vector<T>& items, double length, F&& value_of) {
  std::size_t best = 0, best_end = 0;
  for (std::size_t first = 0, end = 0; first < items.size(); ++first) {
    while (end < items.size() && value_of(items[end]) <= value_of(items[first]) + length) ++end;
    if (end - first > best_end - best) best = first, best_end = end;
  }
  return {best, best_end};
}

/// A first guess of the body under a mask.
struct MaskGuess {
  Silhouette outline;
  Sphere sphere;
};

/// Guess the body under a mask; mask_evidence says how. Two bodies if the mask has the outline of two that touch.
/// @return empty if fewer than 12 of its pixels have a depth, or no outline of an expected size fits
std::vector<MaskGuess> guess_bodies(const MaskImage& image, std::uint16_t instance, const BodyParameters& bodies,
                                    const MaskParameters& parameters);

}  // namespace agrisee::fuse
