// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/faults.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee::study {
namespace {

constexpr auto kWrongPose = static_cast<std::size_t>(Fault::wrong_pose);

/// Three independent normal draws.
Eigen::Vector3d normal3(Rng& rng, double sigma) {
  Eigen::Vector3d v;
  for (int a = 0; a < 3; ++a) v[a] = sigma * rng.normal();
  return v;
}

/// A small random rigid motion.
Pose pose_error(const FaultParameters& parameters, Rng& rng) {
  Pose error = Pose::Identity();
  const Eigen::Vector3d turn = normal3(rng, parameters.rotation_noise);
  if (turn.norm() > 0.0) error.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  error.translation() = normal3(rng, parameters.position_noise);
  return error;
}

/// Let a fault change a capture. Faults that prevent a capture change nothing.
/// @param last what the sensor returned before; an empty frame at first
void apply_fault(Fault fault, const FaultParameters& parameters, const sensor::DepthFrame& last, Rng& rng,
                 Capture& capture) {
  sensor::DepthFrame& frame = capture.frame;
  switch (fault) {
    case Fault::empty_frame:
      frame.depth.assign(frame.depth.size(), 0.0f);
      break;
    case Fault::nan_frame:
      frame.depth.assign(frame.depth.size(), std::numeric_limits<float>::quiet_NaN());
      break;
    case Fault::frozen_frame:
      if (!last.depth.empty()) frame = last;
      break;
    case Fault::wrong_intrinsics:
      frame.intrinsics.fx *= 1.0 + parameters.intrinsics_error;
      frame.intrinsics.fy *= 1.0 + parameters.intrinsics_error;
      break;
    case Fault::noisy_pose:
      capture.world_T_optical = capture.world_T_optical * pose_error(parameters, rng);
      break;
    case Fault::wrong_pose:
      capture.world_T_optical.translation() += parameters.position_error * rng.direction();
      break;
    default:
      break;
  }
}

/// True for faults after which there is no frame.
bool prevents_capture(Fault fault) {
  return fault == Fault::dropped_frame || fault == Fault::refused_motion || fault == Fault::timeout;
}

}  // namespace

ViewTaker faulty(ViewTaker take_view, const FaultParameters& parameters, std::uint64_t seed, FaultCounts* counts) {
  parameters.check();
  struct State {
    std::uint64_t requests = 0;
    sensor::DepthFrame last;  // what the sensor showed last, before any fault but a frozen frame
  };
  return [take_view = std::move(take_view), parameters, seed, counts, state = std::make_shared<State>()](
             const plan::ReachableView& view, std::size_t number) -> std::optional<Capture> {
    constexpr std::uint64_t kStream = 0xFA017;
    Rng rng(seed, kStream, state->requests++);
    const bool occurs = rng.uniform() < parameters.rate;
    const Fault fault = parameters.kind.value_or(static_cast<Fault>(rng.below(kFaults)));
    if (occurs && counts) ++(*counts)[static_cast<std::size_t>(fault)];
    if (occurs && prevents_capture(fault)) return std::nullopt;
    auto capture = take_view(view, number);
    if (!capture) return std::nullopt;
    const sensor::DepthFrame last = std::exchange(state->last, capture->frame);
    if (!occurs) return capture;
    apply_fault(fault, parameters, last, rng, *capture);
    if (fault == Fault::frozen_frame) state->last = capture->frame;
    return capture;
  };
}

FaultRecord scan_with_faults(const std::string& name, const Workcell& workcell, const Truth& truth,
                             const Parameters& parameters, const NoiseModel& noise, const FaultParameters& faults,
                             int trial, int threads) {
  SimulationOptions options;
  options.noise = noise;
  options.seed = static_cast<std::uint64_t>(trial);
  options.threads = threads;
  std::uint64_t seed = options.seed;  // of the faults, which differ between scenes
  for (const char c : name) seed = mix(seed ^ static_cast<unsigned char>(c));
  FaultCounts counts{};
  std::vector<std::size_t> wrong;  // numbers of the views whose pose was wrong
  options.around = [&](ViewTaker take_view) {
    return [&, inner = faulty(std::move(take_view), faults, seed, &counts)](const plan::ReachableView& view,
                                                                            std::size_t number) {
      const int before = counts[kWrongPose];
      auto capture = inner(view, number);
      if (counts[kWrongPose] > before) wrong.push_back(number);
      return capture;
    };
  };
  const ScanResult result = scan(workcell, truth.traced, parameters, std::move(options));
  const Metrics metrics = evaluate(truth, result, {}, {}, threads);

  FaultRecord record;
  record.scene = name;
  if (faults.kind) record.kind = to_string(*faults.kind);
  record.rate = faults.rate;
  record.trial = trial;
  record.fruit = metrics.n_real;
  record.found = metrics.n_true;
  record.invented = metrics.n_det - metrics.n_true;
  record.views = static_cast<int>(result.views.size());
  for (const View& v : result.views) record.discarded += v.discarded;
  for (const int n : counts) record.faults += n;
  record.wrong_poses = counts[kWrongPose];
  for (const std::size_t v : wrong)
    record.wrong_believed += !result.views[v].discarded && result.views[v].points_in > 0;
  record.stop_reason = to_string(result.stop_reason);
  record.seconds = result.seconds.total;
  return record;
}

}  // namespace agrisee::study
