// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a body has the size of a fruit. Metres.
#pragma once

#include <agrisee/cloud/body_counts.hpp>
#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/parameters.hpp>

#include <cstddef>

namespace agrisee::detail {

/// Whether the size of an ellipsoid is that of a fruit, by either definition of its mean radius.
inline bool plausible(const Ellipsoid& body, const BodyParameters& parameters) {
  return parameters.plausible(body.mean_radius()) && parameters.plausible(body.mean_semi_axis());
}

/// The count of bodies whose size is not that of a fruit, for one with mean radius r (m).
inline std::size_t BodyCounts::*wrong_size(double r, const BodyParameters& parameters) {
  return r < parameters.radius_min ? &BodyCounts::too_small : &BodyCounts::too_large;
}

}  // namespace agrisee::detail
