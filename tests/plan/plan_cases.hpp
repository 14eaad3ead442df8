// SPDX-License-Identifier: BSD-3-Clause
// Scans made by hand for the tests of the planners: clouds, cameras and robots of which the right view is known.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/gain_planner.hpp>

#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "spheres.hpp"

namespace cases {

using namespace agrisee;
using namespace agrisee::plan;
using Eigen::Vector3d;

/// Joints at which only the first one is turned. The planner takes a UR3's pi rad/s, so `seconds` is the time to them.
inline Joints at_time(double seconds) {
  Joints q = Joints::Zero();
  q[0] = seconds * kPi;
  return q;
}

/// 96 x 72 pixels without distortion. The point (x, y, z) of the optical frame lies in the image where x / z is in
/// [-48, 48) / focal and y / z is in [-36, 36) / focal.
inline sensor::DepthCamera camera(double focal = 64.0) {
  sensor::DepthCamera out;
  out.intrinsics = {96, 72, focal, focal, 47.5, 35.5};
  out.range_min = 0.01;
  return out;
}

/// A robot that flies: every view, with the top of the image up, in no time.
inline ReachableView fly_to(const ViewRequest& r) {
  ReachableView view;
  view.world_T_optical = look_along(r.target - r.distance * r.direction, r.direction);
  view.target = r.target;
  return view;
}
inline std::optional<ReachableView> fly(const ViewRequest& r, const Joints&) { return fly_to(r); }

/// Views from 0.31 to 0.47 m, best from 0.4 m.
inline ViewRequest band() {
  ViewRequest r;
  r.distance = 0.4;
  r.distance_min = 0.31;
  r.distance_max = 0.47;
  return r;
}

/// What a robot answers that reaches nothing.
inline bool nowhere(const ViewRequest&) { return false; }

/// The angle between two directions (rad).
inline double angle(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// A robot that flies, but only to requests that pass a test, and remembers what it was asked for.
struct Flight {
  std::function<bool(const ViewRequest&)> passes = [](const ViewRequest&) { return true; };
  std::vector<ViewRequest> asked;

  Reach reach() {
    return [this](const ViewRequest& r, const Joints&) -> std::optional<ReachableView> {
      asked.push_back(r);
      return passes(r) ? std::optional(fly_to(r)) : std::nullopt;
    };
  }
};

/// A scan in progress, which owns what a Progress refers to.
struct Scan {
  Cloud cloud;
  std::vector<sensor::SurfaceImage> images;
  std::vector<View> views;
  std::vector<Eigen::Vector3f> added, observed;
  std::optional<Indices> kept;

  Progress progress() const { return {cloud, images, views, added, observed, kept ? &*kept : nullptr}; }
  void add_point(const Vector3d& p) {
    cloud.points.push_back(p.cast<float>());
    cloud.normals.push_back(-Eigen::Vector3f::UnitY());
  }
};

/// An image of camera() in which every cell has the same depth (m; 0 = no return). Without returns, `fill` says whether
/// that means free space (1) or nothing (0).
inline sensor::SurfaceImage flat_image(const Pose& world_T_optical, double depth, double fill = 1.0) {
  sensor::SurfaceImage image;
  image.intrinsics = camera().intrinsics;
  image.world_T_optical = world_T_optical;
  image.depth.assign(image.intrinsics.size(), static_cast<float>(depth));
  image.fill = fill;
  return image;
}

/// The fruit surface (m2) that a view is expected to show.
inline double gain_of(const ExpectedSurface& model, const Pose& world_T_optical) {
  return model.gain(model.shown(world_T_optical));
}

/// A box around a point (m) of half this edge length.
inline Aabb box(const Vector3d& center, double half) {
  return {center - Vector3d::Constant(half), center + Vector3d::Constant(half)};
}

/// Unknown voxels of 1/64 m in a row along x; voxel i is centered at ((i + 0.5) / 64, 0, 0) and stands for 2^-10 m2 of
/// fruit. The points of the cloud are no fruit. All numbers are exact.
struct Row {
  static constexpr double kArea = 0x1p-10;  // of fruit that a voxel stands for (m2)
  /// The surface (m2) of a fruit of middle size, with which promises are compared while no fruit is known.
  static double one_fruit() {
    const BodyParameters bodies;
    return 4.0 * kPi * bodies.radius_min * bodies.radius_max;
  }
  Aabb volume;
  GainPlannerParameters parameters;
  Scan scan;

  explicit Row(int voxels, const Vector3d& point = {0.0, 1.0, 0.0}) {
    volume.min = {0.0, -1.0 / 128, -1.0 / 128};
    volume.max = {voxels / 64.0, 1.0 / 128, 1.0 / 128};
    parameters.expected.voxel = 1.0 / 64;
    parameters.expected.neighborhood = 100.0;
    parameters.expected.unknown_weight = 4.0;
    parameters.dwell = 1.0;
    scan.add_point(point);
  }

  /// A view along +y that shows `count` voxels from the one with the index `first` on, if the focal length is 384. The
  /// arm needs `seconds` from joints of 0; without them it does not report its joints.
  static ReachableView view(int first, int count, std::optional<double> seconds = std::nullopt) {
    ReachableView out;
    out.world_T_optical = look_along({(first + 0.5 * count) / 64.0, -count / 16.0, 0.0}, Vector3d::UnitY());
    if (seconds) out.joints = at_time(*seconds);
    return out;
  }

  /// A planner that has observed the scan.
  std::unique_ptr<GainPlanner> planner(double focal = 384.0) const {
    auto out = std::make_unique<GainPlanner>(camera(focal), volume, Vector3d::Zero(), SplitParameters(),
                                             fuse::FreeSpaceParameters(), parameters);
    out->observe(scan.progress());
    return out;
  }
};

/// A robot that knows one view for each of the planner's candidates, in their order, and remembers what it was asked
/// for. Other requests get `other`.
struct Script {
  std::vector<std::optional<ReachableView>> views;
  std::optional<ReachableView> other;
  std::vector<int> asked;             // the candidates that were asked for; -1 = another request
  std::vector<ViewRequest> requests;  // that were made

  Reach reach() {
    return [this, directions = spread_directions(static_cast<int>(views.size()))](
               const ViewRequest& r, const Joints&) -> std::optional<ReachableView> {
      const auto found = std::find(directions.begin(), directions.end(), r.direction);
      asked.push_back(found == directions.end() ? -1 : static_cast<int>(found - directions.begin()));
      requests.push_back(r);
      return asked.back() < 0 ? other : views[static_cast<std::size_t>(asked.back())];
    };
  }
  /// Which of the views an answer is; -1 if it is none of them.
  int which(const std::optional<ReachableView>& answer) const {
    for (std::size_t i = 0; i < views.size(); ++i)
      if (answer && views[i] && answer->world_T_optical.matrix() == views[i]->world_T_optical.matrix())
        return static_cast<int>(i);
    return -1;
  }
};

/// What a cancelled call was cancelled by: the robot, on being asked for the n-th time (counted from 1).
struct CancelledAt {
  Cancellation stop;
  int asked = 0;

  /// Whether `planner.next` was cancelled.
  bool next(Planner& planner, const Progress& progress, const Joints& current, const Reach& reach, int n) {
    const Reach cancelling = [&](const ViewRequest& r, const Joints& q) {
      if (++asked == n) stop.request();
      return reach(r, q);
    };
    const CancellationScope scope(stop);
    if (n == 0) stop.request();
    try {
      planner.next(progress, current, cancelling);
    } catch (const Cancelled&) {
      return true;
    }
    return false;
  }
};

}  // namespace cases
