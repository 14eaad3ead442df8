// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which fruit hang on one truss, and the frame in which it grows. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/result.hpp>

#include <vector>

namespace agrisee {

/// Group fruit into trusses: fruit are on one truss if the gap between their bodies is at most `truss_gap` mean radii,
/// directly or through other fruit.
/// @param fruits located; their ids and `truss` are not used
/// @param truss_gap see Parameters
/// @return for each fruit the number of its truss, from 0, in the order of the trusses' first fruit
std::vector<int> trusses_of(const std::vector<Fruit>& fruits, double truss_gap);

/// The trusses of located fruit, grouped by `Fruit::truss`, ascending, each with its growth frame.
/// @param fruits as locate() returns them; their ids are listed in this order, from the top down
std::vector<FoundTruss> found_trusses(const std::vector<Fruit>& fruits);

}  // namespace agrisee
