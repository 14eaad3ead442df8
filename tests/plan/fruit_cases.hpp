// SPDX-License-Identifier: BSD-3-Clause
// Spheres as fruit, and the planner's model of them.
#pragma once

#include <agrisee/plan/expected_surface.hpp>

#include "plan/plan_cases.hpp"

namespace cases {

constexpr double kRadius = 0.035;
const double kSurface = 4.0 * kPi * kRadius * kRadius;
const Vector3d kFruit(0.0, 0.5, 0.2);

/// No voxels, and only points on a sample cover it: all samples stay.
inline ExpectedSurfaceParameters bare(int samples = 200) {
  ExpectedSurfaceParameters p;
  p.samples = samples;
  p.cover_radius = 1e-6;
  p.neighborhood = 0.0;
  p.elsewhere = 0.0;
  return p;
}

template <typename Keep = decltype(test::everywhere)>
void add_fruit(Scan& scan, const Vector3d& center, Keep&& keep = test::everywhere, double spacing = 0.003) {
  test::add_sphere(scan.cloud, {center, kRadius}, spacing, keep);
}

inline ExpectedSurface model_of(const Scan& scan, const ExpectedSurfaceParameters& p = bare(),
                                const sensor::DepthCamera& sensor = camera()) {
  ExpectedSurface model(sensor, box(kFruit, 0.12), p);
  model.update(scan.progress(), {}, {});
  return model;
}

inline Pose look_at(const Vector3d& target, const Vector3d& from) { return look_along(from, target - from); }

}  // namespace cases
