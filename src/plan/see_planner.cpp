// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/see_planner.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace agrisee::plan {

namespace {

constexpr double kMaxTurn = deg(45);  // between a proposal's direction and that of the view which replaces it (rad)

}  // namespace

SeePlanner::SeePlanner(const Aabb& volume, const Eigen::Vector3d& robot, const see::Parameters& parameters,
                       const ViewRequest& band, int threads)
    : volume_(volume), robot_(robot), band_(band), explorer_(parameters, threads) {}

void SeePlanner::observe(const Progress& progress) {
  take_offered();
  sensor_ = progress.views.back().world_T_optical.translation();
  const std::size_t before = explored_.size();
  const Indices* kept = progress.kept;
  // A map that starts again keeps none of its points; they must not stand in the way of the new ones.
  if (kept && std::none_of(kept->begin(), kept->end(), [&](Index i) { return static_cast<std::size_t>(i) < before; })) {
    explorer_.keep({});
    std::fill(explored_.begin(), explored_.end(), -1);
  }
  auto next = static_cast<Index>(explorer_.cloud().size());
  explored_.resize(before + progress.added.size(), -1);
  for (const Index i : explorer_.observe(progress.added, progress.observed, sensor_))
    explored_[before + static_cast<std::size_t>(i)] = next++;
  if (kept) keep(*kept);
}

void SeePlanner::keep(const Indices& kept) {
  Indices of_explorer, renumbered;
  for (const Index i : kept) {
    const Index old = explored_[static_cast<std::size_t>(i)];
    renumbered.push_back(old < 0 ? -1 : static_cast<Index>(of_explorer.size()));
    if (old >= 0) of_explorer.push_back(old);
  }
  explorer_.keep(of_explorer);
  explored_ = std::move(renumbered);
}

std::optional<ReachableView> SeePlanner::next(const Progress& progress, const Joints& current, const Reach& reach) {
  // A first frame without points may be the sensor's fault: try a few more views near the front.
  const auto taken = static_cast<int>(progress.views.size());
  if (progress.cloud.empty() && taken < 4) {
    auto view = first_view(volume_, robot_, current, reach, band_, refused_first_ + 12 * taken);
    if (!view) reason_ = StopReason::no_reachable_view;
    return view;
  }
  // Refusing proposals changes SEE++'s state, so it is restored when the call is cancelled, or `reach` throws. The copy
  // takes some tenths of a millisecond.
  see::Explorer before = explorer_;
  try {
    return choose(current, reach);
  } catch (...) {
    explorer_ = std::move(before);
    throw;
  }
}

void SeePlanner::refused() {
  if (last_) explorer_.refuse(*last_);
  last_.reset();
  ++refused_first_;
}

void SeePlanner::take_offered() {
  if (!last_) return;
  explorer_.move_view(*last_, offered_from_);
  explorer_.take(*last_);
  last_.reset();
}

std::optional<ReachableView> SeePlanner::choose(const Joints& current, const Reach& reach) {
  while (const auto p = explorer_.next_view(sensor_)) {
    throw_if_cancelled();
    if (auto view = project(*p, current, reach)) {
      last_ = *p;
      offered_from_ = view->world_T_optical.translation();
      view->gain = p->visible;
      return view;
    }
    explorer_.refuse(*p);
  }
  last_.reset();
  reason_ = explorer_.stop_reason();
  return std::nullopt;
}

std::optional<ReachableView> SeePlanner::project(const see::ViewProposal& p, const Joints& current,
                                                 const Reach& reach) const {
  ViewRequest request = band_;
  // The frontier lies at the view distance along the proposal's axis.
  request.target = p.position + band_.distance * p.direction;
  request.direction = p.direction;
  if (auto view = reach(request, current)) return view;
  const Eigen::Vector3d a = any_orthogonal<double>(p.direction), b = p.direction.cross(a);
  for (double turn = deg(9); turn <= kMaxTurn; turn += deg(9)) {
    std::optional<ReachableView> nearest;
    for (int k = 0; k < 8; ++k) {
      const double around = kTwoPi * k / 8.0;
      request.direction =
          (std::cos(turn) * p.direction + std::sin(turn) * (std::cos(around) * a + std::sin(around) * b)).normalized();
      const auto view = reach(request, current);
      if (!view || (nearest && nearest->move_time <= view->move_time)) continue;
      if (explorer_.sees(p, view->world_T_optical.translation())) nearest = view;
    }
    if (nearest) return nearest;
  }
  return std::nullopt;
}

}  // namespace agrisee::plan
