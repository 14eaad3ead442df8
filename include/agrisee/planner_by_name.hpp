// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All planners, and which is meant. planners.hpp includes it, unless they come compiled.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/baseline_planners.hpp>
#include <agrisee/plan/gain_planner.hpp>
#include <agrisee/plan/see_planner.hpp>
#include <agrisee/planners.hpp>
#include <agrisee/workcell.hpp>

#include <memory>

namespace agrisee::detail {

/// What make_planner() returns.
inline std::unique_ptr<plan::Planner> find_planner(const Workcell& workcell, const Parameters& parameters,
                                                   std::uint64_t seed, int threads) {
  const Aabb& volume = workcell.scan_volume;
  const Eigen::Vector3d eye = workcell.world_T_base.translation();
  plan::ViewRequest band;
  band.distance = parameters.gain.distance;
  band.distance_min = parameters.gain.distance_min;
  band.distance_max = parameters.gain.distance_max;
  if (parameters.planner == "gain")
    return std::make_unique<plan::GainPlanner>(workcell.sensor, volume, eye, parameters.split, parameters.free_space,
                                               parameters.gain);
  if (parameters.planner == "see") {
    see::Parameters see = parameters.see;
    see.max_views = parameters.max_views;
    band.distance = see.view_distance;
    band.distance_min = std::min(band.distance_min, band.distance);
    band.distance_max = std::max(band.distance_max, band.distance);
    return std::make_unique<plan::SeePlanner>(volume, eye, see, band, threads);
  }
  if (parameters.planner == "fixed")
    return std::make_unique<plan::FixedPlanner>(volume, eye, parameters.max_views, band);
  if (parameters.planner == "random") return std::make_unique<plan::RandomPlanner>(volume, eye, band, seed);
  throw ParameterError("planner must be gain, see, fixed or random, got " + parameters.planner);
}

}  // namespace agrisee::detail

#ifndef AGRISEE_COMPILED
inline std::unique_ptr<agrisee::plan::Planner> agrisee::detail::planner_by_name(const Workcell& workcell,
                                                                                const Parameters& parameters,
                                                                                std::uint64_t seed, int threads) {
  return find_planner(workcell, parameters, seed, threads);
}
#endif
