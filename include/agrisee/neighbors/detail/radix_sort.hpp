// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sorts by integer keys in linear time: a radix sort from the least significant digit, 11 bits per pass.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/core/uninitialized.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

namespace agrisee::detail {

/// An index and the key by which it is sorted (32 or 64 bits, unsigned).
template <typename Key>
struct Keyed {
  Key key;
  Index index;
};

/// Sorts items by an unsigned integer key of theirs; items with equal keys keep their order. O(n) per pass, one pass
/// per 11 bits of the largest key.
/// @param key_of key_of(item) is the key
/// @throws Cancelled
template <typename Item, typename KeyOf>
void radix_sort(Uninitialized<Item>& items, KeyOf&& key_of) {
  using Key = std::decay_t<decltype(key_of(items[0]))>;
  constexpr unsigned kBits = 11;
  constexpr Key kMask = (1u << kBits) - 1;
  Key largest = 0;
  for (const Item& item : items) largest = std::max(largest, key_of(item));
  Uninitialized<Item> sorted(items.size());
  std::array<std::size_t, kMask + 1> starts;
  for (unsigned shift = 0; shift < 8 * sizeof(Key) && largest >> shift != 0; shift += kBits) {
    throw_if_cancelled();
    starts.fill(0);
    for (const Item& item : items) ++starts[key_of(item) >> shift & kMask];
    std::size_t sum = 0;
    for (std::size_t& start : starts) {
      const std::size_t n = start;
      start = sum;
      sum += n;
    }
    for (const Item& item : items) sorted[starts[key_of(item) >> shift & kMask]++] = item;
    items.swap(sorted);
  }
}

/// Sorts indices by their keys.
template <typename Key>
void radix_sort(Uninitialized<Keyed<Key>>& items) {
  radix_sort(items, [](const Keyed<Key>& item) { return item.key; });
}

}  // namespace agrisee::detail
