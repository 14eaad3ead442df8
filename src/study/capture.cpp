// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/raycast.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

/// From the surface of each translucent object on along the ray: how far to the next surface that light does not enter
/// (m). Infinite where there is none, and for all other objects.
std::vector<float> distances_behind(const TracedScene& scene, const TrueImage& truth, const NoiseParameters& noise,
                                    const sensor::Intrinsics& k, const Pose& world_T_optical, int threads) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  std::vector<float> behind(k.size(), kFar);
  if (scene.solids().size() == 0) return behind;
  const Eigen::Matrix3d world_R_optical = world_T_optical.linear();
  const Eigen::Vector3d eye = world_T_optical.translation();
  for_each_pixel(k, threads, [&](double u, double v, std::size_t i) {
    if (!(truth.range[i] > 0.0f)) return;
    const Translucency& t = noise.translucency[static_cast<std::size_t>(truth.materials[truth.object[i]])];
    if (!(t.depth > 0.0)) return;
    const Eigen::Vector3d ray = world_R_optical * k.ray(u, v).normalized();
    const Eigen::Vector3f from = (eye + double(truth.range[i]) * ray).cast<float>();
    const float reach = static_cast<float>(2.0 * (t.depth + 4.0 * t.spread));
    if (const auto hit = scene.solids().closest(from, ray.cast<float>(), 0.0f, reach)) behind[i] = hit->t;
  });
  return behind;
}

/// What the camera would see without errors.
TrueImage true_image(const TracedScene& scene, const sensor::DepthCamera& sensor, const Pose& world_T_optical,
                     const NoiseParameters& noise, int threads) {
  const sensor::Intrinsics& k = sensor.intrinsics;
  RayImage rays = raycast(scene, k, world_T_optical, sensor.range_min, sensor.range_max, threads);
  TrueImage out;
  out.incidence = incidence_angles(scene, rays, k, world_T_optical, threads);
  if (noise.knows_materials()) {
    out.materials = scene.materials();
    out.object.resize(k.size());
    for_each_pixel(k, threads, [&](double, double, std::size_t i) {
      if (rays.triangle[i] != kNoHit) out.object[i] = scene.object(rays.triangle[i]);
    });
  }
  out.range = std::move(rays.range);
  if (noise.knows_materials()) out.behind = distances_behind(scene, out, noise, k, world_T_optical, threads);
  return out;
}

/// Replaces ranges along the ray by depths z (m) that are multiples of `unit` (m; 0 = any), and by 0 those outside the
/// sensor's limits.
void ranges_to_depths(std::vector<float>& image, const sensor::DepthCamera& sensor, double unit, int threads) {
  const sensor::Intrinsics& k = sensor.intrinsics;
  for_each_pixel(k, threads, [&](double u, double v, std::size_t i) {
    float& z = image[i];
    if (z == 0.0f) return;
    if (double(z) < sensor.range_min || double(z) > sensor.range_max)
      z = 0.0f;
    else
      z = static_cast<float>(double(z) / k.ray(u, v).norm());
    if (unit > 0.0) z = static_cast<float>(std::round(double(z) / unit) * unit);
  });
}

}  // namespace

Capture capture(const TracedScene& scene, const sensor::DepthCamera& sensor, const Pose& world_T_optical,
                const NoiseModel& noise, std::uint64_t seed, std::uint64_t view, int threads) {
  sensor.check();
  const sensor::Intrinsics& k = sensor.intrinsics;
  const NoiseParameters parameters = noise_parameters(noise);
  const TrueImage truth = true_image(scene, sensor, world_T_optical, parameters, threads);
  Capture out;
  out.frame.intrinsics = k;
  out.frame.depth = measured_ranges(k, truth, sensor.max_incidence, noise, seed, view, threads);
  out.world_T_optical = reported_pose(world_T_optical, noise, seed, view);
  ranges_to_depths(out.frame.depth, sensor, parameters.unit, threads);
  return out;
}

void add_images(sensor::DepthFrame& frame, const TracedScene& scene, const sensor::DepthCamera& sensor,
                const Pose& world_T_optical, const ImageOptions& options, std::uint64_t seed, std::uint64_t view,
                int threads) {
  if (!options.any()) return;
  const sensor::Intrinsics& k = frame.intrinsics;
  const RayImage rays = raycast(scene, k, world_T_optical, 0.0, sensor.range_max, threads);
  if (options.color) frame.color = color_image(scene, rays, k, world_T_optical, options.light, seed, view, threads);
  if (options.detector) detect(frame, scene, rays, world_T_optical, *options.detector, seed, view);
}

}  // namespace agrisee::study
