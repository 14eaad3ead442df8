// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is known of where a ready cloud was seen from.
#pragma once

#include <agrisee/process.hpp>

#include <cstddef>

namespace agrisee {

/// Whether nothing is known of where the points were seen from.
inline bool is_unknown(const CloudOrigin& origin) { return !origin.viewpoint && origin.sensors.empty(); }

/// Whether one viewpoint is given for all points.
inline bool has_one_viewpoint(const CloudOrigin& origin) { return origin.viewpoint && origin.sensors.empty(); }

/// Whether all points are known to be seen from one place.
inline bool is_one_view(const CloudOrigin& origin) { return has_one_viewpoint(origin) || origin.sensors.size() == 1; }

/// Whether views from several sides show each fruit. A cloud of which nothing is known counts as merged from many.
inline bool is_several_views(const CloudOrigin& origin) {
  constexpr std::size_t kSeveral = 3;
  return is_unknown(origin) || origin.sensors.size() >= kSeveral;
}

}  // namespace agrisee
