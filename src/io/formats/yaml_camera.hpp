// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads from YAML what scenes and recorded views both state: sizes of images, ranges, volumes.
#pragma once

#include <agrisee/geometry/aabb.hpp>

#include "io/formats/yaml_map.hpp"

namespace agrisee::io {

/// A number above 0. @throws FileError
double positive(const YamlValue& value);

/// A number of pixels, 1 to 16384. @throws FileError
int pixels(const YamlValue& value);

/// `[min, max]` (m), with 0 <= min < max. @throws FileError, also for a range that begins beyond 50 m
Eigen::Vector2d read_range(const YamlValue& value);

/// `{min: [x, y, z], max: [x, y, z]}` (m), not empty. @throws FileError, also for a volume longer than 50 m
Aabb read_volume(const YamlValue& value);

}  // namespace agrisee::io
