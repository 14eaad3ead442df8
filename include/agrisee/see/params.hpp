// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the Surface Edge Explorer (SEE: Border & Gammell, ICRA 2018; SEE++: Border & Gammell, IJRR 2024) and
/// what follows from them. Metres, radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::see {

/// Points that a flat or spherical surface holds within a chord r at saturation, times (epsilon / r)^2.
///
/// Keeping a new point only where no kept one is nearer than epsilon is random sequential adsorption of discs of
/// diameter epsilon, which jams at a covered share of 0.547 (Feder, J. Theor. Biol. 87, 1980): 0.547 / (pi epsilon^2 /
/// 4) points per area. A sphere's cap within a chord r has the area pi r^2 of the flat disc, whatever the sphere's
/// radius.
constexpr double kSaturation = 4.0 * 0.547;

/// Parameters of density, frontiers and views.
struct Parameters {
  double rho = 2e6;                ///< target density (points / m3), > 0
  double radius = 0.04;            ///< r: neighbourhood of the density (m), > 0
  double separation = 0.0;         ///< epsilon (m); 0 = derived, see min_separation()
  double view_distance = 0.38;     ///< d: of a proposed view from its frontier point (m), > 0
  int max_updates = 50;            ///< tau: frontiers whose views are updated in a step, > 0
  double psi = 0.5;                ///< how far along a sight line occluders count (m), > 0
  double upsilon = 0.005;          ///< radius that a sight line must be free of points (m), > 0
  double max_incidence = deg(80);  ///< largest angle between a frontier's normal and the line to a view of it (rad)
  double least_move = 0.1;         ///< shorter moves (m) count as this long when gain is weighed against motion, > 0
  int max_views = 20;              ///< view budget, > 0
  int min_gain = 0;                ///< a view must see this many of the updated frontiers; 0 = take any
  int max_shifts = 3;              ///< how often the view of a stubborn frontier is shifted before falling back, >= 0
  int max_pulls = 3;  ///< how often an unreachable view is turned towards where its point was seen from, >= 0
  bool return_to_first_view = false;  ///< before a frontier is given up, look again from where it was first seen
  double give_up_radius = 0.01;       ///< frontiers this near to one that is given up are given up with it (m), >= 0
  bool outward_normals_only = false;  ///< only frontiers whose normal points away from the cloud's mean (paper, eq. 2)

  /// Values of the paper (Table of parameters); psi, upsilon and the view budget, of which it gives none, as in SEE++.
  static Parameters paper() {
    Parameters p;
    p.separation = std::cbrt(3.0 * p.radius / (2.0 * kPi * p.rho));
    p.max_incidence = deg(90);
    p.least_move = p.upsilon;
    p.max_views = 50;
    p.return_to_first_view = true;
    p.give_up_radius = 0.0;
    p.outward_normals_only = true;
    return p;
  }

  /// Neighbours within `radius`, the point itself included, that make a core point: ceil(4/3 pi r^3 rho) (SEE++).
  /// 0 of a radius and rho that check() refuses.
  std::size_t k() const {
    const bool valid = radius > 0.0 && rho > 0.0 && radius * radius * radius * rho < 1e8;
    return valid ? static_cast<std::size_t>(std::ceil(4.0 / 3.0 * kPi * radius * radius * radius * rho)) : 0;
  }

  /// Minimum separation epsilon (m) of the merged cloud's points.
  ///
  /// SEE++ takes (3 r / (2 pi rho))^(1/3), 2.12 mm in the paper's setting, whose unit is m^(4/3): it fits one radius
  /// only. Derived here instead: a saturated surface has kSaturation (r / epsilon)^2 neighbours inside and half of them
  /// at a straight edge. With k at two thirds the one is core and the other is not, and a fifth of the points may be
  /// missing: epsilon = r sqrt(2/3 kSaturation / k), which is 2.08 mm here and keeps its meaning for every rho and r.
  /// Not finite where k() is 0.
  double min_separation() const {
    return separation > 0.0 ? separation : radius * std::sqrt(2.0 / 3.0 * kSaturation / static_cast<double>(k()));
  }

  /// @throws ParameterError naming the first field out of its range
  void check() const {
    const auto positive = [](double x, const char* field) {
      check_parameter(std::isfinite(x) && x > 0.0, field, "positive and finite", x);
    };
    const auto not_negative = [](double x, const char* field) {
      check_parameter(std::isfinite(x) && x >= 0.0, field, "zero or more and finite", x);
    };
    positive(rho, "rho");
    positive(radius, "radius");
    check_parameter(radius * radius * radius * rho < 1e8, "rho", "below 1e8 / radius^3", rho);
    not_negative(separation, "separation");
    positive(view_distance, "view_distance");
    check_parameter(max_updates > 0, "max_updates", "positive", max_updates);
    positive(psi, "psi");
    positive(upsilon, "upsilon");
    check_parameter(psi <= 1e5 * upsilon, "upsilon", "at least psi / 100000", upsilon);
    check_parameter(max_incidence > 0.0 && max_incidence <= 0.5 * kPi, "max_incidence", "in (0, pi/2]", max_incidence);
    positive(least_move, "least_move");
    check_parameter(max_views > 0, "max_views", "positive", max_views);
    check_parameter(min_gain >= 0, "min_gain", "zero or more", min_gain);
    check_parameter(max_shifts >= 0 && max_shifts <= 20, "max_shifts", "0 to 20", max_shifts);
    check_parameter(max_pulls >= 0 && max_pulls <= 100, "max_pulls", "0 to 100", max_pulls);
    not_negative(give_up_radius, "give_up_radius");
  }

  /// Call f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("rho", p.rho);
    f("radius", p.radius);
    f("separation", p.separation);
    f("view_distance", p.view_distance);
    f("max_updates", p.max_updates);
    f("psi", p.psi);
    f("upsilon", p.upsilon);
    f("max_incidence", p.max_incidence);
    f("least_move", p.least_move);
    f("max_views", p.max_views);
    f("min_gain", p.min_gain);
    f("max_shifts", p.max_shifts);
    f("max_pulls", p.max_pulls);
    f("return_to_first_view", p.return_to_first_view);
    f("give_up_radius", p.give_up_radius);
    f("outward_normals_only", p.outward_normals_only);
  }
};

}  // namespace agrisee::see
