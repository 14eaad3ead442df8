// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How ripe a fruit is by the measured colours of its surface. Colours are compared in CIELAB (CIE 15:2004; sRGB and
/// D65 by IEC 61966-2-1). Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/color.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/ripeness.hpp>
#include <agrisee/core/types.hpp>

#include <optional>
#include <vector>

namespace agrisee {

/// Parameters of ripeness_of.
struct RipenessParameters {
  double ripe_hue = deg(70);  ///< surface of a smaller hue angle (rad) is ripe; in CIELAB red is at 0.6, yellow at 1.6,
                              ///< green at 2.1
  double hue_error = deg(8);  ///< standard deviation of a hue angle by white balance and shade (rad)
  double min_chroma = 8.0;    ///< surface of less chroma (CIELAB) has no hue: it is left out of the share
  double trim = 0.15;         ///< this share of the points, the brightest (highlights), and as many of the darkest
                              ///< (shade), are left out of the mean color
  double breakers = 0.01;     ///< from this share of ripe surface on a fruit is no longer green
  double turning = 0.10;      ///< from here on it is of the class turning
  double pink = 0.30;         ///< from here on pink
  double light_red = 0.60;    ///< from here on light red
  double red = 0.90;          ///< from here on red

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("ripe_hue", p.ripe_hue, Range::above(0.0).below({kPi, "pi"}).in_radians());
    f("hue_error", p.hue_error, Range::positive());
    f("min_chroma", p.min_chroma, Range::not_negative());
    f("trim", p.trim, Range::at_least(0.0).below(0.5));
    f("breakers", p.breakers, Range::between(0.0, 1.0));
    f("turning", p.turning, Range::between({p.breakers, "breakers"}, 1.0));
    f("pink", p.pink, Range::between({p.turning, "turning"}, 1.0));
    f("light_red", p.light_red, Range::between({p.pink, "pink"}, 1.0));
    f("red", p.red, Range::between({p.light_red, "light_red"}, 1.0));
  }
};

/// A colour in CIELAB: L* from 0 to 100, a* and b*; white point D65.
Eigen::Vector3d to_lab(const Rgb& color);

/// The hue angle (rad) of a colour in CIELAB, -pi/2..3 pi/2: blue counts as far from red.
double hue_of(const Eigen::Vector3d& lab);

/// Linear light (0..1) of a channel of sRGB (0..1), IEC 61966-2-1.
double linear_light(double channel);

/// The class of a fruit of which this share (0..1) of the surface is ripe.
RipenessClass class_of(double ripe_share, const RipenessParameters& parameters = {});

/// How ripe the surface with these colours is.
///
/// Each point that has a hue is ripe to the degree to which that is surely below `ripe_hue` (a normal distribution of
/// width `hue_error`). The error of the share has two parts: what has been seen may not be like the rest, as if the
/// surface had 12 patches of which `seen` were drawn, and a common error of all hues by half of `hue_error`. The
/// brightest and darkest points are left out of the mean color (`trim`).
/// @param colors of points that are evenly spread over what was seen of the surface
/// @param seen   share (0..1) of the surface that was seen
/// @return empty for fewer than 8 colours, or if none has a hue
/// @throws FieldError
std::optional<Ripeness> ripeness_of(const std::vector<Rgb>& colors, double seen,
                                    const RipenessParameters& parameters = {});

}  // namespace agrisee
