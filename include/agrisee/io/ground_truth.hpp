// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The true shapes and positions of the fruit of a generated scene, stored as ground_truth.json beside the scene file.
/// World frame, metres.
#pragma once

#include <agrisee/study/ground_truth.hpp>

#include <filesystem>
#include <optional>

namespace agrisee::io {

/// Write ground_truth.json. @throws FileError when it cannot be written
void write_ground_truth(const std::filesystem::path& path, const study::GroundTruth& truth);

/// Read a file that write_ground_truth wrote: per fruit its id, ellipsoid and volume and, where known, its growth axis,
/// whether it is hidden, and the share of it that is visible from the front.
/// @return none when there is no such file, or when it lacks the keys `format_version` and `fruits`
/// @throws FileError for a file that is not JSON, of an unknown version, or malformed
std::optional<study::GroundTruth> read_ground_truth(const std::filesystem::path& path);

}  // namespace agrisee::io
