// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/study/color_camera.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace agrisee::study {

namespace {

constexpr std::uint64_t kColorStream = 0xC0105;               // tells the random numbers of colors from all others
constexpr std::uint64_t kWholeView = std::uint64_t{1} << 63;  // in place of a pixel: what the whole view shares

/// A color in CIELAB by lightness, chroma and hue angle (rad).
struct Shade {
  double lightness, chroma, hue;
};

/// Linear light of a color in CIELAB (CIE 15:2004, white point D65; IEC 61966-2-1), limited to 0..1.
Eigen::Vector3d linear_of(const Shade& s) {
  const auto inverse = [](double t) {
    constexpr double kDelta = 6.0 / 29.0;
    return t > kDelta ? t * t * t : 3.0 * kDelta * kDelta * (t - 4.0 / 29.0);
  };
  const double fy = (s.lightness + 16.0) / 116.0;
  const double fx = fy + s.chroma * std::cos(s.hue) / 500.0, fz = fy - s.chroma * std::sin(s.hue) / 200.0;
  const Eigen::Vector3d xyz(0.9505 * inverse(fx), inverse(fy), 1.089 * inverse(fz));
  Eigen::Matrix3d rgb_of;
  rgb_of << 3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570;
  return (rgb_of * xyz).cwiseMax(0.0).cwiseMin(1.0);
}

/// A channel of sRGB (0..1) with this linear light: the inverse of linear_light.
double encoded(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055; }

/// The shade of a fruit's surface that has turned to a degree: 0 green, 0.5 half way, 1 red.
Shade turned(double degree) {
  constexpr std::array<Shade, 3> kShades{{{60.0, 42.0, deg(114)}, {56.0, 50.0, deg(70)}, {42.0, 52.0, deg(38)}}};
  const double at = 2.0 * std::clamp(degree, 0.0, 1.0);
  const std::size_t i = at < 1.0 ? 0 : 1;
  const Shade &a = kShades[i], &b = kShades[i + 1];
  const double t = at - static_cast<double>(i);
  return {a.lightness + t * (b.lightness - a.lightness), a.chroma + t * (b.chroma - a.chroma),
          a.hue + t * (b.hue - a.hue)};
}

/// To what degree (0..1) the surface of a fruit has turned at a point.
double degree_at(const Look& look, std::uint32_t number, const Eigen::Vector3d& point) {
  constexpr double kBand = 0.25, kWave = 0.04;  // of the fruit's height
  const double share = look.ripeness.value_or(1.0);
  if (share <= 0.0 || share >= 1.0 || look.box.empty()) return share <= 0.0 ? 0.0 : 1.0;
  // On a sphere the surface below a height is in proportion to the height (Archimedes).
  const Eigen::Vector3d from_middle = point - look.box.center();
  const double height = std::clamp(0.5 + from_middle.z() / std::max(look.box.size().z(), 1e-6), 0.0, 1.0);
  const double around = std::atan2(from_middle.y(), from_middle.x());
  Rng rng(kColorStream, number);
  const double a = rng.uniform(0.0, kTwoPi), b = rng.uniform(0.0, kTwoPi);
  const double least = std::min(share, 1.0 - share);
  const double wave = std::min(kWave, 0.5 * least) * (std::sin(3.0 * around + a) + std::sin(5.0 * around + b));
  return std::clamp(0.5 + (share + wave - height) / std::min(kBand, 2.0 * least), 0.0, 1.0);
}

/// The shade of the objects of a class.
Shade shade_of(ObjectClass cls) {
  switch (cls) {
    case ObjectClass::leaf:
      return {42.0, 34.0, deg(128)};
    case ObjectClass::stem:
      return {54.0, 32.0, deg(116)};
    default:
      return {48.0, 10.0, deg(75)};
  }
}

/// How a view renders brightness and colors.
Eigen::Vector3d gains_of(const ColorParameters& p, std::uint64_t seed, std::uint64_t view) {
  Rng rng(seed ^ kColorStream, view, kWholeView);
  const double brightness = std::exp(p.exposure * rng.normal());
  const double red = std::exp(p.white_balance * rng.normal()), blue = std::exp(p.white_balance * rng.normal());
  return {brightness * red, brightness, brightness * blue};
}

/// What a surface of this color sends to the camera (linear light).
/// @param normal of the surface (unit)  @param to_camera (unit)
Eigen::Vector3d shaded(const Eigen::Vector3d& color, Eigen::Vector3d normal, const Eigen::Vector3d& to_camera,
                       bool glossy, const ColorParameters& p) {
  if (normal.dot(to_camera) < 0.0) normal = -normal;  // sheets have two sides
  const Eigen::Vector3d light = p.light.normalized();
  const Eigen::Vector3d out = (p.ambient + (1.0 - p.ambient) * std::max(0.0, normal.dot(light))) * color;
  if (!glossy) return out;
  const double off = std::acos(std::clamp(normal.dot((light + to_camera).normalized()), -1.0, 1.0)) / p.gloss_width;
  return out + Eigen::Vector3d::Constant(p.gloss * std::exp(-0.5 * off * off));
}

}  // namespace

Eigen::Vector3d surface_color(const Look& look, std::uint32_t number, const Eigen::Vector3d& point) {
  if (look.color) {
    Eigen::Vector3d out;
    for (Eigen::Index c = 0; c < 3; ++c) out[c] = linear_light((*look.color)[static_cast<std::size_t>(c)] / 255.0);
    return out;
  }
  if (look.cls == ObjectClass::fruit) return linear_of(turned(degree_at(look, number, point)));
  Shade shade = shade_of(look.cls);
  Rng rng(kColorStream, number, 1);
  shade.lightness += 4.0 * rng.normal();
  shade.hue += deg(4) * rng.normal();
  return linear_of(shade);
}

std::vector<Rgb> color_image(const TracedScene& scene, const RayImage& rays, const sensor::Intrinsics& intrinsics,
                             const Pose& world_T_optical, const ColorParameters& parameters, std::uint64_t seed,
                             std::uint64_t view, int threads) {
  const Eigen::Vector3d dark(0.006, 0.007, 0.009), eye = world_T_optical.translation();
  const Eigen::Vector3d gains = gains_of(parameters, seed, view);
  const auto width = static_cast<std::size_t>(intrinsics.width);
  std::vector<Rgb> out(intrinsics.size());
  parallel_for(
      static_cast<std::size_t>(intrinsics.height), threads,
      [&](std::size_t v) {
        for (std::size_t u = 0, i = v * width; u < width; ++u, ++i) {
          Eigen::Vector3d light = dark;
          if (const std::uint32_t triangle = rays.triangle[i]; triangle != kNoHit) {
            const Eigen::Vector3d ray = ray_direction(intrinsics, world_T_optical, double(u), double(v)).cast<double>();
            const std::uint32_t number = scene.object(triangle);
            const Look& look = scene.looks()[number];
            const Eigen::Vector3d color = surface_color(look, number, eye + double(rays.range[i]) * ray);
            light =
                shaded(color, scene.normal(triangle).cast<double>(), -ray, look.cls == ObjectClass::fruit, parameters);
          }
          Rng rng(seed ^ kColorStream, view, i);
          for (std::size_t c = 0; c < 3; ++c) {
            const auto axis = static_cast<Eigen::Index>(c);
            const double value = encoded(std::min(1.0, gains[axis] * light[axis])) + parameters.noise * rng.normal();
            out[i][c] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
          }
        }
      },
      8);
  return out;
}

}  // namespace agrisee::study
