// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Generates plants with foliage and objects that are not fruit; study/truss.hpp generates trusses of bare fruit. Each
/// plant has its ground truth and a workcell to scan it in. World frame: z points up, and the robot stands at the
/// origin and looks along +y. Metres. A plant usually takes about a second.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/study/truss.hpp>

#include <array>
#include <cstdint>
#include <string>

namespace agrisee::study {

/// The kinds of plants. `tomato`, `cherry` and `beefsteak` have trusses of tomatoes, `pepper` has bell peppers with
/// three or four lobes. `pear` and `apple` are upright branches with the fruit around them.
constexpr std::array<const char*, 7> kPlantKinds = {"tomato", "cherry",     "pepper", "beefsteak",
                                                    "pear",   "strawberry", "apple"};

/// Describes the plant to generate. The defaults are those of a tomato plant, see of().
struct PlantParameters {
  std::string kind = "tomato";     ///< one of kPlantKinds
  int total = 7;                   ///< number of fruit on all trusses together
  int trusses = 1;                 ///< number of trusses side by side; of main stems if these bear the fruit
  std::uint64_t seed = 1;          ///< equal parameters with equal seeds give equal plants
  double radius_shoulder = 0.036;  ///< half width of the first and largest fruit of a truss (m)
  double radius_tip = 0.010;       ///< half width of its last and smallest fruit (m)
  double foliage = 0.2;            ///< share of the fruit surface seen from frontal_eye() that leaves hide
  int leaves_behind = 4;           ///< number of leaves that hide nothing from there; fewer if there is no room
  bool trunk = false;              ///< whether a trunk with a fork and burls stands behind the plant
  int posts = 0;                   ///< number of posts beside the plant
  int wires = 0;                   ///< number of horizontal wires behind the plant
  int pots = 0;                    ///< number of pots on a bench; the plant grows in the first one
  Eigen::Vector3d center = {0.015, 0.545, 0.21};  ///< middle of the box around the fruit (m, world)

  /// The defaults; [1] has no leaves.
  static PlantParameters paper() { return {}; }
  /// The usual number and size of the fruit of a kind; else the defaults.
  /// @throws FieldError if there is no such kind
  static PlantParameters of(const std::string& kind);

  /// @throws ParameterError for the first field that is out of its range
  void check() const {
    check_fields(*this);
    check_parameter(center.allFinite(), "center", "finite", center.x());
  }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("kind", p.kind, OneOf(kPlantKinds));
    f("trusses", p.trusses, Range::between(1, 2));
    f("total", p.total,
      Range::between({static_cast<double>(p.trusses), "trusses"}, {12.0 * p.trusses, "12 for each truss"}));
    f("seed", p.seed);
    f("radius_tip", p.radius_tip, Range::between(0.008, 0.06).in_metres());
    f("radius_shoulder", p.radius_shoulder, Range::between({p.radius_tip, "radius_tip"}, 0.06).in_metres());
    f("foliage", p.foliage, Range::between(0.0, 0.6));
    f("leaves_behind", p.leaves_behind, Range::between(0, 8));
    f("trunk", p.trunk);
    f("posts", p.posts, Range::between(0, 3));
    f("wires", p.wires, Range::between(0, 4));
    f("pots", p.pots, Range::between(0, 2));
    f("center", p.center);
  }
};

/// A plant, ready to be scanned.
struct Plant {
  Workcell workcell;     ///< as of truss_workcell(); its name is empty
  Scene scene;           ///< the fruit with the ids 1, 2, ..., then the stems, the other objects, and the leaves
  GroundTruth truth;     ///< of every fruit, in ascending order of ids; a fruit counts as hidden below kHiddenBelow
  double foliage = 0.0;  ///< PlantParameters::foliage as it was reached
};

/// Generates a plant.
///
/// The fruit shrink from the shoulder of a truss to its tip. Their ids ascend from top to bottom, truss by truss. No
/// two fruit interpenetrate by more than 1 mm; no leaf passes through a fruit, a stem, another leaf or another object.
/// Leaves are closed blades 0.4 mm thick. Tomatoes have compound leaves of 5, 7 or 9 leaflets, peppers, pears and
/// apples shoots of 5 to 9 leaves, strawberries leaves of three leaflets. Leaves are added before the fruit until they
/// hide `foliage` of the surface that shows without them, to within 0.04.
/// @throws ParameterError if a parameter is out of range, or if no such plant was found
Plant make_plant(const PlantParameters& parameters);

}  // namespace agrisee::study
