// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Median of a list of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace agrisee {

/// The value that would stand at position size / 2 if the values were sorted; 0 if there are none. For an even number
/// of values this is the upper of the two in the middle. Reorders the values, none of which may be NaN. O(n).
template <typename T>
T median(std::vector<T>& values) {
  if (values.empty()) return T(0);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace agrisee
