// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Generates tomato trusses with their ground truth, and a workcell to scan them in. World frame: z points up, and the
/// robot stands at the origin and looks along +y. Metres. A truss usually takes less than half a second.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/scene.hpp>
#include <agrisee/workcell.hpp>

#include <cstdint>

namespace agrisee::study {

/// Describes the truss to generate.
struct TrussParameters {
  int total = 7;                                  ///< number of fruit, 1 to 12
  int hidden = 1;                                 ///< how many of them hang behind the others, 0 to total / 2
  std::uint64_t seed = 1;                         ///< equal parameters with equal seeds give equal trusses
  double radius_min = 0.028;                      ///< smallest semi-axis of a fruit (m)
  double radius_max = 0.042;                      ///< largest semi-axis of a fruit, its lobes included (m)
  double elongation = 1.0;                        ///< stretches fruit along their stem axis; 1.5 gives plum tomatoes
  int leaflets = 0;                               ///< number of leaflets, 0 to 6
  Eigen::Vector3d center = {0.015, 0.545, 0.21};  ///< middle of the truss (m, world)

  /// The defaults, which are in the style of the trusses of [1].
  static TrussParameters paper() { return {}; }

  /// @throws ParameterError for the first field that is out of its range
  void check() const {
    check_fields(*this);
    check_parameter(center.allFinite(), "center", "finite", center.x());
  }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("total", p.total, Range::between(1, 12));
    f("hidden", p.hidden, Range::between(0, {static_cast<double>(p.total / 2), "half of total"}));
    f("seed", p.seed);
    f("radius_min", p.radius_min, Range::between(0.005, 0.06).in_metres());
    f("radius_max", p.radius_max, Range::between({p.radius_min, "radius_min"}, 0.06).in_metres());
    f("elongation", p.elongation, Range::between(0.5, 2.0));
    f("leaflets", p.leaflets, Range::between(0, 6));
    f("center", p.center);
  }
};

/// A truss, ready to be scanned.
struct Truss {
  Workcell workcell;  ///< robot, sensor, scan volume and keep-out; its name is empty
  Scene scene;        ///< the fruit with the ids 1, 2, ..., then the stem, then the leaflets
  GroundTruth truth;  ///< of every fruit, in ascending order of ids
};

/// A hidden fruit shows less than this share of its surface to frontal_eye(), at any angle of incidence.
constexpr double kHiddenBelow = 0.15;
/// Every other fruit shows at least this share of its surface to frontal_eye().
constexpr double kVisibleAbove = 0.27;

/// The camera position that decides which fruit are hidden: 0.38 m straight in front of the middle of the truss,
/// whether or not the arm can reach it (m, world).
/// @param truss_center middle of the truss (m, world)
Eigen::Vector3d frontal_eye(const Eigen::Vector3d& truss_center);

/// The workcell in which a truss is scanned. The robot stands at the origin. The scan volume encloses the fruit, and at
/// least a box of 0.34 x 0.32 x 0.44 m around the middle of the truss. The keep-out consists of the platform, the
/// plant, and a cylinder that keeps the sensor 0.25 m away from the truss; from a wide one up to 0.03 m less, as the
/// arm would start inside of a larger cylinder.
/// @param truss box around the fruit (m, world)
/// @param center middle of the truss (m, world)
Workcell truss_workcell(const Aabb& truss, const Eigen::Vector3d& center);

/// Generates a truss. `hidden` of its fruit are hidden from frontal_eye(), see kHiddenBelow and kVisibleAbove. No two
/// fruit interpenetrate by more than 1 mm. The ids ascend from top to bottom; the hidden fruit have the last ones.
/// @throws ParameterError if a parameter is out of range, or if no such truss was found
Truss make_truss(const TrussParameters& parameters);

}  // namespace agrisee::study
