// SPDX-License-Identifier: BSD-3-Clause
// What the commands read: clouds from files and pipes, and folders that stand for the file in them.
#pragma once

#include <agrisee/io/cloud_file.hpp>

#include <string>

namespace agrisee::cli {

/// `input`, or, where it is a folder, the file of that name in it. @throws FileError if the folder holds no such file
std::string file_in(const std::string& input, const char* name);

/// Whether an input is a recording of views (views.yaml, or a folder with it) and not a cloud.
bool is_recording(const std::string& input);

/// The name of an input in messages and in run.json: that of its file, or "standard input" for `-`.
std::string name_of(const std::string& input);

/// Read a cloud from a file, a named pipe, or, if `input` is `-`, standard input.
/// @throws UsageError if standard input is a terminal; FileError as io::read_cloud
io::CloudFile read_cloud_input(const std::string& input);

}  // namespace agrisee::cli
