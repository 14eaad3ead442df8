// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The texts of the files in a result folder. All functions throw InputError for values that are not finite.
#pragma once

#include <agrisee/io/results.hpp>

#include <string>

namespace agrisee::io {

/// Check that labels, normals and views are absent or one per point. @throws InputError if they are not
void check_result(const ScanResult& result);
/// views.csv
std::string views_text(const std::vector<View>& views);
/// fruits.json
std::string fruits_text(const std::vector<Fruit>& fruits);
/// fruits.csv
std::string fruits_csv_text(const std::vector<Fruit>& fruits);
/// run.json
std::string run_text(const ScanResult& result, const RunInfo& info);

}  // namespace agrisee::io
