// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/study/depth_noise.hpp>

#include <algorithm>
#include <limits>
#include <locale>
#include <sstream>

namespace agrisee::study {

NoiseParameters noise_parameters(const NoiseModel& model) {
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

NoiseModel parse_noise(const std::string& text) {
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

std::string to_string(const NoiseModel& model) {
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
  for (int digits = 1;; ++digits) {  // the fewest digits that give the same number back
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << "gaussian:" << model.sigma;
    if (digits >= 17 || parse_noise(out.str()).sigma == model.sigma) return out.str();
  }
}

namespace {

// The random substreams of a view. Pixel i draws from substream i; these bits mark the others.
constexpr std::uint64_t kViewStream = std::uint64_t{1} << 63;   // what the whole view shares
constexpr std::uint64_t kFieldStream = std::uint64_t{1} << 62;  // the correlated noise

/// A rectangle of pixels [u0, u1) x [v0, v1).
struct PixelBounds {
  int u0 = std::numeric_limits<int>::max(), v0 = std::numeric_limits<int>::max(), u1 = 0, v1 = 0;
};

/// The smallest rectangle that contains all pixels with a range; u1 = 0 if there are none.
PixelBounds bounds_of_returns(const sensor::Intrinsics& k, const std::vector<float>& range) {
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

/// A Gaussian window of standard deviation length / 2 (pixels), cut off at four standard deviations. The sum of the
/// squared weights is 1, so that the window keeps the variance of white noise.
std::vector<float> gaussian_window(double length) {
  const int r = static_cast<int>(std::ceil(2.0 * length));
  std::vector<float> window;
  double squares = 0.0;
  for (int i = -r; i <= r; ++i) {
    const double w = std::exp(-2.0 * i * i / (length * length));
    window.push_back(static_cast<float>(w));
    squares += w * w;
  }
  for (float& w : window) w /= static_cast<float>(std::sqrt(squares));
  return window;
}

/// Standard normal noise at the pixels of `b`, row by row, whose correlation is exp(-(d / length)^2) at a distance of d
/// pixels: white noise filtered with gaussian_window(), first along the rows, then along the columns. The value of a
/// pixel does not depend on `b`.
std::vector<float> correlated_noise(const PixelBounds& b, double length, std::uint64_t seed, std::uint64_t view,
                                    int threads) {
  const std::vector<float> window = gaussian_window(length);
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
  parallel_chunks(height, threads, 16, [&](std::size_t begin, std::size_t end) {  // along the columns
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t i = 0; i < taps; ++i) {
        const float* const from = &smooth[(y + i) * width];
        for (std::size_t x = 0; x < width; ++x) out[y * width + x] += window[i] * from[x];
      }
  });
  return out;
}

/// Compares pixel (u, v), whose depth is z (m), with its four neighbours. Returns the depth z (m) of the neighbour
/// across the largest step in depth, or 0 if no step is larger than `edge` (m).
double across_edge(const sensor::Intrinsics& k, const std::vector<float>& range, int u, int v, double z, double edge) {
  double other = 0.0;
  const int neighbors[4][2] = {{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}};
  for (const auto& [nu, nv] : neighbors) {
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

}  // namespace

Pose reported_pose(const Pose& world_T_optical, const NoiseModel& model, std::uint64_t seed, std::uint64_t view) {
  const NoiseParameters p = noise_parameters(model);
  if (p.position == 0.0 && p.rotation == 0.0) return world_T_optical;
  Rng rng(seed, view, kViewStream | 1);
  Eigen::Vector3d shift, turn;
  for (int a = 0; a < 3; ++a) shift[a] = p.position * rng.normal();
  for (int a = 0; a < 3; ++a) turn[a] = p.rotation * rng.normal();
  Pose error = Pose::Identity();
  const double angle = turn.norm();
  if (angle > 0.0) error.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  error.translation() = shift;
  return world_T_optical * error;
}

std::vector<float> measured_ranges(const sensor::Intrinsics& intrinsics, const std::vector<float>& range,
                                   const std::vector<float>& incidence, double max_incidence, const NoiseModel& model,
                                   std::uint64_t seed, std::uint64_t view, int threads) {
  const sensor::Intrinsics& k = intrinsics;
  check_input(range.size() == k.size() && incidence.size() == k.size(),
              "measured ranges: the image size differs from its intrinsics");
  const NoiseParameters p = noise_parameters(model);
  std::vector<float> out(range.size(), 0.0f);
  const PixelBounds b = bounds_of_returns(k, range);
  if (b.u1 == 0) return out;
  std::vector<float> field;
  if (p.correlation > 0.0) field = correlated_noise(b, p.correlation, seed, view, threads);
  const double bias = p.bias * Rng(seed, view, kViewStream).normal();
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
          double other = 0.0;  // depth z of the surface across the edge, if the pixel flies
          const double slant = p.flying > 0.0 ? k.ray(u, v).norm() : 1.0;
          if (fly < p.flying) other = across_edge(k, range, u, v, r / slant, p.edge);
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

}  // namespace agrisee::study
