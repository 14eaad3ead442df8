// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The evidence of free space that segmentation uses. fuse/free_space.hpp and cloud/sight_lines.hpp compute it.
#pragma once

#include <agrisee/core/types.hpp>

#include <functional>

namespace agrisee {

struct Ellipsoid;

/// The evidence of sight lines for a point in space.
enum class Sight {
  unknown,  ///< none came near, or they ended before it
  surface,  ///< they end there
  through   ///< they go on behind it
};

/// The share (0 to 1) of a body's surface that sight lines pass through, which the body would have stopped. An empty
/// function means that nothing is known.
using SeenThrough = std::function<double(const Ellipsoid&)>;

/// Whether sight lines that ended behind a place (m) passed through it. An empty function means that nothing is known.
using IsFree = std::function<bool(const Eigen::Vector3d&)>;

/// Of the directions in which the sensor of a single view would see a body, except those in which something nearer
/// occludes it: the share (0 to 1) in which a surface was measured where the body's is. An empty function means that
/// nothing is known.
using SeenOn = std::function<double(const Ellipsoid&)>;

}  // namespace agrisee
