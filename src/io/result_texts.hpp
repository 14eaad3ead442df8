// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The contents of a result's text files; each throws InputError for what is not finite.
#pragma once

#include <agrisee/io/results.hpp>

#include <string>

namespace agrisee::io {

/// @throws InputError when labels, normals or views are not one per point
void check_result(const ScanResult& result);
std::string views_text(const std::vector<View>& views);
std::string fruits_text(const std::vector<Fruit>& fruits);
std::string fruits_csv_text(const std::vector<Fruit>& fruits);
std::string run_text(const ScanResult& result, const Workcell& workcell, const RunInfo& info);

}  // namespace agrisee::io
