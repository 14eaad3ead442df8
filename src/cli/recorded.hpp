// SPDX-License-Identifier: BSD-3-Clause
// Views that a camera recorded, processed as those of a scan are.
#pragma once

#include <agrisee/io/mcap.hpp>
#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

#include <Eigen/Core>

#include <optional>
#include <string>

#include "commands.hpp"

namespace agrisee::cli {

/// A result, the cell in which it was made, and what the report shows besides.
struct Processed {
  Workcell workcell;
  ScanResult result;
  io::ScanHistory history;
};

/// What to take from an MCAP file.
struct RecordingChoice {
  io::McapChoice mcap;                   ///< which images, and which frame is the world
  std::optional<Eigen::Vector2d> range;  ///< least and largest distance along the rays (m); none: all that returned
};

/// Fuse, register and segment the views of a recording. Where it states no scan volume, all that the views show within
/// 10 m counts.
/// @param path views.yaml, or an MCAP file  @param choice for an MCAP file
/// @throws FileError
Processed process_recording(const std::string& path, const CommonOptions& options, const Parameters& parameters,
                            const RecordingChoice& choice = {});

}  // namespace agrisee::cli
