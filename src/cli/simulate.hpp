// SPDX-License-Identifier: BSD-3-Clause
// What several commands call and what holds the whole pipeline, the simulated sensor or the evaluation: compiled once,
// in simulate.cpp, since each of these takes the compiler a minute; whoever includes this does not see them. Called as
// cli::scan() and so on: their namesakes in study:: take the same arguments.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/sensor/depth_noise.hpp>
#include <agrisee/study/experiment.hpp>
#include <agrisee/study/fault_record.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/workcell.hpp>

#include <memory>
#include <optional>
#include <string>

namespace agrisee::plan {
class Planner;
}
namespace agrisee::study {
struct SimulationOptions;  // study/simulated_scan.hpp
struct Subject;            // study/run_cell.hpp
struct Truth;              // study/evaluate.hpp
}  // namespace agrisee::study

namespace agrisee::cli {

/// @throws ParameterError, InputError for what cannot be scanned
void check_scan(const Workcell& workcell, const Parameters& parameters);
/// study::scan()
ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters,
                study::SimulationOptions options);
/// study::make_greedy_planner()
std::unique_ptr<plan::Planner> make_greedy_planner(const TracedScene& scene, const study::Samples& samples,
                                                   const Workcell& workcell, int threads);
/// study::make_subject()
std::shared_ptr<const study::Subject> make_subject(const std::string& name, const std::string& fingerprint,
                                                   const Scene& scene, const Workcell& workcell,
                                                   const std::optional<study::GroundTruth>& known);
/// study::make_truth()
std::shared_ptr<const study::Truth> make_truth(const Scene& scene, const std::optional<study::GroundTruth>& known,
                                               const sensor::L515& sensor);
/// study::judge_scene()
study::SceneRecord judge_scene(const study::Subject& subject);
/// study::run_cell()
study::CellRecord run_cell(const study::Subject& subject, const study::Cell& cell, const Parameters& parameters);
/// study::scan_with_faults()
study::FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const study::Truth& truth,
                                    const Parameters& parameters, const sensor::NoiseModel& noise,
                                    const study::FaultParameters& faults, int trial);

}  // namespace agrisee::cli
