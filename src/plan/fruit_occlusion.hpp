// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What fruit hide from a camera. Metres.
#pragma once

#include <agrisee/plan/occluder.hpp>

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace agrisee::plan {

/// All occluders as seen from one camera.
class FruitOcclusion {
 public:
  /// @param occluders are referred to
  /// @param camera its position (m, world)
  FruitOcclusion(const std::vector<Occluder>& occluders, const Eigen::Vector3f& camera) {
    faced_.reserve(occluders.size());
    for (const Occluder& o : occluders) {
      const Eigen::Vector3f center = o.center - camera, unit = o.to_unit * center;
      faced_.push_back({center, unit, center.squaredNorm(), unit.squaredNorm() - 1.0f, &o});
    }
  }

  /// Whether a fruit other than `own` hides what lies at `distance` (m) along the unit vector `u` from the camera.
  bool hides(const Eigen::Vector3f& u, float distance, int own) const {
    for (const Faced& f : faced_) {
      const Occluder& o = *f.occluder;
      if (o.body == own) continue;
      const float along = f.center.dot(u);
      if (along < 0.0f || f.center_sq - along * along >= o.radius * o.radius) continue;
      // Where the ray enters the unit sphere that the ellipsoid becomes.
      const Eigen::Vector3f w = o.to_unit * u;
      const float a = w.squaredNorm(), b = f.unit.dot(w), off = b * b - a * f.outside;
      if (off > 0.0f && b - std::sqrt(off) < a * (distance - 1e-3f)) return true;
    }
    return false;
  }

 private:
  /// An occluder as seen from the camera.
  struct Faced {
    Eigen::Vector3f center;  // from the camera (m)
    Eigen::Vector3f unit;    // the same where the ellipsoid is the unit sphere
    float center_sq;         // squared length of `center` (m2)
    float outside;           // squared length of `unit`, less 1
    const Occluder* occluder;
  };

  std::vector<Faced> faced_;
};

}  // namespace agrisee::plan
