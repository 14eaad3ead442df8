// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface that one depth frame shows, and how it is to be found; reconstruct_surface.hpp finds it.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/intrinsics.hpp>

#include <cmath>
#include <vector>

namespace agrisee::sensor {

/// Parameters of reconstruct_surface.
struct SurfaceParameters {
  double spacing = 0.0022;         ///< wanted distance between cells on the object (m)
  int max_block = 8;               ///< largest block edge (pixels)
  double target_sigma = 0.0004;    ///< windows grow until a cell's standard deviation should reach this (m)
  int max_window = 6;              ///< largest half width of a window (cells)
  double smallest_radius = 0.012;  ///< smallest radius of curvature to be kept (m)
  double max_incidence = deg(81);  ///< cells seen at more than this angle are dropped (rad)

  /// @throws ParameterError
  void check() const {
    check_parameter(spacing > 0, "surface.spacing", "positive", spacing);
    check_parameter(max_block >= 1 && max_block <= 64, "surface.max_block", "in [1, 64]", max_block);
    check_parameter(target_sigma > 0, "surface.target_sigma", "positive", target_sigma);
    check_parameter(max_window >= 1 && max_window <= 20, "surface.max_window", "in [1, 20]", max_window);
    check_parameter(smallest_radius > 0, "surface.smallest_radius", "positive", smallest_radius);
    check_parameter(max_incidence > 0 && max_incidence < kPi / 2, "surface.max_incidence", "in (0, pi/2)",
                    max_incidence);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("spacing", p.spacing);
    f("max_block", p.max_block);
    f("target_sigma", p.target_sigma);
    f("max_window", p.max_window);
    f("smallest_radius", p.smallest_radius);
    f("max_incidence", p.max_incidence);
  }
};

/// The surface seen in one frame: samples of it, and an image of cells with their raw depths.
struct SurfaceImage {
  Intrinsics intrinsics;                    ///< of the cells: pixel (u, v) is cell (u, v)
  Pose world_T_optical = Pose::Identity();  ///< of the sensor
  std::vector<float> depth;                 ///< raw depth z of each cell (m), 0 = no return; inside the volume and out
  std::vector<Eigen::Vector3f> points;      ///< surface points (m, world), in the order of the cells
  std::vector<Eigen::Vector3f> normals;     ///< their unit normals, towards the sensor (world)
  std::vector<float> sigma;                 ///< their standard deviations along the ray (m), positive
  std::size_t points_in = 0;                ///< pixels that returned a point inside the volume
  double noise = 0.0;                       ///< standard deviation of the cells' raw depths (m)
  double fill = 0.0;                        ///< median share of valid pixels in cells with any

  /// Cell at which a point in world is seen, or -1 when it is outside the image or behind the sensor.
  std::ptrdiff_t cell(const Eigen::Vector3d& p_world, double* z = nullptr) const {
    const Eigen::Vector3d p = world_T_optical.inverse(Eigen::Isometry) * p_world;
    if (!(p.z() > 0.0)) return -1;
    const Eigen::Vector2d uv = intrinsics.project(p);
    const double u = std::floor(uv.x() + 0.5), v = std::floor(uv.y() + 0.5);
    if (!(u >= 0 && v >= 0 && u < intrinsics.width && v < intrinsics.height)) return -1;
    if (z) *z = p.z();
    return static_cast<std::ptrdiff_t>(v) * intrinsics.width + static_cast<std::ptrdiff_t>(u);
  }
};

}  // namespace agrisee::sensor
