// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a noisy depth image to the surface behind it: cells of a few pixels, each with depth, normal and uncertainty.
///
/// A depth sensor measures far more densely (0.5 mm at arm's length) than a fruit's surface needs, and its error lies
/// along the ray. So the image is first divided into blocks of b x b pixels of about the wanted spacing; each block
/// keeps the mean of those of its pixels that agree with its median. A paraboloid is then fitted around each block,
/// over a window that grows with the noise that the blocks show among themselves, with weights that leave out what lies
/// beyond a depth edge (iteratively reweighted least squares, Tukey's biweight). The fit's value, slope and covariance
/// at the block are its depth, normal and sigma. Cost: linear in the pixels, and in the blocks times the window.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/paraboloid.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <algorithm>

namespace agrisee::sensor {

namespace detail {

/// Median of v (reordered); 0 when empty.
inline float median(std::vector<float>& v) {
  if (v.empty()) return 0.0f;
  const auto mid = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), mid, v.end());
  return *mid;
}

/// Robust standard deviation of an image's noise from second differences at distance `lag` along rows (MAD scaled to a
/// Gaussian). Differences across invalid pixels are left out.
inline double image_noise(const std::vector<float>& z, int width, int height, int lag, int row_step) {
  std::vector<float> d;
  for (int v = 0; v < height; v += row_step)
    for (int u = lag; u + lag < width; ++u) {
      const float* c = &z[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
      if (c[-lag] > 0.0f && c[0] > 0.0f && c[lag] > 0.0f) d.push_back(std::abs(c[-lag] - 2.0f * c[0] + c[lag]));
    }
  return 1.4826 * static_cast<double>(median(d)) / std::sqrt(6.0);
}

struct Block {
  float u = 0.0f, v = 0.0f, z = 0.0f;  // mean pixel (in cell units) and depth of its agreeing pixels; z = 0: none
};

/// The paraboloid fitted around a cell: depth over the offset (du, dv) from the block's mean pixel, in cells.
struct Patch {
  Eigen::Matrix<double, 6, 1> x;  // 1, du, dv, du du, du dv, dv dv
  double sigma = 0.0;             // of the depth (m); 0: the cell is not kept
};

}  // namespace detail

/// The surface of a depth image inside `volume` (world).
///
/// Pixels outside the volume, invalid ones, and cells without support are left out of `points`; `depth` keeps what lies
/// outside too, as evidence of free space.
/// @param frame as measured
/// @param world_T_optical pose of the sensor when the frame was taken
/// @param volume what lies outside is left out (world)
/// @param parameters see their struct
/// @param threads the result does not depend on it
/// @throws InputError for a frame whose size disagrees with its intrinsics or a pose that is not rigid; ParameterError
inline SurfaceImage reconstruct_surface(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume,
                                        const SurfaceParameters& parameters = {}, int threads = 1) {
  check(frame);
  parameters.check();
  check_input(is_rigid(world_T_optical), "reconstruct_surface: the sensor pose is not a rigid transform");
  const Intrinsics& k = frame.intrinsics;
  const std::size_t width = static_cast<std::size_t>(k.width);

  // Pixels inside the volume, and their typical distance.
  std::vector<float> inside(k.size(), 0.0f);
  const Eigen::Matrix3d rotation = world_T_optical.linear();
  const Eigen::Vector3d origin = world_T_optical.translation();
  SurfaceImage out;
  out.world_T_optical = world_T_optical;
  std::vector<float> depths;
  depths.reserve(k.size() / 4);
  for (int v = 0; v < k.height; ++v) {
    const float* row = &frame.depth[static_cast<std::size_t>(v) * width];
    const Eigen::Vector3d left = rotation * k.ray(0.0, v), pitch = rotation.col(0) / k.fx;  // of the rays at z = 1
    for (int u = 0; u < k.width; ++u) {
      const float z = row[u];
      if (!DepthFrame::valid(z)) continue;
      if (!volume.contains(Eigen::Vector3d(origin + (left + double(u) * pitch) * double(z)))) continue;
      inside[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] = z;
      depths.push_back(z);
    }
  }
  out.points_in = depths.size();
  const double typical = out.points_in ? static_cast<double>(detail::median(depths)) : 1.0;
  const int b = std::clamp(static_cast<int>(std::lround(parameters.spacing * k.fx / typical)), 1, parameters.max_block);
  Intrinsics cells;
  cells.width = (k.width + b - 1) / b;
  cells.height = (k.height + b - 1) / b;
  cells.fx = k.fx / b;
  cells.fy = k.fy / b;
  cells.cx = (k.cx + 0.5) / b - 0.5;
  cells.cy = (k.cy + 0.5) / b - 0.5;
  out.intrinsics = cells;
  const std::size_t n = cells.size();
  out.depth.assign(n, 0.0f);

  // Blocks: the mean of the pixels that agree with the block's median.
  const double pixel_noise = detail::image_noise(inside, k.width, k.height, std::max(1, b), 1);
  const float agree = static_cast<float>(std::max(3.0 * pixel_noise, 0.6 * parameters.spacing));
  std::vector<detail::Block> blocks(n);
  std::vector<float> fill(n, 0.0f);
  const auto make_block = [&](std::size_t c) {
    const int u0 = static_cast<int>(c % static_cast<std::size_t>(cells.width)) * b;
    const int v0 = static_cast<int>(c / static_cast<std::size_t>(cells.width)) * b;
    float in[64 * 64], any[64 * 64];
    int n_in = 0, n_any = 0;
    const int u1 = std::min(u0 + b, k.width), v1 = std::min(v0 + b, k.height);
    for (int v = v0; v < v1; ++v)
      for (int u = u0; u < u1; ++u) {
        const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
        if (inside[i] > 0.0f) in[n_in++] = inside[i];
        if (DepthFrame::valid(frame.depth[i])) any[n_any++] = frame.depth[i];
      }
    if (n_any == 0) return;
    fill[c] = static_cast<float>(n_any) / static_cast<float>((u1 - u0) * (v1 - v0));
    std::nth_element(any, any + n_any / 2, any + n_any);
    out.depth[c] = any[n_any / 2];
    if (n_in == 0) return;
    std::nth_element(in, in + n_in / 2, in + n_in);
    const float middle = in[n_in / 2];
    double su = 0.0, sv = 0.0, sz = 0.0, s1 = 0.0;
    for (int v = v0; v < v1; ++v)
      for (int u = u0; u < u1; ++u) {
        const float z = inside[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
        if (z > 0.0f && std::abs(z - middle) <= agree) su += u, sv += v, sz += double(z), s1 += 1.0;
      }
    blocks[c].u = static_cast<float>((su / s1 + 0.5) / b - 0.5);
    blocks[c].v = static_cast<float>((sv / s1 + 0.5) / b - 0.5);
    blocks[c].z = static_cast<float>(sz / s1);
  };
  parallel_for(n, threads, make_block, 1024);
  std::vector<float> some, block_z(n);
  for (std::size_t c = 0; c < n; ++c) {
    if (fill[c] > 0.0f) some.push_back(fill[c]);
    block_z[c] = blocks[c].z;
  }
  out.fill = static_cast<double>(detail::median(some));

  // The noise that is left between blocks decides how far to smooth.
  const double pitch = typical / cells.fx;
  const double block_noise =
      std::max(detail::image_noise(block_z, cells.width, cells.height, 1, 1), 0.02 * parameters.target_sigma);
  constexpr double kOfMedians = 1.2533;  // sqrt(pi / 2): a median's standard deviation over that of a mean
  out.noise = (b > 1 ? kOfMedians : 1.0) * block_noise;
  const double wanted = 4.0 * block_noise * block_noise / (parameters.target_sigma * parameters.target_sigma);
  const int w = std::clamp(static_cast<int>(std::ceil(0.5 * (std::sqrt(wanted) - 1.0))),
                           std::min(2, parameters.max_window), parameters.max_window);
  const double steepest = std::tan(parameters.max_incidence);
  const double bend = pitch * pitch / (2.0 * parameters.smallest_radius);

  std::vector<detail::Patch> patches(n);
  const std::vector<detail::Tap> taps = detail::window_taps(w);
  const auto row_length = static_cast<std::size_t>(cells.width);
  const auto block_at = [&](int u, int v) -> const detail::Block& {
    return blocks[static_cast<std::size_t>(v) * row_length + static_cast<std::size_t>(u)];
  };
  const auto fit_cell = [&](std::size_t c, std::array<std::vector<float>, 2>& along) {
    const detail::Block& center = blocks[c];
    if (!(center.z > 0.0f)) return;
    const int cu = static_cast<int>(c % row_length), cv = static_cast<int>(c / row_length);
    // The first slope: medians of the differences to the neighbours that no steepest surface would exceed.
    const double step = steepest * pitch + 4.0 * block_noise;
    const int reach = std::min(w, 1 + static_cast<int>(block_noise / 0.001));
    const int u_end = std::min(cu + reach, cells.width - 1), v_end = std::min(cv + reach, cells.height - 1);
    for (auto& differences : along) differences.clear();
    for (int v = std::max(cv - reach, 0); v <= v_end; ++v)
      for (int u = std::max(cu - reach, 0); u <= u_end; ++u) {
        const float z = block_at(u, v).z;
        if (!(z > 0.0f)) continue;
        const auto difference = [&](int axis, const detail::Block& next) {
          if (next.z > 0.0f && std::abs(next.z - z) < static_cast<float>(step))
            along[static_cast<std::size_t>(axis)].push_back(next.z - z);
        };
        if (u < u_end) difference(0, block_at(u + 1, v));
        if (v < v_end) difference(1, block_at(u, v + 1));
      }
    const double slope_u = static_cast<double>(detail::median(along[0]));
    const double slope_v = static_cast<double>(detail::median(along[1]));

    Eigen::Matrix<double, 6, 1> x;
    x << double(center.z), slope_u, slope_v, 0.0, 0.0, 0.0;
    // Before the curvature is known it may explain this much, times the distance squared.
    double slack = bend * (1.0 + slope_u * slope_u / (pitch * pitch));
    double scale = block_noise, variance = 0.0;
    detail::ParaboloidSums sums;
    int window_cells = 0;
    constexpr int kIterations = 3;
    for (int iteration = 0; iteration < kIterations; ++iteration, slack = 0.0) {
      sums = {};
      window_cells = 0;
      for (const detail::Tap& tap : taps) {
        const int u = cu + tap.du, v = cv + tap.dv;
        if (u < 0 || v < 0 || u >= cells.width || v >= cells.height) continue;
        ++window_cells;
        const detail::Block& q = block_at(u, v);
        if (!(q.z > 0.0f)) continue;
        const double du = double(q.u - center.u), dv = double(q.v - center.v), z = double(q.z);
        const double fitted = x[0] + du * (x[1] + x[3] * du + x[4] * dv) + dv * (x[2] + x[5] * dv);
        const double residual = z - fitted, t = residual / (4.0 * scale + 0.2 * pitch + slack * tap.r_sq);
        if (std::abs(t) >= 1.0) continue;
        sums.add((1.0 - t * t) * (1.0 - t * t) * tap.near, du, dv, z, residual);
      }
      if (sums.weight < 2.5) return;
      double* wanted_variance = iteration + 1 == kIterations ? &variance : nullptr;
      if (!(sums.weight > 7.0 ? sums.solve<6>(x, wanted_variance) : sums.solve<3>(x, wanted_variance))) return;
      if (iteration > 0) scale = std::max(block_noise, 0.5 * std::sqrt(sums.squares / sums.weight));
    }
    // Cells without neighbours on their own surface are flying pixels.
    if (sums.weight < 0.2 * 0.63 * double(window_cells)) return;
    if (std::abs(x[0] - double(center.z)) > 4.0 * block_noise + 0.5 * pitch) return;
    patches[c].x = x;
    patches[c].sigma = std::max(std::max(scale, block_noise) * std::sqrt(std::max(variance, 0.0)), 1e-5);
  };
  parallel_chunks(n, threads, 256, [&](std::size_t begin, std::size_t end) {
    std::array<std::vector<float>, 2> along;
    for (std::size_t c = begin; c < end; ++c) fit_cell(c, along);
  });

  // One sample a cell; where the surface is steep several along the slope, so that they stay evenly apart on it.
  const double cos_max = std::cos(parameters.max_incidence);
  for (std::size_t c = 0; c < n; ++c) {
    const detail::Patch& patch = patches[c];
    if (!(patch.sigma > 0.0)) continue;
    const auto sample = [&](double du, double dv, Eigen::Vector3d& point, Eigen::Vector3d& normal) {
      const Eigen::Vector3d ray = cells.ray(double(blocks[c].u) + du, double(blocks[c].v) + dv);
      const auto& x = patch.x;
      const double z = x[0] + x[1] * du + x[2] * dv + x[3] * du * du + x[4] * du * dv + x[5] * dv * dv;
      const Eigen::Vector3d along_u = Eigen::Vector3d(z / cells.fx, 0, 0) + ray * (x[1] + 2.0 * x[3] * du + x[4] * dv);
      const Eigen::Vector3d along_v = Eigen::Vector3d(0, z / cells.fy, 0) + ray * (x[2] + x[4] * du + 2.0 * x[5] * dv);
      point = ray * z;
      normal = along_v.cross(along_u).normalized();
      return -normal.dot(ray.normalized());  // cosine of the incidence
    };
    Eigen::Vector3d point, normal;
    const double cosine = sample(0.0, 0.0, point, normal);
    if (!(cosine > cos_max)) continue;
    const Eigen::Vector2d slope = Eigen::Vector2d(patch.x[1], patch.x[2]).normalized();
    const int m = std::clamp(static_cast<int>(std::lround(point.z() / cells.fx / (cosine * parameters.spacing))), 1, 5);
    for (int i = 0; i < m; ++i) {
      if (m > 1) {
        const double t = (i + 0.5) / m - 0.5;
        if (!(sample(t * slope.x(), t * slope.y(), point, normal) > cos_max)) continue;
      }
      out.points.push_back((world_T_optical * point).cast<float>());
      out.normals.push_back((rotation * normal).cast<float>());
      out.sigma.push_back(static_cast<float>(patch.sigma * point.norm() / point.z()));
    }
  }
  return out;
}

}  // namespace agrisee::sensor
