// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Removes lens distortion from a depth frame: the result is that of a pinhole camera.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee::sensor {

/// The distortion of a lens, in the order of OpenCV and of ROS's `plumb_bob` (the first 5) and `rational_polynomial`
/// (all 8): k1, k2, p1, p2, k3, k4, k5, k6. All 0: none. The model is Brown's (Photogrammetric Engineering, 1971), with
/// the radial part as a fraction of two polynomials in r^2.
struct Distortion {
  std::array<double, 8> k{};  ///< without units; they act on (x / z, y / z)

  /// Whether the lens distorts at all.
  bool any() const {
    return std::any_of(k.begin(), k.end(), [](double x) { return x != 0.0; });
  }
  /// The distorted image of the point p, both at z = 1.
  Eigen::Vector2d distorted(const Eigen::Vector2d& p) const {
    const double r2 = p.squaredNorm(), xy = 2.0 * p.x() * p.y(), radial = stretch(r2);
    return {p.x() * radial + k[2] * xy + k[3] * (r2 + 2.0 * p.x() * p.x()),
            p.y() * radial + k[3] * xy + k[2] * (r2 + 2.0 * p.y() * p.y())};
  }
  /// The inverse of distorted(), by fixed-point iteration; both at z = 1. Empty where it finds none: the lens shows
  /// nothing there, or folds the image.
  std::optional<Eigen::Vector2d> undistorted(const Eigen::Vector2d& p) const {
    Eigen::Vector2d out = p;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d off = p - distorted(out);
      out += off;
      if (!out.allFinite()) return std::nullopt;
      if (off.squaredNorm() < 1e-20) return out;
    }
    return std::nullopt;
  }
  /// The radial factor at the squared distance r2 from the optical axis (z = 1).
  double stretch(double r2) const {
    return (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  }
};

/// A distortion from a list of 4, 5 or 8 coefficients; an empty list means none.
/// @throws InputError for other lengths, such as those of fisheye models, and for coefficients that are not finite
template <typename List>
Distortion distortion_from(const List& coefficients) {
  const std::size_t n = coefficients.size();
  if (n != 0 && n != 4 && n != 5 && n != 8)
    throw InputError("distortion: 4, 5 or 8 coefficients are expected (k1, k2, p1, p2, k3, k4, k5, k6), got " +
                     std::to_string(n) + ": rectify images of other lenses first");
  Distortion out;
  std::copy(coefficients.begin(), coefficients.end(), out.k.begin());
  for (const double x : out.k) check_input(std::isfinite(x), "distortion: a coefficient is not finite");
  return out;
}

/// Check that the radial distortion grows from the middle of the image to its corners, and that no pixel is moved by
/// more than half of the way from the middle to a corner. Wrong coefficients often violate one of both.
/// @throws InputError if two radii would be seen as one, or a pixel is moved too far
inline void check(const Distortion& lens, const Intrinsics& k) {
  const Eigen::Vector3d a = k.ray(-0.5, -0.5), b = k.ray(k.width - 0.5, k.height - 0.5);
  const double farthest = Eigen::Vector2d(std::max(-a.x(), b.x()), std::max(-a.y(), b.y())).norm();
  constexpr int kSteps = 100;
  double last = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double r = farthest * i / kSteps, seen = r * lens.stretch(r * r);
    if (!(std::isfinite(seen) && seen > last))
      throw InputError("distortion: it folds the image " + std::to_string(static_cast<int>(r * k.fx)) +
                       " pixels from the principal point: are the coefficients in the order k1, k2, p1, p2, k3, ...?");
    last = seen;
  }
  constexpr int kCells = 16;  // along each side of the image
  const double most = 0.25 * std::hypot(k.width, k.height);
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      const Eigen::Vector2d uv((k.width - 1) * i / double(kCells), (k.height - 1) * j / double(kCells));
      const Eigen::Vector2d seen = k.project(lens.distorted(k.ray(uv.x(), uv.y()).head<2>()).homogeneous());
      const double moved = (seen - uv).norm();
      if (!(moved <= most))
        throw InputError("distortion: it moves parts of the image by " +
                         std::to_string(std::lround(std::min(1e6, moved))) +
                         " pixels, more than half of the way from the middle of the image to a corner: are these the "
                         "coefficients of this camera, in the order k1, k2, p1, p2, k3, ...?");
    }
}

/// The box through the rectified midpoints of a box's sides. Where the lens shows no midpoint, as near the border under
/// barrel distortion, the nearest point of the side stands for it that the lens shows, and where it shows none of the
/// side, the side ends at what it shows of the box, and at the border of the image. Empty if nothing of the box is left
/// in the image.
/// @param box as in the camera's image
/// @param lens distortion of the camera
/// @param k intrinsics of the camera
inline std::optional<PixelBox> rectified(const PixelBox& box, const Distortion& lens, const Intrinsics& k) {
  constexpr int kHalf = 8;  // lines and points are this fraction of half of a side apart
  // In coordinates whose integers are the middles of pixels, in which pixel_of works.
  const Eigen::Array2d half(0.5 * box.width, 0.5 * box.height);
  const Eigen::Array2d middle = Eigen::Array2d(box.u, box.v) + half - 0.5;
  const Eigen::Array2d first = Eigen::Array2d::Constant(-0.5), end = Eigen::Array2d(k.width, k.height) - 0.5;
  // A side's coordinate along an axis: lines parallel to it are tried inwards, and points of each from its middle on.
  const auto side = [&](int axis, double sign) -> std::optional<double> {
    for (int line = kHalf; line >= -kHalf; --line)
      for (int i = 0; i <= 2 * kHalf; ++i) {
        const double along = (i % 2 ? -0.5 : 0.5) * (i + i % 2) / kHalf;
        const Eigen::Array2d place =
            axis == 0 ? Eigen::Array2d(sign * line / kHalf, along) : Eigen::Array2d(along, sign * line / kHalf);
        const Eigen::Array2d uv = middle + place * half;
        const auto p = lens.undistorted(k.ray(uv.x(), uv.y()).head<2>());
        if (!p) continue;
        const double out = k.project(p->homogeneous())[axis];
        return line == kHalf ? out : std::clamp(out, first[axis], end[axis]);
      }
    return std::nullopt;
  };
  const auto left = side(0, -1.0), right = side(0, 1.0), top = side(1, -1.0), bottom = side(1, 1.0);
  if (!left) return std::nullopt;  // the lens shows nothing of the box
  const bool inside =
      std::max(*left, first.x()) < std::min(*right, end.x()) && std::max(*top, first.y()) < std::min(*bottom, end.y());
  if (!inside) return std::nullopt;
  return PixelBox{*left + 0.5, *top + 0.5, *right - *left, *bottom - *top};
}

/// The frame that a pinhole camera with the same intrinsics would have taken. Each pixel takes the values of the
/// nearest pixel of `frame`; depths are not interpolated, as that would bridge depth edges. Pixels outside the original
/// image have no return. Boxes of detections are rectified, too; a detection of whose box and mask nothing is left is
/// not listed.
/// @param frame  as the camera took it, z along the optical axis; all channels have the same distortion
/// @param lens   distortion of the camera
/// @throws InputError for a frame that is not consistent, or a distortion that folds the image
inline DepthFrame rectified(const DepthFrame& frame, const Distortion& lens) {
  check(frame);
  if (!lens.any()) return frame;
  const Intrinsics& k = frame.intrinsics;
  check(lens, k);
  DepthFrame out;
  out.intrinsics = k;
  out.detections = frame.detections;
  out.detected = frame.detected;
  out.depth.assign(k.size(), 0.0f);
  out.color.resize(frame.color.size());
  out.instances.resize(frame.instances.size());
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const auto source = k.pixel_of(lens.distorted(k.ray(u, v).head<2>()).homogeneous());
      if (!source) continue;
      const std::size_t pixel = k.index(u, v);
      out.depth[pixel] = frame.depth[*source];
      if (!frame.color.empty()) out.color[pixel] = frame.color[*source];
      if (!frame.instances.empty()) out.instances[pixel] = frame.instances[*source];
    }
  const auto is_lost = [&](Detection& d) {
    if (!d.box) return false;
    d.box = rectified(*d.box, lens, k);
    return !d.box && std::find(out.instances.begin(), out.instances.end(), d.instance) == out.instances.end();
  };
  std::vector<Detection> kept;
  for (Detection& d : out.detections)
    if (!is_lost(d)) kept.push_back(std::move(d));
  out.detections = std::move(kept);
  return out;
}

}  // namespace agrisee::sensor
