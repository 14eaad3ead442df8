// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/plan/baseline_planners.hpp>
#include <agrisee/plan/gain_planner.hpp>
#include <agrisee/plan/see_planner.hpp>
#include <agrisee/planners.hpp>

#include <algorithm>

namespace agrisee {

std::unique_ptr<plan::Planner> make_planner(const Workcell& workcell, const Parameters& parameters, std::uint64_t seed,
                                            int threads) {
  const Aabb& volume = workcell.scan_volume;
  const Eigen::Vector3d robot = workcell.world_T_base.translation();
  plan::ViewRequest band;
  band.distance = parameters.gain.distance;
  band.distance_min = parameters.gain.distance_min;
  band.distance_max = parameters.gain.distance_max;
  if (parameters.planner == "gain")
    return std::make_unique<plan::GainPlanner>(workcell.sensor, volume, robot, parameters.scan_split(),
                                               parameters.free_space, parameters.gain, threads);
  if (parameters.planner == "see") {
    see::Parameters see = parameters.see;
    see.max_views = parameters.max_views;
    band.distance = see.view_distance;
    band.distance_min = std::min(band.distance_min, band.distance);
    band.distance_max = std::max(band.distance_max, band.distance);
    return std::make_unique<plan::SeePlanner>(volume, robot, see, band, threads);
  }
  if (parameters.planner == "fixed")
    return std::make_unique<plan::FixedPlanner>(volume, robot, parameters.max_views, band);
  if (parameters.planner == "random") return std::make_unique<plan::RandomPlanner>(volume, robot, band, seed);
  throw FieldError("planner", "must be " + OneOf(kPlannerNames).text() + ", got " + parameters.planner);
}

}  // namespace agrisee
