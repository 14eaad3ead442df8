// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/study/greedy.hpp>

#include <algorithm>
#include <bitset>
#include <cmath>

#include "cloud/searches.hpp"

namespace agrisee::study {

std::size_t most_frontal(const Observability& observed, const Eigen::Vector3d& target, const Eigen::Vector3d& forward,
                         const Flags& except) {
  check_input(except.empty() || except.size() == observed.views.size(),
              "most frontal view: flags and views differ in number");
  std::optional<std::size_t> best;
  double largest = -2.0;
  for (std::size_t v = 0; v < observed.views.size(); ++v) {
    if (!except.empty() && except[v]) continue;
    const Eigen::Vector3d sight = target - observed.views[v].world_T_optical.translation();
    const double cosine = sight.normalized().dot(forward.normalized());
    if (!best || cosine > largest) best = v;
    largest = std::max(largest, cosine);
  }
  check_input(best.has_value(), "most frontal view: there are no views");
  return *best;
}

GreedyCover::GreedyCover(const Observability& observed, const Samples& samples, double radius)
    : dropped_(observed.views.size(), 0) {
  check_parameter(std::isfinite(radius) && radius > 0.0, "radius", "positive and finite", radius);
  if (observed.views.empty()) return;
  check_input(observed.observable.size() == samples.size(), "greedy cover: flags and samples differ in number");
  const Grid<float> grid(samples.points, static_cast<float>(radius));
  const std::size_t words = (samples.size() + 63) / 64;
  covers_.assign(observed.views.size(), Bits(words, 0));
  uncovered_.assign(words, 0);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!observed.observable[i]) continue;
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    uncovered_[i / 64] |= bit;
    ++all_;
    near.clear();
    grid.visit(samples.points[i], static_cast<float>(radius),
               [&](Index j, float) { near.push_back(static_cast<std::size_t>(j)); });
    for (std::size_t v = 0; v < covers_.size(); ++v)
      if (std::any_of(near.begin(), near.end(), [&](std::size_t j) { return observed.sees(v, j); }))
        covers_[v][i / 64] |= bit;
  }
  left_ = all_;
}

std::size_t GreedyCover::gain(std::size_t view) const {
  check_input(view < covers_.size(), "greedy cover: the view does not exist");
  std::size_t n = 0;
  for (std::size_t w = 0; w < uncovered_.size(); ++w) n += std::bitset<64>(covers_[view][w] & uncovered_[w]).count();
  return n;
}

std::optional<std::size_t> GreedyCover::best() const {
  std::optional<std::size_t> view;
  std::size_t most = 0;
  for (std::size_t v = 0; v < covers_.size() && left_ > 0; ++v) {
    if (dropped_[v]) continue;
    const std::size_t n = gain(v);
    if (n > most) most = n, view = v;
  }
  return view;
}

std::size_t GreedyCover::take(std::size_t view) {
  const std::size_t n = gain(view);
  for (std::size_t w = 0; w < uncovered_.size(); ++w) uncovered_[w] &= ~covers_[view][w];
  left_ -= n;
  return n;
}

void GreedyCover::drop(std::size_t view) {
  check_input(view < dropped_.size(), "greedy cover: the view does not exist");
  dropped_[view] = 1;
}

GreedyOrder greedy_order(const Observability& observed, const Samples& samples, std::optional<std::size_t> first,
                         double radius) {
  check_input(!first || *first < observed.views.size(), "greedy order: the first view does not exist");
  GreedyCover cover(observed, samples, radius);
  GreedyOrder order;
  for (auto view = first ? first : cover.best(); view; view = cover.best()) {
    cover.take(*view);
    order.views.push_back(*view);
    order.covered.push_back(cover.covered());
  }
  return order;
}

GreedyOrder frontal_order(const Observability& observed, const Samples& samples, const Workcell& cell, double radius) {
  const Eigen::Vector3d forward = plan::frontal_direction(cell.scan_volume, cell.world_T_base.translation());
  return greedy_order(observed, samples, most_frontal(observed, cell.scan_volume.center(), forward), radius);
}

}  // namespace agrisee::study
