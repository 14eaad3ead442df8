// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/study/detector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace agrisee::study {

namespace {

// The random streams of a detector, by what is drawn.
constexpr std::uint64_t kMissStream = 0xDE7EC700, kInventionStream = 0xDE7EC701, kMergeStream = 0xDE7EC702,
                        kEdgeStream = 0xDE7EC703, kScoreStream = 0xDE7EC704;
constexpr std::uint64_t kAllViews = ~std::uint64_t{0};  // in place of the view: what all views share

/// A mask: rows of bytes over a rectangle of the image, not zero inside.
struct Bitmap {
  int u0 = 0, v0 = 0, width = 0, height = 0;
  std::vector<char> inside;

  bool at(int u, int v) const {
    return u >= u0 && v >= v0 && u < u0 + width && v < v0 + height &&
           inside[static_cast<std::size_t>(v - v0) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(u - u0)];
  }
  std::size_t size() const { return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1)); }
};

/// A rectangle of an image that grows with its pixels.
struct PixelRange {
  int u0 = std::numeric_limits<int>::max(), v0 = std::numeric_limits<int>::max(), u1 = -1, v1 = -1;

  void extend(int u, int v) {
    u0 = std::min(u0, u), u1 = std::max(u1, u);
    v0 = std::min(v0, v), v1 = std::max(v1, v);
  }
};

/// The mask of the pixels of a range for which `inside(u, v)` holds.
template <typename F>
Bitmap bitmap_of(const PixelRange& range, F&& inside) {
  Bitmap out{range.u0, range.v0, range.u1 - range.u0 + 1, range.v1 - range.v0 + 1, {}};
  for (int v = range.v0; v <= range.v1; ++v)
    for (int u = range.u0; u <= range.u1; ++u) out.inside.push_back(inside(u, v) ? 1 : 0);
  return out;
}

/// A mask that is to be reported.
struct Found {
  Bitmap mask;
  double score = 1.0;
  std::uint64_t number = 0;  // chooses its random numbers: the object, or beyond all of them
};

/// A fruit as it shows in the image.
struct Shown {
  std::uint32_t object = 0;
  Bitmap mask;
  double share = 1.0;  // of its disc, 0..1
};

/// The fruit of an image with at least `least` pixels, by object.
std::vector<Shown> fruit_shown(const TracedScene& scene, const RayImage& rays, const sensor::Intrinsics& k,
                               const Pose& world_T_optical, std::size_t least) {
  std::map<std::uint32_t, PixelRange> ranges;
  const auto object = [&](int u, int v) { return scene.object(rays.triangle[k.index(u, v)]); };
  const auto hit = [&](int u, int v) { return rays.triangle[k.index(u, v)] != kNoHit; };
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (hit(u, v) && scene.looks()[object(u, v)].cls == ObjectClass::fruit) ranges[object(u, v)].extend(u, v);
  std::vector<Shown> out;
  for (const auto& [number, range] : ranges) {
    Bitmap mask = bitmap_of(range, [&, o = number](int u, int v) { return hit(u, v) && object(u, v) == o; });
    const std::size_t pixels = mask.size();
    if (pixels < least) continue;
    const Aabb& box = scene.looks()[number].box;
    const double radius = box.size().sum() / 6.0;
    const double disc = kPi * k.fx * k.fy * std::pow(radius / (world_T_optical.translation() - box.center()).norm(), 2);
    out.push_back({number, std::move(mask), std::clamp(static_cast<double>(pixels) / disc, 0.0, 1.0)});
  }
  return out;
}

/// The view whose random numbers decide on something: mostly this one, else what all views share.
std::uint64_t deciding_view(double alike, std::uint64_t seed, std::uint64_t stream, std::uint64_t number,
                            std::uint64_t view) {
  return Rng(seed ^ stream, kAllViews, number).uniform() < alike ? kAllViews : view;
}

/// How far each pixel of a mask, and around it up to `reach` pixels, is inside of its edge: 1 for the outermost pixels
/// of the mask, 0 for those just outside.
std::vector<int> levels_of(const Bitmap& mask, int reach, const PixelRange& range) {
  const int width = range.u1 - range.u0 + 1, height = range.v1 - range.v0 + 1;
  std::vector<int> level(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto at = [&](int u, int v) -> int& {
    return level[static_cast<std::size_t>(v - range.v0) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(u - range.u0)];
  };
  for (int v = range.v0; v <= range.v1; ++v)
    for (int u = range.u0; u <= range.u1; ++u) at(u, v) = mask.at(u, v) ? reach + 1 : -reach;
  const auto next_to = [&](int u, int v, bool diagonal, auto&& test) {
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du) {
        if ((du == 0 && dv == 0) || (!diagonal && du != 0 && dv != 0)) continue;
        const int a = u + du, b = v + dv;
        const bool in = a >= range.u0 && b >= range.v0 && a <= range.u1 && b <= range.v1;
        if (test(in ? at(a, b) : -reach)) return true;
      }
    return false;
  };
  for (int step = 1; step <= reach; ++step)  // four and eight neighbors in turn: nearly round
    for (int v = range.v0; v <= range.v1; ++v)
      for (int u = range.u0; u <= range.u1; ++u) {
        int& own = at(u, v);
        if (own == reach + 1 && next_to(u, v, step % 2 == 0, [&](int l) { return l < step; }))
          own = step;
        else if (own == -reach && next_to(u, v, step % 2 == 0, [&](int l) { return l > 1 - step; }))
          own = 1 - step;
      }
  return level;
}

/// A mask as the detector draws it: shifted, eroded or grown, with a wavy edge.
Bitmap drawn(const Bitmap& mask, const DetectorParameters& p, const sensor::Intrinsics& k, Rng& rng) {
  const int du = static_cast<int>(std::lround(p.shift * rng.normal()));
  const int dv = static_cast<int>(std::lround(p.shift * rng.normal()));
  double wave[4], phase[4];
  for (int i = 0; i < 4; ++i) wave[i] = p.edge * rng.normal() / std::sqrt(2.0), phase[i] = rng.uniform(0.0, kTwoPi);
  if (p.shift == 0.0 && p.erosion == 0.0 && p.edge == 0.0) return mask;
  const int reach = static_cast<int>(std::ceil(std::abs(p.erosion) + 3.0 * p.edge)) + 1;
  const PixelRange range{mask.u0 - reach, mask.v0 - reach, mask.u0 + mask.width - 1 + reach,
                         mask.v0 + mask.height - 1 + reach};
  const std::vector<int> levels = levels_of(mask, reach, range);
  const double cu = mask.u0 + 0.5 * mask.width, cv = mask.v0 + 0.5 * mask.height;
  std::size_t i = 0;
  Bitmap out = bitmap_of(range, [&](int u, int v) {
    const double around = std::atan2(v - cv, u - cu);
    double inset = p.erosion;
    for (int n = 0; n < 4; ++n) inset += wave[n] * std::sin((n + 2) * around + phase[n]);
    const bool in_image = u + du >= 0 && v + dv >= 0 && u + du < k.width && v + dv < k.height;
    return levels[i++] - 0.5 > inset && in_image;
  });
  out.u0 += du;
  out.v0 += dv;
  return out;
}

/// Whether two masks touch: a pixel of one is next to a pixel of the other.
bool touch(const Bitmap& a, const Bitmap& b) {
  if (a.u0 > b.u0 + b.width || b.u0 > a.u0 + a.width || a.v0 > b.v0 + b.height || b.v0 > a.v0 + a.height) return false;
  for (int v = a.v0; v < a.v0 + a.height; ++v)
    for (int u = a.u0; u < a.u0 + a.width; ++u)
      if (a.at(u, v) && (b.at(u + 1, v) || b.at(u - 1, v) || b.at(u, v + 1) || b.at(u, v - 1))) return true;
  return false;
}

/// One mask for two.
Bitmap joined(const Bitmap& a, const Bitmap& b) {
  PixelRange range{a.u0, a.v0, a.u0 + a.width - 1, a.v0 + a.height - 1};
  range.extend(b.u0, b.v0);
  range.extend(b.u0 + b.width - 1, b.v0 + b.height - 1);
  return bitmap_of(range, [&](int u, int v) { return a.at(u, v) || b.at(u, v); });
}

/// Draws what a detector finds in one image.
class Looking {
 public:
  Looking(const TracedScene& scene, const RayImage& rays, const sensor::Intrinsics& k, const Pose& world_T_optical,
          const DetectorParameters& parameters, std::uint64_t seed, std::uint64_t view)
      : scene_(scene), rays_(rays), k_(k), p_(parameters), seed_(seed), view_(view) {
    shown_ = fruit_shown(scene, rays, k, world_T_optical, static_cast<std::size_t>(parameters.least_pixels));
  }

  /// The masks, those with the smallest score first.
  std::vector<Found> masks() {
    find_fruit();
    merge();
    invent();
    for (Found& f : found_) {
      Rng rng(seed_ ^ kEdgeStream, view_, f.number);
      f.mask = drawn(f.mask, p_, k_, rng);
    }
    found_.erase(std::remove_if(found_.begin(), found_.end(), [&](const Found& f) { return f.score < p_.least_score; }),
                 found_.end());
    std::stable_sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.score < b.score; });
    return std::move(found_);
  }

 private:
  /// A score about a mean.
  double score(double mean, std::uint64_t number) const {
    return std::clamp(mean + p_.score_spread * Rng(seed_ ^ kScoreStream, view_, number).normal(), 0.0, 1.0);
  }

  void find_fruit() {
    for (const Shown& s : shown_) {
      const std::uint64_t view = deciding_view(p_.alike, seed_, kMissStream, s.object, view_);
      const double missed = p_.miss + (p_.miss_hidden - p_.miss) * (1.0 - s.share);
      if (Rng(seed_ ^ kMissStream, view, s.object).uniform() < missed) continue;
      found_.push_back({s.mask, score(p_.score - 2.0 * p_.score_spread * (1.0 - s.share), s.object), s.object});
    }
  }

  void merge() {
    Rng rng(seed_ ^ kMergeStream, view_);
    for (std::size_t a = 0; a < found_.size(); ++a)
      for (std::size_t b = found_.size() - 1; b > a; --b) {
        if (p_.merge == 0.0 || !touch(found_[a].mask, found_[b].mask) || !(rng.uniform() < p_.merge)) continue;
        found_[a].mask = joined(found_[a].mask, found_[b].mask);
        found_.erase(found_.begin() + static_cast<std::ptrdiff_t>(b));
      }
  }

  /// Whether something that is no fruit shows at a pixel.
  bool shows_other(int u, int v) const {
    if (u < 0 || v < 0 || u >= k_.width || v >= k_.height) return false;
    const std::uint32_t t = rays_.triangle[k_.index(u, v)];
    return t != kNoHit && scene_.looks()[scene_.object(t)].cls != ObjectClass::fruit;
  }

  /// A pixel at which a false mask lies. Those that all views share lie on a certain triangle, and only where it shows.
  std::optional<std::pair<int, int>> place(bool shared, Rng& rng) const {
    constexpr int kTries = 200;
    if (shared) {
      std::vector<std::uint32_t> other;
      for (std::uint32_t t = 0; t < scene_.size(); ++t)
        if (scene_.looks()[scene_.object(t)].cls != ObjectClass::fruit) other.push_back(t);
      if (other.empty()) return std::nullopt;
      const std::uint32_t target = other[static_cast<std::size_t>(rng.below(other.size()))];
      for (std::size_t i = 0; i < rays_.triangle.size(); ++i)
        if (rays_.triangle[i] == target)
          return std::pair(static_cast<int>(i) % k_.width, static_cast<int>(i) / k_.width);
      return std::nullopt;
    }
    for (int i = 0; i < kTries; ++i) {
      const int u = static_cast<int>(rng.below(static_cast<std::uint64_t>(k_.width)));
      const int v = static_cast<int>(rng.below(static_cast<std::uint64_t>(k_.height)));
      if (shows_other(u, v)) return std::pair(u, v);
    }
    return std::nullopt;
  }

  void invent() {
    constexpr double kFruit = 10.0;
    if (shown_.empty()) return;
    const double mean = p_.inventions * static_cast<double>(shown_.size()) / kFruit;
    for (std::uint64_t n = 0; static_cast<double>(n) < std::ceil(2.0 * mean); ++n) {  // each with one half, or less
      const std::uint64_t number = scene_.looks().size() + n;
      const bool shared = deciding_view(p_.alike, seed_, kInventionStream, n, view_) == kAllViews;
      if (!(Rng(seed_ ^ kInventionStream, view_, 2 * n).uniform() < mean / std::ceil(2.0 * mean))) continue;
      Rng rng(seed_ ^ kInventionStream, shared ? kAllViews - 1 : view_, 2 * n + 1);
      const auto at = place(shared, rng);
      if (!at) continue;
      Bitmap mask = shown_[static_cast<std::size_t>(rng.below(shown_.size()))].mask;
      mask.u0 = at->first - mask.width / 2;
      mask.v0 = at->second - mask.height / 2;
      const PixelRange range{mask.u0, mask.v0, mask.u0 + mask.width - 1, mask.v0 + mask.height - 1};
      mask = bitmap_of(range, [&](int u, int v) { return mask.at(u, v) && shows_other(u, v); });
      if (mask.size() < static_cast<std::size_t>(p_.least_pixels)) continue;
      found_.push_back({std::move(mask), score(p_.false_score, number), number});
    }
  }

  const TracedScene& scene_;
  const RayImage& rays_;
  const sensor::Intrinsics& k_;
  const DetectorParameters& p_;
  std::uint64_t seed_, view_;
  std::vector<Shown> shown_;
  std::vector<Found> found_;
};

}  // namespace

DetectorParameters detector_named(const std::string& name) {
  DetectorParameters p;
  if (name == kDetectorNames[0]) return p;
  if (name != kDetectorNames[1] && name != kDetectorNames[2])
    throw FieldError("detector", "must be " + OneOf(kDetectorNames).text() + ", got " + name);
  p.miss = 0.04;
  p.miss_hidden = 0.30;
  p.least_pixels = 60;
  p.inventions = 0.7;
  p.merge = 0.03;
  p.shift = 0.7;
  p.erosion = 0.5;
  p.edge = 0.8;
  p.alike = 0.5;
  p.score = 0.88;
  p.score_spread = 0.10;
  p.false_score = 0.45;
  if (name == kDetectorNames[1]) return p;
  p.miss = 0.15;
  p.miss_hidden = 0.65;
  p.inventions = 2.5;
  p.merge = 0.15;
  p.shift = 2.0;
  p.erosion = 1.0;
  p.edge = 2.0;
  p.score = 0.75;
  p.score_spread = 0.15;
  return p;
}

void detect(sensor::DepthFrame& frame, const TracedScene& scene, const RayImage& rays, const Pose& world_T_optical,
            const DetectorParameters& parameters, std::uint64_t seed, std::uint64_t view) {
  parameters.check();
  const sensor::Intrinsics& k = frame.intrinsics;
  check_input(rays.triangle.size() == k.size(), "detect: not one ray a pixel");
  frame.detected = true;
  frame.instances.assign(k.size(), 0);
  frame.detections.clear();
  for (const Found& f : Looking(scene, rays, k, world_T_optical, parameters, seed, view).masks()) {
    const int instance = static_cast<int>(frame.detections.size()) + 1;
    for (int v = f.mask.v0; v < f.mask.v0 + f.mask.height; ++v)
      for (int u = f.mask.u0; u < f.mask.u0 + f.mask.width; ++u)
        if (f.mask.at(u, v)) frame.instances[k.index(u, v)] = static_cast<std::uint16_t>(instance);
    frame.detections.push_back({instance, f.score, true, "fruit", std::nullopt});
  }
}

}  // namespace agrisee::study
