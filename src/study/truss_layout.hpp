// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decides where the fruit of a generated truss hang. Those in front hang in two rows along the rachis (herringbone)
/// and touch each other; the hidden ones hang behind them, as seen from frontal_eye(). World frame: z points up, and
/// the robot looks along +y. Metres. A dozen fruit take some tens of milliseconds.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/study/truss.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include <cstddef>
#include <vector>

namespace agrisee::study {

/// A fruit in its place.
struct PlacedFruit {
  FruitShape shape;                      ///< its shape in the body frame
  Pose world_T_body = Pose::Identity();  ///< the z axis is the growth axis
  bool hidden = false;                   ///< whether it hangs behind the others
  std::vector<Eigen::Vector3d> surface;  ///< points all over its surface (m), relative to its origin, in world axes

  /// The origin of its body frame (m, world).
  Eigen::Vector3d center() const { return world_T_body.translation(); }
  /// Depth (m) of a point (m, world) below the surface, measured along the radius; negative outside.
  double depth(const Eigen::Vector3d& p) const;
};

/// Puts a fruit at `center` (m, world), its calyx along `axis` (of any length but zero), turned about that by `turn`
/// (rad).
/// @param around, rows how many points its surface gets: around the axis, and from pole to pole
PlacedFruit place_fruit(const FruitShape& shape, const Eigen::Vector3d& center, const Eigen::Vector3d& axis,
                        double turn, int around, int rows);

/// Interpenetration depth of two fruit (m): the largest depth() of a point of either surface below the other. Depth
/// along the radius is never less than the true depth, so only the spacing of the points can make the result too small.
/// A negative result is roughly the gap between the fruit; it is never below -`far`.
double interpenetration(const PlacedFruit& a, const PlacedFruit& b, double far = 0.01);

/// The fruit of a truss and the rachis they hang from.
struct TrussLayout {
  std::vector<PlacedFruit> fruits;                ///< those in front from top to bottom, then the hidden ones
  std::vector<Eigen::Vector3d> rachis;            ///< polyline from top to bottom (m, world)
  double rachis_radius = 0.0025;                  ///< m
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< frontal_eye(): the hidden fruit must not be visible from here (m)

  /// Largest interpenetration() of any two fruit (m); negative if no two fruit touch.
  double deepest() const;
};

/// Draws the shape of a fruit whose equatorial semi-axis is about `size` (m). The semi-axes stay within the limits of
/// the parameters; the elongation is applied after that.
FruitShape draw_shape(const TrussParameters& parameters, double size, Rng& rng);

/// Places a fruit at random: its calyx points up, a little towards the rachis, and the fruit is turned about its growth
/// axis.
/// @param shape of the fruit
/// @param center where to place it (m, world)
/// @param rachis polyline from top to bottom (m, world)
/// @param rng random numbers
PlacedFruit draw_fruit(const FruitShape& shape, const Eigen::Vector3d& center,
                       const std::vector<Eigen::Vector3d>& rachis, Rng& rng);

/// The point at the height z (m) on a polyline that descends; its first or last point if z is above or below it.
Eigen::Vector3d at_height(const std::vector<Eigen::Vector3d>& polyline, double z);

/// Pushes fruit apart, and off the rachis, until nothing interpenetrates by more than 0.2 mm or the rounds are used up.
/// Only the fruit from index `first` on move. This way, the fruit in front can be settled before those behind them.
void settle(TrussLayout& layout, std::size_t first);

/// Adds `count` hidden fruit, each behind a different one of those in front, and settles them.
/// @param layout with the fruit in front; receives the hidden ones
/// @param count number of hidden fruit
/// @param parameters of the truss
/// @param spread 0 to 1, scales how far they stray from the line of sight through the fruit in front
/// @param rng random numbers
void hide_behind(TrussLayout& layout, int count, const TrussParameters& parameters, double spread, Rng& rng);

/// Draws the layout of a herringbone truss.
/// @param parameters of the truss
/// @param spread 0 to 1, scales everything that varies from truss to truss: yaw, lean, sway, and stray of the fruit
/// @param rng random numbers
TrussLayout herringbone(const TrussParameters& parameters, double spread, Rng& rng);

}  // namespace agrisee::study
