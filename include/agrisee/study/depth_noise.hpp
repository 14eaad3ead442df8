// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Noise of a simulated depth sensor: errors along the ray, lost returns, flying pixels, and an error in the reported
/// pose. Ranges are in metres along the ray, angles in radians. Every pixel of every view draws its random numbers from
/// a stream of its own, so the result does not depend on the number of threads. The cost is linear in the number of
/// pixels that return something.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/sensor/intrinsics.hpp>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace agrisee::study {

/// Selects the noise of a simulated sensor.
struct NoiseModel {
  /// The available models.
  enum class Kind {
    none,      ///< no error at all
    gaussian,  ///< independent errors along the ray with the standard deviation `sigma`
    l515,      ///< the published figures of the Intel L515: 2.5 mm at 1 m, 15.5 mm at 9 m
    rough      ///< a worse sensor: correlated noise, range bias, many flying pixels, and a wrong pose
  };
  Kind kind = Kind::none;  ///< the model
  double sigma = 0.0;      ///< standard deviation (m); only `gaussian` reads it

  /// @throws ParameterError if `sigma` is negative or not finite
  void check() const { check_parameter(std::isfinite(sigma) && sigma >= 0.0, "noise sigma", "0 or more", sigma); }
};

/// The figures behind a noise model. The defaults describe a sensor without errors.
struct NoiseParameters {
  double sigma = 0.0;             ///< standard deviation along the ray at range 0 (m)
  double sigma_per_range = 0.0;   ///< increase of the standard deviation per metre of range
  double correlation = 0.0;       ///< distance at which the correlation of the noise falls to 1/e (pixels); 0 = white
  double bias = 0.0;              ///< standard deviation of an error that all ranges of one view share (m)
  double flying = 0.0;            ///< share of the pixels at depth edges that measure between the two surfaces
  double edge = 0.010;            ///< smallest step in depth z between neighbouring pixels that counts as an edge (m)
  double loss_begin = 0.5 * kPi;  ///< angle of incidence above which some returns are lost (rad)
  double loss_end = 0.5 * kPi;    ///< angle of incidence from which all returns are lost (rad)
  double position = 0.0;          ///< standard deviation of the reported position along each axis (m)
  double rotation = 0.0;          ///< standard deviation of the reported rotation about each axis (rad)
};

/// The figures of a model.
/// @throws ParameterError as NoiseModel::check() does
NoiseParameters noise_parameters(const NoiseModel& model);

/// Reads a model from text: `none`, `gaussian:SIGMA` (m), `l515` or `rough`.
/// @throws ParameterError, quoting the text, if it is none of these
NoiseModel parse_noise(const std::string& text);

/// Writes a model as text. parse_noise() turns the text back into exactly the same model.
std::string to_string(const NoiseModel& model);

/// Probability that a return is lost at the angle `incidence` (rad) between ray and surface normal. It rises linearly
/// from 0 at loss_begin to 1 at loss_end.
inline double loss_probability(const NoiseParameters& parameters, double incidence) {
  if (incidence <= parameters.loss_begin) return 0.0;
  if (incidence >= parameters.loss_end) return 1.0;
  return (incidence - parameters.loss_begin) / (parameters.loss_end - parameters.loss_begin);
}

/// The pose that the robot reports for a sensor whose true pose is `world_T_optical`. The error is a normally
/// distributed shift along each axis of the optical frame, and a rotation vector in that frame with a normally
/// distributed error in each component.
/// @throws ParameterError as NoiseModel::check() does
Pose reported_pose(const Pose& world_T_optical, const NoiseModel& model, std::uint64_t seed, std::uint64_t view);

/// The ranges that a sensor measures, given the true ranges.
///
/// A pixel lies at a depth edge if its depth z differs by more than NoiseParameters::edge from that of one of its four
/// neighbours. The share NoiseParameters::flying of these pixels measures a range that is uniformly distributed between
/// the two surfaces. Such a pixel always returns something, whatever the incidence, because its beam falls on both
/// surfaces. Every other pixel loses its return with loss_probability(). Noise and bias are added last.
/// @param intrinsics of the camera
/// @param range true range of each pixel (m), row by row; 0 = the ray hits nothing
/// @param incidence angle between ray and surface normal (rad) of each pixel that hits something
/// @param max_incidence beyond this angle all returns are lost, except those of flying pixels (rad)
/// @param model the noise model
/// @param seed, view select the random numbers
/// @param threads number of threads; the result does not depend on it
/// @return measured range of each pixel (m), row by row; 0 = no return
/// @throws InputError if the size of an image differs from that of the intrinsics, ParameterError as
/// NoiseModel::check() does
std::vector<float> measured_ranges(const sensor::Intrinsics& intrinsics, const std::vector<float>& range,
                                   const std::vector<float>& incidence, double max_incidence, const NoiseModel& model,
                                   std::uint64_t seed, std::uint64_t view, int threads = 1);

}  // namespace agrisee::study
