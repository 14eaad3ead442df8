// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A planner that knows the truth, for comparison: it shows how good a scan can be if the choice of views is not the
/// limit. It does not use the results of the scan. World frame, metres, radians.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/study/greedy.hpp>

#include <memory>
#include <optional>

namespace agrisee::study {

/// Takes the views of frontal_order(): first the most frontal view, then always the one that covers most of what is
/// left.
///
/// `next` returns the same view again until `observe` reports it taken or `refused` reports that it cannot be taken.
/// An `observe` without a preceding `next` changes nothing.
class GreedyPlanner : public plan::Planner {
 public:
  /// @param observed which views see which samples; shared, so that many planners can use one
  /// @param samples the samples that `observed` refers to
  /// @param volume scan volume (m, world); the first view is the most frontal one of its center
  /// @param robot where the robot's base stands (m, world); the frontal direction is horizontal, from there to the
  ///   center
  /// @param limits of the arm's joints; their speeds tell which moves are shorter
  /// @param radius a sample is covered if an observable sample within this distance (m) is seen
  /// @throws InputError if a pointer is null, or flags and samples differ in number (and there are views);
  ///   ParameterError for a radius that is not positive, or limits that are none
  GreedyPlanner(std::shared_ptr<const Observability> observed, std::shared_ptr<const Samples> samples,
                const Aabb& volume, const Eigen::Vector3d& robot, const arm::JointLimits& limits,
                double radius = 0.005);

  void observe(const plan::Progress&) override;

  /// The gain of the view is the number of samples that it newly covers. Its joints are those with which it was found
  /// to be within reach, or, if that move is shorter, those that `reach` now answers for exactly the same sensor pose.
  std::optional<plan::ReachableView> next(const plan::Progress&, const Joints& current,
                                          const plan::Reach& reach) override;

  /// Drop the view that `next` last returned for good.
  void refused() override;

  /// `no_frontier` if everything that can be observed is covered; `no_reachable_view` if there is no view at all, or
  /// what is left can be seen only from refused views.
  StopReason stop_reason() const override;

 private:
  std::optional<std::size_t> first() const;

  std::shared_ptr<const Observability> observed_;
  GreedyCover cover_;
  Eigen::Vector3d target_, forward_;
  arm::JointLimits limits_;
  std::optional<std::size_t> asked_for_;  // the view that `next` returned; neither taken nor refused yet
  bool begun_ = false;                    // a view has been taken
};

/// A planner that knows what the arm of a workcell can observe of the samples. It keeps what it needs of its arguments.
/// Cost: about a second, see limit.hpp.
/// @param scene what hides samples
/// @param samples of the fruit's surface
/// @param cell arm, camera and keep-out spaces
/// @param parameters which poses are tried
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError, also if the arm's mount is not valid
std::unique_ptr<GreedyPlanner> make_greedy_planner(const TracedScene& scene, const Samples& samples,
                                                   const Workcell& cell, const LimitParameters& parameters = {},
                                                   int threads = 1);

}  // namespace agrisee::study
