// SPDX-License-Identifier: BSD-3-Clause
// Random cells: an arm somewhere, holding its sensor somehow, spaces to keep out of, and spheres for fruit.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/workcell.hpp>

#include "catch.hpp"
#include "spheres.hpp"
#include "support/arm_verifier.hpp"

namespace cells {

using namespace agrisee;

struct Cell {
  Workcell workcell;
  std::vector<test::Sphere> fruit;
};

inline Cell random_cell(std::uint64_t seed) {
  Rng rng(seed, 0x63656c6c);
  Cell cell;
  Workcell& w = cell.workcell;
  w.world_T_base =
      pose_from_xyz_rpy({rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-0.3, 0.3)}, {0, 0, rng.uniform(-3, 3)});
  if (seed % 3 == 1)  // beside the last joint's axis, where a roll is another posture
    w.tool0_T_optical = pose_from_xyz_rpy({rng.uniform(-0.04, 0.04), rng.uniform(0.02, 0.05), rng.uniform(0.0, 0.06)},
                                          {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-3, 3)});
  w.sensor.intrinsics = sensor::intrinsics_from_fov(80, 60, deg(70), deg(55));
  const auto in_base = [&](double ahead, double side, double up) {
    return Eigen::Vector3d(w.world_T_base * Eigen::Vector3d(ahead, side, up));
  };
  const Eigen::Vector3d middle = in_base(rng.uniform(0.38, 0.6), rng.uniform(-0.15, 0.15), rng.uniform(0.05, 0.4));
  const int n = 2 + static_cast<int>(rng.below(4));
  for (int tries = 0; static_cast<int>(cell.fruit.size()) < n && tries < 200; ++tries) {
    const Eigen::Vector3d at =
        middle + Eigen::Vector3d(rng.uniform(-0.07, 0.07), rng.uniform(-0.07, 0.07), rng.uniform(-0.09, 0.09));
    const double radius = rng.uniform(0.025, 0.037);
    bool apart = true;
    for (const auto& f : cell.fruit) apart = apart && (f.center - at).norm() > f.radius + radius;
    if (apart) cell.fruit.push_back({at, radius});
  }
  w.scan_volume.extend(middle - Eigen::Vector3d(0.15, 0.15, 0.16));
  w.scan_volume.extend(middle + Eigen::Vector3d(0.15, 0.15, 0.16));
  for (int k = static_cast<int>(rng.below(5)); k > 0; --k) {
    const Eigen::Vector3d at = in_base(rng.uniform(-0.5, 0.8), rng.uniform(-0.6, 0.6), rng.uniform(-0.2, 0.8));
    KeepOut space{"space " + std::to_string(k), {}};
    if (k % 2)
      space.shape = Box{at, {rng.uniform(0.01, 0.4), rng.uniform(0.01, 0.4), rng.uniform(0.01, 0.4)}};
    else
      space.shape = Cylinder{at, rng.uniform(0.01, 0.15), rng.uniform(0.02, 0.8)};
    w.keep_out.push_back(space);
  }
  return cell;
}

/// Any joint angles within the limits.
inline Joints random_joints(Rng& rng, const arm::JointLimits& limits = {}) {
  Joints q;
  for (int j = 0; j < 6; ++j) q[j] = rng.uniform(limits.min[j], limits.max[j]);
  return q;
}

/// A proposed view is what it says, for an arm that stands at `current`: where the sensor then stands, limits,
/// collisions, range, field of view, and the time of the move.
inline void check_view(const plan::ReachableView& view, const Workcell& w, const arm::Mount& mount,
                       const Joints& current) {
  REQUIRE(view.joints);
  const Joints q = *view.joints;
  REQUIRE(q.allFinite());
  const auto stands = verify::times(verify::times(verify::matrix_of(w.world_T_base), verify::links(q)[5]),
                                    verify::matrix_of(w.tool0_T_optical));
  REQUIRE(verify::difference(stands, verify::matrix_of(view.world_T_optical)) < 1e-8);
  REQUIRE(verify::fault_of(q, mount) == "");
  // The target, in the optical frame: ahead, within range, in the image.
  const Eigen::Vector3d seen = view.world_T_optical.inverse() * view.target;
  REQUIRE(seen.norm() >= w.sensor.range_min - 1e-9);
  REQUIRE(seen.norm() <= w.sensor.range_max + 1e-9);
  REQUIRE(seen.z() > 0.0);
  const auto& k = w.sensor.intrinsics;
  const double u = k.fx * seen.x() / seen.z() + k.cx, v = k.fy * seen.y() / seen.z() + k.cy;
  REQUIRE((u >= -0.5 && u <= k.width - 0.5 && v >= -0.5 && v <= k.height - 0.5));
  REQUIRE(seen.head<2>().norm() < 1e-6);  // on the axis
  const double speeds[] = {kPi, kPi, kPi, kTwoPi, kTwoPi, kTwoPi};
  double time = 0.0;
  for (int j = 0; j < 6; ++j) time = std::max(time, std::abs(q[j] - current[j]) / speeds[j]);
  REQUIRE(view.move_time == Approx(time).margin(1e-9));
}

}  // namespace cells
