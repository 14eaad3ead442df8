// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/limits.hpp>

#include <cstdio>

namespace agrisee::arm {

std::string JointLimits::complaint(const Joints& q, double slack) const {
  for (int j = 0; j < 6; ++j) {
    if (q[j] >= min[j] - slack && q[j] <= max[j] + slack) continue;
    char text[160];
    std::snprintf(text, sizeof text, "joint %d is %.4g rad, outside of its limits, %.4g to %.4g", j + 1, q[j], min[j],
                  max[j]);
    const bool degrees = (q.array() >= min.array() / deg(1)).all() && (q.array() <= max.array() / deg(1)).all();
    return std::string(text) + (degrees ? ": are the angles in degrees?" : "");
  }
  return "";
}

void JointLimits::check() const {
  for (int j = 0; j < 6; ++j) {
    check_parameter(min[j] <= max[j], "limits.min", "at most limits.max", min[j]);
    check_parameter(velocity[j] > 0.0, "limits.velocity", "positive", velocity[j]);
  }
}

bool JointLimits::contain(const Joints& q) const {
  return (q.array() >= min.array()).all() && (q.array() <= max.array()).all();
}

std::optional<Joints> nearest(const Joints& q, const Joints& reference, const JointLimits& limits) {
  Joints out;
  for (int j = 0; j < 6; ++j) {
    const auto a = nearest(q[j], reference[j], limits.min[j], limits.max[j]);
    if (!a) return std::nullopt;
    out[j] = *a;
  }
  return out;
}

double move_time(const Joints& from, const Joints& to, const JointLimits& limits) {
  return ((to - from).cwiseAbs().cwiseQuotient(limits.velocity)).maxCoeff();
}

}  // namespace agrisee::arm
