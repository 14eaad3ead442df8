// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Ripeness of a fruit from the measured colors of its surface, in CIELAB (CIE 15:2004; sRGB and D65 by
/// IEC 61966-2-1). Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace agrisee {

/// The six classes of tomatoes in the United States Standards for Grades of Fresh Tomatoes, 7 CFR 51.1860.
enum class RipenessClass {
  green,      ///< the surface is completely green
  breakers,   ///< it has begun to turn to tannish-yellow, pink or red, on not more than 10 percent
  turning,    ///< more than 10 and not more than 30 percent have turned
  pink,       ///< more than 30 and not more than 60 percent
  light_red,  ///< more than 60 and not more than 90 percent
  red         ///< more than 90 percent
};

/// Number of classes.
constexpr std::size_t kRipenessClasses = 6;

/// The name of a class, as in fruits.json.
const char* to_string(RipenessClass ripeness);

/// The class of that name; empty for any other text.
std::optional<RipenessClass> ripeness_named(std::string_view name);

/// The ripeness of a fruit or a truss.
struct Ripeness {
  Eigen::Vector3d lab = Eigen::Vector3d::Zero();  ///< mean color of the points used: L*, a*, b*
  double hue = 0.0;                            ///< its hue angle (rad) from red (a*) towards yellow (b*), -pi/2..3 pi/2
  double hue_error = 0.0;                      ///< its standard error (rad)
  double ripe_share = 0.0;                     ///< share (0..1) of the surface that is ripe
  double ripe_share_error = 0.0;               ///< its standard error
  RipenessClass grade = RipenessClass::green;  ///< the class of that share
  double probability = 0.0;                    ///< of the class, given the error of the share
  std::size_t points = 0;                      ///< number of colored points used
};

/// Parameters of ripeness_of.
struct RipenessParameters {
  double ripe_hue = deg(70);  ///< surface with a smaller hue angle (rad) is ripe; in CIELAB red is at 0.6, yellow at
                              ///< 1.6, green at 2.1
  double hue_error = deg(8);  ///< standard deviation of a hue angle due to white balance and shade (rad)
  double min_chroma = 8.0;    ///< surface with less chroma (CIELAB) has no hue and is left out of the share
  double trim = 0.15;         ///< share of the points, the brightest (highlights) and again the darkest (shade), that
                              ///< is left out of the mean color
  double breakers = 0.01;     ///< ripe share above which a fruit is of the class breakers
  double turning = 0.10;      ///< ripe share above which it is turning
  double pink = 0.30;         ///< ripe share above which it is pink
  double light_red = 0.60;    ///< ripe share above which it is light red
  double red = 0.90;          ///< ripe share above which it is red

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("ripe_hue", p.ripe_hue, Range::above(0.0).below({kPi, "pi"}).in_radians());
    f("hue_error", p.hue_error, Range::above(0.0).up_to({kPi, "pi"}).in_radians());
    f("min_chroma", p.min_chroma, Range::not_negative());
    f("trim", p.trim, Range::at_least(0.0).below(0.5));
    f("breakers", p.breakers, Range::between(0.0, 1.0));
    f("turning", p.turning, Range::between({p.breakers, "breakers"}, 1.0));
    f("pink", p.pink, Range::between({p.turning, "turning"}, 1.0));
    f("light_red", p.light_red, Range::between({p.pink, "pink"}, 1.0));
    f("red", p.red, Range::between({p.light_red, "light_red"}, 1.0));
  }
};

/// A color in CIELAB: L* from 0 to 100, a* and b*; white point D65.
Eigen::Vector3d to_lab(const Rgb& color);

/// The hue angle (rad) of a color in CIELAB, -pi/2..3 pi/2: blue counts as far from red.
double hue_of(const Eigen::Vector3d& lab);

/// Linear light (0..1) of a channel of sRGB (0..1), IEC 61966-2-1.
double linear_light(double channel);

/// The class of a fruit of which this share (0..1) of the surface is ripe. A share that is just a limit, such as
/// `turning`, still belongs to the class below it.
/// @throws InputError for NaN
RipenessClass class_of(double ripe_share, const RipenessParameters& parameters = {});

/// The ripeness of a surface with these colors.
///
/// Each point with a hue counts as ripe with the probability that its true hue is below `ripe_hue` (a normal
/// distribution with the standard deviation `hue_error`). The error of the share has two parts: the unseen surface may
/// differ from the seen one, as if `seen` of 12 patches had been drawn at random, and all hues may be off together by
/// half of `hue_error`. The brightest and darkest points are left out of the mean color (`trim`).
/// @param colors of points spread evenly over the part of the surface that was seen
/// @param seen   share (0..1) of the surface that was seen
/// @return empty if there are fewer than 8 colors, or none with a hue
/// @throws InputError unless `seen` is from 0 to 1; FieldError
std::optional<Ripeness> ripeness_of(const std::vector<Rgb>& colors, double seen,
                                    const RipenessParameters& parameters = {});

}  // namespace agrisee
