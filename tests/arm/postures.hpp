// SPDX-License-Identifier: BSD-3-Clause
// Postures of the arm that several tests use.
#pragma once

#include <agrisee/arm/ur.hpp>

namespace agrisee::test {

/// Joint angles (rad), from the base to the wrist.
inline Joints joints(double a, double b, double c, double d, double e, double f) {
  return (Joints() << a, b, c, d, e, f).finished();
}

inline const Joints kStart = joints(0.0, -1.57, 1.57, -1.57, -1.57, 0.0);

}  // namespace agrisee::test
