// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes the report of an experiment: the three result tables of the paper [1] beside the results of AgriSEE, further
/// tables that the paper does not have, and plots. All of it is computed from the records of the experiment.
#pragma once

#include <agrisee/study/experiment.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::report {

/// How the records of a report were made; stated in its text.
struct ReportInfo {
  std::string version;    ///< version of AgriSEE
  std::string command;    ///< command line that repeats the experiment; may have several lines
  bool per_truss = true;  ///< whether the document of an experiment has the paper's tables, with a row per truss
};

/// Write the report as the Markdown document `path`, and its attachments into a folder beside it that has the same name
/// without the extension (docs/experiment/ for docs/experiment.md), which is created if necessary. The attachments are
/// scanning.csv, segmentation.csv and localization.csv (a row per cell), fruits.csv (a row per fruit and cell),
/// curves.csv (a row per view and cell), scenes.csv (a row per scene), and plots as SVG files.
///
/// The same records give the same bytes, whatever their order. Values that are missing or not finite are `-` in the
/// document and empty in the CSV files.
/// @param path the Markdown document
/// @param cells records of the scans; records of the same scene, preset, planner and noise model are trials of each
/// other
/// @param scenes records of what can be seen of the scenes; may be empty
/// @param info how the records were made
/// @throws InputError if `cells` is empty, if two records are of the same cell or scene, if the lists of fruit in a
///   record differ in length, and if the path has no extension
/// @throws FileError if a file cannot be written
void write_experiment_report(const std::filesystem::path& path, const std::vector<study::CellRecord>& cells,
                             const std::vector<study::SceneRecord>& scenes, const ReportInfo& info);

}  // namespace agrisee::report
