// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sums of three products that give the same bits wherever they are computed. On processors with a fused
/// multiply-add, compilers use it in some places and not in others, so the same distance computed twice could differ in
/// the last bit, and ties and limits would be decided differently. These functions fix the order and the rounding.
#pragma once

#include <cmath>

namespace agrisee::detail {

/// True if the processor has a fast fused multiply-add for the type S.
template <typename S>
constexpr bool kFuses = false;
#ifdef __FP_FAST_FMAF
template <>
constexpr bool kFuses<float> = true;
#endif
#ifdef __FP_FAST_FMA
template <>
constexpr bool kFuses<double> = true;
#endif

/// a u + b v + c w, summed from left to right, with fused multiply-adds where they are fast.
template <typename S>
S sum_of_products(S a, S b, S c, S u, S v, S w) {
  if constexpr (kFuses<S>)
    return std::fma(c, w, std::fma(b, v, a * u));
  else
    return a * u + b * v + c * w;
}

/// x^2 + y^2 + z^2
template <typename S>
S sum_of_squares(S x, S y, S z) {
  return sum_of_products(x, y, z, x, y, z);
}

}  // namespace agrisee::detail
