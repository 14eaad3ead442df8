// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a planner is: it is told every view that was taken and says which to take next.
/// Reach is a callable, so that any arm's own motion planner can answer.
#pragma once

#include <agrisee/plan/free_space.hpp>
#include <agrisee/result.hpp>

#include <functional>
#include <optional>

namespace agrisee::plan {

/// A wish to look at a point: from `target - distance * direction` along `direction`, the sensor's roll free, the
/// distance free within a band. World, metres.
struct ViewRequest {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();      ///< m
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  ///< unit, from the sensor to the target
  double distance = 0.38;                                ///< preferred
  double distance_min = 0.28;                            ///< nearest
  double distance_max = 0.55;                            ///< farthest
};

/// A view that the arm can take.
struct ReachableView {
  Pose world_T_optical = Pose::Identity();           ///< of the sensor
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< the point looked at, on the optical axis
  std::optional<Joints> joints;                      ///< absent where the caller moves without telling
  double move_time = 0.0;                            ///< from the present joints (s)
  double gain = 0.0;                                 ///< what the planner expects of it, in the planner's own unit
};

/// Answers a wish with the nearest way to fulfil it from the present joints, or with nothing when it is out of reach.
using Reach = std::function<std::optional<ReachableView>(const ViewRequest&, const Joints& current)>;

/// What a planner may look at after a view: the merged cloud, and the views that made it.
struct Progress {
  const Cloud& cloud;                               ///< merged so far; points, normals where known, views
  const std::vector<sensor::SurfaceImage>& images;  ///< what each view saw, where surfaces are fused; else empty
  const std::vector<View>& views;                   ///< taken so far
  const std::vector<Eigen::Vector3f>& added;        ///< points that the last view added
  const Indices* kept = nullptr;  ///< where the last view was followed by a filter: the points that it kept,
                                  ///< counting those from before the view, then `added`
};

/// Decides where to look next.
class Planner {
 public:
  Planner() = default;
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;
  virtual ~Planner() = default;

  /// A view has been taken and merged. Never cancelled: the pipeline sees to that.
  virtual void observe(const Progress& progress) = 0;

  /// The next view for an arm that stands at `current`; nothing when there is none worth taking. Where it is cancelled,
  /// the next call answers as if there had been none.
  virtual std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) = 0;

  /// The view last returned could not be taken; the next call returns another.
  virtual void refused() = 0;

  /// Why `next` returned nothing.
  virtual StopReason stop_reason() const = 0;

  /// How complete the scan is, as of the last call of `next`; nothing where the planner does not reckon with surfaces,
  /// or knows of none yet.
  virtual std::optional<Completeness> completeness() const { return std::nullopt; }

  /// The views that the last call of `next` compared and found worth taking, best first; empty where the planner does
  /// not compare views.
  virtual std::vector<ReachableView> candidates() const { return {}; }
};

}  // namespace agrisee::plan
