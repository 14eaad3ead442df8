// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Weighted least squares of a paraboloid over the cells of a round window of an image. It works on moments: adding a
/// cell costs some thirty multiplications, and solving does not depend on the size of the window. Lengths in the plane
/// below the paraboloid are in units of the distance between cells, heights over it in metres.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <vector>

namespace agrisee::sensor::detail {

/// A cell of a round window.
struct Tap {
  int du, dv;   ///< offset from the middle
  double near;  ///< weight for its distance from the middle, 1 in the middle
};

/// The cells of the window of half width w, row by row.
inline std::vector<Tap> window_taps(int w) {
  std::vector<Tap> taps;
  const int most = w * w + 1;
  for (int dv = -w; dv <= w; ++dv)
    for (int du = -w; du <= w; ++du)
      if (const int r_sq = du * du + dv * dv; r_sq <= most)
        taps.push_back({du, dv, std::exp(-double(r_sq) / double(most))});
  return taps;
}

/// Numbers of several cells, so that the compiler can use vector instructions.
constexpr int kLanes = 8;
using Lanes = Eigen::Array<float, kLanes, 1>;

/// Weighted sums for the height z as a paraboloid over (u, v), with the coefficients of 1, u, v, uu, uv, vv. The 21
/// different products of these are 15 different monomials.
class ParaboloidSums {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< one number for each coefficient

  ParaboloidSums() {
    squares_.setZero();
    m_.fill(squares_);
    rhs_.fill(squares_);
  }

  /// Add cells of weight w at (u, v) with height z (m) and residual (m).
  void add(const Lanes& w, const Lanes& u, const Lanes& v, const Lanes& z, const Lanes& residual) {
    const Lanes wu = w * u, wv = w * v, wuu = wu * u, wuv = wu * v, wvv = wv * v, uu = u * u, uv = u * v, vv = v * v;
    squares_ += w * residual * residual;
    m_[0] += w, m_[1] += wu, m_[2] += wv, m_[3] += wuu, m_[4] += wuv, m_[5] += wvv;
    m_[6] += wuu * u, m_[7] += wuu * v, m_[8] += wvv * u, m_[9] += wvv * v;
    m_[10] += wuu * uu, m_[11] += wuu * uv, m_[12] += wuu * vv, m_[13] += wuv * vv, m_[14] += wvv * vv;
    rhs_[0] += w * z, rhs_[1] += wu * z, rhs_[2] += wv * z;
    rhs_[3] += wuu * z, rhs_[4] += wuv * z, rhs_[5] += wvv * z;
  }

  /// Sum of the weights.
  double weight() const { return sum(m_[0]); }
  /// Weighted sum of squared residuals (m2).
  double squares() const { return sum(squares_); }

  /// Solve for the coefficients.
  /// @param x receives the coefficients
  /// @param stiffness inverse variance of the prior that the quadratic ones are 0, for data of unit variance
  /// @param variance if not null, receives the variance of the height at (0, 0) for data of unit variance
  /// @return false if the sums are degenerate
  bool solve(Vector6& x, double stiffness, double* variance) const {
    static constexpr std::size_t kMonomial[6][6] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                                    {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                                    {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
    std::array<double, 15> m;
    for (std::size_t i = 0; i < m.size(); ++i) m[i] = sum(m_[i]);
    Matrix6 a;
    Vector6 b;
    for (int i = 0; i < 6; ++i) {
      b[i] = sum(rhs_[static_cast<std::size_t>(i)]);
      for (int j = 0; j < 6; ++j) a(i, j) = m[kMonomial[i][j]];
    }
    constexpr double kRounding = 1e-6;  // of sums in single precision, as a share, with room
    a.diagonal() += kRounding * (a.diagonal() + Vector6::Constant(weight()));
    a.diagonal().tail<3>().array() += stiffness;
    if (!factorize(a)) return false;
    x = solved(a, b);
    if (variance) *variance = solved(a, Vector6::Unit(0))[0];
    return x.allFinite();
  }

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  // Cholesky decomposition with loops that the compiler unrolls: Eigen's takes three times as long for six unknowns.

  /// Replace the lower half of a symmetric matrix by its factor L; false if it is not positive definite.
  static bool factorize(Matrix6& a) {
    for (int j = 0; j < 6; ++j) {
      double d = a(j, j);
      for (int k = 0; k < j; ++k) d -= a(j, k) * a(j, k);
      if (!(d > 0.0)) return false;
      a(j, j) = std::sqrt(d);
      for (int i = j + 1; i < 6; ++i) {
        double s = a(i, j);
        for (int k = 0; k < j; ++k) s -= a(i, k) * a(j, k);
        a(i, j) = s / a(j, j);
      }
    }
    return true;
  }

  /// Solve L L^T x = b.
  static Vector6 solved(const Matrix6& l, Vector6 x) {
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= l(i, k) * x[k];
      x[i] /= l(i, i);
    }
    for (int i = 5; i >= 0; --i) {
      for (int k = i + 1; k < 6; ++k) x[i] -= l(k, i) * x[k];
      x[i] /= l(i, i);
    }
    return x;
  }

  static double sum(const Lanes& lanes) { return double(lanes.sum()); }

  std::array<Lanes, 15> m_;   // 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv
  std::array<Lanes, 6> rhs_;  // right-hand side
  Lanes squares_;
};

}  // namespace agrisee::sensor::detail
