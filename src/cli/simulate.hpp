// SPDX-License-Identifier: BSD-3-Clause
// What several commands call and what holds the whole pipeline, the simulated sensor or the evaluation: compiled once,
// in simulate.cpp, since each of these takes the compiler a minute. Called as cli::scan() and so on: their namesakes in
// study:: take the same arguments.
#pragma once

#include <agrisee/study/faults.hpp>
#include <agrisee/study/run_cell.hpp>

#include <optional>
#include <string>

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
study::Subject make_subject(const std::string& name, const std::string& fingerprint, const Scene& scene,
                            const Workcell& workcell, const std::optional<study::GroundTruth>& known);
/// study::make_truth()
study::Truth make_truth(const Scene& scene, const std::optional<study::GroundTruth>& known, const sensor::L515& sensor);
/// study::judge_scene()
study::SceneRecord judge_scene(const study::Subject& subject);
/// study::run_cell()
study::CellRecord run_cell(const study::Subject& subject, const study::Cell& cell, const Parameters& parameters);
/// study::scan_with_faults()
study::FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const study::Truth& truth,
                                    const Parameters& parameters, const sensor::NoiseModel& noise,
                                    const study::FaultParameters& faults, int trial);

}  // namespace agrisee::cli
