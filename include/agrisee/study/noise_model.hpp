// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The noise models of the simulated depth cameras, and their figures, compared with those of real cameras by
/// tests/study/sensor_figures_test.cpp. Ranges are in metres along the ray, angles in radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/study/scene.hpp>

#include <array>
#include <cmath>
#include <string>

namespace agrisee::study {

/// The light on the scene. Sunlight contains much infrared light, which disturbs depth cameras.
enum class Light { shade, sun };

/// Selects the noise of a simulated sensor.
struct NoiseModel {
  /// The available models.
  enum class Kind {
    none,        ///< no error at all
    gaussian,    ///< independent errors along the ray with the standard deviation `sigma`
    l515_white,  ///< errors of the size that Intel publishes for the L515, independent from pixel to pixel
    rough,       ///< a worse sensor: correlated noise, range bias, many flying pixels, and a wrong pose
    l515,        ///< Intel RealSense L515: correlated noise, leaves that read too deep, holes where fruit face the beam
    azure,       ///< Microsoft Azure Kinect: like l515, with more flying pixels behind edges
    d405         ///< Intel RealSense D405, a stereo camera: errors grow with the square of the range, edges smear
  };
  Kind kind = Kind::none;      ///< the model
  double sigma = 0.0;          ///< standard deviation (m); only `gaussian` reads it
  Light light = Light::shade;  ///< `sun` only with `l515`, `azure` and `d405`

  /// @throws ParameterError if `sigma` is not from 0 to 0.2 m, or if another model has `sun`
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

/// Correlated noise along the ray: two pixels at an angle of a have the correlation exp(-0.75 (a / spacing)^2).
struct Waves {
  RangeError error;      ///< standard deviation
  double spacing = 0.1;  ///< correlation angle (rad)
  double fixed = 0.5;    ///< share of the variance that is fixed to the sensor, the same in every view
};

/// By how much a material reads too deep, because light enters it.
struct Translucency {
  double depth = 0.0;   ///< mean over objects (m)
  double spread = 0.0;  ///< standard deviation from object to object (m)
};

/// The figures of a noise model. The defaults describe a sensor without errors.
struct NoiseParameters {
  RangeError white;            ///< noise of each pixel, see `correlation`
  double correlation = 0.0;    ///< distance at which the correlation of that noise falls to 1/e (pixels); 0 = white
  std::array<Waves, 2> waves;  ///< fine and wide correlated noise
  double bias = 0.0;           ///< standard deviation of an error common to all ranges of one view (m)

  double flying = 0.0;  ///< share of the pixels at depth edges that measure between the two surfaces
  double edge = 0.010;  ///< smallest step in depth z between neighboring pixels that counts as an edge (m)
  int edge_width = 1;   ///< flying pixels occur up to this many pixels from an edge, fewer with each pixel
  double skirt = 0.0;   ///< how far flying pixels lie behind an edge with nothing beyond it, at most (m)
  int smear = 0;        ///< the nearer surface covers up to this many pixels beyond its edge (pixels); stereo
  int thin = 0;         ///< narrower surfaces are not measured (pixels); stereo

  double loss_begin = 0.5 * kPi;  ///< angle of incidence above which some returns are lost (rad)
  double loss_end = 0.5 * kPi;    ///< angle of incidence from which all returns are lost (rad)
  double loss = 0.0;              ///< share of the pixels that are lost at random
  double patches_least = 0.0;     ///< least share of a view that is lost in patches
  double patches_most = 0.0;      ///< largest share of a view that is lost in patches
  double patch_spacing = 0.05;    ///< size of the patches (rad), as the correlation angle of Waves
  double mirror = 0.0;  ///< fruit returns nothing below this angle of incidence (rad), where it reflects the beam

  std::array<Translucency, 4> translucency;  ///< by ObjectClass
  double unit = 0.0;                         ///< step of the depths z (m); 0 = none

  double position = 0.0;  ///< standard deviation of the reported position along each axis (m)
  double rotation = 0.0;  ///< standard deviation of the reported rotation about each axis (rad)

  /// True if the noise depends on the materials of the objects.
  bool knows_materials() const;
};

/// The figures of a model.
/// @throws ParameterError as NoiseModel::check() does
NoiseParameters noise_parameters(const NoiseModel& model);

/// The names of the models, for help texts.
constexpr const char* kNoiseNames =
    "none, gaussian:SIGMA (metres: gaussian:0.001), l515, azure, d405, l515-white or rough";

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
