// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes the report of scans under faults.
#pragma once

#include <agrisee/study/fault_record.hpp>

#include <filesystem>
#include <vector>

#include "report/experiment_report.hpp"

namespace agrisee::report {

/// Write the report as the Markdown document `path`, and, into a folder beside it that has the same name without the
/// extension, faults.csv (a row per scan) and found.svg (the share of the fruit that was found, over the rate of
/// faults). The same records give the same bytes, whatever their order.
/// @param path the Markdown document
/// @param records the scans
/// @param info how the records were made
/// @throws InputError if there is no record, or if the path has no extension
/// @throws FileError if a file cannot be written
void write_fault_report(const std::filesystem::path& path, std::vector<study::FaultRecord> records,
                        const ReportInfo& info);

}  // namespace agrisee::report
