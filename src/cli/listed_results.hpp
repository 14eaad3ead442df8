// SPDX-License-Identifier: BSD-3-Clause
// What lies in the output folders of lists, judged by what the lists say of it: their summaries.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "season/results.hpp"

namespace agrisee::cli {

/// The results in some folders.
struct ListedResults {
  std::vector<season::Scan> scans;     ///< that count, and inputs without a result (`failed`, `open`)
  std::vector<season::Scan> left_out;  ///< of older lists
  std::vector<std::string> notes;      ///< why each of these is left out
  std::vector<std::string> faults;     ///< results that cannot be read, or are listed but gone
};

/// Add all results in and below a folder. Where a folder holds summaries of lists, a result in it counts if they name
/// its folder; if no list made it (no job.json); or if they do not name its input, which still exists: then it is of
/// another list. The others are left over, as from inputs that were renamed.
/// @throws FileError if there is none, or a summary cannot be read
void collect_results(const std::filesystem::path& folder, ListedResults& found);

}  // namespace agrisee::cli
