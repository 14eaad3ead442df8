// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The interface of a planner: it observes every view that was taken and chooses the next one.
///
/// Whether the arm can take a view is answered by a callable, so that any robot's own motion planner can be used.
/// World frame, metres, seconds.
#pragma once

#include <agrisee/cloud/mask_evidence.hpp>
#include <agrisee/result.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace agrisee::plan {

/// A request to look at a point: from `target - distance * direction` along `direction`. The roll of the sensor is
/// free, and the distance is free within its limits. World frame, metres.
struct ViewRequest {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();      ///< the point to look at (m)
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  ///< unit vector from the sensor to the target
  double distance = kViewDistance;                       ///< preferred distance from the sensor to the target (m)
  double distance_min = 0.28;                            ///< shortest distance (m)
  double distance_max = 0.55;                            ///< longest distance (m)
};

/// A view that the arm can take.
struct ReachableView {
  Pose world_T_optical = Pose::Identity();           ///< pose of the sensor
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< the point looked at, on the optical axis (m)
  std::optional<Joints> joints;                      ///< joint angles (rad); empty when the arm does not report them
  double move_time = 0.0;                            ///< duration of the move from the present joints (s); the
                                                     ///< default planner reads it only where joints are empty
  double gain = 0.0;                                 ///< what the planner expects to gain, in the planner's own unit
};

/// Answers a request with the view that the arm reaches soonest from its present joints `current` (rad), or with
/// nothing when the request is out of reach. The view has to look at the target along the direction; its roll is free,
/// and so is its distance, within the limits.
using Reach = std::function<std::optional<ReachableView>(const ViewRequest&, const Joints& current)>;

/// The state of a scan that a planner may read after each view: the merged cloud, and the views that made it.
struct Progress {
  const Cloud& cloud;                               ///< merged so far: points, views, and normals if known
  const std::vector<sensor::SurfaceImage>& images;  ///< surface image of each view; empty unless surfaces are fused
  const std::vector<View>& views;                   ///< taken so far
  const std::vector<Eigen::Vector3f>& added;        ///< points that the last view added (m)
  const std::vector<Eigen::Vector3f>& observed;     ///< all points that the last view showed (m)
  const Indices* kept = nullptr;  ///< points kept by the filter after the last view, as indices into the points from
                                  ///< before the view followed by `added`; null if no filter ran
  const MaskEvidence* masks = nullptr;  ///< evidence from the masks of the views so far; null without a detector
};

/// Decides where to look next.
class Planner {
 public:
  Planner() = default;
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;
  virtual ~Planner() = default;

  /// Update the planner after a view has been taken and merged. The pipeline never cancels this call.
  virtual void observe(const Progress& progress) = 0;

  /// The next view for an arm whose joints are at `current` (rad); nothing when no view is worth taking, see
  /// stop_reason(). Called again before observe() or refused(), from the same joints, it answers the same. When the
  /// call is cancelled, the next call answers as if the cancelled one had not been made.
  virtual std::optional<ReachableView> next(const Progress& progress, const Joints& current, const Reach& reach) = 0;

  /// Report that the view last returned could not be taken; the next call of `next` returns another.
  virtual void refused() = 0;

  /// Why `next` last returned nothing.
  virtual StopReason stop_reason() const = 0;

  /// How complete the scan is, as of the last call of `next`. Nothing when the planner has no model of the fruit's
  /// surface, or has not rated any view by it yet, as before points are seen. Without fruit, the shares are 0.
  virtual std::optional<Completeness> completeness() const { return std::nullopt; }

  /// The views that the last call of `next` compared and found worth taking, best first. Empty when the planner does
  /// not compare views.
  virtual std::vector<ReachableView> candidates() const { return {}; }
};

}  // namespace agrisee::plan
