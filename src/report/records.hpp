// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Stores the records of an experiment as JSON files, one per cell or scene, so that an interrupted experiment can be
/// continued.
#pragma once

#include <agrisee/study/experiment.hpp>

#include <filesystem>

namespace agrisee::report {

/// Write the record of a cell, atomically. @throws FileError if it cannot be written
void write_record(const std::filesystem::path& path, const study::CellRecord& record);
/// Write the record of a scene, atomically. @throws FileError if it cannot be written
void write_record(const std::filesystem::path& path, const study::SceneRecord& record);

/// Read the record of a cell; all values are exactly those that were written.
/// @throws FileError for a file that is missing or is not such a record
study::CellRecord read_cell_record(const std::filesystem::path& path);
/// Read the record of a scene; all values are exactly those that were written.
/// @throws FileError for a file that is missing or is not such a record
study::SceneRecord read_scene_record(const std::filesystem::path& path);

}  // namespace agrisee::report
