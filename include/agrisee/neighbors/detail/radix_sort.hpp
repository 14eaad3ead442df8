// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sorts indices by integer keys in linear time: a radix sort from the least significant digit, 11 bits per pass.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/core/uninitialized.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace agrisee::detail {

/// An index and the key by which it is sorted (32 or 64 bits, unsigned).
template <typename Key>
struct Keyed {
  Key key;
  Index index;
};

/// Sorts by key; items with equal keys keep their order. O(n) per pass, one pass per 11 bits of the largest key.
/// @throws Cancelled
template <typename Key>
void radix_sort(Uninitialized<Keyed<Key>>& items) {
  constexpr unsigned kBits = 11;
  constexpr Key kMask = (1u << kBits) - 1;
  Key largest = 0;
  for (const auto& item : items) largest = std::max(largest, item.key);
  Uninitialized<Keyed<Key>> sorted(items.size());
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

}  // namespace agrisee::detail
