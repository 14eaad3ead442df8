// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is known of where a ready cloud was seen from.
#pragma once

#include <agrisee/process.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace agrisee {

/// Whether nothing is known of where the points were seen from.
inline bool is_unknown(const CloudOrigin& origin) { return !origin.viewpoint && origin.sensors.empty(); }

/// Whether one viewpoint is given for all points.
inline bool has_one_viewpoint(const CloudOrigin& origin) { return origin.viewpoint && origin.sensors.empty(); }

/// Whether all points are known to be seen from one place.
inline bool is_one_view(const CloudOrigin& origin) { return has_one_viewpoint(origin) || origin.sensors.size() == 1; }

/// From this number of views on, several show each fruit.
constexpr std::size_t kSeveralViews = 3;

/// The number of views that show a point of the cloud, or of all sensors if no point names its view. Discarded views
/// have a sensor, but no points.
inline std::size_t views_with_points(const Cloud& cloud, const CloudOrigin& origin) {
  std::vector<char> shows(origin.sensors.size(), 0);
  for (const int v : cloud.views)
    if (v >= 0 && static_cast<std::size_t>(v) < shows.size()) shows[static_cast<std::size_t>(v)] = 1;
  const auto count = static_cast<std::size_t>(std::count(shows.begin(), shows.end(), 1));
  return count > 0 ? count : origin.sensors.size();
}

/// Whether views from several sides show each fruit. A cloud of which nothing is known counts as merged from many.
inline bool is_several_views(const Cloud& cloud, const CloudOrigin& origin) {
  return is_unknown(origin) || views_with_points(cloud, origin) >= kSeveralViews;
}

}  // namespace agrisee
