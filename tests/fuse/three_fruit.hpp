// SPDX-License-Identifier: BSD-3-Clause
// Views of three fruit, taken into a map one after the other. Some of their poses are reported wrongly.
#pragma once

#include <agrisee/fuse/fused_views.hpp>

#include "spheres.hpp"

namespace agrisee::test {

using namespace fuse;
using Eigen::Vector3d;
using Eigen::Vector3f;

inline const Aabb kVolume{{-0.3, 0.2, -0.1}, {0.3, 0.9, 0.5}};
inline const Vector3d kRight(0, 0, 0);
inline const Vector3d kNearer(0, -0.04, 0);  // with a pose reported so, all seems to be 4 cm nearer than it is

/// A fine surface, so that a view has some thousand points.
inline FusionParameters fine() {
  FusionParameters parameters;
  parameters.surface.spacing = 0.0014;
  return parameters;
}

inline sensor::DepthFrame frame_from(const Pose& pose, const std::vector<Sphere>& spheres = kThreeFruit,
                                     double fov_x = deg(40), double fov_y = deg(30)) {
  return render(spheres, sensor::intrinsics_from_fov(160, 120, fov_x, fov_y), pose);
}

/// Where the camera really is for view i.
inline Pose place(int i) {
  const std::vector<Vector3d> from{
      {0.0, 0.2, 0.2}, {0.05, 0.2, 0.22}, {-0.05, 0.21, 0.2}, {0.02, 0.2, 0.26}, {0.0, 0.22, 0.15}};
  const Vector3d position = from[static_cast<std::size_t>(i)];
  return look_along(position, Vector3d(0.01, 0.55, 0.2) - position);
}

/// What the camera sees of the three fruit at place i.
inline const sensor::DepthFrame& frame_at(int i) {
  static const std::vector<sensor::DepthFrame> frames{frame_from(place(0)), frame_from(place(1)), frame_from(place(2)),
                                                      frame_from(place(3)), frame_from(place(4))};
  return frames[static_cast<std::size_t>(i)];
}

/// A pose as it is reported when it is `error` (m) off.
inline Pose off_by(Pose pose, const Vector3d& error) {
  pose.pretranslate(error);
  return pose;
}

/// Take in what the camera sees at place i, with the pose reported `error` (m) off.
inline Change see(FusedViews& map, int i, const Vector3d& error = kRight) {
  const Pose reported = off_by(place(i), error);
  return map.take(map.look(frame_at(i), reported), reported);
}

/// Take in what the camera sees of other spheres at place 0, with the pose reported `error` (m) off.
inline Change see_spheres(FusedViews& map, const std::vector<Sphere>& spheres, const Vector3d& error = kRight) {
  const Pose reported = off_by(place(0), error);
  return map.take(map.look(frame_from(place(0), spheres), reported), reported);
}

inline std::vector<bool> discarded(const FusedViews& map) {
  std::vector<bool> out;
  for (std::size_t v = 0; v < map.images().size(); ++v) out.push_back(map.discarded(v));
  return out;
}

inline bool same(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }
inline double distance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

inline std::size_t near(const Cloud& cloud, const Sphere& s) {
  std::size_t count = 0;
  for (const Vector3f& p : cloud.points) count += (p.cast<double>() - s.center).norm() < 1.1 * s.radius;
  return count;
}

/// Add the points of a look to surfels; the points that founded one.
inline std::vector<Vector3f> add(SurfelMap& surfels, const sensor::SurfaceImage& seen, int view) {
  std::vector<Vector3f> added;
  for (std::size_t i = 0; i < seen.points.size(); ++i)
    if (surfels.add(seen.points[i], seen.normals[i], seen.sigma[i], view)) added.push_back(seen.points[i]);
  return added;
}

}  // namespace agrisee::test
