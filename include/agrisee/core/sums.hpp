// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sums of three products that come out the same to the last bit wherever they are written. Where the processor can
/// multiply and add in one rounding, compilers do so at one place and not at the next; ties and limits would be decided
/// here in one way and there in another.
#pragma once

#include <cmath>

namespace agrisee::detail {

/// a u + b v + c w, from left to right: in one rounding each where the processor multiplies and adds as fast as it
/// multiplies, in two elsewhere.
inline float sum_of_products(float a, float b, float c, float u, float v, float w) {
#ifdef __FP_FAST_FMAF
  return std::fma(c, w, std::fma(b, v, a * u));
#else
  return a * u + b * v + c * w;
#endif
}
/// The same.
inline double sum_of_products(double a, double b, double c, double u, double v, double w) {
#ifdef __FP_FAST_FMA
  return std::fma(c, w, std::fma(b, v, a * u));
#else
  return a * u + b * v + c * w;
#endif
}

/// x^2 + y^2 + z^2
template <typename S>
S sum_of_squares(S x, S y, S z) {
  return sum_of_products(x, y, z, x, y, z);
}

}  // namespace agrisee::detail
