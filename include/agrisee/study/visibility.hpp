// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which samples of the fruit's surface a position sees: they face it and nothing lies between. World frame, metres.
/// Cost: a short ray for each sample that faces the position.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/traced_scene.hpp>
#include <agrisee/sensor/l515.hpp>
#include <agrisee/study/samples.hpp>

#include <algorithm>

namespace agrisee::study {

/// One flag a sample: 1 = yes.
using Flags = std::vector<std::uint8_t>;

/// Rays start this far (m) from the surface that they come from.
constexpr float kRayOffset = 1e-5f;

/// True when the straight line from the surface point p to the eye meets nothing.
inline bool unobstructed(const Bvh& bvh, const Eigen::Vector3f& p, const Eigen::Vector3f& eye) {
  const Eigen::Vector3f to_eye = eye - p;
  return !bvh.any(p, to_eye, kRayOffset / to_eye.norm(), 1.0f);
}

/// Samples that are seen from `eye`, whatever the field of view.
/// @param scene what is seen
/// @param samples of the fruit's surface
/// @param eye where from (m, world)
/// @param max_incidence largest angle between the line of sight and the normal (rad)
/// @param threads the result does not depend on it
inline Flags visible_from(const TracedScene& scene, const Samples& samples, const Eigen::Vector3d& eye,
                          double max_incidence = 0.5 * kPi, int threads = 1) {
  Flags seen(samples.size(), 0);
  const Eigen::Vector3f e = eye.cast<float>();
  const auto least = static_cast<float>(std::max(0.0, std::cos(max_incidence)));
  parallel_for(samples.size(), threads, [&](std::size_t i) {
    const Eigen::Vector3f to_eye = e - samples.points[i];
    const float facing = samples.normals[i].dot(to_eye);
    if (facing > 0.0f && facing >= least * to_eye.norm()) seen[i] = unobstructed(scene.bvh(), samples.points[i], e);
  });
  return seen;
}

/// Samples that a sensor would return points of from `world_T_optical`: in the image, within range, below the largest
/// incidence, and not hidden. Noise and the pixel raster are left out.
inline Flags visible_to(const TracedScene& scene, const Samples& samples, const Pose& world_T_optical,
                        const sensor::L515& sensor, int threads = 1) {
  Flags seen(samples.size(), 0);
  const Eigen::Vector3f e = world_T_optical.translation().cast<float>();
  const Eigen::Isometry3f optical_T_world = world_T_optical.inverse().cast<float>();
  const sensor::Intrinsics& k = sensor.intrinsics;
  const auto least = static_cast<float>(std::max(0.0, std::cos(sensor.max_incidence)));
  const auto range_min = static_cast<float>(sensor.range_min), range_max = static_cast<float>(sensor.range_max);
  // Image borders on the plane z = 1, half a pixel beyond the outermost centres.
  const Eigen::Vector2f low = k.ray(-0.5, -0.5).head<2>().cast<float>();
  const Eigen::Vector2f high = k.ray(k.width - 0.5, k.height - 0.5).head<2>().cast<float>();
  parallel_for(samples.size(), threads, [&](std::size_t i) {
    const Eigen::Vector3f to_eye = e - samples.points[i];
    const float facing = samples.normals[i].dot(to_eye);
    if (!(facing > 0.0f)) return;
    const float distance = to_eye.norm();
    if (facing < least * distance || distance < range_min || distance > range_max) return;
    const Eigen::Vector3f p = optical_T_world * samples.points[i];
    if (!(p.z() > 0.0f) || p.x() < low.x() * p.z() || p.x() > high.x() * p.z() || p.y() < low.y() * p.z() ||
        p.y() > high.y() * p.z())
      return;
    seen[i] = unobstructed(scene.bvh(), samples.points[i], e);
  });
  return seen;
}

/// Share of the samples of fruit `id` that are flagged; 0 for a fruit without samples.
inline double share(const Samples& samples, const Flags& flags, int id) {
  double all = 0.0, flagged = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.fruit[i] != id) continue;
    all += 1.0;
    flagged += flags[i] ? 1.0 : 0.0;
  }
  return all > 0.0 ? flagged / all : 0.0;
}

/// Share of the samples that are flagged; of nothing, or without flags, it is 0.
inline double share(const Samples& samples, const Flags& flags) {
  if (samples.size() == 0 || flags.empty()) return 0.0;
  check_input(flags.size() == samples.size(), "share: flags and samples differ in number");
  const auto flagged = std::count_if(flags.begin(), flags.end(), [](std::uint8_t f) { return f != 0; });
  return static_cast<double>(flagged) / static_cast<double>(samples.size());
}

/// What can be observed of one fruit.
struct FruitShare {
  int id = 0;               ///< of the scene's fruit
  std::size_t samples = 0;  ///< of its surface
  double observable = 0.0;  ///< share of them
};

/// What can be observed of each fruit that has samples, by id.
/// @throws InputError when there are flags and they differ in number from the samples
inline std::vector<FruitShare> fruit_shares(const Samples& samples, const Flags& observable) {
  check_input(observable.empty() || observable.size() == samples.size(),
              "fruit shares: flags and samples differ in number");
  std::vector<FruitShare> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto at = std::lower_bound(out.begin(), out.end(), samples.fruit[i],
                               [](const FruitShare& f, int id) { return f.id < id; });
    if (at == out.end() || at->id != samples.fruit[i]) at = out.insert(at, {samples.fruit[i], 0, 0.0});
    ++at->samples;
    if (!observable.empty() && observable[i]) at->observable += 1.0;
  }
  for (FruitShare& f : out) f.observable /= static_cast<double>(f.samples);
  return out;
}

/// Mean (m) of the flagged samples of fruit `id`; none when there are none.
inline std::optional<Eigen::Vector3d> mean_of(const Samples& samples, const Flags& flags, int id) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double n = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples.fruit[i] == id && flags[i]) sum += samples.points[i].cast<double>(), n += 1.0;
  if (n == 0.0) return std::nullopt;
  return Eigen::Vector3d(sum / n);
}

}  // namespace agrisee::study
