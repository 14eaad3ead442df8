// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence of free space, as the split asks for it.
#pragma once

#include <functional>

namespace agrisee {

struct Ellipsoid;

/// Share (0..1) of a body's surface (cloud/fit.hpp) that sight lines have gone through; see plan/free_space.hpp. May be
/// empty: unknown.
using SeenThrough = std::function<double(const Ellipsoid&)>;

}  // namespace agrisee
