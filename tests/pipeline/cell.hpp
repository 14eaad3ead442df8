// SPDX-License-Identifier: BSD-3-Clause
// The workcell that the pipeline's tests scan test::kThreeFruit in.
#pragma once

#include <agrisee/workcell.hpp>

namespace agrisee::test {

/// Without keep-out spaces, and with a small camera, so that frames are rendered fast.
inline Workcell three_fruit_cell() {
  Workcell w;
  w.scan_volume.extend({-0.17, 0.40, -0.02});
  w.scan_volume.extend({0.17, 0.72, 0.42});
  w.sensor.intrinsics = sensor::intrinsics_from_fov(400, 300, deg(70), deg(55));
  return w;
}

}  // namespace agrisee::test
