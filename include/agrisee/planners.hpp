// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The planners by name.
#pragma once

#include <agrisee/core/compiled.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/workcell.hpp>

#include <memory>

namespace agrisee {

namespace detail {
inline namespace AGRISEE_ABI {
AGRISEE_INLINE std::unique_ptr<plan::Planner> planner_by_name(const Workcell& workcell, const Parameters& parameters,
                                                              std::uint64_t seed, int threads);
}  // namespace AGRISEE_ABI
}  // namespace detail

/// The planner that `parameters.planner` names: `gain` (default), `see`, `fixed` (a ring of `max_views`) or `random`.
/// @param workcell arm, sensor, scan volume
/// @param parameters of the planner
/// @param seed of whatever it draws
/// @param threads the planner's choice does not depend on it
/// @throws ParameterError for any other name
inline std::unique_ptr<plan::Planner> make_planner(const Workcell& workcell, const Parameters& parameters,
                                                   std::uint64_t seed = 0, int threads = 1) {
  return detail::planner_by_name(workcell, parameters, seed, threads);
}

}  // namespace agrisee

#ifndef AGRISEE_COMPILED
#include <agrisee/planner_by_name.hpp>
#endif
