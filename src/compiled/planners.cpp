// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/planner_by_name.hpp>
#include <agrisee/planners.hpp>

std::unique_ptr<agrisee::plan::Planner> agrisee::detail::planner_by_name(const Workcell& workcell,
                                                                         const Parameters& parameters,
                                                                         std::uint64_t seed, int threads) {
  return find_planner(workcell, parameters, seed, threads);
}
