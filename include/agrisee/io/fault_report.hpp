// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What scans make of faults, as a document.
#pragma once

#include <agrisee/io/report.hpp>
#include <agrisee/study/fault_record.hpp>

#include <filesystem>
#include <vector>

namespace agrisee::io {

/// Write the Markdown document `path` and, in the folder beside it that has its stem as name, faults.csv (a row a scan)
/// and found.svg (the share of the fruit that is found, over the rate). The same records give the same bytes, whatever
/// their order.
/// @throws InputError without any record, and for a path without an extension  @throws FileError
void write_fault_report(const std::filesystem::path& path, std::vector<study::FaultRecord> records,
                        const ReportInfo& info);

}  // namespace agrisee::io
