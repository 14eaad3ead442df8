// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a depth sensor adds to the truth: noise along the ray, lost returns, flying pixels, a wrong pose. Ranges in
/// metres along the ray, angles in radians. Every draw comes from a stream of its own, named by seed, view and pixel,
/// so the result does not depend on the number of threads. Cost: linear in the pixels that return something.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/sensor/intrinsics.hpp>

#include <limits>
#include <locale>
#include <sstream>

namespace agrisee::sensor {

/// Which noise a simulated sensor has.
struct NoiseModel {
  /// Its kind.
  enum class Kind {
    none,      ///< the truth
    gaussian,  ///< independent along the ray, standard deviation `sigma`
    l515,      ///< fits the sensor's published figures (2.5 mm at 1 m, 15.5 mm at 9 m)
    rough      ///< a harder sensor: correlated noise, range bias, many flying pixels, a wrong pose
  };
  Kind kind = Kind::none;  ///< which
  double sigma = 0.0;      ///< m; of `gaussian` alone

  /// @throws ParameterError
  void check() const { check_parameter(std::isfinite(sigma) && sigma >= 0.0, "noise sigma", "0 or more", sigma); }
};

/// What a model is made of. The defaults add nothing.
struct NoiseParameters {
  double sigma = 0.0;             ///< standard deviation along the ray at range 0 (m)
  double sigma_per_range = 0.0;   ///< its growth per metre of range
  double correlation = 0.0;       ///< distance at which the noise's correlation is 1/e (pixels); 0 = independent
  double bias = 0.0;              ///< standard deviation of an error common to all ranges of a view (m)
  double flying = 0.0;            ///< share of the pixels at depth edges that measure between the two surfaces
  double edge = 0.010;            ///< smallest step in depth z between neighbouring pixels that is an edge (m)
  double loss_begin = 0.5 * kPi;  ///< incidence at which returns begin to be lost (rad)
  double loss_end = 0.5 * kPi;    ///< incidence from which all are lost (rad)
  double position = 0.0;          ///< standard deviation of the reported position, each axis (m)
  double rotation = 0.0;          ///< standard deviation of the reported rotation about each axis (rad)
};

/// The parameters of a model.
inline NoiseParameters noise_parameters(const NoiseModel& model) {
  model.check();
  NoiseParameters p;
  switch (model.kind) {
    case NoiseModel::Kind::none:
      break;
    case NoiseModel::Kind::gaussian:
      p.sigma = model.sigma;
      break;
    case NoiseModel::Kind::l515:
      p.sigma = 0.0009;
      p.sigma_per_range = 0.0016;
      p.flying = 0.2;
      break;
    case NoiseModel::Kind::rough:
      p.sigma = 0.002;
      p.correlation = 3.0;
      p.bias = 0.0015;
      p.flying = 0.5;
      p.position = 0.0005;
      p.rotation = deg(0.1);
      break;
  }
  if (model.kind == NoiseModel::Kind::l515 || model.kind == NoiseModel::Kind::rough) {
    p.loss_begin = deg(60);
    p.loss_end = deg(80);
  }
  return p;
}

/// The model named by `none`, `gaussian:SIGMA` (m), `l515` or `rough`.
/// @throws ParameterError quoting a text that is none of these
inline NoiseModel parse_noise(const std::string& text) {
  if (text == "none") return {};
  if (text == "l515") return {NoiseModel::Kind::l515, 0.0};
  if (text == "rough") return {NoiseModel::Kind::rough, 0.0};
  const std::string prefix = "gaussian:";
  if (text.compare(0, prefix.size(), prefix) == 0) {
    std::istringstream in(text.substr(prefix.size()));
    in.imbue(std::locale::classic());
    NoiseModel model{NoiseModel::Kind::gaussian, -1.0};
    in >> std::noskipws >> model.sigma;
    if (in && in.peek() == std::istringstream::traits_type::eof() && model.sigma >= 0.0 && std::isfinite(model.sigma))
      return model;
  }
  throw ParameterError("noise must be none, gaussian:SIGMA (metres, 0 or more), l515 or rough, got '" + text + "'");
}

/// The text that parse_noise() turns into the same model.
inline std::string to_string(const NoiseModel& model) {
  switch (model.kind) {
    case NoiseModel::Kind::none:
      return "none";
    case NoiseModel::Kind::l515:
      return "l515";
    case NoiseModel::Kind::rough:
      return "rough";
    case NoiseModel::Kind::gaussian:
      break;
  }
  for (int digits = 1;; ++digits) {  // as few as give the number back
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << "gaussian:" << model.sigma;
    if (digits >= 17 || parse_noise(out.str()).sigma == model.sigma) return out.str();
  }
}

/// Probability that a return is lost at an angle (rad) between ray and surface normal: rises linearly.
inline double loss_probability(const NoiseParameters& p, double incidence) {
  if (incidence <= p.loss_begin) return 0.0;
  return incidence >= p.loss_end ? 1.0 : (incidence - p.loss_begin) / (p.loss_end - p.loss_begin);
}

/// The pose that the robot reports for a sensor at `world_T_optical`: shifted by a normal error along each axis of the
/// optical frame and turned about it by a rotation vector with a normal error in each component.
inline Pose reported_pose(const Pose& world_T_optical, const NoiseModel& model, std::uint64_t seed, std::uint64_t view);

/// The ranges that a sensor measures where the true ones are `range`.
///
/// A pixel at a depth edge (its depth z differs by more than the limit from that of one of its four neighbours) flies
/// with the share given: its range is then uniform between the two surfaces, and whether it returns does not depend on
/// incidence, as its beam falls on both. All others are lost by their incidence. Noise and bias come on top.
/// @param intrinsics of the camera
/// @param range        true range of each pixel (m), row by row; 0 = nothing is met
/// @param incidence    angle between ray and surface normal where something is met (rad)
/// @param max_incidence returns beyond it are always lost (rad)
/// @param model of the noise
/// @param seed names the random draws, with `view`
/// @param view number of the view
/// @param threads the result does not depend on it
/// @return as `range`; 0 = no return
/// @throws InputError when an image is not as large as the intrinsics say
inline std::vector<float> measured_ranges(const Intrinsics& intrinsics, const std::vector<float>& range,
                                          const std::vector<float>& incidence, double max_incidence,
                                          const NoiseModel& model, std::uint64_t seed, std::uint64_t view,
                                          int threads = 1);

namespace detail {

/// Substreams of a view; pixel i draws from substream i.
constexpr std::uint64_t kViewStream = std::uint64_t{1} << 63;
constexpr std::uint64_t kFieldStream = std::uint64_t{1} << 62;

/// A rectangle of pixels [u0, u1) x [v0, v1).
struct PixelBounds {
  int u0 = std::numeric_limits<int>::max(), v0 = std::numeric_limits<int>::max(), u1 = 0, v1 = 0;
};

inline PixelBounds bounds_of_returns(const Intrinsics& k, const std::vector<float>& range) {
  PixelBounds b;
  std::size_t i = 0;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u, ++i)
      if (range[i] > 0.0f) {
        b.u0 = std::min(b.u0, u), b.u1 = std::max(b.u1, u + 1);
        b.v0 = std::min(b.v0, v), b.v1 = v + 1;
      }
  return b;
}

/// Standard normal noise over the pixels of `b`, row by row, whose correlation is exp(-(d / length)^2) at d pixels:
/// white noise under a Gaussian window of standard deviation length / 2. A pixel's value does not depend on `b`.
inline std::vector<float> correlated_noise(const PixelBounds& b, double length, std::uint64_t seed, std::uint64_t view,
                                           int threads) {
  const int r = static_cast<int>(std::ceil(2.0 * length));  // four standard deviations
  std::vector<float> window;
  double squares = 0.0;
  for (int i = -r; i <= r; ++i) {
    const double w = std::exp(-2.0 * i * i / (length * length));
    window.push_back(static_cast<float>(w));
    squares += w * w;
  }
  for (float& w : window) w /= static_cast<float>(std::sqrt(squares));
  const std::size_t width = static_cast<std::size_t>(b.u1 - b.u0), height = static_cast<std::size_t>(b.v1 - b.v0);
  const std::size_t taps = window.size();
  std::vector<float> smooth((height + taps - 1) * width), out(height * width, 0.0f);
  parallel_chunks(height + taps - 1, threads, 16, [&](std::size_t begin, std::size_t end) {  // along the rows
    std::vector<float> white(width + taps - 1);
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < white.size(); ++x) {
        const auto row = static_cast<std::uint64_t>(b.v0) + y, column = static_cast<std::uint64_t>(b.u0) + x;
        white[x] = static_cast<float>(Rng(seed, view, kFieldStream | row << 31 | column).normal());
      }
      float* const to = &smooth[y * width];
      for (std::size_t x = 0; x < width; ++x) {
        float sum = 0.0f;
        for (std::size_t i = 0; i < taps; ++i) sum += window[i] * white[x + i];
        to[x] = sum;
      }
    }
  });
  parallel_chunks(height, threads, 16, [&](std::size_t begin, std::size_t end) {  // across them
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t i = 0; i < taps; ++i) {
        const float* const from = &smooth[(y + i) * width];
        for (std::size_t x = 0; x < width; ++x) out[y * width + x] += window[i] * from[x];
      }
  });
  return out;
}

/// Depth z (m) of the neighbour of pixel (u, v) across the largest step in depth above `edge`; 0 = no such neighbour.
inline double across_edge(const Intrinsics& k, const std::vector<float>& range, int u, int v, double z, double edge) {
  double other = 0.0;
  const int neighbours[4][2] = {{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}};
  for (const auto& [nu, nv] : neighbours) {
    if (nu < 0 || nv < 0 || nu >= k.width || nv >= k.height) continue;
    const float r =
        range[static_cast<std::size_t>(nv) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(nu)];
    if (!(r > 0.0f)) continue;
    const double nz = double(r) / k.ray(nu, nv).norm();
    if (std::abs(nz - z) > edge) {
      edge = std::abs(nz - z);
      other = nz;
    }
  }
  return other;
}

}  // namespace detail

inline Pose reported_pose(const Pose& world_T_optical, const NoiseModel& model, std::uint64_t seed,
                          std::uint64_t view) {
  const NoiseParameters p = noise_parameters(model);
  if (p.position == 0.0 && p.rotation == 0.0) return world_T_optical;
  Rng rng(seed, view, detail::kViewStream | 1);
  Eigen::Vector3d shift, turn;
  for (int a = 0; a < 3; ++a) shift[a] = p.position * rng.normal();
  for (int a = 0; a < 3; ++a) turn[a] = p.rotation * rng.normal();
  Pose error = Pose::Identity();
  const double angle = turn.norm();
  if (angle > 0.0) error.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  error.translation() = shift;
  return world_T_optical * error;
}

inline std::vector<float> measured_ranges(const Intrinsics& k, const std::vector<float>& range,
                                          const std::vector<float>& incidence, double max_incidence,
                                          const NoiseModel& model, std::uint64_t seed, std::uint64_t view,
                                          int threads) {
  check_input(range.size() == k.size() && incidence.size() == k.size(),
              "measured ranges: the image size differs from its intrinsics");
  const NoiseParameters p = noise_parameters(model);
  std::vector<float> out(range.size(), 0.0f);
  const detail::PixelBounds b = detail::bounds_of_returns(k, range);
  if (b.u1 == 0) return out;
  std::vector<float> field;
  if (p.correlation > 0.0) field = detail::correlated_noise(b, p.correlation, seed, view, threads);
  const double bias = p.bias * Rng(seed, view, detail::kViewStream).normal();
  const std::size_t width = static_cast<std::size_t>(k.width), field_width = static_cast<std::size_t>(b.u1 - b.u0);
  parallel_for(
      static_cast<std::size_t>(b.v1 - b.v0), threads,
      [&](std::size_t row) {
        const int v = b.v0 + static_cast<int>(row);
        for (int u = b.u0; u < b.u1; ++u) {
          const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
          if (!(range[i] > 0.0f)) continue;
          double r = double(range[i]);
          Rng rng(seed, view, i);
          const double white = rng.normal(), loss = rng.uniform(), fly = rng.uniform(), where = rng.uniform();
          double other = 0.0;
          const double slant = p.flying > 0.0 ? k.ray(u, v).norm() : 1.0;
          if (fly < p.flying) other = detail::across_edge(k, range, u, v, r / slant, p.edge);
          if (other > 0.0)
            r += where * (other * slant - r);
          else if (double(incidence[i]) > max_incidence || loss < loss_probability(p, double(incidence[i])))
            continue;
          const double noise =
              field.empty() ? white : double(field[row * field_width + static_cast<std::size_t>(u - b.u0)]);
          r += bias + (p.sigma + p.sigma_per_range * r) * noise;
          if (r > 0.0) out[i] = static_cast<float>(r);
        }
      },
      8);
  return out;
}

}  // namespace agrisee::sensor
