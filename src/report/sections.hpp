// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The parts of the report of an experiment: the sections of the document and the files beside it.
#pragma once

#include <string>
#include <vector>

#include "report/experiment_report.hpp"
#include "report/groups.hpp"

namespace agrisee::report {

/// The head of the document: what was run, and how to read the tables.
std::string introduction(const Data& data, const ReportInfo& info);
/// The averages of all groups.
std::string summary_section(const Data& data);
/// Table 1: scanning.
std::string scanning_section(const Data& data);
/// Table 2: segmentation.
std::string segmentation_section(const Data& data);
/// Table 3: localization.
std::string localization_section(const Data& data);
/// The presets under each noise model.
std::string noise_section(const Data& data);
/// The planners, view by view.
std::string planner_section(const Data& data);
/// What the arm can see of each scene, and how many views a planner needs that knows the truth.
std::string limit_section(const Data& data);
/// The figures in which the tables, the text and the parameters of [1] contradict each other.
std::string paper_section();

/// A file beside the document.
struct File {
  std::string name;
  std::string bytes;
};
/// All CSV tables.
std::vector<File> csv_files(const Data& data);
/// All plots for which there are records.
std::vector<File> plots(const Data& data);

}  // namespace agrisee::report
