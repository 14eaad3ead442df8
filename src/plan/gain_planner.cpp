// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/gain_planner.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace agrisee::plan {

namespace {

constexpr std::size_t kRefined = 8;       // the best candidates, around which more directions are tried
constexpr std::size_t kRefinedAgain = 4;  // and the best of all, around which closer ones are

/// How long the move from the joints `from` to a view counts (s): the joint-space distance at pi rad/s, the UR3's speed
/// limit; when the view has no joints, the move time that the arm answered.
double time_to_move(const ReachableView& view, const Joints& from) {
  return view.joints ? (*view.joints - from).norm() / kPi : view.move_time;
}

/// How wide a part of the volume may be (m) that one view at this distance shows well enough to tell whether it is
/// empty.
double width_of_a_look(const sensor::Intrinsics& k, double distance) {
  constexpr double kMore = 1.25;  // what is at the border is seen from the next part, or a little in part
  return kMore * distance * std::min(k.width / k.fx, k.height / k.fy);
}

}  // namespace

GainPlanner::GainPlanner(const sensor::DepthCamera& sensor, const Aabb& volume, const Eigen::Vector3d& robot,
                         const SplitParameters& split, const fuse::FreeSpaceParameters& free_space,
                         const GainPlannerParameters& parameters, int threads)
    : parameters_(parameters),
      split_(split),
      free_space_(free_space),
      volume_(volume),
      robot_(robot),
      model_(sensor, volume, parameters.expected, threads),
      threads_(threads) {
  parameters_.check();
  look_ = width_of_a_look(sensor.intrinsics, parameters_.distance);
  divide(1.0);
}

void GainPlanner::observe(const Progress& progress) {
  model_.update(progress, split_, free_space_);
  ranked_.clear();
  left_out_.clear();
  refused_ = 0;
  if (last_) left_out_.push_back(*last_);  // taken just now: from the same place it shows the same
  if (part_) ++parts_[*part_].looks;
  part_.reset();
  last_.reset();
  stopped_at_.reset();
}

std::optional<ReachableView> GainPlanner::next(const Progress& progress, const Joints& current, const Reach& reach) {
  if (stopped_at_ && *stopped_at_ == current) return std::nullopt;
  if (progress.cloud.empty()) return front_view(static_cast<int>(progress.views.size()), current, reach);
  update_candidates(current, reach);
  if (!last_ || current != asked_from_) rank_again(current);  // a view was refused, or the arm has moved
  if (!first_within_reach(current, reach)) {
    ranked_.clear();
    const auto completeness = completeness_;
    try {
      if (const auto reason = rank(current, reach)) return stop(*reason, current);
      if (!first_within_reach(current, reach)) {
        ranked_.clear();
        return stop(StopReason::no_reachable_view, current);
      }
    } catch (...) {  // cancelled: do not keep half a ranking
      ranked_.clear();
      completeness_ = completeness;
      throw;
    }
  }
  last_ = ranked_.front().request;
  asked_from_ = current;
  return ranked_.front().view;
}

void GainPlanner::refused() {
  if (last_) left_out_.push_back(*last_);
  last_.reset();
  stopped_at_.reset();
  ++refused_;
}

std::vector<ReachableView> GainPlanner::candidates() const {
  std::vector<ReachableView> views;
  views.reserve(ranked_.size());
  for (const Scored& s : ranked_) views.push_back(s.view);
  return views;
}

std::optional<ReachableView> GainPlanner::front_view(int taken, const Joints& current, const Reach& reach) {
  part_.reset();
  auto view = view_of_part(taken, current, reach);
  if (!view && taken == 0) {
    // Even the middles of the parts are out of reach; those of smaller ones may be nearer.
    divide(0.5);
    view = view_of_part(taken, current, reach);
  }
  return view ? view : stop(taken > 0 ? StopReason::nothing_seen : StopReason::no_reachable_view, current);
}

std::optional<ReachableView> GainPlanner::view_of_part(int taken, const Joints& current, const Reach& reach) {
  constexpr int kFew = 4;  // views near the front that show nothing, and one of every part, end the scan
  std::vector<std::size_t> order(parts_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto fewer_looks = [&](std::size_t a, std::size_t b) { return parts_[a].looks < parts_[b].looks; };
  std::stable_sort(order.begin(), order.end(), fewer_looks);
  for (const std::size_t i : order) {
    const Part& part = parts_[i];
    if (taken >= kFew && (part.looks > 0 || parts_.size() == 1)) break;
    const int skip = refused_ + 12 * part.looks;
    if (auto view = first_view(part.box, robot_, current, reach, request(Eigen::Vector3d::UnitY()), skip)) {
      part_ = i;
      return view;
    }
  }
  return std::nullopt;
}

void GainPlanner::divide(double factor) {
  parts_.clear();
  for (const Aabb& box : parts_to_look_at(volume_, factor * look_)) parts_.push_back({box});
}

void GainPlanner::update_candidates(const Joints& current, const Reach& reach) {
  const Aabb& extent = model_.extent();
  if (!candidates_.empty() && !((extent_.min - extent.min).norm() > 0.02) &&
      !((extent_.max - extent.max).norm() > 0.02))
    return;
  std::vector<Candidate> candidates;  // kept only when complete, in case the call is cancelled
  const std::vector<Eigen::Vector3d> directions = spread_directions(parameters_.candidates);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    throw_if_cancelled();
    ViewRequest r = request(directions[i]);
    spread_aim(r, static_cast<double>(i), extent.size(), parameters_.spread);
    if (auto view = reach(r, current)) candidates.push_back({r, std::move(*view)});
  }
  extent_ = extent;
  candidates_ = std::move(candidates);
}

ViewRequest GainPlanner::request(const Eigen::Vector3d& direction) const {
  return {model_.center(), direction, parameters_.distance, parameters_.distance_min, parameters_.distance_max};
}

bool GainPlanner::first_within_reach(const Joints& current, const Reach& reach) {
  for (auto s = ranked_.begin(); s != ranked_.end(); ++s)
    if (const auto view = reach(s->request, current)) {
      rate(*s, *view, current);
      ranked_.erase(ranked_.begin(), s);
      return true;
    }
  return false;
}

std::optional<StopReason> GainPlanner::rank(const Joints& current, const Reach& reach) {
  for (const Candidate& c : candidates_) consider(c.request, c.view);
  rate_from(0, current);
  std::vector<char> can_be_seen(model_.areas().size(), 0);
  for (const Scored& s : ranked_)
    for (std::uint32_t i : s.shown) can_be_seen[i] = 1;
  completeness_ = model_.completeness(can_be_seen);
  leave_out();
  if (ranked_.empty()) return StopReason::no_reachable_view;
  sort_ranked();
  refine(current, reach);
  const auto shows = [](const Scored& s) { return s.view.gain > 0.0; };
  const bool any = std::any_of(ranked_.begin(), ranked_.end(), shows);
  const auto poor = [least = least_gain()](const Scored& s) { return s.view.gain < least; };
  const auto lost = [&](const Scored& s) { return s.lost && !poor(s); };
  const bool any_lost = std::any_of(ranked_.begin(), ranked_.end(), lost);
  const auto drop = [&](const Scored& s) { return s.lost || poor(s); };
  ranked_.erase(std::remove_if(ranked_.begin(), ranked_.end(), drop), ranked_.end());
  sort_ranked();
  // The refused ones were worth taking, and so were the lost ones.
  if (ranked_.empty() && (refused_ > 0 || any_lost)) return StopReason::no_reachable_view;
  if (ranked_.empty()) return any ? StopReason::low_gain : StopReason::no_frontier;
  return std::nullopt;
}

void GainPlanner::refine(const Joints& current, const Reach& reach) {
  const double step = 0.5 * std::sqrt(4.0 * kPi / parameters_.candidates);  // half the candidates' spacing (rad)
  std::size_t rated = ranked_.size();
  for (std::size_t i = 0, n = std::min(kRefined, ranked_.size()); i < n; ++i) {
    throw_if_cancelled();
    if (const auto view = reach(ranked_[i].request, current))
      rate(ranked_[i], *view, current);
    else
      ranked_[i].lost = true;
    consider_around(ranked_[i].request, step, current, reach);
  }
  rate_from(rated, current);
  sort_ranked();
  rated = ranked_.size();
  for (std::size_t i = 0, n = std::min(kRefinedAgain, ranked_.size()); i < n; ++i)
    if (!ranked_[i].lost) consider_around(ranked_[i].request, 0.5 * step, current, reach);
  rate_from(rated, current);
}

void GainPlanner::consider_around(ViewRequest middle, double step, const Joints& current, const Reach& reach) {
  const Eigen::Vector3d a = any_orthogonal<double>(middle.direction), b = middle.direction.cross(a);
  for (int k = 0; k < 6; ++k) {
    const double angle = kPi / 3.0 * k;
    ViewRequest around = middle;
    around.direction = (middle.direction + step * (std::cos(angle) * a + std::sin(angle) * b)).normalized();
    if (is_left_out(around)) continue;
    if (const auto view = reach(around, current)) consider(around, *view);
  }
}

void GainPlanner::rank_again(const Joints& current) {
  leave_out();
  for (Scored& s : ranked_) s.score = s.view.gain / (parameters_.dwell + time_to_move(s.view, current));
  sort_ranked();
}

void GainPlanner::leave_out() {
  const auto left_out = [&](const Scored& s) { return is_left_out(s.request); };
  ranked_.erase(std::remove_if(ranked_.begin(), ranked_.end(), left_out), ranked_.end());
}

void GainPlanner::sort_ranked() {
  std::stable_sort(ranked_.begin(), ranked_.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
}

void GainPlanner::consider(const ViewRequest& request, const ReachableView& view) {
  throw_if_cancelled();
  ranked_.emplace_back();
  ranked_.back().request = request;
  ranked_.back().view = view;
}

void GainPlanner::rate_from(std::size_t first, const Joints& current) {
  const auto rate_one = [&](std::size_t i) {
    Scored& scored = ranked_[first + i];
    rate(scored, scored.view, current);
  };
  parallel_for(ranked_.size() - first, threads_, rate_one, 8);
}

void GainPlanner::rate(Scored& scored, const ReachableView& view, const Joints& current) const {
  // What a pose shows changes with the model alone, and `ranked_` is cleared then.
  const bool rated = scored.rated && scored.view.world_T_optical.matrix() == view.world_T_optical.matrix();
  if (!rated) scored.shown = model_.shown(view.world_T_optical);
  scored.rated = true;
  scored.view = view;
  scored.view.gain = model_.clearness(view.world_T_optical) * model_.gain(scored.shown);
  scored.score = scored.view.gain / (parameters_.dwell + time_to_move(view, current));
}

bool GainPlanner::is_left_out(const ViewRequest& request) const {
  return std::any_of(left_out_.begin(), left_out_.end(), [&](const ViewRequest& r) {
    return r.direction.dot(request.direction) > 0.9999 && (r.target - request.target).norm() < 0.01 &&
           std::abs(r.distance - request.distance) < 0.01;
  });
}

double GainPlanner::least_gain() const {
  const double one_fruit = 4.0 * kPi * split_.bodies.radius_min * split_.bodies.radius_max;  // of middle size (m2)
  return parameters_.min_gain * std::max(model_.area(), one_fruit) / std::max(model_.reliability(), 1e-3);
}

std::optional<ReachableView> GainPlanner::stop(StopReason reason, const Joints& current) {
  reason_ = reason;
  stopped_at_ = current;
  return std::nullopt;
}

}  // namespace agrisee::plan
