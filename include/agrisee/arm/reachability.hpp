// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds joint angles with which the arm can take a view: within the limits, without collisions, and those that the arm
/// reaches soonest from its present posture.
///
/// The caller gives either a full sensor pose, or a target point and a viewing direction. In the second case roll and
/// distance are free, as in the controller of [1]; with a fixed distance and roll most views would be out of a UR3's
/// reach. Only the posture is checked, not the path to it. World frame; metres, rad, seconds. A view takes a few
/// microseconds if the optical axis is the axis of the last joint, otherwise about 60 us with 24 rolls.
/// Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/arm/collision.hpp>
#include <agrisee/core/parameter_range.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace agrisee::arm {

/// Which distances and rolls a view may have.
struct ReachParameters {
  double distance = kViewDistance;  ///< preferred distance from the sensor to the target (m)
  double distance_min = 0.28;       ///< shortest distance (m)
  double distance_max = 0.55;       ///< longest distance (m)
  double distance_step = 0.02;      ///< step between the distances that are tried (m)
  int rolls = 24;                   ///< number of evenly spaced rolls about the optical axis that are tried

  /// The values of [1]: exactly the view distance.
  static ReachParameters paper() {
    ReachParameters p;
    p.distance_min = p.distance_max = p.distance;
    return p;
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// Calls f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("distance", p.distance, Range::between({p.distance_min, "distance_min"}, {p.distance_max, "distance_max"}));
    f("distance_min", p.distance_min, Range::positive());
    f("distance_max", p.distance_max, Range::finite());
    f("distance_step", p.distance_step, Range::at_least(1e-4));
    f("rolls", p.rolls, Range::at_least(1));
  }
};

/// A view that the arm can take.
struct Reached {
  Joints joints = Joints::Zero();           ///< joint angles (rad), within the limits and nearest to the present ones
  Pose world_T_optical = Pose::Identity();  ///< pose of the sensor
  double distance = 0.0;                    ///< from the sensor to the target (m); 0 if the request was a pose
  double move_time = 0.0;                   ///< duration of the move from the present joints (s), see arm::move_time
};

/// The distances to try (m): the preferred one, then alternately a step farther and a step nearer, up to the longest
/// and the shortest distance.
std::vector<double> distances_to_try(const ReachParameters& p);

/// Joint angles that put the sensor at world_T_optical. Of all solutions without collisions it is the one that is
/// reached soonest from `present` (shortest move time, then smallest joint distance, then the order of `inverse`);
/// nothing if there is none.
/// @throws InputError if the pose is not rigid or `present` is not finite; ParameterError if the mount is invalid
std::optional<Reached> reach(const Mount& mount, const Joints& present, const Pose& world_T_optical);

/// Joint angles for a view of `target` (m) along `direction` (from the sensor to the target, of any length). The roll
/// is free, and the distance is free within the limits of the parameters.
///
/// Distances are tried in the order of distances_to_try, until the arm has a posture without collisions at one. Of all
/// rolls and solutions at that distance, the one that is reached soonest from `present` is returned (shortest move
/// time, then smallest joint distance, then the order of the rolls, which starts with an upright image, then that of
/// `inverse`); nothing if there is none.
/// @throws InputError if target, direction or `present` is not finite or the direction is zero; ParameterError if the
///   mount or the parameters are invalid
std::optional<Reached> reach(const Mount& mount, const Joints& present, const Eigen::Vector3d& target,
                             const Eigen::Vector3d& direction, const ReachParameters& parameters = {});

}  // namespace agrisee::arm
