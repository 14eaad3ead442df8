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

/// The frame that a pinhole camera with the same intrinsics would have taken. Each pixel takes the values of the
/// nearest pixel of `frame`; depths are not interpolated, as that would bridge depth edges. Pixels outside the original
/// image have no return. The box of a detection becomes the one through the rectified midpoints of its sides.
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
  // Where a place of the image goes; what the lens does not show lies beyond the border, where `otherwise` is.
  const auto pinhole = [&](double u, double v, double otherwise) {
    const auto p = lens.undistorted(k.ray(u, v).head<2>());
    return p ? k.project(p->homogeneous()) : Eigen::Vector2d::Constant(otherwise).eval();
  };
  for (Detection& d : out.detections) {
    if (!d.box) continue;
    // The sides in coordinates whose integers are the middles of pixels, in which pixel_of works.
    const double left = d.box->u - 0.5, top = d.box->v - 0.5, right = left + d.box->width, bottom = top + d.box->height;
    const double u = 0.5 * (left + right), v = 0.5 * (top + bottom);
    const double new_left = pinhole(left, v, -0.5).x(), new_right = pinhole(right, v, k.width - 0.5).x();
    const double new_top = pinhole(u, top, -0.5).y(), new_bottom = pinhole(u, bottom, k.height - 0.5).y();
    d.box = PixelBox{new_left + 0.5, new_top + 0.5, new_right - new_left, new_bottom - new_top};
  }
  return out;
}

}  // namespace agrisee::sensor
