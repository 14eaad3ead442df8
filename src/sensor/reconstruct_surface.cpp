// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/median.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

#include <algorithm>
#include <array>

#include "depth_blocks.hpp"
#include "paraboloid.hpp"

namespace agrisee::sensor {
namespace {

using detail::Block;
using detail::Blocks;
using detail::ParaboloidSums;
using detail::Tap;

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
/// Samples outside of the volume are left out.
void sample_patches(const Blocks& blocks, const std::vector<Patch>& patches, const Aabb& volume,
                    const SurfaceParameters& parameters, SurfaceImage& out) {
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
      const Eigen::Vector3d point = out.world_T_optical * s.point;
      if (!volume.contains(point)) continue;
      out.points.push_back(point.cast<float>());
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
  detail::Crop inside = detail::crop(frame, world_T_optical, volume);
  const int b =
      std::clamp(static_cast<int>(std::lround(parameters.spacing * k.fx / inside.typical)), 1, parameters.max_block);
  const double pixel_noise = detail::image_noise(inside.depth, k.width, k.height, b);
  detail::add_border(frame, pixel_noise, inside);
  Blocks blocks = detail::make_blocks(frame, inside.depth, b, parameters.spacing, pixel_noise, threads);
  // The noise that is left between blocks decides how far to smooth.
  const double block_noise = std::max(detail::noise_of(blocks), 0.02 * parameters.target_sigma);
  const PatchFitter fitter(blocks, inside.typical / blocks.cells.fx, block_noise, parameters);
  const std::vector<Patch> patches = fit_patches(fitter, blocks.blocks.size(), threads);

  SurfaceImage out;
  out.intrinsics = blocks.cells;
  out.world_T_optical = world_T_optical;
  out.points_in = inside.pixels;
  out.fill = blocks.fill;
  constexpr double kOfMedians = 1.2533;  // sqrt(pi / 2): a median's standard deviation over that of a mean
  out.noise = (b > 1 ? kOfMedians : 1.0) * block_noise;
  sample_patches(blocks, patches, volume, parameters, out);
  out.depth = std::move(blocks.depth);
  return out;
}

}  // namespace agrisee::sensor
