// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// SEE++ (see/planner.hpp), the planner of [1], behind the common planner interface: its view proposals, replaced by
/// what the arm can reach. World frame, metres.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/see/planner.hpp>

namespace agrisee::plan {

/// Takes SEE++'s best reachable proposal. A proposal out of reach is replaced by the reachable view whose direction
/// differs least, by at most 45 degrees, and whose line of sight to the same frontier is free. Where there is none the
/// frontier is given up, see see::Explorer::refuse().
class SeePlanner : public Planner {
 public:
  /// @param volume to be scanned (world)
  /// @param robot where the robot's base stands (m, world); the first view looks from there
  /// @param parameters of SEE++
  /// @param band the distance of the views and its limits
  /// @param threads number of threads; the results do not depend on it
  /// @throws ParameterError
  SeePlanner(const Aabb& volume, const Eigen::Vector3d& robot, const see::Parameters& parameters,
             const ViewRequest& band, int threads);

  void observe(const Progress& progress) override;
  std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) override;
  void refused() override;
  StopReason stop_reason() const override { return reason_; }

 private:
  /// Drop all points but `kept` (indices in the map, with the points of the last view).
  void keep(const Indices& kept);
  /// Tell SEE++ from where its proposal was viewed. Not earlier, as `next` would then not answer alike if asked again.
  void take_offered();
  /// SEE++'s best proposal that can be reached; refuses those that cannot.
  std::optional<ReachableView> choose(const Joints& current, const Reach& reach);
  /// The reachable view that is nearest to a proposal and sees its frontier.
  std::optional<ReachableView> project(const see::ViewProposal& p, const Joints& current, const Reach& reach) const;

  Aabb volume_;
  Eigen::Vector3d robot_;
  ViewRequest band_;
  see::Explorer explorer_;
  Indices explored_;  // per point of the map: its index in the explorer; -1 if that has dropped it
  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();  // position of the sensor at the last view (m)
  std::optional<see::ViewProposal> last_;  // the proposal of the view last returned, unless that was taken or refused
  Eigen::Vector3d offered_from_ = Eigen::Vector3d::Zero();  // position of the sensor in that view (m)
  int refused_first_ = 0;                                   // views refused so far; the first view skips as many
  StopReason reason_ = StopReason::not_stopped;
};

}  // namespace agrisee::plan
