// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Weighted least squares of a paraboloid over the cells of a round window of an image, by moments: adding a cell costs
/// some thirty multiplications, and solving does not depend on the window. Lengths along the image in cells, depths in
/// metres.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <cmath>
#include <vector>

namespace agrisee::sensor::detail {

/// A cell of a round window, and how much it counts at its distance from the middle.
struct Tap {
  int du, dv;
  double r_sq, near;
};

/// The window of half width w, row by row.
inline std::vector<Tap> window_taps(int w) {
  std::vector<Tap> taps;
  const int most = w * w + 1;
  for (int dv = -w; dv <= w; ++dv)
    for (int du = -w; du <= w; ++du)
      if (const int r_sq = du * du + dv * dv; r_sq <= most)
        taps.push_back({du, dv, double(r_sq), std::exp(-double(r_sq) / double(most))});
  return taps;
}

/// Sums of weighted least squares for the depth z as a paraboloid over (u, v): the 21 products of 1, u, v, uu, uv, vv
/// are 15 different monomials.
struct ParaboloidSums {
  double weight = 0.0, squares = 0.0;  // of residuals
  std::array<double, 15> m{};          // 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv
  Eigen::Matrix<double, 6, 1> rhs = Eigen::Matrix<double, 6, 1>::Zero();

  void add(double w, double u, double v, double z, double residual) {
    const double uu = u * u, uv = u * v, vv = v * v, wuu = w * uu, wuv = w * uv, wvv = w * vv, wz = w * z;
    weight += w;
    squares += w * residual * residual;
    const double products[15] = {w,       w * u,   w * v,    wuu,      wuv,      wvv,      wuu * u, wuu * v,
                                 wvv * u, wvv * v, wuu * uu, wuu * uv, wuu * vv, wuv * vv, wvv * vv};
    for (std::size_t k = 0; k < 15; ++k) m[k] += products[k];
    const double depths[6] = {wz, wz * u, wz * v, wz * uu, wz * uv, wz * vv};
    for (int k = 0; k < 6; ++k) rhs[k] += depths[k];
  }

  /// Solve for the first N coefficients; also the variance factor of the depth at (0, 0), where `variance` asks for it.
  /// False when degenerate.
  template <int N>
  bool solve(Eigen::Matrix<double, 6, 1>& x, double* variance) const {
    static constexpr std::size_t kMonomial[6][6] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                                    {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                                    {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
    Eigen::Matrix<double, N, N> a;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) a(i, j) = m[kMonomial[i][j]];
    a.diagonal().array() += 1e-9 * weight;
    const Eigen::LLT<Eigen::Matrix<double, N, N>> solver(a);
    if (solver.info() != Eigen::Success) return false;
    x.setZero();
    x.template head<N>() = solver.solve(rhs.template head<N>());
    if (variance) *variance = solver.solve(Eigen::Matrix<double, N, 1>::Unit(0))[0];
    return x.allFinite();
  }
};

}  // namespace agrisee::sensor::detail
