// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/median.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "depth_blocks.hpp"
#include "paraboloid.hpp"

namespace agrisee::sensor {
namespace {

using detail::Block;
using detail::Blocks;
using detail::kLanes;
using detail::Lanes;
using detail::ParaboloidSums;
using detail::Tap;

/// Height (m) of a paraboloid over the place (a, b), or over several.
/// @param x coefficients of 1, a, b, a a, a b, b b (m)
template <typename Coefficients, typename Real>
Real height_of(const Coefficients& x, const Real& a, const Real& b) {
  return x[0] + a * (x[1] + x[3] * a + x[4] * b) + b * (x[2] + x[5] * b);
}

/// Derivatives of that height by a and by b (m).
template <typename Coefficients, typename Real>
std::array<Real, 2> slopes_of(const Coefficients& x, const Real& a, const Real& b) {
  return {x[1] + 2 * x[3] * a + x[4] * b, x[2] + x[4] * a + 2 * x[5] * b};
}

/// The paraboloid fitted around a block: its height over a plane at the place (a, b), in units of the distance between
/// blocks. The plane is nearly tangent to the surface if there is little noise, and faces the sensor if there is much.
struct Patch {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< of the plane (m, optical frame)
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< of the plane and its normal, towards the sensor (columns)
  Eigen::Matrix<double, 6, 1> x = Eigen::Matrix<double, 6, 1>::Zero();  ///< coefficients of 1, a, b, a a, a b, b b (m)
  double sigma = 0.0;  ///< standard deviation of the depth (m); 0: there is no patch

  /// Height (m) at a place.
  double height(double a, double b) const { return height_of(x, a, b); }
  /// Derivatives of the height by the place (m).
  Eigen::Vector2d slope(double a, double b) const {
    const auto [by_a, by_b] = slopes_of(x, a, b);
    return {by_a, by_b};
  }
};

/// Blocks about a cell: their rays and depths.
struct Window {
  std::vector<float> x, y;  ///< of the rays where their z is 1
  std::vector<float> z;     ///< measured depths (m)
  std::vector<float> near;  ///< weights for their distances from the cell; 0 for what fills the last lanes
  int cells = 0;            ///< number of cells of the window that lie in the image

  std::size_t size() const { return z.size(); }
  void clear() {
    for (auto* numbers : {&x, &y, &z, &near}) numbers->clear();
    cells = 0;
  }
  void add(const Eigen::Vector2f& ray, float depth, float weight) {
    x.push_back(ray.x());
    y.push_back(ray.y());
    z.push_back(depth);
    near.push_back(weight);
  }
};

/// Fits the paraboloids.
class PatchFitter {
 public:
  /// Differences of depth between neighboring blocks along u and along v (m).
  using Differences = std::array<std::vector<float>, 2>;

  /// What is kept from cell to cell to save allocations.
  struct Scratch {
    Differences differences;
    Window window;
  };

  /// @param pitch distance between blocks at the typical depth (m)
  /// @param noise standard deviation of the blocks' depths (m)
  PatchFitter(const Blocks& blocks, double pitch, double noise, const SurfaceParameters& parameters)
      : blocks_(blocks),
        pitch_(pitch),
        noise_(noise),
        window_(half_width(noise, parameters)),
        steepest_(std::tan(parameters.max_incidence)),
        bend_(pitch * pitch / (2.0 * parameters.smallest_radius)),
        tilt_(1.0 / (1.0 + std::pow(noise / (0.5 * pitch), 4))),
        taps_(detail::window_taps(window_)) {
    rays_.resize(blocks.blocks.size(), Eigen::Vector2f::Zero());
    for (const std::size_t c : blocks.filled) {
      const Block& b = blocks.blocks[c];
      rays_[c] = blocks.cells.ray(double(b.u), double(b.v)).head<2>().cast<float>();
    }
  }

  /// Fit the paraboloid around the filled cell c; `patch` is left as it is if there is none.
  void fit(std::size_t c, Scratch& scratch, Patch& patch) const {
    const auto across = static_cast<std::size_t>(blocks_.cells.width);
    const int cu = static_cast<int>(c % across), cv = static_cast<int>(c / across);
    Patch found = first_guess(c, first_slope(cu, cv, scratch.differences));
    // Before the curvature is known it may explain this much, times the squared distance.
    double slack = bend_ * (1.0 + (found.x[1] * found.x[1] + found.x[2] * found.x[2]) / (pitch_ * pitch_));
    double scale = noise_, variance = 0.0, weight = 0.0;
    collect(cu, cv, scratch.window);
    constexpr int kIterations = 3;
    for (int iteration = 0; iteration < kIterations; ++iteration, slack = 0.0) {
      const ParaboloidSums sums = add_window(scratch.window, found, scale, slack);
      weight = sums.weight();
      if (weight < 2.5) return;
      // Few cells do not tell the curvature from noise; nor do more that lie in two rows.
      const double stiffness = weight > 7.0 ? 1e-3 * weight : std::pow(scale / (2.0 * bend_), 2);
      if (!sums.solve(found.x, stiffness, iteration + 1 == kIterations ? &variance : nullptr)) return;
      if (iteration > 0) scale = std::max(noise_, 0.5 * std::sqrt(sums.squares() / weight));
    }
    // Cells without neighbors on their own surface are flying pixels.
    if (weight < 0.2 * 0.63 * double(scratch.window.cells)) return;
    if (std::abs(found.x[0]) > 4.0 * noise_ + 0.5 * pitch_) return;
    found.sigma = std::max(scale * std::sqrt(std::max(variance, 0.0)), 1e-5);
    patch = found;
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
  Eigen::Vector2d first_slope(int cu, int cv, Differences& along) const {
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
    return {static_cast<double>(median(along[0])), static_cast<double>(median(along[1]))};
  }

  /// The plane through block c with these slopes along u and v (m a cell), as the first guess of a patch.
  Patch first_guess(std::size_t c, const Eigen::Vector2d& slope) const {
    Patch out;
    const Eigen::Vector3d ray = rays_[c].cast<double>().homogeneous();
    out.origin = ray * double(blocks_.blocks[c].z);
    const Eigen::Vector3d normal = out.axes.col(2) = normal_of(out.origin, ray, tilt_ * slope);
    const Eigen::Vector3d down = ray - ray.dot(normal) * normal;
    out.axes.col(0) = down.squaredNorm() > 1e-6 ? down.normalized() : any_orthogonal<double>(normal);
    out.axes.col(1) = normal.cross(out.axes.col(0));
    const Eigen::Vector3d n = out.axes.transpose() * normal_of(out.origin, ray, slope);
    out.x[1] = -n[0] / n[2] * pitch_;
    out.x[2] = -n[1] / n[2] * pitch_;
    return out;
  }

  /// Unit normal, towards the sensor, of a plane through a point (m) on a ray with slopes along u and v (m a cell).
  Eigen::Vector3d normal_of(const Eigen::Vector3d& point, const Eigen::Vector3d& ray,
                            const Eigen::Vector2d& slope) const {
    const Eigen::Vector3d along_u = Eigen::Vector3d(point.z() / blocks_.cells.fx, 0.0, 0.0) + ray * slope[0];
    const Eigen::Vector3d along_v = Eigen::Vector3d(0.0, point.z() / blocks_.cells.fy, 0.0) + ray * slope[1];
    return along_v.cross(along_u).normalized();
  }

  /// Collect the blocks of the window about a cell.
  void collect(int cu, int cv, Window& window) const {
    window.clear();
    for (const Tap& tap : taps_) {
      const int u = cu + tap.du, v = cv + tap.dv;
      if (u < 0 || v < 0 || u >= blocks_.cells.width || v >= blocks_.cells.height) continue;
      ++window.cells;
      const std::size_t i = blocks_.cells.index(u, v);
      if (blocks_.blocks[i].z > 0.0f) window.add(rays_[i], blocks_.blocks[i].z, static_cast<float>(tap.near));
    }
    const std::size_t middle = blocks_.cells.index(cu, cv);
    while (window.size() % kLanes != 0) window.add(rays_[middle], blocks_.blocks[middle].z, 0.0f);
  }

  /// Add the blocks of a window, weighted by their nearness and by their residuals from the fit so far. The error of a
  /// depth lies along its ray. It is taken as an error of height where the ray meets the paraboloid, so that noise does
  /// not move the place.
  /// @param patch the fit so far
  /// @param scale standard deviation of the residuals (m)
  /// @param slack how far (m) the surface may bend away at the distance of one cell
  ParaboloidSums add_window(const Window& window, const Patch& patch, double scale, double slack) const {
    Eigen::Matrix3d to_plane = patch.axes.transpose();
    to_plane.topRows<2>() /= pitch_;
    const Eigen::Matrix3f t = to_plane.cast<float>();
    const Eigen::Vector3f origin = (to_plane * patch.origin).cast<float>();
    const Eigen::Matrix<float, 6, 1> x = patch.x.cast<float>();
    const auto gate = static_cast<float>(4.0 * scale + 0.2 * pitch_), bends = static_cast<float>(slack);
    ParaboloidSums sums;
    for (std::size_t k = 0; k < window.size(); k += kLanes) {
      const Eigen::Map<const Lanes> rx(&window.x[k]), ry(&window.y[k]), z(&window.z[k]), near(&window.near[k]);
      // Rays in the plane's axes; on a ray the place is (a, b) + height * (da, db).
      const Lanes per_height = 1.0f / (t(2, 0) * rx + t(2, 1) * ry + t(2, 2));
      const Lanes da = (t(0, 0) * rx + t(0, 1) * ry + t(0, 2)) * per_height;
      const Lanes db = (t(1, 0) * rx + t(1, 1) * ry + t(1, 2)) * per_height;
      const Lanes measured = z / per_height - origin[2];
      const Lanes a = da * origin[2] - origin[0], b = db * origin[2] - origin[1];
      const Lanes at_plane = height_of(x, a, b);
      const auto [by_a, by_b] = slopes_of(x, a, b);
      const Lanes rise = 1.0f - da * by_a - db * by_b;
      const Lanes bend = da * (x[3] * da + x[4] * db) + x[5] * db * db, root = rise * rise - 4.0f * bend * at_plane;
      const Lanes steepness = root.max(0.0f).sqrt();
      Lanes along = 2.0f * at_plane / (rise + steepness), residual = (measured - along) * steepness;
      Lanes seen = along + residual, weight = near;
      if (!(rise.min(root).minCoeff() > 0.0f))
        for (int i = 0; i < kLanes; ++i) {
          if (rise[i] > 0.0f && root[i] > 0.0f) continue;  // else the ray misses the paraboloid
          along[i] = seen[i] = measured[i];
          residual[i] = measured[i] - height_of(x, a[i] + measured[i] * da[i], b[i] + measured[i] * db[i]);
        }
      Lanes at_a = a + along * da, at_b = b + along * db;
      const Lanes all = at_a + at_b + seen + residual;
      if (!((all - all).sum() == 0.0f))  // a ray along the plane
        for (int i = 0; i < kLanes; ++i)
          if (!std::isfinite(at_a[i] + at_b[i] + seen[i] + residual[i]))
            at_a[i] = at_b[i] = seen[i] = residual[i] = weight[i] = 0.0f;
      const Lanes off = residual / (gate + bends * (at_a * at_a + at_b * at_b));
      const Lanes trust = (1.0f - off * off).max(0.0f);
      sums.add(trust * trust * weight, at_a, at_b, seen, residual);
    }
    return sums;
  }

  const Blocks& blocks_;
  double pitch_, noise_;
  int window_;  // half width (cells)
  double steepest_, bend_;
  double tilt_;  // of a patch's plane, as a share of the slope: noise hides where the slope is
  std::vector<Tap> taps_;
  std::vector<Eigen::Vector2f> rays_;  // of the blocks: x and y where z is 1
};

/// The patches of some cells.
std::vector<Patch> fit_patches(const PatchFitter& fitter, const std::vector<std::size_t>& cells, int threads) {
  std::vector<Patch> patches(cells.size());
  parallel_chunks(cells.size(), threads, 256, [&](std::size_t begin, std::size_t end) {
    PatchFitter::Scratch scratch;
    for (std::size_t i = begin; i < end; ++i) fitter.fit(cells[i], scratch, patches[i]);
  });
  return patches;
}

/// A point of a patch (m, optical frame) and its normal, unit, towards the sensor.
struct Sample {
  Eigen::Vector3d point, normal;
  double cosine;  ///< of the incidence
};

/// The point of a patch at a place in its plane.
/// @param pitch distance between blocks at the typical depth (m)
Sample sample(const Patch& patch, const Eigen::Vector2d& place, double pitch) {
  const Eigen::Vector2d slope = patch.slope(place[0], place[1]);
  Sample s;
  s.point =
      patch.origin + patch.axes * Eigen::Vector3d(place[0] * pitch, place[1] * pitch, patch.height(place[0], place[1]));
  s.normal = (patch.axes * Eigen::Vector3d(-slope[0], -slope[1], pitch)).normalized();
  s.cosine = -s.normal.dot(s.point.normalized());
  return s;
}

/// The step in a patch's plane that follows the slope of the surface for a length (m).
/// @param middle the patch's sample in the middle of the block
Eigen::Vector2d step_down(const Patch& patch, const Sample& middle, double length, double pitch) {
  const Eigen::Vector3d ray = middle.point.normalized();
  const Eigen::Vector3d down = patch.axes.transpose() * (ray - ray.dot(middle.normal) * middle.normal).normalized();
  return length / pitch * down.head<2>();
}

/// Take one sample of each patch; where the surface is steep several along the slope, so that they stay evenly apart on
/// the surface.
/// Samples outside of the volume are left out.
/// @param pitch distance between blocks at the typical depth (m)
void sample_patches(const Intrinsics& cells, const std::vector<Patch>& patches, double pitch, const Aabb& volume,
                    const SurfaceParameters& parameters, SurfaceImage& out) {
  const Eigen::Matrix3d rotation = out.world_T_optical.linear();
  const double cos_max = std::cos(parameters.max_incidence);
  for (const Patch& patch : patches) {
    if (!(patch.sigma > 0.0)) continue;
    const Sample middle = sample(patch, {0.0, 0.0}, pitch);
    if (!(middle.cosine > cos_max)) continue;
    const double length = middle.point.z() / cells.fx / middle.cosine;  // of the block's surface along the slope (m)
    const int m = std::clamp(static_cast<int>(std::lround(length / parameters.spacing)), 1, 5);
    const Eigen::Vector2d step = m > 1 ? step_down(patch, middle, length, pitch) : Eigen::Vector2d(0.0, 0.0);
    for (int i = 0; i < m; ++i) {
      const Sample s = m > 1 ? sample(patch, ((i + 0.5) / m - 0.5) * step, pitch) : middle;
      if (!(s.cosine > cos_max)) continue;
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
  constexpr double kLeastNoise = 8e-6;  // m; of a perfect sensor, so that nothing is divided by zero
  const double block_noise = std::max(detail::noise_of(blocks), kLeastNoise);
  const double pitch = inside.typical / blocks.cells.fx;
  const PatchFitter fitter(blocks, pitch, block_noise, parameters);
  const std::vector<Patch> patches = fit_patches(fitter, blocks.filled, threads);

  SurfaceImage out;
  out.intrinsics = blocks.cells;
  out.world_T_optical = world_T_optical;
  out.points_in = inside.pixels;
  out.fill = blocks.fill;
  constexpr double kOfMedians = 1.2533;  // sqrt(pi / 2): a median's standard deviation over that of a mean
  out.noise = (b > 1 ? kOfMedians : 1.0) * block_noise;
  sample_patches(blocks.cells, patches, pitch, volume, parameters, out);
  out.depth = std::move(blocks.depth);
  return out;
}

}  // namespace agrisee::sensor
