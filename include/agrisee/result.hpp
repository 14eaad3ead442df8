// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a scan reports: views, stop reasons, fruit. All poses are in world (Workcell::world_T_base says where the arm
/// stands in it; in [1] it is the arm's base frame {M}) unless named otherwise.
#pragma once

#include <agrisee/cloud/body_counts.hpp>
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/stop_reason.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Why a view is not part of the map.
enum class DiscardReason {
  none,                ///< it is part of the map
  repeated_frame,      ///< its frame repeats the one before bit for bit: the camera is stuck
  contradicts_others,  ///< it puts surface where other views looked through, or the reverse: its pose is wrong
};

/// Its name, as in run.json.
inline const char* to_string(DiscardReason reason) {
  switch (reason) {
    case DiscardReason::none:
      return "none";
    case DiscardReason::repeated_frame:
      return "repeated_frame";
    case DiscardReason::contradicts_others:
      return "contradicts_others";
  }
  return "unknown";
}

/// A view that was taken.
struct View {
  Pose world_T_optical = Pose::Identity();           ///< as reported by the robot
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< observed point on the optical axis
  std::optional<Joints> joints;                      ///< absent without an arm
  double median_depth = 0.0;     ///< of the frame (m), inside the scan volume or not; 0 = no return, or unknown
  double volume_distance = 0.0;  ///< from the sensor to the middle of the scan volume (m); 0 = unknown
  std::size_t points_in = 0;     ///< number of points measured inside the scan volume
  std::size_t points_new = 0;    ///< number of these that the merged cloud kept
  double plan_seconds = 0.0;     ///< time it took to choose this view
  bool discarded = false;        ///< the view was rejected and is not part of the map
  DiscardReason discard_reason = DiscardReason::none;  ///< why it was discarded
};

/// The body of a fruit as an ellipsoid: the one fitted to its points or, if they contradict it, the one with the center
/// of volume and the second moments of its closed surface (cloud/closed_surface.hpp).
struct Body {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();             ///< m, world
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();              ///< semi-axes (m), largest first
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();           ///< columns: directions of the semi-axes, right-handed
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();  ///< m2
  /// The part of center_covariance due to the unknown shape of the unseen side; the rest is due to the sensor (m2).
  Eigen::Matrix3d center_covariance_by_shape = Eigen::Matrix3d::Zero();
  double rms = 0.0;           ///< root mean square distance of its points from the surface (m)
  double completeness = 0.0;  ///< share of its surface that was observed, 0..1
  double confidence = 0.0;    ///< probability that it is a fruit, 0..1
  double volume = 0.0;        ///< m3
  double volume_error = 0.0;  ///< standard error of the volume (m3); 0 = unknown
  /// The part of volume_error due to the unknown shape of the unseen side; the rest is due to the sensor (m3).
  double volume_error_by_shape = 0.0;
  double mass = 0.0;        ///< kg, with the density of MassParameters
  double mass_error = 0.0;  ///< standard error of the mass (kg), including that of the density; 0 = unknown
};

/// Whether a fruit can be picked, or what prevents it. Each direction of approach is tested in this order; the reason
/// is that of the direction that passed most tests.
enum class PickingReason {
  reachable,                ///< it can be picked
  not_tested,               ///< an approach is free, but there is no arm model to ask whether it can be reached
  no_body,                  ///< no body was fitted, so it is unknown where to grip
  blocked_by_keep_out,      ///< every approach meets a space to keep out of
  blocked_by_surroundings,  ///< every approach crosses more than `picking.max_crossed` of what was measured
  blocked_by_fruit,         ///< every approach meets fruit that cannot be picked first
  out_of_reach,             ///< no joint angles within the limits put the tool at a pre-grasp pose
  arm_collision,            ///< the arm would meet a space to keep out of, or itself
  approach_interrupted,     ///< the arm can stand at a pre-grasp pose but not follow the straight approach
  arm_meets_fruit           ///< the arm would meet fruit that cannot be picked first
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
    case PickingReason::blocked_by_surroundings:
      return "blocked_by_surroundings";
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

/// How to pick a fruit: the tool moves straight from the pre-grasp pose along the direction towards the fruit's center.
struct Picking {
  int order = 0;           ///< from 1 over all fruit of a result; those that cannot be picked come last
  bool reachable = false;  ///< the fruit can be picked
  PickingReason reason = PickingReason::not_tested;     ///< why it cannot be picked, if so
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, from pre-grasp to the center; zero without a body
  Pose world_T_pre_grasp = Pose::Identity();  ///< of the tool, z along `direction`; identity if the fruit has no body
  std::optional<Joints> joints;  ///< at the pre-grasp pose (rad), if it is reachable and the arm model gives them
  std::vector<int> after;        ///< ids of the fruit that are in the way and must be picked first
  /// Measured surface of stems, leaves, trays and other things that are no fruit in the space that the gripper sweeps
  /// (m2); zero if the fruit has no body or nothing was measured there.
  double crossed = 0.0;
};

/// A located fruit.
struct Fruit {
  int id = 0;                                                  ///< from 1; the label of its points
  int truss = 1;                                               ///< number of the truss that it hangs on, from 1
  std::size_t points = 0;                                      ///< number of its points
  std::string found_by;                                        ///< the stage that found it, as in fruits.json
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();          ///< mean of its points, world
  Eigen::Vector3d centroid_cluster = Eigen::Vector3d::Zero();  ///< centroid in the cluster frame {R}
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();             ///< standard deviation of its points per world axis (m)
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();   ///< the pose frame's axes in world
  std::optional<Body> body;                                    ///< the fitted body, if any
  std::optional<Picking> picking;                              ///< the approach, if planned (pick/picking.hpp)
  std::optional<Ripeness> ripeness = {};                       ///< if the cloud has colors
  std::optional<double> growth_axis_error = {};  ///< standard deviation (rad) of the orientation's z as the
                                                 ///< direction to the calyx; none if it is not that

  /// Position of the fruit (m, world): the center of its body if one was fitted, else the centroid of its points.
  const Eigen::Vector3d& position() const { return body ? body->center : centroid; }
  /// position() in the cluster frame {R} (m).
  Eigen::Vector3d position_cluster() const { return centroid_cluster + (position() - centroid); }
  /// The pose of the fruit in world, for a gripper: origin at position(), axes of the pose frame.
  Pose pose() const { return pose_at(position()); }
  /// The pose frame of [1] in world: origin at the centroid of the points that were seen, up to half a radius nearer to
  /// the sensor than the fruit's center; axes as those of pose().
  Pose centroid_pose() const { return pose_at(centroid); }

 private:
  Pose pose_at(const Eigen::Vector3d& origin) const {
    Pose p = Pose::Identity();
    p.linear() = orientation;
    p.translation() = origin;
    return p;
  }
};

/// A truss: fruit that hang close to one another (see `truss_gap` of Parameters).
struct FoundTruss {
  int id = 0;               ///< from 1, from the top down by their highest fruit
  std::vector<int> fruits;  ///< ids of its fruit, from the top down
  /// The growth frame in world. Origin: the mean position of its fruit. z: the direction along which its fruit hang,
  /// upwards; if no direction stands out, their mean growth axis. x: as near to the x axis of world as z allows.
  Pose world_T_truss = Pose::Identity();
  std::optional<Ripeness> ripeness = {};  ///< of the surface of all its fruit, if the cloud has colors
};

/// The planner's estimate of how much of the fruit's surface has been seen and how much the arm can see at all: shares
/// (0..1) of the surface of the bodies found so far. No ground truth is used.
struct Completeness {
  /// The estimate for one body.
  struct Part {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m, world
    double seen = 0.0;                                 ///< share of its surface that points cover
    double observable = 0.0;                           ///< share that points can cover, from all views in reach
  };
  std::vector<Part> fruits;  ///< in the planner's order of bodies
  double seen = 0.0;         ///< of all bodies
  double observable = 0.0;   ///< of all bodies

  /// Share of what can be seen that has been seen; 0 when nothing can.
  double of_observable() const { return observable > 0.0 ? seen / observable : 0.0; }
};

/// Seconds of computing per stage.
struct Timing {
  double capture = 0.0;  ///< taken by the simulated sensor; not part of `total`
  double plan = 0.0;     ///< choosing views
  double fuse = 0.0;     ///< reconstructing, registering and merging frames
  double filter = 0.0;   ///< outlier removal
  double normals = 0.0;  ///< estimating missing normals
  double segment = 0.0;  ///< segmentation into fruit
  double locate = 0.0;   ///< bodies, poses, picking
  double total = 0.0;    ///< everything except `capture`

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

/// The result of a scan, or of processing a ready cloud.
struct ScanResult {
  std::vector<View> views;                                   ///< in the order in which they were taken
  StopReason stop_reason = StopReason::not_stopped;          ///< why the scan ended
  Cloud raw;                                                 ///< the merged cloud before any filtering; `views` filled
  Cloud cloud;                                               ///< the consolidated cloud: points, normals, views (world)
  Labels labels;                                             ///< one per point of `cloud`: the fruit's id, or 0
  Eigen::Vector3d cluster_origin = Eigen::Vector3d::Zero();  ///< origin of the cluster frame {R} (m, world)
  std::vector<Fruit> fruits;                                 ///< truss by truss, each from the top down
  std::vector<FoundTruss> trusses;                           ///< from the top down by their highest fruit
  std::optional<Completeness> completeness;                  ///< the planner's estimate; empty if it makes none
  Timing seconds;                                            ///< computing time
  std::vector<std::string> warnings;  ///< sentences about input that should be checked; see also discarded_views()
  BodyCounts bodies;                  ///< how many proposed bodies were taken as fruit or rejected
};

/// How many of some views were discarded, and what is likely wrong, in one sentence without a full stop; empty if none
/// was. Views are numbered from 0, as in views.csv. Defined in `agrisee::agrisee`.
std::string discarded_views(const std::vector<View>& views);

/// Why a result has no fruit, as far as it is known, in one sentence without a full stop: whether anything was seen,
/// and by which tests the proposed bodies failed. Empty if it has fruit. Defined in `agrisee::agrisee`.
std::string why_no_fruit(const ScanResult& result);

}  // namespace agrisee
