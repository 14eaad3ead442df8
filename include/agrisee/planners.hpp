// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The planners by name. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/workcell.hpp>

#include <cstdint>
#include <memory>

namespace agrisee {

/// The planner that `parameters.planner` names: `gain` (default), `see`, `fixed` (`max_views` directions, spread
/// evenly) or `random`.
/// @param workcell arm, camera, scan volume
/// @param parameters of the planner
/// @param seed of the planner's random draws
/// @param threads number of threads; the planner's choice does not depend on it
/// @throws ParameterError for any other name
std::unique_ptr<plan::Planner> make_planner(const Workcell& workcell, const Parameters& parameters,
                                            std::uint64_t seed = 0, int threads = 1);

}  // namespace agrisee
