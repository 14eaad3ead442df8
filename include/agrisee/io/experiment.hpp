// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Records of the experiment as JSON files, one a cell or scene, so that an interrupted experiment can go on.
#pragma once

#include <agrisee/study/experiment.hpp>

#include <filesystem>

namespace agrisee::io {

/// Write a record, atomically. @throws FileError when it cannot be written
void write_record(const std::filesystem::path& path, const study::CellRecord& record);
/// The same of a scene.
void write_record(const std::filesystem::path& path, const study::SceneRecord& record);

/// Read a record back as it was. @throws FileError for a file that is missing or no such record
study::CellRecord read_cell_record(const std::filesystem::path& path);
/// The same of a scene.
study::SceneRecord read_scene_record(const std::filesystem::path& path);

}  // namespace agrisee::io
