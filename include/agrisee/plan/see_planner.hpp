// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// SEE++ (see/planner.hpp) behind the common planner interface: its proposals, projected to what the arm can reach.
#pragma once

#include <agrisee/plan/directions.hpp>
#include <agrisee/see/planner.hpp>

namespace agrisee::plan {

/// The paper's planner. A proposal out of reach is replaced by the reachable view of the same point whose direction is
/// nearest (within `kMaxTurn`); where there is none the controller's own fallbacks follow.
class SeePlanner : public Planner {
 public:
  /// Of a volume to scan, seen from the side of `eye`; distances from `band`.
  SeePlanner(const Aabb& volume, const Eigen::Vector3d& eye, const see::Parameters& parameters, const ViewRequest& band,
             int threads)
      : volume_(volume), eye_(eye), band_(band), planner_(parameters, threads) {}

  void observe(const Progress& progress) override {
    sensor_ = progress.views.back().world_T_optical.translation();
    planner_.observe(progress.added, sensor_);
    if (progress.kept) planner_.keep(*progress.kept);
  }

  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override {
    // A first frame that shows nothing may be the sensor's fault: a few more tries near the front.
    const auto taken = static_cast<int>(progress.views.size());
    if (progress.cloud.empty() && taken < 4) {
      auto view = first_view(volume_, eye_, current, reach, band_, refused_first_ + 12 * taken);
      if (!view) reason_ = StopReason::no_reachable_view;
      return view;
    }
    // Proposals that are out of reach change SEE's own list: should this be cancelled, it is as before.
    std::optional<see::Planner> before;
    if (cancellable()) before = planner_;
    try {
      return choose(current, reach);
    } catch (...) {
      if (before) planner_ = std::move(*before);
      throw;
    }
  }

  void refused() override {
    if (last_) planner_.refuse(*last_);
    ++refused_first_;
  }

  StopReason stop_reason() const override { return reason_; }

 private:
  static constexpr double kMaxTurn = deg(45);

  std::optional<ReachableView> choose(const Joints& current, const Reach& reach) {
    while (true) {
      const std::vector<see::ViewProposal> proposals = planner_.next_views(sensor_);
      if (proposals.empty()) {
        reason_ = planner_.stop_reason();
        return std::nullopt;
      }
      for (const see::ViewProposal& p : proposals) {
        throw_if_cancelled();
        if (auto view = project(p, current, reach)) {
          planner_.take(p);
          last_ = p;
          view->gain = p.visible;
          return view;
        }
        planner_.refuse(p);
      }
    }
  }

  std::optional<ReachableView> project(const see::ViewProposal& p, const Joints& current, const Reach& reach) const {
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
            (std::cos(turn) * p.direction + std::sin(turn) * (std::cos(around) * a + std::sin(around) * b))
                .normalized();
        const auto view = reach(request, current);
        if (view && (!nearest || view->move_time < nearest->move_time)) nearest = view;
      }
      if (nearest) return nearest;
    }
    return std::nullopt;
  }

  Aabb volume_;
  Eigen::Vector3d eye_;
  ViewRequest band_;
  see::Planner planner_;
  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();
  std::optional<see::ViewProposal> last_;
  int refused_first_ = 0;
  StopReason reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::plan
