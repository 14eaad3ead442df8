// SPDX-License-Identifier: BSD-3-Clause
#include "simulate.hpp"

#include <agrisee/study/faults.hpp>
#include <agrisee/study/run_cell.hpp>

namespace agrisee::cli {

void check_scan(const Workcell& workcell, const Parameters& parameters) {
  workcell.sensor.check();
  Pipeline(workcell, parameters);
}

ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters,
                study::SimulationOptions options) {
  return study::scan(workcell, scene, parameters, std::move(options));
}

std::unique_ptr<plan::Planner> make_greedy_planner(const TracedScene& scene, const study::Samples& samples,
                                                   const Workcell& workcell, int threads) {
  return study::make_greedy_planner(scene, samples, workcell, {}, threads);
}

std::shared_ptr<const study::Subject> make_subject(const std::string& name, const std::string& fingerprint,
                                                   const Scene& scene, const Workcell& workcell,
                                                   const std::optional<study::GroundTruth>& known) {
  return std::make_shared<study::Subject>(study::make_subject(name, fingerprint, scene, workcell, known, 1));
}

std::shared_ptr<const study::Truth> make_truth(const Scene& scene, const std::optional<study::GroundTruth>& known,
                                               const sensor::L515& sensor) {
  return std::make_shared<study::Truth>(study::make_truth(scene, known, sensor));
}

study::SceneRecord judge_scene(const study::Subject& subject) { return study::judge_scene(subject); }

study::CellRecord run_cell(const study::Subject& subject, const study::Cell& cell, const Parameters& parameters) {
  return study::run_cell(subject, cell, parameters, 1);
}

study::FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const study::Truth& truth,
                                    const Parameters& parameters, const sensor::NoiseModel& noise,
                                    const study::FaultParameters& faults, int trial) {
  return study::scan_with_faults(name, workcell, truth, parameters, noise, faults, trial, 1);
}

}  // namespace agrisee::cli
