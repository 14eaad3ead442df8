// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Two baselines to compare planners with. Neither uses what it has seen: one takes a fixed set of well spread
/// reachable views, the other random reachable views. Asked again before `observe` or `refused`, they answer alike.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/plan/planner.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace agrisee::plan {

/// Views that are chosen once, before the scan: `count` reachable directions, each as far as possible from those chosen
/// before it (farthest-point sampling), the first one nearest to frontal. The most frontal view is taken first, then
/// always the one with the shortest move.
class FixedPlanner : public Planner {
 public:
  /// @param volume to be scanned; all views look at its center (world)
  /// @param robot where the robot's base stands (m, world)
  /// @param count number of views
  /// @param band the distance of the views and its limits
  FixedPlanner(const Aabb& volume, const Eigen::Vector3d& robot, int count, const ViewRequest& band);

  void observe(const Progress& progress) override;
  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override;
  void refused() override;
  /// `max_views` when all `count` views were offered, else `no_reachable_view`.
  StopReason stop_reason() const override;

 private:
  /// The view that was offered is taken or refused.
  void done();
  /// Fill `directions_` with up to `count_` directions that can be reached from `current`.
  void plan(const Joints& current, const Reach& reach);

  Aabb volume_;
  Eigen::Vector3d robot_;
  int count_;
  ViewRequest band_;
  std::vector<Eigen::Vector3d> directions_;  // that are still to be taken
  std::optional<std::size_t> offered_;       // the one last returned, unless it was taken or refused
  bool planned_ = false, first_ = true;
  bool complete_ = false;  // there are `count` reachable views, and none has become unreachable
};

/// Random reachable views of the volume's center; the first view is the most frontal one.
class RandomPlanner : public Planner {
 public:
  /// @param volume to be scanned; all views look at its center (world)
  /// @param robot where the robot's base stands (m, world)
  /// @param band the distance of the views and its limits
  /// @param seed of the random directions
  RandomPlanner(const Aabb& volume, const Eigen::Vector3d& robot, const ViewRequest& band, std::uint64_t seed);

  void observe(const Progress& progress) override;
  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override;
  void refused() override;
  StopReason stop_reason() const override;

 private:
  Aabb volume_;
  Eigen::Vector3d robot_;
  ViewRequest band_;
  Rng rng_, after_;  // before and after the draws of the last call
  bool refused_ = false;
};

}  // namespace agrisee::plan
