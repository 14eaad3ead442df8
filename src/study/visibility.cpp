// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::study {

namespace {

/// Rays start this far (m) from the surface that they leave.
constexpr float kRayOffset = 1e-5f;

/// Whether nothing lies between the surface point p and the eye.
bool unobstructed(const Bvh& bvh, const Eigen::Vector3f& p, const Eigen::Vector3f& eye) {
  const Eigen::Vector3f to_eye = eye - p;
  return !bvh.any(p, to_eye, kRayOffset / to_eye.norm(), 1.0f);
}

}  // namespace

Flags visible_from(const TracedScene& scene, const Samples& samples, const Eigen::Vector3d& eye, double max_incidence,
                   int threads) {
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

Flags visible_to(const TracedScene& scene, const Samples& samples, const Pose& world_T_optical,
                 const sensor::DepthCamera& sensor, int threads) {
  Flags seen(samples.size(), 0);
  const Eigen::Vector3f e = world_T_optical.translation().cast<float>();
  const Eigen::Isometry3f optical_T_world = world_T_optical.inverse().cast<float>();
  const sensor::Intrinsics& k = sensor.intrinsics;
  const auto least = static_cast<float>(std::max(0.0, std::cos(sensor.max_incidence)));
  const auto range_min = static_cast<float>(sensor.range_min), range_max = static_cast<float>(sensor.range_max);
  // The borders of the image on the plane z = 1, half a pixel outside the centers of the outermost pixels.
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

double share(const Samples& samples, const Flags& flags, int id) {
  double all = 0.0, flagged = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.fruit[i] != id) continue;
    all += 1.0;
    flagged += flags[i] ? 1.0 : 0.0;
  }
  return all > 0.0 ? flagged / all : 0.0;
}

double share(const Samples& samples, const Flags& flags) {
  if (samples.size() == 0 || flags.empty()) return 0.0;
  check_input(flags.size() == samples.size(), "share: flags and samples differ in number");
  const auto flagged = std::count_if(flags.begin(), flags.end(), [](std::uint8_t f) { return f != 0; });
  return static_cast<double>(flagged) / static_cast<double>(samples.size());
}

std::vector<FruitShare> fruit_shares(const Samples& samples, const Flags& observable) {
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

std::optional<Eigen::Vector3d> mean_of(const Samples& samples, const Flags& flags, int id) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double n = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples.fruit[i] == id && flags[i]) sum += samples.points[i].cast<double>(), n += 1.0;
  if (n == 0.0) return std::nullopt;
  return Eigen::Vector3d(sum / n);
}

}  // namespace agrisee::study
