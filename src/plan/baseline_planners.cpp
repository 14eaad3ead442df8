// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/plan/baseline_planners.hpp>
#include <agrisee/plan/directions.hpp>

#include <algorithm>

namespace agrisee::plan {

namespace {

/// Up to `count` of some directions: the one nearest to `frontal` first, then always the one that is farthest from all
/// those chosen before it.
std::vector<Eigen::Vector3d> farthest_directions(const std::vector<Eigen::Vector3d>& all,
                                                 const Eigen::Vector3d& frontal, int count) {
  std::vector<Eigen::Vector3d> chosen;
  Eigen::Vector3d last = frontal;
  std::vector<double> nearest(all.size(), 2.0);  // cosine to the nearest chosen direction; 2 = none chosen yet
  for (int n = 0; n < count && n < static_cast<int>(all.size()); ++n) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (n == 0) {
        if (all[i].dot(frontal) > all[best].dot(frontal)) best = i;
      } else {
        const double c = all[i].dot(last);
        nearest[i] = n == 1 ? c : std::max(nearest[i], c);
        if (nearest[i] < nearest[best]) best = i;
      }
    }
    last = all[best];
    chosen.push_back(last);
  }
  return chosen;
}

}  // namespace

FixedPlanner::FixedPlanner(const Aabb& volume, const Eigen::Vector3d& robot, int count, const ViewRequest& band)
    : volume_(volume), robot_(robot), count_(count), band_(band) {
  band_.target = volume.center();
}

void FixedPlanner::observe(const Progress&) { done(); }

void FixedPlanner::refused() { done(); }

std::optional<ReachableView> FixedPlanner::next(const Progress&, const Joints& current, const Reach& reach) {
  if (!planned_) plan(current, reach);
  if (directions_.empty()) return std::nullopt;
  std::optional<std::size_t> best;
  std::optional<ReachableView> view;
  for (std::size_t i = 0; i < (first_ ? 1 : directions_.size()); ++i) {
    throw_if_cancelled();
    band_.direction = directions_[i];
    const auto there = reach(band_, current);
    if (there && (!view || there->move_time < view->move_time)) {
      view = there;
      best = i;
    }
  }
  offered_ = best;
  if (!view) complete_ = false;
  return view;
}

StopReason FixedPlanner::stop_reason() const {
  return complete_ ? StopReason::max_views : StopReason::no_reachable_view;
}

void FixedPlanner::done() {
  if (planned_) first_ = false;
  if (offered_) directions_.erase(directions_.begin() + static_cast<std::ptrdiff_t>(*offered_));
  offered_.reset();
}

void FixedPlanner::plan(const Joints& current, const Reach& reach) {
  std::vector<Eigen::Vector3d> reachable;
  for (const Eigen::Vector3d& d : spread_directions(400)) {
    throw_if_cancelled();
    band_.direction = d;
    if (reach(band_, current)) reachable.push_back(d);
  }
  directions_ = farthest_directions(reachable, frontal_direction(volume_, robot_), count_);
  complete_ = static_cast<int>(directions_.size()) == count_;
  planned_ = true;
}

RandomPlanner::RandomPlanner(const Aabb& volume, const Eigen::Vector3d& robot, const ViewRequest& band,
                             std::uint64_t seed)
    : volume_(volume), robot_(robot), band_(band), rng_(seed, 0x72616e64), after_(rng_) {
  band_.target = volume.center();
}

void RandomPlanner::observe(const Progress&) { rng_ = after_; }

void RandomPlanner::refused() {
  rng_ = after_;
  refused_ = true;
}

std::optional<ReachableView> RandomPlanner::next(const Progress& progress, const Joints& current, const Reach& reach) {
  if (progress.views.empty() && !refused_) return first_view(volume_, robot_, current, reach, band_);
  Rng rng = rng_;  // a copy: asked again, or after a cancelled call, it draws the same
  std::optional<ReachableView> view;
  for (int tries = 0; tries < 2000 && !view; ++tries) {
    throw_if_cancelled();
    band_.direction = rng.direction();
    view = reach(band_, current);
  }
  after_ = rng;
  return view;
}

StopReason RandomPlanner::stop_reason() const { return StopReason::no_reachable_view; }

}  // namespace agrisee::plan
