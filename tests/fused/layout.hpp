// SPDX-License-Identifier: BSD-3-Clause
// Sizes and alignments of types that cross between a program and the compiled library.
#pragma once

#include <agrisee/agrisee.hpp>

#include <array>

namespace agrisee::test {

template <typename... T>
constexpr std::array<std::size_t, 2 * sizeof...(T)> layout_of() {
  return {sizeof(T)..., alignof(T)...};
}

/// As the file that includes this is compiled.
constexpr auto kLayout = layout_of<Pose, Matrix6, Joints, Cloud, Ellipsoid, EllipsoidFit, FoundBody, MaskBody, Split,
                                   Fruit, ScanResult, Workcell, Parameters, View, sensor::DepthFrame>();

/// As a file without further vector instructions is compiled.
decltype(kLayout) plain_layout();

}  // namespace agrisee::test
