// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The Intel RealSense L515, simulated: a depth frame by ray casting (raycast.hpp) under a noise model
/// (depth_noise.hpp).
#pragma once

#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/depth_noise.hpp>
#include <agrisee/sensor/raycast.hpp>

namespace agrisee::sensor {

/// An L515: 1024 x 768 pixels over 70 x 55 degrees, 0.25 to 9 m (published figures), surfaces seen below 80 degrees of
/// incidence.
struct L515 {
  Intrinsics intrinsics = intrinsics_from_fov(1024, 768, deg(70), deg(55));  ///< of the depth image
  double range_min = 0.25;                                                   ///< shortest distance along the ray (m)
  double range_max = 9.0;                                                    ///< longest distance along the ray (m)
  double max_incidence = deg(80);  ///< largest angle between ray and surface normal that still returns (rad)

  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(std::isfinite(range_min) && range_min >= 0.0, "sensor.range_min", "0 or more", range_min);
    check_parameter(std::isfinite(range_max) && range_max > range_min, "sensor.range_max", "above range_min",
                    range_max);
    check_parameter(max_incidence > 0.0 && max_incidence <= 0.5 * kPi, "sensor.max_incidence", "in (0, pi/2]",
                    max_incidence);
  }
};

/// One simulated look.
struct Capture {
  DepthFrame frame;      ///< depth z (m), as measured; 0 = no return
  Pose world_T_optical;  ///< as the robot reports it; noise model `rough` makes it differ from the truth
};

/// Look at a scene from `world_T_optical` (the true pose). A surface nearer than `range_min` hides what is behind it
/// and returns nothing; a measured range outside of the limits is no return either.
/// @param scene what is seen
/// @param sensor camera and range
/// @param world_T_optical true pose of the sensor
/// @param noise model of the noise
/// @param seed, view name the random draws: the same pair gives the same frame, other pairs give independent ones
/// @param threads    the result does not depend on it
/// @throws ParameterError for unusable limits or noise, InputError for an unusable camera
inline Capture capture(const TracedScene& scene, const L515& sensor, const Pose& world_T_optical,
                       const NoiseModel& noise, std::uint64_t seed, std::uint64_t view, int threads = 1) {
  sensor.check();
  const Intrinsics& k = sensor.intrinsics;
  const RayImage truth = raycast(scene, k, world_T_optical, sensor.range_min, sensor.range_max, threads);
  const std::size_t width = static_cast<std::size_t>(k.width), height = static_cast<std::size_t>(k.height);

  std::vector<float> incidence(k.size(), 0.0f);
  const Eigen::Matrix3d world_R_optical = world_T_optical.linear();
  parallel_for(
      height, threads,
      [&](std::size_t v) {
        for (std::size_t u = 0, i = v * width; u < width; ++u, ++i) {
          if (truth.triangle[i] == kNoHit) continue;
          const Eigen::Vector3d ray = world_R_optical * k.ray(double(u), double(v)).normalized();
          const double cosine = std::abs(scene.normal(truth.triangle[i]).cast<double>().dot(ray));
          incidence[i] = static_cast<float>(std::acos(std::min(cosine, 1.0)));
        }
      },
      8);

  Capture out;
  out.frame.intrinsics = k;
  out.frame.depth = measured_ranges(k, truth.range, incidence, sensor.max_incidence, noise, seed, view, threads);
  out.world_T_optical = reported_pose(world_T_optical, noise, seed, view);
  parallel_for(
      height, threads,
      [&](std::size_t v) {  // ranges along the ray to depths z
        for (std::size_t u = 0, i = v * width; u < width; ++u, ++i) {
          float& z = out.frame.depth[i];
          if (z == 0.0f) continue;
          if (double(z) < sensor.range_min || double(z) > sensor.range_max)
            z = 0.0f;
          else
            z = static_cast<float>(double(z) / k.ray(double(u), double(v)).norm());
        }
      },
      8);
  return out;
}

}  // namespace agrisee::sensor
