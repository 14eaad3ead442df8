// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The page of a season.
#pragma once

#include <string>

#include "season/overview.hpp"

namespace agrisee::season {

/// One HTML page, without scripts or other files: counts, sizes and ripeness of the fruit by date, by row, and by both.
/// @param name what the season is called
std::string season_page(const Overview& overview, const std::string& name);

}  // namespace agrisee::season
