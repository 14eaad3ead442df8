// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The report of an experiment: the paper's three tables with the paper's figures beside ours, what it leaves out, and
/// plots. Everything in it follows from the records alone.
#pragma once

#include <agrisee/study/experiment.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::io {

/// What a report says of itself.
struct ReportInfo {
  std::string version;  ///< of AgriSEE
  std::string command;  ///< how to rerun the experiment; may have several lines
};

/// Write the Markdown document `path` and, in the folder beside it that has its stem as name (docs/experiment.md:
/// docs/experiment/, made if need be), what it links to: scanning.csv, segmentation.csv, localization.csv (a row a
/// cell), fruits.csv (a row a fruit and cell), curves.csv (a row a view and cell), scenes.csv, and plots as SVG.
///
/// The same records give the same bytes, whatever their order. Values that are missing or not finite are `-` in the
/// document and empty in the tables.
/// @param path of the Markdown file
/// @param cells  the records of the scans; those of one scene, preset, planner and noise are trials of each other
/// @param scenes  what can be seen of the scenes; may be empty
/// @param info what the text says besides
/// @throws InputError without any cell, for two records of one cell or scene, for a record whose lists of fruit differ
///   in length, and for a path without an extension
/// @throws FileError when a file cannot be written
void write_report(const std::filesystem::path& path, const std::vector<study::CellRecord>& cells,
                  const std::vector<study::SceneRecord>& scenes, const ReportInfo& info);

}  // namespace agrisee::io
