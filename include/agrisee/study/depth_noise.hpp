// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Noise of a simulated depth sensor (noise_model.hpp): errors along the ray, lost returns, flying pixels, and an error
/// in the reported pose. Ranges are in metres along the ray, angles in radians. Every pixel of every view draws its
/// random numbers from a stream of its own, so the result does not depend on the number of threads. The cost is linear
/// in the number of pixels.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/sensor/intrinsics.hpp>
#include <agrisee/study/noise_model.hpp>

#include <cstdint>
#include <vector>

namespace agrisee::study {

/// The images of a camera without errors, row by row.
struct TrueImage {
  std::vector<float> range;            ///< of each pixel along its ray (m); 0 = the ray hits nothing
  std::vector<float> incidence;        ///< angle between ray and surface normal (rad) of each pixel that hits something
  std::vector<std::uint32_t> object;   ///< index of the object that each pixel hits; empty: unknown
  std::vector<ObjectClass> materials;  ///< materials of the objects, by index
  std::vector<float> behind;  ///< distance along the ray from the surface to the next opaque one (m); empty: far away
};

/// The pose that the robot reports for a sensor whose true pose is `world_T_optical`. The error is a normally
/// distributed shift along each axis of the optical frame, and a rotation vector in that frame with a normally
/// distributed error in each component.
/// @throws ParameterError as NoiseModel::check() does
Pose reported_pose(const Pose& world_T_optical, const NoiseModel& model, std::uint64_t seed, std::uint64_t view);

/// The ranges that a sensor measures, given the true ranges. In this order:
///
/// - Stereo: surfaces narrower than NoiseParameters::thin are not seen, and the nearer surface covers up to `smear`
///   pixels beyond its edge.
/// - Light enters translucent objects and returns from some depth, but not from behind the next opaque surface.
/// - Flying pixels. A pixel lies at a depth edge if its depth z differs by more than NoiseParameters::edge from that of
///   one of its four neighbors, or, with a larger `edge_width`, if a surface that is so much nearer lies within that
///   many pixels along its row or column. The share `flying` of these pixels measures a range that is uniformly
///   distributed between the two surfaces. Such a pixel always returns something, whatever the incidence, because its
///   beam falls on both surfaces. With `skirt`, a pixel at an edge with nothing beyond it measures up to that far
///   behind its surface.
/// - Lost returns: by incidence, at random, in patches, and where fruit reflects the beam.
/// - White noise, correlated noise and bias are added, each with its standard deviation at that range.
///
/// Errors that belong to the sensor or to an object (NoiseParameters::waves, translucency) depend on the seed alone and
/// are the same in every view.
/// @param intrinsics of the camera
/// @param truth the images without errors
/// @param max_incidence beyond this angle all returns are lost, except those of flying pixels (rad)
/// @param model the noise model
/// @param seed, view select the random numbers
/// @param threads number of threads; the result does not depend on it
/// @return measured range of each pixel (m), row by row; 0 = no return
/// @throws InputError if the size of an image differs from that of the intrinsics or an object has no material,
/// ParameterError as NoiseModel::check() does
std::vector<float> measured_ranges(const sensor::Intrinsics& intrinsics, const TrueImage& truth, double max_incidence,
                                   const NoiseModel& model, std::uint64_t seed, std::uint64_t view, int threads = 1);

}  // namespace agrisee::study
