// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where to put the robot: what its arm could observe from places around the present one. World frame, metres. Cost:
/// about a third of a second per place on one core, nearly all of it ray casting.
#pragma once

#include <agrisee/study/limit.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::study {

/// Which places are tried, and how thoroughly.
struct BaseSearchParameters {
  double range = 0.3;              ///< the base is moved by up to this along world's x and y, either way (m)
  double step = 0.1;               ///< distance between neighboring places (m)
  double share = 0.95;             ///< share of the observable surface for which views are counted
  LimitParameters limit = {1000};  ///< which poses are tried at each place: fewer than for a single place

  /// [1] does not search for a place; these are the defaults.
  static BaseSearchParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range for a struct.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("range", p.range, Range::not_negative());
    f("step", p.step, Range::positive().from({p.range / 50.0, "range / 50"}));
    f("share", p.share, Range::above(0.0).up_to(1.0));
    f("limit", p.limit);
  }
};

/// What the arm could observe from one place.
struct BasePlace {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< origin of the base (m, world)
  bool present = false;                            ///< this is where the robot stands now
  std::string blocked_by;                          ///< name of the solid that the base would stand in
  bool blocked = false;              ///< the base would stand in a solid; the figures below are not computed
  std::size_t poses = 0;             ///< sensor poses within reach that see any of the fruit
  double observable = 0.0;           ///< share of the samples that any of these poses sees
  double least = 0.0;                ///< the same share of the fruit that is seen least
  std::optional<std::size_t> views;  ///< number of greedy views, the first frontal, that cover `share` of what is
                                     ///< observable; none if nothing is
};

/// True for a solid that the robot stands on: it contains the point 5 cm below the origin of the base, along the base's
/// z axis, or the origin itself (a thin plate).
bool stands_on(const Workcell& cell, const KeepOut& space);

/// A workcell whose robot is moved together with everything that it stands on (see stands_on()). All else stays.
/// @param cell the present workcell
/// @param shift m, world
Workcell with_base_moved(const Workcell& cell, const Eigen::Vector3d& shift);

/// What the arm could observe from places on a grid around the present one, along world's x and y.
///
/// The base keeps its z and its rotation, and the scan volume stays. A place is blocked if the base's origin would lie
/// inside a solid that stays. The figures of the present place are those of observable() with the same parameters.
/// @param scene what hides samples
/// @param samples of the fruit's surface
/// @param cell arm, camera and keep-out spaces
/// @param parameters which places are tried
/// @param threads number of threads, which share the places; the result does not depend on it
/// @return best first: by observable share, then least share of a fruit, nearness to the present place, x, and y;
///   blocked places last
/// @throws ParameterError, also if the arm's mount is not valid
std::vector<BasePlace> base_search(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                                   const BaseSearchParameters& parameters = {}, int threads = 1);

}  // namespace agrisee::study
