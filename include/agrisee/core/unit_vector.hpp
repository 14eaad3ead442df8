// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Normals of any length, as files and other programs have them, as unit vectors.
#pragma once

#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

/// Scale a vector to unit length; set it to zero if it has no direction (zero, or not finite). A unit vector is not
/// changed, not even in its last bit.
template <typename S>
void make_unit_or_zero(Vector3<S>& v) {
  const S norm = v.norm();
  if (!(std::isfinite(norm) && norm > S(1e-12)))
    v.setZero();
  else if (std::abs(norm - S(1)) > S(1e-5))
    v /= norm;
}

}  // namespace agrisee
