// SPDX-License-Identifier: BSD-3-Clause
#include "fuse/mask_outline.hpp"

#include <agrisee/core/cancellation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace agrisee::fuse {
namespace {

/// A place on the border of a mask: between a pixel of it and one outside.
struct BorderPlace {
  double u, v;    // pixels
  double du, dv;  // outwards
};

/// What the pixels of a mask say before any body is fitted.
struct MaskGeometry {
  std::vector<BorderPlace> border;
  double radius = 0.0;                 // of a disc as large as the mask (pixels)
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;  // the box about it, the last included
  double near = 0.0;                   // distance (m) of the nearest part of the body's front
  std::vector<Eigen::Vector3d> front;  // points (m, world) at the depth of most of its pixels
};

/// Add the places where the mask ends at one pixel of it.
void add_border(const MaskImage& image, std::uint16_t instance, int u, int v, std::vector<BorderPlace>& border) {
  constexpr std::array<std::array<int, 2>, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  const sensor::Intrinsics& k = image.frame->intrinsics;
  for (const auto& [du, dv] : kSides) {
    const int a = u + du, b = v + dv;
    const bool inside = a >= 0 && b >= 0 && a < k.width && b < k.height;
    if (inside && image.instances[k.index(a, b)] == instance) continue;
    border.push_back({u + 0.5 * du, v + 0.5 * dv, double(du), double(dv)});
  }
}

/// @return empty if fewer than 12 pixels have a depth
std::optional<MaskGeometry> geometry_of(const MaskImage& image, std::uint16_t instance, const BodyParameters& bodies) {
  constexpr std::size_t kFewest = 12, kMost = 400;
  const std::vector<std::uint32_t>& pixels = image.pixels.at(instance);
  const auto width = static_cast<std::size_t>(image.frame->intrinsics.width);
  MaskGeometry out;
  out.u0 = out.v0 = std::numeric_limits<int>::max();
  std::vector<double> distances;
  for (const std::uint32_t p : pixels) {
    const int u = static_cast<int>(p % width), v = static_cast<int>(p / width);
    add_border(image, instance, u, v, out.border);
    out.u0 = std::min(out.u0, u), out.u1 = std::max(out.u1, u);
    out.v0 = std::min(out.v0, v), out.v1 = std::max(out.v1, v);
    if (const double d = image.distance(p); d > 0.0) distances.push_back(d);
  }
  if (distances.size() < kFewest) return std::nullopt;
  out.radius = std::sqrt(static_cast<double>(pixels.size()) / kPi);
  std::sort(distances.begin(), distances.end());
  const auto [first, end] = densest(distances, bodies.radius_max, [](double d) { return d; });
  out.near = distances[first + (end - first) / 10];
  const double far = distances[end - 1];
  const Eigen::Vector3d sensor = image.world_T_optical.translation();
  for (const std::uint32_t p : pixels) {
    const double d = image.distance(p);
    if (d >= distances[first] && d <= far)
      out.front.push_back(sensor + d * image.direction(double(p % width), double(p / width)));
  }
  const std::size_t step = out.front.size() / kMost + 1;
  for (std::size_t i = 0; i * step < out.front.size(); ++i) out.front[i] = out.front[i * step];
  out.front.resize((out.front.size() + step - 1) / step);
  return out;
}

/// How surely (0..1) the mask ends at a place because the body ends there: not where something hides the body, which is
/// nearer than what the body's rim can be, and not where the image ends.
double own_outline(const MaskImage& image, const MaskGeometry& mask, const BorderPlace& at, double nearer) {
  constexpr std::array<double, 4> kSteps{0.09, 0.16, 0.24, 0.31};  // of the mask's radius
  constexpr double kHidden = 0.05;                                 // what is left of the weight
  const sensor::Intrinsics& k = image.frame->intrinsics;
  int nearby = 0, hiding = 0;
  for (const double step : kSteps) {
    const double reach = std::max(1.0, step * mask.radius);
    const int u = static_cast<int>(std::lround(at.u + reach * at.du));
    const int v = static_cast<int>(std::lround(at.v + reach * at.dv));
    if (u < 0 || v < 0 || u >= k.width || v >= k.height) return kHidden;
    const double d = image.distance(k.index(u, v));
    ++nearby;
    hiding += d > 0.0 && d < nearer;
  }
  return 2 * hiding >= nearby ? kHidden : 1.0 - double(hiding) / nearby;
}

/// The outline as sight lines, in order about its middle.
Silhouette outline_of(const MaskImage& image, const MaskGeometry& mask, double pixel, const BodyParameters& bodies,
                      const MaskParameters& parameters) {
  constexpr double kRim = 0.35;  // of the radius: what hides a body is nearer than this behind the body's front
  const double radius = std::clamp(mask.radius * pixel * mask.near, bodies.radius_min, bodies.radius_max);
  Silhouette out;
  out.sensor = image.world_T_optical.translation();
  out.angle_error = parameters.edge * pixel;
  out.front = mask.front;
  double cu = 0.0, cv = 0.0;
  for (const BorderPlace& b : mask.border) cu += b.u, cv += b.v;
  cu /= static_cast<double>(mask.border.size());
  cv /= static_cast<double>(mask.border.size());
  std::vector<BorderPlace> ordered = mask.border;
  std::stable_sort(ordered.begin(), ordered.end(), [&](const BorderPlace& a, const BorderPlace& b) {
    return std::atan2(a.v - cv, a.u - cu) < std::atan2(b.v - cv, b.u - cu);
  });
  for (const BorderPlace& b : ordered) {
    out.rays.push_back(image.direction(b.u, b.v));
    out.weights.push_back(own_outline(image, mask, b, mask.near + kRim * radius));
  }
  return out;
}

/// A circular cone of sight lines about a sphere.
struct Cone {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // unit
  double cosine = 0.0, sine = 0.0;                 // of half its opening angle

  /// How far a direction lies outside of the cone (rad); negative inside.
  double outside(const Eigen::Vector3d& direction) const { return (cosine - axis.dot(direction)) / sine; }
  /// The sphere that fills the cone and whose nearest point is at a distance (m) from the sensor.
  Sphere sphere(const Eigen::Vector3d& sensor, double near) const {
    const double distance = near / (1.0 - sine);
    return {sensor + distance * axis, distance * sine};
  }
};

/// The cone through three directions; empty where they are in a line.
std::optional<Cone> cone_through(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Cone cone;
  cone.axis = (b - a).cross(c - a);
  const double length = cone.axis.norm();
  if (!(length > 1e-12)) return std::nullopt;
  cone.axis /= length;
  cone.cosine = cone.axis.dot(a);
  if (cone.cosine < 0.0) cone.axis = -cone.axis, cone.cosine = -cone.cosine;
  cone.sine = std::sqrt(std::max(0.0, 1.0 - cone.cosine * cone.cosine));
  if (!(cone.sine > 1e-6) || !(cone.sine < 0.9)) return std::nullopt;
  return cone;
}

/// A pixel outside of the mask, which may contradict a cone.
struct Beside {
  Eigen::Vector3d direction;
  double distance;  // m, > 0
};

/// Pixels about a mask that have a depth, each for step x step pixels.
std::vector<Beside> beside(const MaskImage& image, std::uint16_t instance, const MaskGeometry& mask, int step) {
  const sensor::Intrinsics& k = image.frame->intrinsics;
  const int margin = static_cast<int>(mask.radius) + 2;
  std::vector<Beside> out;
  for (int v = std::max(0, mask.v0 - margin); v < std::min(k.height, mask.v1 + margin + 1); v += step)
    for (int u = std::max(0, mask.u0 - margin); u < std::min(k.width, mask.u1 + margin + 1); u += step) {
      const std::size_t p = k.index(u, v);
      const double d = image.distance(p);
      if (image.instances[p] != instance && d > 0.0) out.push_back({image.direction(u, v), d});
    }
  return out;
}

/// What a ray outside of a cone takes from its score at most, in rays.
constexpr double kWorst = 2.0;

/// Rates cones by the border of a mask and the pixels beside it.
class ConeSearch {
 public:
  ConeSearch(const Silhouette& outline, const MaskGeometry& mask, std::vector<Beside> pixels_beside, int step,
             double pixel, double tolerance)
      : near_(mask.near), beside_(std::move(pixels_beside)), step_(step), pixel_(pixel), tolerance_(tolerance) {
    constexpr std::size_t kMost = 96;
    const std::size_t n = std::min(kMost, outline.rays.size());
    for (std::size_t i = 0; i < n; ++i) {
      rays_.push_back(outline.rays[i * outline.rays.size() / n]);
      weights_.push_back(outline.weights[i * outline.rays.size() / n]);
    }
    length_ = static_cast<double>(outline.rays.size()) / static_cast<double>(n);
  }

  /// The border on the cone less what of the mask is outside, as a share of the circle; at most about 1.3.
  /// @param worst what a ray outside takes at most, in rays
  /// @param other the cone of another body: what is in it is not outside, and what is on it is not on this one
  double border_score(const Cone& cone, double worst, const Cone* other) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const double x = cone.outside(rays_[i]) / tolerance_;
      if (other && !(other->outside(rays_[i]) > tolerance_)) continue;
      if (std::abs(x) < 1.0)
        sum += weights_[i] * (1.0 - x * x);
      else if (x > 1.0)
        sum -= std::min(x - 1.0, worst);
    }
    return sum * length_ * pixel_ / (kTwoPi * cone.sine);
  }

  /// How much of the border is on a cone or, with another, on either: a sum of weights.
  double explained(const Cone& cone, const Cone* other = nullptr) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      double off = std::abs(cone.outside(rays_[i]));
      if (other) off = std::min(off, std::abs(other->outside(rays_[i])));
      const double x = off / tolerance_;
      if (x < 1.0) sum += weights_[i] * (1.0 - x * x);
    }
    return sum;
  }

  /// The share of the circle in which sight lines go on behind the sphere's center.
  double seen_through(const Cone& cone) const {
    constexpr double kInner = 0.93;  // of the circle: nearer to its edge pixels may be off
    const double center = near_ / (1.0 - cone.sine), inner = std::cos(kInner * std::asin(cone.sine));
    std::size_t count = 0;
    for (const Beside& b : beside_) count += b.distance > center && cone.axis.dot(b.direction) > inner;
    return static_cast<double>(count) * step_ * step_ * pixel_ * pixel_ / (kPi * cone.sine * cone.sine);
  }

  /// The best cone through three places of the border that has a sphere of an expected size. Empty if of each such cone
  /// more is seen through than borders the mask, where a part seen through counts twice.
  /// @param worst, other as of border_score; with another cone the places are outside of that
  std::optional<Cone> best(const BodyParameters& bodies, double worst = kWorst, const Cone* other = nullptr) const {
    constexpr std::size_t kMost = 30;
    constexpr double kThrough = 2.0;  // weight of what is seen through
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < rays_.size(); ++i)
      if (!other || other->outside(rays_[i]) > tolerance_) places.push_back(i);
    const std::size_t n = std::min(kMost, places.size());
    const auto ray = [&](std::size_t i) -> const Eigen::Vector3d& { return rays_[places[i * places.size() / n]]; };
    std::optional<Cone> best;
    double most = 0.0;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b)
        for (std::size_t c = b + 1; c < n; ++c) {
          const auto cone = cone_through(ray(a), ray(b), ray(c));
          if (!cone || !bodies.plausible(cone->sphere(Eigen::Vector3d::Zero(), near_).radius)) continue;
          double score = border_score(*cone, worst, other);
          if (best && !(score > most)) continue;
          const double through = kThrough * seen_through(*cone);
          score -= through;
          if (best && !(score > most)) continue;
          if (border_score(*cone, 0.0, other) > through) best = cone, most = score;
        }
    return best;
  }

  /// The cones of the bodies under the mask: one, or two if these explain much more of its border.
  std::vector<Cone> bodies_under(const BodyParameters& bodies) const {
    constexpr double kMore = 1.15;                 // the border on two cones over that on one
    constexpr double kApart = 0.8, kAlike = 0.55;  // of the larger cone's angle
    const auto one = best(bodies);
    if (!one) return {};
    const auto first = best(bodies, 0.0);
    if (!first) return {*one};
    const auto second = best(bodies, kWorst, &*first);
    if (!second) return {*one};
    const double larger = std::max(first->sine, second->sine), smaller = std::min(first->sine, second->sine);
    const bool two = explained(*first, &*second) > kMore * explained(*one) && smaller > kAlike * larger &&
                     (first->axis - second->axis).norm() > kApart * larger;
    return two ? std::vector<Cone>{*first, *second} : std::vector<Cone>{*one};
  }

  /// The share of the circle's border (0..1) that is the mask's, as surely as its weights say.
  double share_seen(const Cone& cone) const {
    constexpr std::size_t kBins = 36;
    std::array<double, kBins> seen{};
    const Eigen::Vector3d x = cone.axis.unitOrthogonal(), y = cone.axis.cross(x);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (!(std::abs(cone.outside(rays_[i])) < tolerance_)) continue;
      const double turn = std::atan2(y.dot(rays_[i]), x.dot(rays_[i])) / kTwoPi + 0.5;
      const auto bin = std::min(kBins - 1, static_cast<std::size_t>(turn * static_cast<double>(kBins)));
      seen[bin] = std::max(seen[bin], weights_[i]);
    }
    double sum = 0.0;
    for (const double s : seen) sum += s;
    return sum / static_cast<double>(kBins);
  }

 private:
  double near_;
  std::vector<Beside> beside_;
  int step_;
  double pixel_, tolerance_;  // rad
  std::vector<Eigen::Vector3d> rays_;
  std::vector<double> weights_;
  double length_ = 1.0;  // pixels of the border that a ray stands for
};

}  // namespace

std::vector<MaskGuess> guess_bodies(const MaskImage& image, std::uint16_t instance, const BodyParameters& bodies,
                                    const MaskParameters& parameters) {
  throw_if_cancelled();
  const auto mask = geometry_of(image, instance, bodies);
  if (!mask) return {};
  const sensor::Intrinsics& k = image.frame->intrinsics;
  const double pixel = 1.0 / std::sqrt(k.fx * k.fy);
  const int step = std::max(1, static_cast<int>(mask->radius / 14.0));
  const Silhouette outline = outline_of(image, *mask, pixel, bodies, parameters);
  const ConeSearch search(outline, *mask, beside(image, instance, *mask, step), step, pixel, parameters.edge * pixel);
  const std::vector<Cone> cones = search.bodies_under(bodies);
  std::vector<MaskGuess> out;
  for (const Cone& cone : cones) {
    MaskGuess guess{outline, cone.sphere(outline.sensor, mask->near)};
    guess.outline.seen = std::max(0.05, search.share_seen(cone));
    for (std::size_t i = 0; i < outline.rays.size(); ++i)  // each place is on the outline of the body nearest to it
      for (const Cone& other : cones)
        if (std::abs(other.outside(outline.rays[i])) < std::abs(cone.outside(outline.rays[i])))
          guess.outline.weights[i] = 0.0;
    out.push_back(std::move(guess));
  }
  return out;
}

}  // namespace agrisee::fuse
