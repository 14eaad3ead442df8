// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The views that somebody who knows the truth would take: each the one that covers most of what is still uncovered.
/// Coverage is submodular, so n such views cover at least 1 - 1/e of what the best n could (Nemhauser et al., 1978).
/// Cost: some 50 ms for 450 views of 10,000 samples.
#pragma once

#include <agrisee/study/limit.hpp>

#include <bitset>

namespace agrisee::study {

/// Views in the order of choice, and what they cover.
struct GreedyOrder {
  std::vector<std::size_t> views;  ///< indices in Observability::views
  std::vector<double> covered;     ///< share of the observable samples that is covered after each

  /// How many views cover at least `share`; none when all together do not.
  std::optional<std::size_t> views_for(double share) const {
    for (std::size_t i = 0; i < covered.size(); ++i)
      if (covered[i] >= share) return i + 1;
    return std::nullopt;
  }
};

/// The view that looks at `target` most nearly along `forward` (index in `observed.views`; the first of equals).
/// @throws InputError when there are no views
inline std::size_t most_frontal(const Observability& observed, const Eigen::Vector3d& target,
                                const Eigen::Vector3d& forward) {
  check_input(!observed.views.empty(), "most frontal view: there are no views");
  std::size_t best = 0;
  double largest = -2.0;
  for (std::size_t v = 0; v < observed.views.size(); ++v) {
    const Eigen::Vector3d sight = target - observed.views[v].world_T_optical.translation();
    const double cosine = sight.normalized().dot(forward.normalized());
    if (cosine > largest) largest = cosine, best = v;
  }
  return best;
}

/// Greedy cover of the observable samples, until nothing is left; equal gains go to the first view.
/// @param first   the view to begin with, as a scan does (see most_frontal); none = the best
/// @param radius  a sample is covered when an observable one within this distance (m) is seen
/// @throws InputError when `first` is no view, or flags and samples differ in number; ParameterError for a radius that
/// is not positive
inline GreedyOrder greedy_order(const Observability& observed, const Samples& samples,
                                std::optional<std::size_t> first = std::nullopt, double radius = 0.005) {
  check_parameter(std::isfinite(radius) && radius > 0.0, "radius", "positive and finite", radius);
  check_input(!first || *first < observed.views.size(), "greedy order: the first view does not exist");
  GreedyOrder order;
  if (observed.views.empty()) return order;
  check_input(observed.observable.size() == samples.size(), "greedy order: flags and samples differ in number");

  // What a view covers: all observable samples near one that it sees.
  const Grid<float> grid(samples.points, static_cast<float>(radius));
  const std::size_t words = (samples.size() + 63) / 64;
  std::vector<Bits> covers(observed.views.size(), Bits(words, 0));
  double all = 0.0;
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!observed.observable[i]) continue;
    all += 1.0;
    near.clear();
    grid.visit(samples.points[i], static_cast<float>(radius),
               [&](Index j, float) { near.push_back(static_cast<std::size_t>(j)); });
    for (std::size_t v = 0; v < covers.size(); ++v)
      for (const std::size_t j : near)
        if (observed.sees(v, j)) {
          covers[v][i / 64] |= std::uint64_t{1} << (i % 64);
          break;
        }
  }

  Bits left(words, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) left[i / 64] |= std::uint64_t{observed.observable[i]} << (i % 64);
  double covered = 0.0;
  while (covered < all) {
    std::size_t best = 0, most = 0;
    for (std::size_t v = 0; v < covers.size(); ++v) {
      if (order.views.empty() && first && v != *first) continue;
      std::size_t gain = 0;
      for (std::size_t w = 0; w < words; ++w) gain += std::bitset<64>(covers[v][w] & left[w]).count();
      if (gain > most) most = gain, best = v;
    }
    for (std::size_t w = 0; w < words; ++w) left[w] &= ~covers[best][w];
    covered += static_cast<double>(most);
    order.views.push_back(best);
    order.covered.push_back(covered / all);
  }
  return order;
}

}  // namespace agrisee::study
