// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/raycast.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::study {

namespace {

/// Calls f(u, v, i) for every pixel, where i = v * width + u, with the rows spread over threads.
template <typename F>
void for_each_pixel(const sensor::Intrinsics& k, int threads, F&& f) {
  const std::size_t width = static_cast<std::size_t>(k.width);
  parallel_for(
      static_cast<std::size_t>(k.height), threads,
      [&](std::size_t v) {
        for (std::size_t u = 0, i = v * width; u < width; ++u, ++i) f(double(u), double(v), i);
      },
      8);
}

/// The angle between ray and surface normal at each pixel (rad); 0 where the ray hits nothing.
std::vector<float> incidence_angles(const TracedScene& scene, const RayImage& truth, const sensor::Intrinsics& k,
                                    const Pose& world_T_optical, int threads) {
  std::vector<float> incidence(k.size(), 0.0f);
  const Eigen::Matrix3d world_R_optical = world_T_optical.linear();
  for_each_pixel(k, threads, [&](double u, double v, std::size_t i) {
    if (truth.triangle[i] == kNoHit) return;
    const Eigen::Vector3d ray = world_R_optical * k.ray(u, v).normalized();
    const double cosine = std::abs(scene.normal(truth.triangle[i]).cast<double>().dot(ray));
    incidence[i] = static_cast<float>(std::acos(std::min(cosine, 1.0)));
  });
  return incidence;
}

/// Replaces ranges along the ray by depths z (m), and by 0 those outside the sensor's limits.
void ranges_to_depths(std::vector<float>& image, const sensor::DepthCamera& sensor, int threads) {
  const sensor::Intrinsics& k = sensor.intrinsics;
  for_each_pixel(k, threads, [&](double u, double v, std::size_t i) {
    float& z = image[i];
    if (z == 0.0f) return;
    if (double(z) < sensor.range_min || double(z) > sensor.range_max)
      z = 0.0f;
    else
      z = static_cast<float>(double(z) / k.ray(u, v).norm());
  });
}

}  // namespace

Capture capture(const TracedScene& scene, const sensor::DepthCamera& sensor, const Pose& world_T_optical,
                const NoiseModel& noise, std::uint64_t seed, std::uint64_t view, int threads) {
  sensor.check();
  const sensor::Intrinsics& k = sensor.intrinsics;
  const RayImage truth = raycast(scene, k, world_T_optical, sensor.range_min, sensor.range_max, threads);
  const std::vector<float> incidence = incidence_angles(scene, truth, k, world_T_optical, threads);
  Capture out;
  out.frame.intrinsics = k;
  out.frame.depth = measured_ranges(k, truth.range, incidence, sensor.max_incidence, noise, seed, view, threads);
  out.world_T_optical = reported_pose(world_T_optical, noise, seed, view);
  ranges_to_depths(out.frame.depth, sensor, threads);
  return out;
}

}  // namespace agrisee::study
