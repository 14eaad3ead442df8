// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small operations on labels: one number per point, 1 and up for an instance, 0 for none. Cost: linear in the points.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>

namespace agrisee {

/// Indices of the points of each label, ascending. Element 0 holds the points of label 1, and so on up to the largest
/// label.
inline std::vector<Indices> indices_by_label(const Labels& labels) {
  std::vector<Indices> out;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] <= 0) continue;
    const auto l = static_cast<std::size_t>(labels[i]);
    if (out.size() < l) out.resize(l);
    out[l - 1].push_back(static_cast<Index>(i));
  }
  return out;
}

/// Indices of the points without a label (0), ascending. After region growing this is the set U of [1], 2.2.4, to which
/// DBSCAN is applied.
inline Indices residual(const Labels& labels) {
  Indices out;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == 0) out.push_back(static_cast<Index>(i));
  return out;
}

/// Set the labels that fewer than `min_size` points have to 0, and number the others anew from 1 in their old order.
/// @param labels none is negative
/// @param min_size least number of points of a label that stays
/// @return the largest label left
inline int drop_small(Labels& labels, int min_size) {
  const int largest = labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end());
  std::vector<int> sizes(static_cast<std::size_t>(largest) + 1, 0);
  for (const int label : labels) ++sizes[static_cast<std::size_t>(label)];
  std::vector<int> renumbered(sizes.size(), 0);
  int kept = 0;
  for (std::size_t label = 1; label < sizes.size(); ++label)
    if (sizes[label] >= min_size) renumbered[label] = ++kept;
  for (int& label : labels) label = renumbered[static_cast<std::size_t>(label)];
  return kept;
}

}  // namespace agrisee
