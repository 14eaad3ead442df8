// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The noise models of the simulated depth cameras, and the figures behind them. docs/sensors.md compares the figures
/// with those of real cameras. Ranges are in metres along the ray, angles in radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/study/scene.hpp>

#include <array>
#include <cmath>
#include <string>

namespace agrisee::study {

/// The light that falls on the scene. Sunlight holds much of the infrared that a camera looks for.
enum class Light { shade, sun };

/// Selects the noise of a simulated sensor.
struct NoiseModel {
  /// The available models.
  enum class Kind {
    none,        ///< no error at all
    gaussian,    ///< independent errors along the ray with the standard deviation `sigma`
    l515_white,  ///< errors of the size that Intel publishes for the L515, independent from pixel to pixel
    rough,       ///< a worse sensor: correlated noise, range bias, many flying pixels, and a wrong pose
    l515,        ///< Intel RealSense L515: waves, leaves that read too deep, holes where a fruit mirrors the beam
    azure,       ///< Microsoft Azure Kinect: as l515, with wide skirts behind every rim
    d405         ///< Intel RealSense D405, a stereo camera: errors grow with the square of the range, edges smear
  };
  Kind kind = Kind::none;      ///< the model
  double sigma = 0.0;          ///< standard deviation (m); only `gaussian` reads it
  Light light = Light::shade;  ///< only `l515`, `azure` and `d405` may have `sun`

  /// @throws ParameterError if `sigma` is negative or not finite, or if a model that knows no light has `sun`
  void check() const;
};

/// The standard deviation of an error that depends on the range: constant + linear r + quadratic r^2 (m).
struct RangeError {
  double constant = 0.0;   ///< m
  double linear = 0.0;     ///< m per metre
  double quadratic = 0.0;  ///< m per square metre

  /// Standard deviation (m) at a range of r metres.
  double at(double r) const { return constant + r * (linear + r * quadratic); }
  /// True if there is no error at any range.
  bool zero() const { return constant == 0.0 && linear == 0.0 && quadratic == 0.0; }
};

/// A smooth random error along the ray. Two pixels at an angle of a have the correlation exp(-0.75 (a / spacing)^2).
struct Waves {
  RangeError error;      ///< its standard deviation
  double spacing = 0.1;  ///< how far the waves reach (rad)
  double fixed = 0.5;    ///< share of the variance that belongs to the sensor: it is the same in every view
};

/// How much too deep a material reads, because light enters it.
struct Translucency {
  double depth = 0.0;   ///< mean over objects (m)
  double spread = 0.0;  ///< standard deviation from object to object (m)
};

/// The figures behind a noise model. The defaults describe a sensor without errors.
struct NoiseParameters {
  RangeError white;            ///< independent from pixel to pixel
  double correlation = 0.0;    ///< distance at which the correlation of that noise falls to 1/e (pixels); 0 = white
  std::array<Waves, 2> waves;  ///< fine ones and wide ones
  double bias = 0.0;           ///< standard deviation of an error that all ranges of one view share (m)

  double flying = 0.0;  ///< share of the pixels at depth edges that measure between the two surfaces
  double edge = 0.010;  ///< smallest step in depth z between neighbouring pixels that counts as an edge (m)
  int edge_width = 1;   ///< pixels fly up to so many pixels behind an edge, fewer of them with each pixel
  double skirt = 0.0;   ///< how far behind a rim its pixels may fly if nothing stands behind it (m)
  int smear = 0;        ///< the nearer surface covers up to so many pixels beyond its edge (pixels); stereo
  int thin = 0;         ///< what is narrower is not measured (pixels); stereo

  double loss_begin = 0.5 * kPi;  ///< angle of incidence above which some returns are lost (rad)
  double loss_end = 0.5 * kPi;    ///< angle of incidence from which all returns are lost (rad)
  double loss = 0.0;              ///< share of the pixels that are lost one by one, whatever they see
  double patches_least = 0.0;     ///< least share of a view that is lost in patches
  double patches_most = 0.0;      ///< largest share of a view that is lost in patches
  double patch_spacing = 0.05;    ///< how far a patch reaches (rad), see Waves
  double mirror = 0.0;  ///< a fruit sends nothing back where the incidence is smaller (rad): it mirrors the beam

  std::array<Translucency, 4> translucency;  ///< by ObjectClass
  double unit = 0.0;                         ///< step of the depths z (m); 0 = none

  double position = 0.0;  ///< standard deviation of the reported position along each axis (m)
  double rotation = 0.0;  ///< standard deviation of the reported rotation about each axis (rad)

  /// True if the noise depends on what the objects are made of.
  bool knows_materials() const;
};

/// The figures of a model.
/// @throws ParameterError as NoiseModel::check() does
NoiseParameters noise_parameters(const NoiseModel& model);

/// How users write the models.
constexpr const char* kNoiseNames = "none, gaussian:SIGMA (metres, 0 or more), l515, azure, d405, l515-white or rough";

/// Reads a model from text: one of kNoiseNames; `l515`, `azure` and `d405` may be followed by `:shade` or `:sun`.
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

}  // namespace agrisee::study
