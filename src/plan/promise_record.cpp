// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/angle.hpp>
#include <agrisee/plan/promise_record.hpp>

#include <algorithm>

namespace agrisee::plan {

void PromiseRecord::weigh(const Outcome& outcome, double measured) {
  constexpr double kForget = 0.5;
  promised_ = kForget * promised_ + measured * outcome.promised;
  kept_ = kForget * kept_ + outcome.kept;
}

double PromiseRecord::reliability(double area) const {
  constexpr double kTrusted = 0.003;  // share of the fruit surface that is taken to have been promised and kept before
  const double before = kTrusted * area;
  return promised_ > 0.0 ? std::min(1.0, (kept_ + before) / (promised_ + before)) : 1.0;
}

double PromiseRecord::clearness(const Pose& world_T_optical) const {
  constexpr double kClose = 0.08, kTurned = deg(30.0), kLess = 0.3;  // m, rad, factor
  double clear = 1.0;
  for (const Pose& blind : blind_)
    if ((blind.translation() - world_T_optical.translation()).norm() < kClose &&
        angle_between(blind.linear().col(2), world_T_optical.linear().col(2)) < kTurned)
      clear *= kLess;
  return clear;
}

}  // namespace agrisee::plan
