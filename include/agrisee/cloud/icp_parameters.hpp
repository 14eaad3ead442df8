// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of ICP and its robust kernels (Huber, 1964; Beaton & Tukey, 1974) with their scale. Metres, radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace agrisee {

/// How far residuals count: `none` squares; `huber` linear beyond 1.345 scales; `tukey` not at all beyond 4.685 scales.
enum class RobustKernel { none, huber, tukey };

/// Its name.
inline const char* to_string(RobustKernel kernel) {
  return kernel == RobustKernel::huber ? "huber" : kernel == RobustKernel::tukey ? "tukey" : "none";
}

/// The kernel of that name. @throws ParameterError for any other name
inline RobustKernel robust_kernel(const std::string& name) {
  for (const RobustKernel k : {RobustKernel::none, RobustKernel::huber, RobustKernel::tukey})
    if (name == to_string(k)) return k;
  throw ParameterError("kernel must be none, huber or tukey, got " + name);
}

/// Parameters of register_cloud.
struct IcpParameters {
  bool point_to_point = false;                ///< minimise distances between points instead of to the target's planes
  double max_distance = 0.005;                ///< matches are at most this far apart (m)
  double max_normal_angle = deg(30.0);        ///< and their normals differ by at most this (rad); pi = no test
  RobustKernel kernel = RobustKernel::tukey;  ///< how far residuals count
  int max_iterations = 30;                    ///< at most so many steps
  double translation_tolerance = 1e-6;        ///< it has converged when a step moves the centroid by less than this (m)
  double rotation_tolerance = 1e-5;           ///< and turns by less than this (rad)
  double degeneracy = 0.01;        ///< eigenvalues below this share of the largest leave their direction free
  int min_matches = 20;            ///< fewer matches say nothing
  double max_translation = 0.005;  ///< a larger correction (m, at the source's centroid) is not believed
  double max_rotation = deg(1.0);  ///< nor is a larger turn (rad)

  /// What serves the paper's pipeline; the paper gives no values.
  static IcpParameters paper() { return {}; }

  /// Smallest scale (m) of the robust kernels: a thousandth of `max_distance`, for data without noise.
  double min_scale() const { return 1e-3 * max_distance; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
    check_parameter(positive(max_distance), "max_distance", "positive and finite", max_distance);
    check_parameter(max_normal_angle >= 0 && max_normal_angle <= kPi, "max_normal_angle", "from 0 to pi",
                    max_normal_angle);
    check_parameter(max_iterations >= 1, "max_iterations", "at least 1", max_iterations);
    check_parameter(translation_tolerance >= 0, "translation_tolerance", "not negative", translation_tolerance);
    check_parameter(rotation_tolerance >= 0, "rotation_tolerance", "not negative", rotation_tolerance);
    check_parameter(degeneracy >= 0 && degeneracy < 1, "degeneracy", "from 0 to below 1", degeneracy);
    check_parameter(min_matches >= 6, "min_matches", "at least 6", min_matches);
    check_parameter(positive(max_translation), "max_translation", "positive and finite", max_translation);
    check_parameter(positive(max_rotation), "max_rotation", "positive and finite", max_rotation);
  }

  /// f(name, field) for every field; `kernel` is an enumeration with to_string and robust_kernel.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("point_to_point", p.point_to_point);
    f("max_distance", p.max_distance);
    f("max_normal_angle", p.max_normal_angle);
    f("kernel", p.kernel);
    f("max_iterations", p.max_iterations);
    f("translation_tolerance", p.translation_tolerance);
    f("rotation_tolerance", p.rotation_tolerance);
    f("degeneracy", p.degeneracy);
    f("min_matches", p.min_matches);
    f("max_translation", p.max_translation);
    f("max_rotation", p.max_rotation);
  }
};

namespace detail {

/// The value of that rank, from 0, among numbers that are not negative; they are shuffled, and most of them lost. Two
/// passes: the bits of such numbers are in the order of the numbers, so the first few tell which can be the one.
inline double nth_size(std::vector<double>& sizes, std::size_t rank) {
  constexpr unsigned kRest = 48;  // bits
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

/// Robust standard deviation of the matched residuals: 1.4826 times the median of |r|, at least `least` (m).
inline double robust_scale(const std::vector<Index>& matches, const std::vector<double>& residuals, double least) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (matches[i] >= 0) sizes.push_back(std::abs(residuals[i]));
  if (sizes.empty()) return least;
  return std::max(least, 1.4826 * detail::nth_size(sizes, sizes.size() / 2));
}

/// rho(r) (m2): r^2 / 2 for small residuals. The tuning constants give 95 % efficiency on Gaussian residuals.
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
inline double robust_weight(RobustKernel kernel, double r, double scale) {
  const double size = std::abs(r);
  if (kernel == RobustKernel::huber) return size <= 1.345 * scale ? 1.0 : 1.345 * scale / size;
  if (kernel == RobustKernel::tukey) {
    const double c = 4.685 * scale;
    const double u = std::max(0.0, 1.0 - (r / c) * (r / c));
    return u * u;
  }
  return 1.0;
}

/// Angle (rad) of a pose's rotation; exact for small ones, unlike the arc cosine of the trace.
inline double angle_of(const Pose& pose) { return Eigen::AngleAxisd(Eigen::Quaterniond(pose.linear())).angle(); }

}  // namespace agrisee
