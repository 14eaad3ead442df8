// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The views that somebody who knows the truth would take: each the one that covers most of what is still uncovered.
/// Coverage is submodular, so n such views cover at least 1 - 1/e of what the best n could (Nemhauser et al., 1978).
/// Cost: some 50 ms for 450 views of 10,000 samples.
#pragma once

#include <agrisee/plan/directions.hpp>
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
/// @param observed what each view sees of the samples
/// @param target   m, world
/// @param forward  world, need not be unit length
/// @param except   one flag a view: those to pass over; empty = none
/// @throws InputError when there are no views, all are passed over, or flags and views differ in number
inline std::size_t most_frontal(const Observability& observed, const Eigen::Vector3d& target,
                                const Eigen::Vector3d& forward, const Flags& except = {}) {
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

/// What each of some views covers of the observable samples, and what those taken so far have left. A view covers all
/// observable samples near one that it sees. Copies are independent. Cost: some 50 ms to make, below 1 ms to ask.
class GreedyCover {
 public:
  /// @param observed what each view sees of the samples
  /// @param samples of the fruit's surface
  /// @param radius  a sample is covered when an observable one within this distance (m) is seen
  /// @throws InputError when there are views and flags and samples differ in number; ParameterError for a radius that
  /// is not positive
  GreedyCover(const Observability& observed, const Samples& samples, double radius = 0.005)
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
        for (const std::size_t j : near)
          if (observed.sees(v, j)) {
            covers_[v][i / 64] |= bit;
            break;
          }
    }
    left_ = all_;
  }

  /// Number of observable samples.
  std::size_t all() const { return all_; }
  /// Number of them that no view taken so far covers.
  std::size_t left() const { return left_; }
  /// Share of the observable samples that is covered; of nothing it is 0.
  double covered() const { return all_ > 0 ? static_cast<double>(all_ - left_) / static_cast<double>(all_) : 0.0; }
  /// One flag a view: dropped.
  const Flags& dropped() const { return dropped_; }

  /// Number of samples that a view would cover beyond those taken so far.
  /// @throws InputError when there is no such view
  std::size_t gain(std::size_t view) const {
    check_input(view < covers_.size(), "greedy cover: the view does not exist");
    std::size_t n = 0;
    for (std::size_t w = 0; w < uncovered_.size(); ++w) n += std::bitset<64>(covers_[view][w] & uncovered_[w]).count();
    return n;
  }

  /// The view, not dropped, that covers most of what is left, the first of equals; none when none covers anything more.
  std::optional<std::size_t> best() const {
    std::optional<std::size_t> view;
    std::size_t most = 0;
    for (std::size_t v = 0; v < covers_.size() && left_ > 0; ++v) {
      if (dropped_[v]) continue;
      const std::size_t n = gain(v);
      if (n > most) most = n, view = v;
    }
    return view;
  }

  /// A view is taken. @return number of samples that it newly covers  @throws InputError when there is no such view
  std::size_t take(std::size_t view) {
    const std::size_t n = gain(view);
    for (std::size_t w = 0; w < uncovered_.size(); ++w) uncovered_[w] &= ~covers_[view][w];
    left_ -= n;
    return n;
  }

  /// A view cannot be taken: `best` names it no more. @throws InputError when there is no such view
  void drop(std::size_t view) {
    check_input(view < dropped_.size(), "greedy cover: the view does not exist");
    dropped_[view] = 1;
  }

 private:
  std::vector<Bits> covers_;  // a set of samples for each view
  Bits uncovered_;            // observable, and covered by no view taken
  Flags dropped_;
  std::size_t all_ = 0, left_ = 0;
};

/// Greedy cover of the observable samples, until nothing is left; equal gains go to the first view.
/// @param observed what each view sees of the samples
/// @param samples of the fruit's surface
/// @param first   the view to begin with, as a scan does (see most_frontal); none = the best
/// @param radius  a sample is covered when an observable one within this distance (m) is seen
/// @throws InputError when `first` is no view, or flags and samples differ in number; ParameterError for a radius that
/// is not positive
inline GreedyOrder greedy_order(const Observability& observed, const Samples& samples,
                                std::optional<std::size_t> first = std::nullopt, double radius = 0.005) {
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

/// Greedy cover as a scan of a workcell begins: with the view that looks most frontally at the scan volume's centre.
/// @param observed what each view sees of the samples
/// @param samples of the fruit's surface
/// @param cell arm, sensor and spaces to keep out of
/// @param radius  see above
/// @throws InputError as greedy_order() does, and when there are no views; ParameterError for a radius that is not
/// positive
inline GreedyOrder frontal_order(const Observability& observed, const Samples& samples, const Workcell& cell,
                                 double radius = 0.005) {
  const Eigen::Vector3d forward = plan::frontal_direction(cell.scan_volume, cell.world_T_base.translation());
  return greedy_order(observed, samples, most_frontal(observed, cell.scan_volume.center(), forward), radius);
}

}  // namespace agrisee::study
