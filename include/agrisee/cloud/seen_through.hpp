// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the split asks for evidence of free space, without knowing what gives it (fuse/free_space.hpp does).
#pragma once

#include <functional>

namespace agrisee {

struct Ellipsoid;

/// What sight lines say of a place.
enum class Sight {
  unknown,  ///< none came near, or they ended before it
  surface,  ///< they end there
  through   ///< they go on behind it
};

/// The share (0 to 1) of a body's surface that sight lines have gone through: where the body, if it were there, would
/// have stopped them. An empty function means that nothing is known.
using SeenThrough = std::function<double(const Ellipsoid&)>;

}  // namespace agrisee
