// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a generated scene knows of its fruit, as ground_truth.json beside the scene file. World frame, metres.
#pragma once

#include <agrisee/study/ground_truth.hpp>

#include <filesystem>
#include <optional>

namespace agrisee::io {

/// Write ground_truth.json. @throws FileError
void write_ground_truth(const std::filesystem::path& path, const study::GroundTruth& truth);

/// Read what write_ground_truth wrote: growth axes, hidden flags and visible shares by fruit id. Empty when there is no
/// such file or it is of another format. @throws FileError for a file of ours that is broken
std::optional<study::GroundTruth> read_ground_truth(const std::filesystem::path& path);

}  // namespace agrisee::io
