// SPDX-License-Identifier: BSD-3-Clause
// The stages as they are defined, by comparing all pairs of points, and nothing else.
#pragma once

#include <agrisee/see/density.hpp>

#include <algorithm>

#include "properties/laws.hpp"

namespace oracle {

using namespace agrisee;
using laws::Points;

/// Which points are near which: all pairs.
template <typename S>
std::vector<Indices> within(const Points<S>& cloud, S radius, bool strictly = false) {
  std::vector<Indices> out(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      if (!is_finite(cloud[i]) || !is_finite(cloud[j])) continue;
      const S d_sq = distance_sq<S>(cloud[i], cloud[j]);
      if (strictly ? d_sq < radius * radius : d_sq <= radius * radius) out[i].push_back(static_cast<Index>(j));
    }
  return out;
}

/// Parts of the graph that joins i with the points of `next(i)`: labels from 1 by the lowest index, 0 where `in(i)` is
/// false.
template <typename In, typename Next>
Labels parts(std::size_t n, const In& in, const Next& next) {
  Labels labels(n, 0);
  int count = 0;
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (!in(seed) || labels[seed]) continue;
    labels[seed] = ++count;
    std::vector<std::size_t> stack{seed};
    while (!stack.empty()) {
      const std::size_t i = stack.back();
      stack.pop_back();
      for (const Index j : next(i)) {
        const auto k = static_cast<std::size_t>(j);
        if (!in(k) || labels[k]) continue;
        labels[k] = count;
        stack.push_back(k);
      }
    }
  }
  return labels;
}

/// DBSCAN as defined: parts of the core points, and border points to the first part within reach.
template <typename S>
Labels dbscan(const Points<S>& cloud, double eps, std::size_t min_points) {
  const auto near = within(cloud, static_cast<S>(eps));
  const auto core = [&](std::size_t i) { return is_finite(cloud[i]) && near[i].size() >= min_points; };
  Labels labels = parts(cloud.size(), core, [&](std::size_t i) { return near[i]; });
  const Labels cores = labels;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const Index j : near[i]) {
      const int label = cores[static_cast<std::size_t>(j)];
      if (!core(i) && label > 0 && (labels[i] == 0 || label < labels[i])) labels[i] = label;
    }
  return labels;
}

/// Density and classes of points that come in one view, as see/density.hpp defines them: one after the other, twice.
template <typename S>
see::Classification classify(const Points<S>& cloud, double radius, std::size_t k) {
  using see::PointClass;
  const auto near = within(cloud, static_cast<S>(radius));
  see::Classification out;
  for (const auto& found : near) out.counts.push_back(static_cast<int>(found.size()));
  const auto core = [&](std::size_t i) { return !near[i].empty() && near[i].size() >= k; };
  out.classes.assign(cloud.size(), PointClass::outlier);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (core(i)) out.classes[i] = PointClass::core;
  const auto has = [&](std::size_t i, PointClass wanted, std::size_t end) {
    return std::any_of(near[i].begin(), near[i].end(), [&](Index j) {
      const auto other = static_cast<std::size_t>(j);
      return other != i && other < end && out.classes[other] == wanted;
    });
  };
  for (const bool first : {true, false})
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (near[i].empty() || core(i)) continue;
      const bool outlier_near =
          first ? has(i, PointClass::outlier, i)
                : out.classes[i] == PointClass::outlier || has(i, PointClass::outlier, cloud.size());
      out.classes[i] =
          outlier_near && has(i, PointClass::core, cloud.size()) ? PointClass::frontier : PointClass::outlier;
    }
  return out;
}

/// Mean distance to the k nearest others, or to as many as there are; NaN where the point is not finite.
template <typename S>
std::vector<double> mean_distances(const Points<S>& cloud, std::size_t k) {
  std::vector<double> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<double> d;
    for (std::size_t j = 0; j < cloud.size(); ++j)
      if (i != j && is_finite(cloud[j])) d.push_back(double(std::sqrt(distance_sq<S>(cloud[i], cloud[j]))));
    std::sort(d.begin(), d.end());
    d.resize(std::min(d.size(), k));
    double sum = 0.0;
    for (const double x : d) sum += x;
    out.push_back(is_finite(cloud[i]) ? sum / double(std::max<std::size_t>(d.size(), 1)) : std::nan(""));
  }
  return out;
}

/// Region growing as the paper defines it: parts of the graph of points nearer than the radius whose normals agree.
template <typename S>
Labels regions(const Points<S>& cloud, const Points<S>& normals, double radius, double smoothness, int min_size) {
  const auto near = within(cloud, static_cast<S>(radius), true);
  const auto can = [&](std::size_t i) {
    return is_finite(cloud[i]) && is_finite(normals[i]) && normals[i].squaredNorm() > 0;
  };
  const auto next = [&](std::size_t i) {
    Indices out;
    for (const Index j : near[i])
      if (normals[i].dot(normals[static_cast<std::size_t>(j)]) > static_cast<S>(std::cos(smoothness))) out.push_back(j);
    return out;
  };
  Labels labels = parts(cloud.size(), can, next);
  std::vector<int> sizes(cloud.size() + 1, 0), name(cloud.size() + 1, 0);
  for (const int label : labels) ++sizes[static_cast<std::size_t>(label)];
  int kept = 0;
  for (std::size_t r = 1; r < sizes.size(); ++r)
    if (sizes[r] >= min_size) name[r] = ++kept;
  for (int& label : labels) label = name[static_cast<std::size_t>(label)];
  return labels;
}

}  // namespace oracle
