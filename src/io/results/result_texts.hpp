// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The texts of the files in a result folder. All functions throw InputError for values that are not finite.
#pragma once

#include <agrisee/io/results.hpp>

#include <string>

#include "io/formats/json_value.hpp"

namespace agrisee::io {

/// Check that labels, normals and views are absent or one per point. @throws InputError if they are not
void check_result(const ScanResult& result);
/// views.csv
std::string views_text(const std::vector<View>& views);
/// fruits.json
std::string fruits_text(const std::vector<Fruit>& fruits);
/// fruits.csv
std::string fruits_csv_text(const std::vector<Fruit>& fruits);
/// How ripe a fruit or truss is, as its object in fruits.json or run.json has it.
Json ripeness_json(const Ripeness& ripeness);
/// run.json
std::string run_text(const ScanResult& result, const RunInfo& info);

}  // namespace agrisee::io
