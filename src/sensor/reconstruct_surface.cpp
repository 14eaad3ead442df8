// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/median.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

#include <algorithm>
#include <array>

#include "paraboloid.hpp"

namespace agrisee::sensor {
namespace {

using detail::ParaboloidSums;
using detail::Tap;

/// Robust standard deviation (m) of an image's noise, from second differences of pixels `lag` apart along rows (median
/// of their sizes, scaled to a Gaussian). Differences across invalid pixels are left out.
double image_noise(const std::vector<float>& z, int width, int height, int lag) {
  std::vector<float> d;
  for (int v = 0; v < height; ++v)
    for (int u = lag; u + lag < width; ++u) {
      const float* c = &z[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
      if (c[-lag] > 0.0f && c[0] > 0.0f && c[lag] > 0.0f) d.push_back(std::abs(c[-lag] - 2.0f * c[0] + c[lag]));
    }
  return 1.4826 * static_cast<double>(median(d)) / std::sqrt(6.0);
}

/// The pixels inside the volume.
struct Crop {
  std::vector<float> depth;  ///< z (m) of each pixel; 0 where it is invalid or outside
  std::size_t pixels = 0;    ///< how many are inside
  double typical = 1.0;      ///< their median depth (m)
};

Crop crop(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume) {
  const Intrinsics& k = frame.intrinsics;
  const std::size_t width = static_cast<std::size_t>(k.width);
  const Eigen::Matrix3d rotation = world_T_optical.linear();
  const Eigen::Vector3d origin = world_T_optical.translation();
  Crop out;
  out.depth.assign(k.size(), 0.0f);
  std::vector<float> depths;
  depths.reserve(k.size() / 4);
  for (int v = 0; v < k.height; ++v) {
    const float* row = &frame.depth[static_cast<std::size_t>(v) * width];
    // The ray of column u at z = 1, in world, is left + u * pitch.
    const Eigen::Vector3d left = rotation * k.ray(0.0, v), pitch = rotation.col(0) / k.fx;
    for (int u = 0; u < k.width; ++u) {
      const float z = row[u];
      if (!DepthFrame::valid(z)) continue;
      if (!volume.contains(Eigen::Vector3d(origin + (left + double(u) * pitch) * double(z)))) continue;
      out.depth[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] = z;
      depths.push_back(z);
    }
  }
  out.pixels = depths.size();
  if (out.pixels) out.typical = static_cast<double>(median(depths));
  return out;
}

/// Intrinsics of an image whose pixels are blocks of b x b pixels.
Intrinsics block_intrinsics(const Intrinsics& k, int b) {
  Intrinsics cells;
  cells.width = (k.width + b - 1) / b;
  cells.height = (k.height + b - 1) / b;
  cells.fx = k.fx / b;
  cells.fy = k.fy / b;
  cells.cx = (k.cx + 0.5) / b - 0.5;
  cells.cy = (k.cy + 0.5) / b - 0.5;
  return cells;
}

/// The pixels of a block that agree with its median: their mean pixel (in cells) and depth (m). z = 0: there are none.
struct Block {
  float u = 0.0f, v = 0.0f, z = 0.0f;
};

/// The image as blocks of b x b pixels.
struct Blocks {
  Intrinsics cells;           ///< of the blocks
  std::vector<Block> blocks;  ///< row by row
  std::vector<float> depth;   ///< median depth (m) of all valid pixels of a block, inside the volume or not; 0: none
  double fill = 0.0;          ///< median share of valid pixels in blocks with any

  const Block& at(int u, int v) const {
    return blocks[static_cast<std::size_t>(v) * static_cast<std::size_t>(cells.width) + static_cast<std::size_t>(u)];
  }
};

/// Make block c.
/// @param agree pixels agree with the median when they differ by at most this (m)
/// @param any_depth receives the median depth (m) of all valid pixels
/// @return share of valid pixels
float make_block(const DepthFrame& frame, const std::vector<float>& inside, int cells_across, int b, float agree,
                 std::size_t c, Block& block, float& any_depth) {
  const Intrinsics& k = frame.intrinsics;
  const std::size_t width = static_cast<std::size_t>(k.width);
  const int u0 = static_cast<int>(c % static_cast<std::size_t>(cells_across)) * b;
  const int v0 = static_cast<int>(c / static_cast<std::size_t>(cells_across)) * b;
  float in[64 * 64], any[64 * 64];
  int n_in = 0, n_any = 0;
  const int u1 = std::min(u0 + b, k.width), v1 = std::min(v0 + b, k.height);
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      if (inside[i] > 0.0f) in[n_in++] = inside[i];
      if (DepthFrame::valid(frame.depth[i])) any[n_any++] = frame.depth[i];
    }
  if (n_any == 0) return 0.0f;
  const float fill = static_cast<float>(n_any) / static_cast<float>((u1 - u0) * (v1 - v0));
  std::nth_element(any, any + n_any / 2, any + n_any);
  any_depth = any[n_any / 2];
  if (n_in == 0) return fill;
  std::nth_element(in, in + n_in / 2, in + n_in);
  const float middle = in[n_in / 2];
  double su = 0.0, sv = 0.0, sz = 0.0, s1 = 0.0;
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) {
      const float z = inside[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
      if (z > 0.0f && std::abs(z - middle) <= agree) su += u, sv += v, sz += double(z), s1 += 1.0;
    }
  block.u = static_cast<float>((su / s1 + 0.5) / b - 0.5);
  block.v = static_cast<float>((sv / s1 + 0.5) / b - 0.5);
  block.z = static_cast<float>(sz / s1);
  return fill;
}

/// Divide the image into blocks of b x b pixels.
Blocks make_blocks(const DepthFrame& frame, const std::vector<float>& inside, int b, double spacing, int threads) {
  const Intrinsics& k = frame.intrinsics;
  Blocks out;
  out.cells = block_intrinsics(k, b);
  const std::size_t n = out.cells.size();
  out.depth.assign(n, 0.0f);
  out.blocks.resize(n);
  const double pixel_noise = image_noise(inside, k.width, k.height, std::max(1, b));
  const float agree = static_cast<float>(std::max(3.0 * pixel_noise, 0.6 * spacing));
  std::vector<float> fill(n, 0.0f);
  const auto make = [&](std::size_t c) {
    fill[c] = make_block(frame, inside, out.cells.width, b, agree, c, out.blocks[c], out.depth[c]);
  };
  parallel_for(n, threads, make, 1024);
  std::vector<float> some;
  for (const float share : fill)
    if (share > 0.0f) some.push_back(share);
  out.fill = static_cast<double>(median(some));
  return out;
}

/// Robust standard deviation (m) of the noise between blocks.
double noise_of(const Blocks& blocks) {
  std::vector<float> z(blocks.blocks.size());
  for (std::size_t c = 0; c < z.size(); ++c) z[c] = blocks.blocks[c].z;
  return image_noise(z, blocks.cells.width, blocks.cells.height, 1);
}

/// The paraboloid fitted around a block: depth over the offset (du, dv) from the block's mean pixel, in cells.
struct Patch {
  Eigen::Matrix<double, 6, 1> x;  ///< coefficients of 1, du, dv, du du, du dv, dv dv
  double sigma = 0.0;             ///< standard deviation of the depth (m); 0: there is no patch
};

/// Fits the paraboloids.
class PatchFitter {
 public:
  /// Differences of depth between neighboring blocks along u and along v; kept from cell to cell to save allocations.
  using Differences = std::array<std::vector<float>, 2>;

  /// @param pitch distance between blocks at the typical depth (m)
  /// @param noise standard deviation of the blocks' depths (m)
  PatchFitter(const Blocks& blocks, double pitch, double noise, const SurfaceParameters& parameters)
      : blocks_(blocks),
        pitch_(pitch),
        noise_(noise),
        window_(half_width(noise, parameters)),
        steepest_(std::tan(parameters.max_incidence)),
        bend_(pitch * pitch / (2.0 * parameters.smallest_radius)),
        taps_(detail::window_taps(window_)) {}

  /// Fit the paraboloid around cell c; `patch` is left as it is if there is none.
  void fit(std::size_t c, Differences& along, Patch& patch) const {
    const Block& center = blocks_.blocks[c];
    if (!(center.z > 0.0f)) return;
    const auto across = static_cast<std::size_t>(blocks_.cells.width);
    const int cu = static_cast<int>(c % across), cv = static_cast<int>(c / across);
    const auto [slope_u, slope_v] = first_slope(cu, cv, along);
    Eigen::Matrix<double, 6, 1> x;
    x << double(center.z), slope_u, slope_v, 0.0, 0.0, 0.0;
    // Before the curvature is known it may explain this much, times the squared distance.
    double slack = bend_ * (1.0 + slope_u * slope_u / (pitch_ * pitch_));
    double scale = noise_, variance = 0.0;
    ParaboloidSums sums;
    int window_cells = 0;
    constexpr int kIterations = 3;
    for (int iteration = 0; iteration < kIterations; ++iteration, slack = 0.0) {
      sums = {};
      window_cells = add_window(cu, cv, x, scale, slack, sums);
      if (sums.weight < 2.5) return;
      double* wanted_variance = iteration + 1 == kIterations ? &variance : nullptr;
      if (!(sums.weight > 7.0 ? sums.solve<6>(x, wanted_variance) : sums.solve<3>(x, wanted_variance))) return;
      if (iteration > 0) scale = std::max(noise_, 0.5 * std::sqrt(sums.squares / sums.weight));
    }
    // Cells without neighbors on their own surface are flying pixels.
    if (sums.weight < 0.2 * 0.63 * double(window_cells)) return;
    if (std::abs(x[0] - double(center.z)) > 4.0 * noise_ + 0.5 * pitch_) return;
    patch.x = x;
    patch.sigma = std::max(std::max(scale, noise_) * std::sqrt(std::max(variance, 0.0)), 1e-5);
  }

 private:
  /// Half width of the window (cells), such that the depth's standard deviation should reach the wanted one.
  static int half_width(double noise, const SurfaceParameters& parameters) {
    const double wanted = 4.0 * noise * noise / (parameters.target_sigma * parameters.target_sigma);
    return std::clamp(static_cast<int>(std::ceil(0.5 * (std::sqrt(wanted) - 1.0))), std::min(2, parameters.max_window),
                      parameters.max_window);
  }

  /// First guess of the slopes (m a cell): medians of the differences between neighboring blocks about a cell, without
  /// those that are too large for the steepest surface that is kept.
  std::pair<double, double> first_slope(int cu, int cv, Differences& along) const {
    const double step = steepest_ * pitch_ + 4.0 * noise_;
    const int reach = std::min(window_, 1 + static_cast<int>(noise_ / 0.001));
    const int u_end = std::min(cu + reach, blocks_.cells.width - 1);
    const int v_end = std::min(cv + reach, blocks_.cells.height - 1);
    for (auto& differences : along) differences.clear();
    for (int v = std::max(cv - reach, 0); v <= v_end; ++v)
      for (int u = std::max(cu - reach, 0); u <= u_end; ++u) {
        const float z = blocks_.at(u, v).z;
        if (!(z > 0.0f)) continue;
        const auto difference = [&](int axis, const Block& next) {
          if (next.z > 0.0f && std::abs(next.z - z) < static_cast<float>(step))
            along[static_cast<std::size_t>(axis)].push_back(next.z - z);
        };
        if (u < u_end) difference(0, blocks_.at(u + 1, v));
        if (v < v_end) difference(1, blocks_.at(u, v + 1));
      }
    const double slope_u = static_cast<double>(median(along[0]));
    return {slope_u, static_cast<double>(median(along[1]))};
  }

  /// Add the blocks of the window about a cell, weighted by their nearness and by their residuals from the fit so far.
  /// @param x the fit so far
  /// @param scale standard deviation of the residuals (m)
  /// @param slack how far (m) the surface may bend away at the distance of one cell
  /// @return number of cells of the window that lie in the image
  int add_window(int cu, int cv, const Eigen::Matrix<double, 6, 1>& x, double scale, double slack,
                 ParaboloidSums& sums) const {
    const Block& center = blocks_.at(cu, cv);
    int window_cells = 0;
    for (const Tap& tap : taps_) {
      const int u = cu + tap.du, v = cv + tap.dv;
      if (u < 0 || v < 0 || u >= blocks_.cells.width || v >= blocks_.cells.height) continue;
      ++window_cells;
      const Block& q = blocks_.at(u, v);
      if (!(q.z > 0.0f)) continue;
      const double du = double(q.u - center.u), dv = double(q.v - center.v), z = double(q.z);
      const double fitted = x[0] + du * (x[1] + x[3] * du + x[4] * dv) + dv * (x[2] + x[5] * dv);
      const double residual = z - fitted, t = residual / (4.0 * scale + 0.2 * pitch_ + slack * tap.r_sq);
      if (std::abs(t) >= 1.0) continue;
      sums.add((1.0 - t * t) * (1.0 - t * t) * tap.near, du, dv, z, residual);
    }
    return window_cells;
  }

  const Blocks& blocks_;
  double pitch_, noise_;
  int window_;  // half width (cells)
  double steepest_, bend_;
  std::vector<Tap> taps_;
};

std::vector<Patch> fit_patches(const PatchFitter& fitter, std::size_t n, int threads) {
  std::vector<Patch> patches(n);
  parallel_chunks(n, threads, 256, [&](std::size_t begin, std::size_t end) {
    PatchFitter::Differences along;
    for (std::size_t c = begin; c < end; ++c) fitter.fit(c, along, patches[c]);
  });
  return patches;
}

/// A point of a patch (m, optical frame) and its normal, unit, towards the sensor.
struct Sample {
  Eigen::Vector3d point, normal;
  double cosine;  ///< of the incidence
};

/// The point of a patch at an offset (du, dv) from the block's mean pixel, in cells.
Sample sample(const Intrinsics& cells, const Block& block, const Patch& patch, double du, double dv) {
  const Eigen::Vector3d ray = cells.ray(double(block.u) + du, double(block.v) + dv);
  const auto& x = patch.x;
  const double z = x[0] + x[1] * du + x[2] * dv + x[3] * du * du + x[4] * du * dv + x[5] * dv * dv;
  const Eigen::Vector3d along_u = Eigen::Vector3d(z / cells.fx, 0, 0) + ray * (x[1] + 2.0 * x[3] * du + x[4] * dv);
  const Eigen::Vector3d along_v = Eigen::Vector3d(0, z / cells.fy, 0) + ray * (x[2] + x[4] * du + 2.0 * x[5] * dv);
  Sample s;
  s.point = ray * z;
  s.normal = along_v.cross(along_u).normalized();
  s.cosine = -s.normal.dot(ray.normalized());
  return s;
}

/// Take one sample of each patch; where the surface is steep several along the slope, so that they stay evenly apart on
/// the surface.
void sample_patches(const Blocks& blocks, const std::vector<Patch>& patches, const SurfaceParameters& parameters,
                    SurfaceImage& out) {
  const Intrinsics& cells = blocks.cells;
  const Eigen::Matrix3d rotation = out.world_T_optical.linear();
  const double cos_max = std::cos(parameters.max_incidence);
  for (std::size_t c = 0; c < patches.size(); ++c) {
    const Patch& patch = patches[c];
    if (!(patch.sigma > 0.0)) continue;
    Sample s = sample(cells, blocks.blocks[c], patch, 0.0, 0.0);
    if (!(s.cosine > cos_max)) continue;
    const Eigen::Vector2d slope = Eigen::Vector2d(patch.x[1], patch.x[2]).normalized();
    const int m =
        std::clamp(static_cast<int>(std::lround(s.point.z() / cells.fx / (s.cosine * parameters.spacing))), 1, 5);
    for (int i = 0; i < m; ++i) {
      if (m > 1) {
        const double t = (i + 0.5) / m - 0.5;
        s = sample(cells, blocks.blocks[c], patch, t * slope.x(), t * slope.y());
        if (!(s.cosine > cos_max)) continue;
      }
      out.points.push_back((out.world_T_optical * s.point).cast<float>());
      out.normals.push_back((rotation * s.normal).cast<float>());
      out.sigma.push_back(static_cast<float>(patch.sigma * s.point.norm() / s.point.z()));
    }
  }
}

}  // namespace

SurfaceImage reconstruct_surface(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume,
                                 const SurfaceParameters& parameters, int threads) {
  check(frame);
  parameters.check();
  check_input(is_rigid(world_T_optical), "reconstruct_surface: the sensor pose is not a rigid transform");
  const Intrinsics& k = frame.intrinsics;
  const Crop inside = crop(frame, world_T_optical, volume);
  const int b =
      std::clamp(static_cast<int>(std::lround(parameters.spacing * k.fx / inside.typical)), 1, parameters.max_block);
  Blocks blocks = make_blocks(frame, inside.depth, b, parameters.spacing, threads);
  // The noise that is left between blocks decides how far to smooth.
  const double block_noise = std::max(noise_of(blocks), 0.02 * parameters.target_sigma);
  const PatchFitter fitter(blocks, inside.typical / blocks.cells.fx, block_noise, parameters);
  const std::vector<Patch> patches = fit_patches(fitter, blocks.blocks.size(), threads);

  SurfaceImage out;
  out.intrinsics = blocks.cells;
  out.world_T_optical = world_T_optical;
  out.points_in = inside.pixels;
  out.fill = blocks.fill;
  constexpr double kOfMedians = 1.2533;  // sqrt(pi / 2): a median's standard deviation over that of a mean
  out.noise = (b > 1 ? kOfMedians : 1.0) * block_noise;
  sample_patches(blocks, patches, parameters, out);
  out.depth = std::move(blocks.depth);
  return out;
}

}  // namespace agrisee::sensor
