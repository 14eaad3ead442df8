// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether single views of a scan show fruit that all views together do not.
#pragma once

#include <agrisee/fuse/views.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Doubt the poses, the calibration or that the plant stood still, where views by themselves show several fruit and all
/// together hardly any: what is laid down in different places makes no round surface. Only where at most one fruit was
/// found, which tells little about how the views agree, and only for fused surfaces. Cost: three times the processing
/// of a view.
/// @param map what each view shows
/// @param views of the scan
/// @param parameters of all stages
/// @param volume that is scanned (world)
/// @param fruits number of fruit that were found in all views together
/// @param threads the result does not depend on it
/// @return the doubt as a sentence
std::optional<std::string> doubt_of_agreement(const fuse::Views& map, const std::vector<View>& views,
                                              const Parameters& parameters, const Aabb& volume, std::size_t fruits,
                                              int threads);

}  // namespace agrisee
