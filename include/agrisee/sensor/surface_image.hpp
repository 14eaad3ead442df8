// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface that one depth frame shows, and the parameters of its reconstruction (reconstruct_surface.hpp). Metres,
/// radians.
#pragma once

#include <agrisee/core/median.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/intrinsics.hpp>

#include <cmath>
#include <vector>

namespace agrisee::sensor {

/// Parameters of reconstruct_surface.
struct SurfaceParameters {
  double spacing = 0.0022;         ///< desired distance between cells on the object (m)
  int max_block = 8;               ///< largest edge of the block of pixels that makes a cell (pixels)
  double target_sigma = 0.002;     ///< a window grows until the cell's standard deviation should be this small (m)
  int max_window = 4;              ///< largest half width of a window (cells)
  double smallest_radius = 0.012;  ///< smallest radius of curvature that smoothing has to preserve (m)
  double max_incidence = deg(84);  ///< cells seen at a larger angle of incidence are dropped (rad)

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("spacing", p.spacing, Range::positive());
    f("max_block", p.max_block, Range::between(1, 64));
    f("target_sigma", p.target_sigma, Range::positive());
    f("max_window", p.max_window, Range::between(1, 20));
    f("smallest_radius", p.smallest_radius, Range::positive());
    f("max_incidence", p.max_incidence, Range::above(0.0).below({kPi / 2, "pi/2"}).in_radians());
  }
};

/// The surface seen in one frame: samples of it, and an image of cells with their raw depths.
struct SurfaceImage {
  Intrinsics intrinsics;                    ///< of the image of cells
  Pose world_T_optical = Pose::Identity();  ///< pose of the sensor
  std::vector<float> depth;                 ///< raw depth z (m) of each cell, in the scan volume or not; 0 = no return
  std::vector<Eigen::Vector3f> points;      ///< surface points (m, world), in the order of the cells
  std::vector<Eigen::Vector3f> normals;     ///< unit normals of the points, towards the sensor (world)
  std::vector<float> sigma;                 ///< standard deviations of the points along the ray (m), positive
  std::size_t points_in = 0;                ///< number of pixels that returned a point inside the scan volume
  double noise = 0.0;                       ///< standard deviation of the cells' raw depths (m)
  /// Share of the pixels with a return, where there is a surface: the median of the cells with at least one return.
  /// Once the view is compared with others (fuse::returned), at most the share of their surface that it measures.
  double fill = 0.0;

  /// Index of the cell in which a point is seen, or -1 if it is outside the image or behind the sensor.
  /// @param p_world the point (m)
  /// @param z if given, receives the depth of the point (m), unless it is behind the sensor or outside the image
  std::ptrdiff_t cell(const Eigen::Vector3d& p_world, double* z = nullptr) const {
    const Eigen::Vector3d p = world_T_optical.linear().transpose() * (p_world - world_T_optical.translation());
    const auto seen = intrinsics.pixel_of(p);
    if (!seen) return -1;
    if (z) *z = p.z();
    return static_cast<std::ptrdiff_t>(*seen);
  }
};

/// Standard deviation of the angle of the normals (rad) in fused surfaces due to the sensor alone: the median noise of
/// the images with points over 20 mm. The patches that normals are fitted to are 11 mm wide, and up to 20 mm at much
/// noise. 0 without such images.
inline double normal_noise(const std::vector<SurfaceImage>& images) {
  constexpr double kPatch = 0.020;
  std::vector<double> noise;
  for (const SurfaceImage& image : images)
    if (!image.points.empty()) noise.push_back(image.noise);
  return median(noise) / kPatch;
}

}  // namespace agrisee::sensor
