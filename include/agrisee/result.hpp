// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a scan reports: views, stop reasons, fruit. All poses are in world (the UR3's base frame {M}) unless named
/// otherwise.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Why a scan ended.
enum class StopReason {
  not_stopped,        ///< it has not ended
  no_frontier,        ///< nothing is left that is worth seeing
  no_reachable_view,  ///< what is left cannot be seen from where the arm can go
  low_gain,           ///< the best reachable view promises less than the threshold
  max_views,          ///< the view budget is used up
  nothing_seen        ///< the first views returned no point inside the scan volume
};

/// Its name, as in run.json.
inline const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::not_stopped:
      return "not_stopped";
    case StopReason::no_frontier:
      return "no_frontier";
    case StopReason::no_reachable_view:
      return "no_reachable_view";
    case StopReason::low_gain:
      return "low_gain";
    case StopReason::max_views:
      return "max_views";
    case StopReason::nothing_seen:
      return "nothing_seen";
  }
  return "unknown";
}

/// A view that was taken.
struct View {
  Pose world_T_optical = Pose::Identity();           ///< as reported by the robot
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< observed point on the optical axis
  std::optional<Joints> joints;                      ///< absent without an arm
  std::size_t points_in = 0;                         ///< points returned inside the scan volume
  std::size_t points_new = 0;                        ///< points that the merged cloud kept
  double plan_seconds = 0.0;                         ///< time it took to choose this view
  bool discarded = false;                            ///< what it saw was not believed: see Pipeline::observe
};

/// A body fitted to a fruit: an ellipsoid.
struct Body {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();             ///< m, world
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();              ///< semi-axes (m), largest first
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();           ///< columns: directions of the semi-axes, right-handed
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();  ///< m2
  double rms = 0.0;                                             ///< root mean square distance of its points (m)
  double completeness = 0.0;                                    ///< share of its surface that was observed, 0..1
  double confidence = 0.0;                                      ///< 0..1
  double volume = 0.0;                                          ///< m3
  double volume_error = 0.0;                                    ///< its standard error (m3); 0 = not known
  double mass = 0.0;                                            ///< kg, through a density parameter
  double mass_error = 0.0;  ///< its standard error (kg), the density's included; 0 = not known
};

/// Whether a fruit can be picked, or what is in the way: of all directions of approach, what stopped the one that came
/// farthest. In the order in which an approach is tested.
enum class PickingReason {
  reachable,             ///< it can be picked
  not_tested,            ///< an approach is free, but no arm was asked whether it can reach it
  no_body,               ///< no body was fitted: where to grip is not known
  blocked_by_keep_out,   ///< every approach meets a space to keep out of
  blocked_by_fruit,      ///< every approach meets fruit that cannot be picked before
  out_of_reach,          ///< no joint angles within the limits put the tool at a pre-grasp pose
  arm_collision,         ///< the arm would meet a space to keep out of, or itself
  approach_interrupted,  ///< the arm can stand at a pre-grasp pose but not follow the straight approach
  arm_meets_fruit        ///< the arm would meet fruit that cannot be picked before
};

/// Its name, as in fruits.json.
inline const char* to_string(PickingReason reason) {
  switch (reason) {
    case PickingReason::reachable:
      return "reachable";
    case PickingReason::not_tested:
      return "not_tested";
    case PickingReason::no_body:
      return "no_body";
    case PickingReason::blocked_by_keep_out:
      return "blocked_by_keep_out";
    case PickingReason::blocked_by_fruit:
      return "blocked_by_fruit";
    case PickingReason::out_of_reach:
      return "out_of_reach";
    case PickingReason::arm_collision:
      return "arm_collision";
    case PickingReason::approach_interrupted:
      return "approach_interrupted";
    case PickingReason::arm_meets_fruit:
      return "arm_meets_fruit";
  }
  return "unknown";
}

/// How to pick a fruit: the tool moves straight from the pre-grasp pose along the direction towards the fruit's centre.
struct Picking {
  int order = 0;           ///< from 1 over all fruit of a result; those that cannot be picked come last
  bool reachable = false;  ///< it can be picked
  PickingReason reason = PickingReason::not_tested;     ///< if not, why
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, from pre-grasp to the centre; zero without a body
  Pose world_T_pre_grasp =
      Pose::Identity();          ///< of the tool: z along the direction (REP-103's optical frame); with a body
  std::optional<Joints> joints;  ///< at the pre-grasp pose, where it is reachable and the arm tells them
  std::vector<int> after;        ///< ids of the fruit that stand in the way and have to be picked before
};

/// A located fruit.
struct Fruit {
  int id = 0;                                          ///< from 1; the label of its points
  std::size_t points = 0;                              ///< number of its points
  std::string found_by;                                ///< `region_growing`, `dbscan` or a further method's name
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< mean of its points, world
  Eigen::Vector3d centroid_cluster = Eigen::Vector3d::Zero();  ///< the same in the cluster frame {R}
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();             ///< standard deviation of its points per world axis (m)
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();   ///< the pose frame's axes in world
  std::optional<Body> body;                                    ///< where one was fitted
  std::optional<Picking> picking;                              ///< where it was planned (plan/picking.hpp)

  /// The pose frame in world: origin at the centroid.
  Pose pose() const {
    Pose p = Pose::Identity();
    p.linear() = orientation;
    p.translation() = centroid;
    return p;
  }
};

/// How much of the fruit's surface a planner believes to have been seen, and that the arm can see at all: shares of the
/// surface of the bodies that it knows of, 0..1. Nothing true is read for it.
struct Completeness {
  /// Of one body.
  struct Part {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m, world
    double seen = 0.0;                                 ///< share of its surface that points cover
    double observable = 0.0;  ///< the same once everything that the arm can still see has been seen
  };
  std::vector<Part> fruits;  ///< in the planner's own order
  double seen = 0.0;         ///< of all bodies
  double observable = 0.0;   ///< of all bodies

  /// Share of what can be seen that has been seen; 0 when nothing can.
  double of_observable() const { return observable > 0.0 ? seen / observable : 0.0; }
};

/// Seconds of computing per stage. `total` is all of it but the simulated sensor's `capture`.
struct Timing {
  double capture = 0.0;  ///< the simulated sensor's
  double plan = 0.0;     ///< choosing views
  double fuse = 0.0;     ///< merging them
  double filter = 0.0;   ///< outlier removal
  double normals = 0.0;  ///< where they had to be estimated
  double segment = 0.0;  ///< splitting into fruit
  double locate = 0.0;   ///< bodies, poses, picking
  double total = 0.0;    ///< all but `capture`

  /// f(name, field) for every stage.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("capture", p.capture);
    f("plan", p.plan);
    f("fuse", p.fuse);
    f("filter", p.filter);
    f("normals", p.normals);
    f("segment", p.segment);
    f("locate", p.locate);
    f("total", p.total);
  }
};

/// Everything that a scan, or the processing of a ready cloud, leaves behind.
struct ScanResult {
  std::vector<View> views;                           ///< in the order in which they were taken
  StopReason stop_reason = StopReason::not_stopped;  ///< why there are no more
  Cloud raw;                                         ///< the merged cloud before any filtering; `views` filled
  Cloud cloud;                                       ///< the consolidated cloud: points, normals, views (world)
  Labels labels;                                     ///< one per point of `cloud`: the fruit's id, or 0
  std::vector<Fruit> fruits;                         ///< from the top of the truss down
  std::optional<Completeness> completeness;  ///< as the planner believes; absent where it does not reckon with surfaces
  Timing seconds;                            ///< of computing
};

}  // namespace agrisee
