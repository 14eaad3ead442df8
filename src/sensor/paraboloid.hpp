// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Weighted least squares of a paraboloid over the cells of a round window of an image. It works on moments: adding a
/// cell costs some thirty multiplications, and solving does not depend on the size of the window. Lengths in the plane
/// below the paraboloid are in units of the distance between cells, heights over it in metres.
#pragma once

#include <Eigen/Cholesky>
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

/// Weighted sums for the height z as a paraboloid over (u, v), with the coefficients of 1, u, v, uu, uv, vv. The 21
/// different products of these are 15 different monomials.
struct ParaboloidSums {
  double weight = 0.0;         ///< sum of the weights
  double squares = 0.0;        ///< weighted sum of squared residuals (m2)
  std::array<double, 15> m{};  ///< 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv
  Eigen::Matrix<double, 6, 1> rhs = Eigen::Matrix<double, 6, 1>::Zero();  ///< right-hand side

  /// Add a cell of weight w at (u, v) with height z (m) and residual (m).
  void add(double w, double u, double v, double z, double residual) {
    const double uu = u * u, uv = u * v, vv = v * v, wuu = w * uu, wuv = w * uv, wvv = w * vv, wz = w * z;
    weight += w;
    squares += w * residual * residual;
    const double products[15] = {w,       w * u,   w * v,    wuu,      wuv,      wvv,      wuu * u, wuu * v,
                                 wvv * u, wvv * v, wuu * uu, wuu * uv, wuu * vv, wuv * vv, wvv * vv};
    for (std::size_t k = 0; k < 15; ++k) m[k] += products[k];
    const double heights[6] = {wz, wz * u, wz * v, wz * uu, wz * uv, wz * vv};
    for (int k = 0; k < 6; ++k) rhs[k] += heights[k];
  }

  /// Solve for the coefficients.
  /// @param x receives the coefficients
  /// @param stiffness inverse variance of the prior that the quadratic ones are 0, for data of unit variance
  /// @param variance if not null, receives the variance of the height at (0, 0) for data of unit variance
  /// @return false if the sums are degenerate
  bool solve(Eigen::Matrix<double, 6, 1>& x, double stiffness, double* variance) const {
    static constexpr std::size_t kMonomial[6][6] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                                    {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                                    {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
    Eigen::Matrix<double, 6, 6> a;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) a(i, j) = m[kMonomial[i][j]];
    a.diagonal().array() += 1e-9 * weight;
    a.diagonal().tail<3>().array() += stiffness;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> solver(a);
    if (solver.info() != Eigen::Success) return false;
    x = solver.solve(rhs);
    if (variance) *variance = solver.solve(Eigen::Matrix<double, 6, 1>::Unit(0))[0];
    return x.allFinite();
  }
};

}  // namespace agrisee::sensor::detail
