// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sorts points by cell in time linear in their number: least significant digits first, 11 bits a pass.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/core/uninitialized.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace agrisee {

/// An index and what it is sorted by, 32 or 64 bits.
template <typename Key>
struct Keyed {
  Key key;      ///< what is sorted by
  Index index;  ///< what is sorted
};

/// Sort by key; equal keys keep their order. Cost O(n) a pass, one pass for each 11 bits of the largest key.
/// @throws Cancelled
template <typename Key>
void radix_sort(detail::Uninitialized<Keyed<Key>>& items) {
  constexpr unsigned kBits = 11;
  constexpr Key kMask = (1u << kBits) - 1;
  Key largest = 0;
  for (const auto& item : items) largest = std::max(largest, item.key);
  detail::Uninitialized<Keyed<Key>> sorted(items.size());
  std::array<std::size_t, kMask + 1> starts;
  for (unsigned shift = 0; shift < 8 * sizeof(Key) && largest >> shift != 0; shift += kBits) {
    throw_if_cancelled();
    starts.fill(0);
    for (const auto& item : items) ++starts[item.key >> shift & kMask];
    std::size_t sum = 0;
    for (std::size_t& start : starts) {
      const std::size_t n = start;
      start = sum;
      sum += n;
    }
    for (const auto& item : items) sorted[starts[item.key >> shift & kMask]++] = item;
    items.swap(sorted);
  }
}

}  // namespace agrisee
