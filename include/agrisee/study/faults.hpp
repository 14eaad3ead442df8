// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A wrapper around sensor and arm that lets views go wrong at a given rate, and a scan under it. Metres, radians,
/// world frame.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/fault_record.hpp>
#include <agrisee/study/simulated_scan.hpp>

#include <array>
#include <limits>
#include <memory>
#include <utility>

namespace agrisee::study {

/// How often each fault struck.
using FaultCounts = std::array<int, kFaults>;

/// Put faults around sensor and arm. What goes wrong follows from the seed and the number of times that a view was
/// asked for.
/// @param look what takes views when nothing goes wrong
/// @param parameters how often what goes wrong
/// @param seed names the random draws
/// @param counts filled where given; has to live as long as the Look
/// @throws ParameterError
inline Look faulty(Look look, const FaultParameters& parameters, std::uint64_t seed, FaultCounts* counts = nullptr) {
  parameters.check();
  struct State {
    std::uint64_t asked = 0;
    sensor::DepthFrame last;  // what the sensor showed last, before any fault
  };
  return [look = std::move(look), parameters, seed, counts, state = std::make_shared<State>()](
             const plan::ReachableView& view, std::size_t number) -> std::optional<sensor::Capture> {
    constexpr std::uint64_t kStream = 0xFA017;
    Rng rng(seed, kStream, state->asked++);
    const bool struck = rng.uniform() < parameters.rate;
    const Fault fault = parameters.kind.value_or(static_cast<Fault>(rng.below(kFaults)));
    if (struck && counts) ++(*counts)[static_cast<std::size_t>(fault)];
    if (struck && (fault == Fault::dropped_frame || fault == Fault::refused_motion || fault == Fault::timeout))
      return std::nullopt;
    auto capture = look(view, number);
    if (!capture) return std::nullopt;
    const sensor::DepthFrame last = std::exchange(state->last, capture->frame);
    if (!struck) return capture;
    sensor::DepthFrame& frame = capture->frame;
    const auto normal3 = [&](double sigma) {
      Eigen::Vector3d v;
      for (int a = 0; a < 3; ++a) v[a] = sigma * rng.normal();
      return v;
    };
    switch (fault) {
      case Fault::empty_frame:
        frame.depth.assign(frame.depth.size(), 0.0f);
        break;
      case Fault::nan_frame:
        frame.depth.assign(frame.depth.size(), std::numeric_limits<float>::quiet_NaN());
        break;
      case Fault::frozen_frame:
        if (!last.depth.empty()) state->last = frame = last;
        break;
      case Fault::wrong_intrinsics:
        frame.intrinsics.fx *= 1.0 + parameters.intrinsics_error;
        frame.intrinsics.fy *= 1.0 + parameters.intrinsics_error;
        break;
      case Fault::noisy_pose: {
        Pose error = Pose::Identity();
        const Eigen::Vector3d turn = normal3(parameters.rotation_noise);
        if (turn.norm() > 0.0) error.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
        error.translation() = normal3(parameters.position_noise);
        capture->world_T_optical = capture->world_T_optical * error;
        break;
      }
      case Fault::wrong_pose:
        capture->world_T_optical.translation() += parameters.position_error * rng.direction();
        break;
      default:
        break;
    }
    return capture;
  };
}

/// Scan a scene under faults.
/// @param name of the scene
/// @param workcell arm, sensor, scan volume
/// @param truth of the scene
/// @param parameters of the pipeline
/// @param noise of the sensor
/// @param faults how often what goes wrong
/// @param trial seed of noise and planner, and with the name of the faults
/// @param threads the result does not depend on it
/// @throws ParameterError, InputError as scan() does
inline FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const Truth& truth,
                                    const Parameters& parameters, const sensor::NoiseModel& noise,
                                    const FaultParameters& faults, int trial, int threads = 1) {
  FaultRecord record;
  record.scene = name;
  if (faults.kind) record.kind = to_string(*faults.kind);
  record.rate = faults.rate;
  record.trial = trial;
  SimulationOptions options;
  options.noise = noise;
  options.seed = static_cast<std::uint64_t>(trial);
  options.threads = threads;
  std::uint64_t seed = options.seed;  // of the faults: other scenes are struck otherwise
  for (const char c : name) seed = mix(seed ^ static_cast<unsigned char>(c));
  FaultCounts counts{};
  constexpr auto kWrong = static_cast<std::size_t>(Fault::wrong_pose);
  std::vector<std::size_t> wrong;  // numbers of the views whose pose was wrong
  options.around = [&](Look look) {
    return [&, inner = faulty(std::move(look), faults, seed, &counts)](const plan::ReachableView& view,
                                                                       std::size_t number) {
      const int before = counts[kWrong];
      auto capture = inner(view, number);
      if (counts[kWrong] > before) wrong.push_back(number);
      return capture;
    };
  };
  const ScanResult result = scan(workcell, truth.traced, parameters, std::move(options));
  const Metrics metrics = evaluate(truth, result, {}, {}, threads);
  record.fruit = metrics.n_real;
  record.found = metrics.n_true;
  record.invented = metrics.n_det - metrics.n_true;
  record.views = static_cast<int>(result.views.size());
  for (const View& v : result.views) record.discarded += v.discarded;
  for (const int n : counts) record.faults += n;
  record.wrong_poses = counts[kWrong];
  for (const std::size_t v : wrong)
    record.wrong_believed += !result.views[v].discarded && result.views[v].points_in > 0;
  record.stop_reason = to_string(result.stop_reason);
  record.seconds = result.seconds.total;
  return record;
}

}  // namespace agrisee::study
