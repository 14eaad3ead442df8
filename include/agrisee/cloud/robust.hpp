// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Robust kernels for iterated least squares, and the scale of residuals (Huber, 1964; Beaton & Tukey, 1974).
///
/// A kernel replaces half the square of a residual r by rho(r), which grows more slowly beyond a multiple of the
/// residuals' scale (their robust standard deviation). The multiples give 95 % efficiency on Gaussian residuals.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace agrisee {

/// How much large residuals count.
enum class RobustKernel {
  none,   ///< by their squares
  huber,  ///< by their squares, beyond 1.345 scales by their size
  tukey   ///< beyond 4.685 scales not at all
};

/// The kernel's name.
inline const char* to_string(RobustKernel kernel) {
  return kernel == RobustKernel::huber ? "huber" : kernel == RobustKernel::tukey ? "tukey" : "none";
}

/// The kernel of a name.
/// @throws ParameterError for any other name than none, huber and tukey
inline RobustKernel robust_kernel(const std::string& name) {
  for (const RobustKernel k : {RobustKernel::none, RobustKernel::huber, RobustKernel::tukey})
    if (name == to_string(k)) return k;
  throw ParameterError("must be none, huber or tukey, got " + name);
}

namespace detail {

/// The number of a given rank, 0 for the smallest, among numbers that are not negative. Two passes: as unsigned
/// integers the bits of such numbers have the same order as the numbers, so a histogram of the upper bits tells which
/// of them can have that rank. The others are removed from `sizes`, and its order changes.
inline double nth_size(std::vector<double>& sizes, std::size_t rank) {
  constexpr unsigned kRest = 48;  // lower bits, which the histogram leaves out
  const auto bin = [](double size) {
    std::uint64_t bits;
    std::memcpy(&bits, &size, sizeof bits);
    return static_cast<std::size_t>(bits >> kRest);
  };
  std::vector<std::uint32_t> counts(std::size_t(1) << (63 - kRest), 0);
  for (const double size : sizes) ++counts[bin(size)];
  std::size_t least = 0, before = 0;
  while (before + counts[least] <= rank) before += counts[least++];
  sizes.erase(std::remove_if(sizes.begin(), sizes.end(), [&](double size) { return bin(size) != least; }), sizes.end());
  const auto nth = sizes.begin() + static_cast<std::ptrdiff_t>(rank - before);
  std::nth_element(sizes.begin(), nth, sizes.end());
  return *nth;
}

}  // namespace detail

/// Robust standard deviation of residuals: 1.4826 times the median of |r|; 0 if there are none.
/// @param sizes |r| of each (m); their order changes
inline double robust_scale(std::vector<double>& sizes) {
  if (sizes.empty()) return 0.0;
  return 1.4826 * detail::nth_size(sizes, sizes.size() / 2);
}

/// Robust standard deviation of residuals: 1.4826 times the median of |r|.
/// @param matches residuals whose match is negative do not count
/// @param residuals r (m), as many as `matches`
/// @param least the result is at least this (m)
inline double robust_scale(const std::vector<Index>& matches, const std::vector<double>& residuals, double least) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (matches[i] >= 0) sizes.push_back(std::abs(residuals[i]));
  return std::max(least, robust_scale(sizes));
}

/// Weight of a residual with Tukey's kernel: (1 - t^2)^2 within the gate, 0 beyond.
/// @param t residual over gate
inline double biweight(double t) {
  const double u = std::max(0.0, 1.0 - t * t);
  return u * u;
}

/// rho(r) (m2): r^2 / 2 for small residuals.
/// @param r residual (m)
/// @param scale of the residuals (m)
inline double robust_cost(RobustKernel kernel, double r, double scale) {
  const double size = std::abs(r);
  if (kernel == RobustKernel::huber) {
    const double k = 1.345 * scale;
    return size <= k ? 0.5 * r * r : k * (size - 0.5 * k);
  }
  if (kernel == RobustKernel::tukey) {
    const double c = 4.685 * scale;
    const double u = std::max(0.0, 1.0 - (r / c) * (r / c));
    return c * c / 6.0 * (1.0 - u * u * u);
  }
  return 0.5 * r * r;
}

/// Weight rho'(r) / r of a residual in iterated least squares, 0 to 1.
/// @param r residual (m)
/// @param scale of the residuals (m)
inline double robust_weight(RobustKernel kernel, double r, double scale) {
  const double size = std::abs(r);
  if (kernel == RobustKernel::huber) return size <= 1.345 * scale ? 1.0 : 1.345 * scale / size;
  if (kernel == RobustKernel::tukey) return biweight(r / (4.685 * scale));
  return 1.0;
}

}  // namespace agrisee
