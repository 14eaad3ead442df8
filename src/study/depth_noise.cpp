// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/study/depth_noise.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "study/smooth_field.hpp"

namespace agrisee::study {

namespace {

// The random substreams of a view. Pixel i draws from substream i; these bits mark the others.
constexpr std::uint64_t kViewStream = std::uint64_t{1} << 63;    // what the whole view shares
constexpr std::uint64_t kFieldStream = std::uint64_t{1} << 62;   // the correlated noise
constexpr std::uint64_t kSmoothStream = std::uint64_t{1} << 61;  // the smooth fields, by number
constexpr std::uint64_t kStereoStream = std::uint64_t{1} << 60;  // the edges of a stereo camera, by pixel
constexpr std::uint64_t kObjectStream = std::uint64_t{1} << 59;  // the objects, by number
constexpr std::uint64_t kAlways = ~std::uint64_t{0};             // in place of the view: what all views share

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

/// The pixels of an image with their depths z.
class DepthView {
 public:
  DepthView(const sensor::Intrinsics& k, const std::vector<float>& range) : k_(k), range_(range) {}

  bool inside(int u, int v) const { return u >= 0 && v >= 0 && u < k_.width && v < k_.height; }
  std::size_t index(int u, int v) const { return k_.index(u, v); }
  /// Depth z (m) of a pixel inside the image; 0 if its ray hits nothing.
  double z(int u, int v) const {
    const float r = range_[index(u, v)];
    return r > 0.0f ? double(r) / k_.ray(u, v).norm() : 0.0;
  }

 private:
  const sensor::Intrinsics& k_;
  const std::vector<float>& range_;
};

constexpr int kAside[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/// Where a pixel at a depth edge may fly to.
struct Flight {
  double z = 0.0;      ///< depth z (m) of the surface across the edge; 0 if there is no edge
  double share = 0.0;  ///< how many of such pixels fly, as a share of NoiseParameters::flying
};

/// The flight of pixel (u, v), whose depth is z (m): to the neighbor across the largest step in depth, else to the
/// nearest pixel in its row or column that lies well before it, else behind a rim with nothing beside it.
Flight flight(const DepthView& image, int u, int v, double z, const NoiseParameters& p) {
  Flight out;
  double step = p.edge;
  bool rim = false;
  for (const auto& [du, dv] : kAside) {
    if (!image.inside(u + du, v + dv)) continue;
    const double other = image.z(u + du, v + dv);
    rim = rim || other == 0.0;
    if (other > 0.0 && std::abs(other - z) > step) step = std::abs(other - z), out = {other, 1.0};
  }
  for (int d = 2; d <= p.edge_width && out.z == 0.0; ++d)
    for (const auto& [du, dv] : kAside) {
      if (!image.inside(u + d * du, v + d * dv)) continue;
      const double other = image.z(u + d * du, v + d * dv);
      if (other > 0.0 && other < z - p.edge) out = {other, 1.0 - double(d - 1) / p.edge_width};
    }
  if (out.z == 0.0 && rim && p.skirt > 0.0) out = {z + p.skirt, 1.0};
  return out;
}

/// True if the surface that pixel (u, v) shows is narrower than `width` pixels along (du, dv), with nothing before it
/// on either side.
bool thin_along(const DepthView& image, int u, int v, int du, int dv, int width, double edge) {
  int pixels = 1;
  for (const int sign : {-1, 1}) {
    double z = image.z(u, v);
    for (int d = 1;; ++d) {
      const int nu = u + sign * d * du, nv = v + sign * d * dv;
      if (!image.inside(nu, nv)) return false;
      const double next = image.z(nu, nv);
      if (next == 0.0 || next > z + edge) break;
      if (next < z - edge || ++pixels >= width) return false;
      z = next;
    }
  }
  return true;
}

/// The pixel that shows the nearest surface that covers pixel (u, v) of a stereo image, whose own depth is z (m; 0 =
/// nothing), because it ends a few pixels beside it; none if nothing does.
std::optional<std::size_t> covering(const DepthView& image, int u, int v, double z, const NoiseParameters& p,
                                    Rng& rng) {
  std::optional<std::size_t> by;
  double nearest = z > 0.0 ? z - p.edge : std::numeric_limits<double>::infinity();
  const double reach = rng.uniform() * (p.smear + 1);
  for (int d = 1; d <= p.smear && d <= reach; ++d)
    for (const auto& [du, dv] : kAside) {
      if (!image.inside(u + d * du, v + d * dv)) continue;
      const double other = image.z(u + d * du, v + d * dv);
      if (other > 0.0 && other < nearest) nearest = other, by = image.index(u + d * du, v + d * dv);
    }
  return by;
}

/// What a stereo camera matches: surfaces that are not thin, and wider than they are.
TrueImage matched(const sensor::Intrinsics& k, const TrueImage& truth, const NoiseParameters& p, std::uint64_t seed,
                  std::uint64_t view, int threads) {
  std::vector<float> thick = truth.range;  // without what is thin
  const DepthView true_view(k, truth.range);
  parallel_for(
      static_cast<std::size_t>(k.height), threads,
      [&](std::size_t row) {
        const int v = static_cast<int>(row);
        for (int u = 0; u < k.width; ++u)
          if (true_view.z(u, v) > 0.0 &&
              (thin_along(true_view, u, v, 1, 0, p.thin, p.edge) || thin_along(true_view, u, v, 0, 1, p.thin, p.edge)))
            thick[true_view.index(u, v)] = 0.0f;
      },
      8);
  TrueImage out = truth;
  out.range = thick;
  const DepthView image(k, thick);
  parallel_for(
      static_cast<std::size_t>(k.height), threads,
      [&](std::size_t row) {
        const int v = static_cast<int>(row);
        for (int u = 0; u < k.width; ++u) {
          const std::size_t i = image.index(u, v);
          Rng rng(seed, view, kStereoStream | i);
          const auto by = covering(image, u, v, image.z(u, v), p, rng);
          if (!by) continue;
          const int width = k.width, from = static_cast<int>(*by);
          out.range[i] = static_cast<float>(image.z(from % width, from / width) * k.ray(u, v).norm());
          out.incidence[i] = truth.incidence[*by];
          if (!truth.object.empty()) out.object[i] = truth.object[*by];
          if (!truth.behind.empty()) out.behind[i] = truth.behind[*by];
        }
      },
      8);
  return out;
}

/// How much too deep each object reads (m).
std::vector<double> translucent_depths(const TrueImage& truth, const NoiseParameters& p, std::uint64_t seed) {
  std::vector<double> depths;
  for (std::size_t o = 0; o < truth.materials.size(); ++o) {
    const Translucency& t = p.translucency[static_cast<std::size_t>(truth.materials[o])];
    const double depth = t.depth > 0.0 ? t.depth + t.spread * Rng(seed, kAlways, kObjectStream | o).normal() : 0.0;
    depths.push_back(std::max(0.0, depth));
  }
  return depths;
}

/// The smooth fields of a view: waves, and the patches that are lost.
class ViewFields {
 public:
  ViewFields(const sensor::Intrinsics& k, const NoiseParameters& p, std::uint64_t seed, std::uint64_t view) : p_(p) {
    const auto field = [&](std::uint64_t number, double spacing, double fixed) {
      const std::uint64_t stream = kSmoothStream | number;
      return SmoothField(k, spacing, fixed, {seed, kAlways, stream}, {seed, view, stream});
    };
    for (std::size_t w = 0; w < p.waves.size(); ++w)
      if (!p.waves[w].error.zero()) waves_[w] = field(w, p.waves[w].spacing, p.waves[w].fixed);
    lost_ = Rng(seed, view, kViewStream | 2).uniform(p.patches_least, p.patches_most);
    if (p.patches_most > 0.0) patches_ = field(p.waves.size(), p.patch_spacing, 0.0);
  }

  /// The fields of the pixels [u0, u1) of row v.
  struct Row {
    std::vector<float> waves[2], patches;
  };
  void row(int v, int u0, int u1, Row& out) const {
    for (std::size_t w = 0; w < p_.waves.size(); ++w)
      if (waves_[w]) waves_[w]->row(v, u0, u1, out.waves[w]);
    if (patches_) patches_->row(v, u0, u1, out.patches);
  }

  /// Error (m) of pixel x of a row at a range of r (m).
  double error(const Row& row, std::size_t x, double r) const {
    double sum = 0.0;
    for (std::size_t w = 0; w < p_.waves.size(); ++w)
      if (waves_[w]) sum += p_.waves[w].error.at(r) * double(row.waves[w][x]);
    return sum;
  }
  /// True if pixel x of a row lies in a lost patch.
  bool lost(const Row& row, std::size_t x) const {
    return patches_ && 0.5 * std::erfc(-double(row.patches[x]) / std::sqrt(2.0)) < lost_;
  }

 private:
  const NoiseParameters& p_;
  std::array<std::optional<SmoothField>, 2> waves_;
  std::optional<SmoothField> patches_;
  double lost_ = 0.0;  // share of this view's pixels that is lost in patches
};

void check_truth(const sensor::Intrinsics& k, const TrueImage& truth) {
  const auto fits = [&](std::size_t pixels) { return pixels == k.size(); };
  check_input(fits(truth.range.size()) && fits(truth.incidence.size()) &&
                  (truth.object.empty() || fits(truth.object.size())) &&
                  (truth.behind.empty() || fits(truth.behind.size())),
              "measured ranges: the image size differs from its intrinsics");
  for (std::size_t i = 0; i < truth.object.size(); ++i)
    check_input(!(truth.range[i] > 0.0f) || truth.object[i] < truth.materials.size(),
                "measured ranges: an object has no material");
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

std::vector<float> measured_ranges(const sensor::Intrinsics& intrinsics, const TrueImage& truth, double max_incidence,
                                   const NoiseModel& model, std::uint64_t seed, std::uint64_t view, int threads) {
  const sensor::Intrinsics& k = intrinsics;
  check_truth(k, truth);
  const NoiseParameters p = noise_parameters(model);
  std::optional<TrueImage> stereo;
  if (p.smear > 0 || p.thin > 0) stereo = matched(k, truth, p, seed, view, threads);
  const TrueImage& seen = stereo ? *stereo : truth;
  std::vector<float> out(seen.range.size(), 0.0f);
  const PixelBounds b = bounds_of_returns(k, seen.range);
  if (b.u1 == 0) return out;
  std::vector<float> correlated;
  if (p.correlation > 0.0) correlated = correlated_noise(b, p.correlation, seed, view, threads);
  const ViewFields fields(k, p, seed, view);
  const std::vector<double> depths = translucent_depths(seen, p, seed);
  const DepthView image(k, seen.range);
  const double bias = p.bias * Rng(seed, view, kViewStream).normal();
  const std::size_t width = static_cast<std::size_t>(b.u1 - b.u0);
  parallel_for(
      static_cast<std::size_t>(b.v1 - b.v0), threads,
      [&](std::size_t row) {
        const int v = b.v0 + static_cast<int>(row);
        ViewFields::Row smooth;
        fields.row(v, b.u0, b.u1, smooth);
        for (int u = b.u0; u < b.u1; ++u) {
          const std::size_t i = image.index(u, v), x = static_cast<std::size_t>(u - b.u0);
          if (!(seen.range[i] > 0.0f)) continue;
          double r = double(seen.range[i]);
          Rng rng(seed, view, i);
          const double white = rng.normal(), loss = rng.uniform(), fly = rng.uniform(), where = rng.uniform();
          if ((p.loss > 0.0 && rng.uniform() < p.loss) || fields.lost(smooth, x)) continue;
          Flight to;
          const double slant = p.flying > 0.0 ? k.ray(u, v).norm() : 1.0;
          if (fly < p.flying) to = flight(image, u, v, r / slant, p);
          const bool known = !seen.object.empty();
          if (known) {
            const double behind =
                seen.behind.empty() ? std::numeric_limits<double>::infinity() : double(seen.behind[i]);
            r += std::min(depths[seen.object[i]], 0.8 * behind);
          }
          if (to.z > 0.0 && fly < p.flying * to.share)
            r += where * (to.z * slant - r);
          else if (double(seen.incidence[i]) > max_incidence || loss < loss_probability(p, double(seen.incidence[i])) ||
                   (known && double(seen.incidence[i]) < p.mirror &&
                    seen.materials[seen.object[i]] == ObjectClass::fruit))
            continue;
          const double noise = correlated.empty() ? white : double(correlated[row * width + x]);
          r += bias + p.white.at(r) * noise + fields.error(smooth, x, r);
          if (r > 0.0) out[i] = static_cast<float>(r);
        }
      },
      8);
  return out;
}

}  // namespace agrisee::study
