// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ripeness of a fruit, as ripeness_of (cloud/ripeness.hpp) estimates it. The functions are
/// defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/types.hpp>

#include <cstddef>
#include <optional>
#include <string_view>

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

}  // namespace agrisee
