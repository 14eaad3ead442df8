// SPDX-License-Identifier: BSD-3-Clause
// What the commands read: clouds from files and pipes, folders that stand for the file in them, and what to say to
// those who name one thing where another is wanted.
#pragma once

#include <agrisee/io/cloud_file.hpp>

#include <string>

namespace agrisee::cli {

/// What an input may be.
enum class Kind {
  scene,      ///< scene.yaml, or a folder with it
  recording,  ///< views.yaml, a folder with it, or an MCAP file
  cloud,      ///< a file with points
  scan,       ///< the result folder of a scan
  processed,  ///< any other result folder
  unknown     ///< the reader may tell
};

/// Refuse an input that is clearly of another kind than the one that is wanted.
/// @throws FileError "<input>: is not a scene, but a point cloud, which `agrisee process` takes"
void check_kind(const std::string& input, Kind wanted);

/// The scene file that an input names: it, or scene.yaml in it. @throws FileError if it is something else
std::string scene_file(const std::string& input);

/// views.yaml that an input names: it, or that in it. @throws FileError if it is something else
std::string recording_file(const std::string& input);

/// Whether an input is a recording of views (views.yaml, a folder with it, or an MCAP file) and not a cloud.
bool is_recording(const std::string& input);

/// Whether an input is an MCAP file, by its name.
bool is_mcap(const std::string& input);

/// The name of an input in messages and in run.json: that of its file, or "standard input" for `-`.
std::string name_of(const std::string& input);

/// Read a cloud from a file, a named pipe, or, if `input` is `-`, standard input.
/// @throws UsageError if standard input is a terminal; FileError as io::read_cloud
io::CloudFile read_cloud_input(const std::string& input);

}  // namespace agrisee::cli
