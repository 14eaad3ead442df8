// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sums of three products that come out the same to the last bit wherever they are written. Where the processor can
/// multiply and add in one rounding, compilers do so at one place and not at the next; ties and limits would be decided
/// here in one way and there in another.
#pragma once

#include <cmath>

namespace agrisee::detail {

/// Whether the processor multiplies and adds numbers of the type in one rounding as fast as it multiplies.
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

/// a u + b v + c w, from left to right, in one rounding each where that costs nothing, in two elsewhere.
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
