// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the measured colors of a result's points to the ripeness of its fruit and trusses.
#pragma once

#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/result.hpp>

namespace agrisee {

/// Set how ripe the fruit and trusses of a result are, where its cloud has colors.
void add_ripeness(ScanResult& result, const RipenessParameters& parameters);

}  // namespace agrisee
