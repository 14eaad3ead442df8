// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the Surface Edge Explorer (SEE: Border & Gammell, ICRA 2018; SEE++: Border & Gammell, IJRR 2024) and
/// the values that follow from them. Metres, radians.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::see {

/// Number of points that a flat or spherical surface can hold within a distance r of one of its points, if no two are
/// nearer than epsilon: this factor times (r / epsilon)^2.
///
/// Keeping a new point only where no kept one is nearer than epsilon is random sequential adsorption of discs of
/// diameter epsilon. It jams when the discs cover 0.547 of the area (Feder, J. Theor. Biol. 87, 1980), which is
/// 0.547 / (pi epsilon^2 / 4) points per area. The part of a sphere within a chord r has the area pi r^2 of the flat
/// disc, whatever the sphere's radius.
constexpr double kSaturation = 4.0 * 0.547;

/// Parameters of density, frontiers and views. The names are those of SEE++.
struct Parameters {
  double rho = 2e6;                      ///< target density (points / m3)
  double radius = 0.04;                  ///< r: radius of the neighborhood in which density is measured (m)
  double separation = 0.0;               ///< epsilon: smallest distance of merged points (m); 0: see min_separation()
  double view_distance = kViewDistance;  ///< d: distance of a proposed view from its frontier point (m)
  int max_updates = 50;                  ///< tau: number of views that are updated in a step
  double psi = 0.5;                      ///< occluders count up to this distance along a sight line (m)
  double upsilon = 0.005;                ///< radius about a sight line that must be free of points (m)
  int max_views = 20;                    ///< largest number of views
  bool adjusted_first = true;         ///< a view that was adjusted or switched comes next; off: it competes as in SEE++
  bool renew_frames = true;           ///< frames of updated views are estimated anew; off: once, as in SEE++
  double min_move = 0.08;             ///< views nearer to an earlier one (m) come last; 0: as in SEE++
  bool outward_normals_only = false;  ///< only frontiers whose normals point away from the cloud's mean ([1], eq. 2)

  /// SEE++ as published: its own rule for the separation. Density, distances and tau are those of [1]. Three things are
  /// not as published: `adjusted_first` and `renew_frames` are on, and there is a `min_move`.
  static Parameters published() {
    Parameters p;
    p.separation = std::cbrt(3.0 * p.radius / (2.0 * kPi * p.rho));
    p.max_views = 50;
    return p;
  }

  /// The values of [1], table of parameters, and its test of normals. It gives no values for psi, upsilon and the
  /// number of views.
  static Parameters paper() {
    Parameters p = published();
    p.outward_normals_only = true;
    return p;
  }

  /// Number of points within `radius`, the point itself included, from which a point is a core point:
  /// ceil(4/3 pi r^3 rho) (SEE++). 0 if check() refuses radius or rho.
  std::size_t k() const {
    const bool valid = radius > 0.0 && rho > 0.0 && radius * radius * radius * rho < 1e8;
    return valid ? static_cast<std::size_t>(std::ceil(4.0 / 3.0 * kPi * radius * radius * radius * rho)) : 0;
  }

  /// Smallest distance epsilon (m) of the merged cloud's points: `separation` or, where that is 0, derived from radius
  /// and rho. Not finite where k() is 0.
  ///
  /// SEE++ uses (3 r / (2 pi rho))^(1/3), 2.12 mm with the values of [1]. Its unit is m^(4/3), so it suits one radius
  /// only. Here it is derived instead. On a saturated surface, a point has kSaturation (r / epsilon)^2 neighbors, and
  /// one at a straight edge has half of them. If k is two thirds of the first number, the inner point is core, the one
  /// at the edge is not, and a fifth of the points may be missing: epsilon = r sqrt(2/3 kSaturation / k). This is
  /// 2.08 mm with the defaults and means the same for every rho and r.
  double min_separation() const {
    return separation > 0.0 ? separation : radius * std::sqrt(2.0 / 3.0 * kSaturation / static_cast<double>(k()));
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("rho", p.rho, Range::positive());
    f("radius", p.radius, Range::positive().below({std::cbrt(1e8 / p.rho), "(1e8 / rho)^(1/3)"}));
    f("separation", p.separation, Range::not_negative());
    f("view_distance", p.view_distance, Range::positive());
    f("max_updates", p.max_updates, Range::at_least(1));
    f("psi", p.psi, Range::positive());
    f("upsilon", p.upsilon, Range::positive().from({p.psi / 1e5, "psi / 100000"}));
    f("max_views", p.max_views, Range::at_least(1));
    f("adjusted_first", p.adjusted_first);
    f("renew_frames", p.renew_frames);
    f("min_move", p.min_move, Range::not_negative());
    f("outward_normals_only", p.outward_normals_only);
  }
};

}  // namespace agrisee::see
