// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Real spherical harmonics: smooth functions on the sphere of directions, from coarse (low degree) to fine.
///
/// A harmonic of degree l and order m varies as cos(m phi) or sin(m phi) around the z axis. Order 0 are bodies of
/// revolution; a body that looks the same after each turn by 2 pi / n has the orders 0, n, 2n, ... only. All are scaled
/// to a mean square of 1 over the sphere. Recurrences: Press et al., Numerical Recipes, 3rd ed., 2007, 6.7.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace agrisee {

/// A set of real spherical harmonics: for each order m the degrees from m to top(m). Of an order above 0 each degree
/// has two functions, cosine and sine.
class SphericalHarmonics {
 public:
  /// One function of the set.
  struct Term {
    int degree;  ///< 0 or more
    int order;   ///< 0 to degree
  };

  /// @param top for each order, from 0, its highest degree; an order whose entry is below it is left out. Order 0 must
  ///   be there.
  explicit SphericalHarmonics(std::vector<int> top) : top_(std::move(top)) {
    for (int l = 0; l <= at(0); ++l) scales_.push_back(l == 0 ? 0.0 : std::sqrt((2.0 * l + 1.0) / (2.0 * l - 1.0)));
    for (int m = 0; m < static_cast<int>(top_.size()); ++m) {
      sectoral_.push_back(m == 0 ? 1.0 : std::sqrt((2.0 * m + 1.0) / (2.0 * m)));
      for (int l = m; l <= at(m); ++l) {
        const double n = l, o = m;
        factors_.push_back(l == m ? 0.0 : std::sqrt((4.0 * n * n - 1.0) / (n * n - o * o)));
        for (int twin = 0; twin < (m == 0 ? 1 : 2); ++twin) terms_.push_back({l, m});
      }
    }
  }

  /// The functions, in the order of their values.
  const std::vector<Term>& terms() const { return terms_; }
  /// Their number.
  std::size_t size() const { return terms_.size(); }

  /// The values of all functions in a direction.
  /// @param u unit vector
  /// @param out receives size() values: order by order, degree by degree, the cosine before the sine
  void values(const Eigen::Vector3d& u, double* out) const {
    const double z = u.z(), s = std::sqrt(u.x() * u.x() + u.y() * u.y());
    const double cos_phi = s > 0.0 ? u.x() / s : 1.0, sin_phi = s > 0.0 ? u.y() / s : 0.0;
    double sectoral = 1.0, cos_m = 1.0, sin_m = 0.0;  // of degree m and order m
    std::size_t k = 0;
    for (int m = 0; m < static_cast<int>(top_.size()); ++m) {
      if (m > 0) {
        sectoral *= s * sectoral_[static_cast<std::size_t>(m)];
        const double c = cos_m * cos_phi - sin_m * sin_phi;
        sin_m = sin_m * cos_phi + cos_m * sin_phi;
        cos_m = c;
      }
      double before = 0.0, value = sectoral;
      for (int l = m; l <= at(m); ++l, ++k) {
        if (l > m) {
          const double next = factors_[k] * (z * value - (l > m + 1 ? before / factors_[k - 1] : 0.0));
          before = value;
          value = next;
        }
        if (m == 0) {
          *out++ = value;
        } else {
          *out++ = std::sqrt(2.0) * value * cos_m;
          *out++ = std::sqrt(2.0) * value * sin_m;
        }
      }
    }
  }

  /// Derivative, by the angle from the z axis (rad), of the sum of the functions of order 0; 0 on the axis.
  /// @param u direction (unit)
  /// @param values those in this direction
  /// @param coefficients of all functions; those of order 0 come first
  double slope(const Eigen::Vector3d& u, const double* values, const Eigen::VectorXd& coefficients) const {
    const double s = std::sqrt(u.x() * u.x() + u.y() * u.y());
    if (s < 1e-9) return 0.0;
    double sum = 0.0;
    for (int l = 1; l <= at(0); ++l)
      sum += coefficients[l] * l * (u.z() * values[l] - scales_[static_cast<std::size_t>(l)] * values[l - 1]);
    return sum / s;
  }

 private:
  int at(int order) const { return top_[static_cast<std::size_t>(order)]; }

  std::vector<int> top_;
  std::vector<Term> terms_;
  std::vector<double> scales_;    ///< of one degree over that of the one before, at order 0
  std::vector<double> sectoral_;  ///< of the recurrence from order to order
  std::vector<double> factors_;   ///< of that from degree to degree: one for each order and degree
};

}  // namespace agrisee
