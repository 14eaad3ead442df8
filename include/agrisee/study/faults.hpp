// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Simulated faults of sensor and arm: a wrapper that lets views go wrong at a given rate, and a scan with it.
/// World frame, metres, radians.
#pragma once

#include <agrisee/study/fault_record.hpp>
#include <agrisee/study/simulated_scan.hpp>

#include <array>
#include <cstdint>
#include <string>

namespace agrisee::study {

struct Truth;  // study/evaluate.hpp

/// How often each kind of fault occurred, in the order of Fault.
using FaultCounts = std::array<int, kFaults>;

/// Wrap what takes views so that some views go wrong. Which ones, and how, depends only on the seed and on how many
/// views were requested before.
/// @param take_view takes the views if nothing goes wrong
/// @param parameters which faults, how often, how large
/// @param seed of the random draws
/// @param counts counted up at each fault, or null; must outlive the returned function
/// @throws ParameterError
ViewTaker faulty(ViewTaker take_view, const FaultParameters& parameters, std::uint64_t seed,
                 FaultCounts* counts = nullptr);

/// Scan a scene with faults and judge what was found.
/// @param name of the scene
/// @param workcell arm, camera, scan volume
/// @param truth of the scene
/// @param parameters of the pipeline
/// @param noise of the simulated sensor
/// @param faults which faults, how often, how large
/// @param trial seed of noise and planner; the faults also depend on the scene's name
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError, InputError as scan() does
FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const Truth& truth,
                             const Parameters& parameters, const NoiseModel& noise, const FaultParameters& faults,
                             int trial, int threads = 1);

}  // namespace agrisee::study
