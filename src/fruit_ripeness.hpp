// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the measured colors of a result's points to the ripeness of its fruit and trusses.
#pragma once

#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/result.hpp>

#include <optional>
#include <string>

namespace agrisee {

/// Set how ripe the fruit and trusses of a result are, where its cloud has colors.
void add_ripeness(ScanResult& result, const RipenessParameters& parameters);

/// What speaks against the colors of a result: that all of them are gray or black, or that most of the fruit is blue.
/// Empty for usual colors, and for a cloud without colors.
std::optional<std::string> doubt_of_colors(const ScanResult& result, const RipenessParameters& parameters);

}  // namespace agrisee
