// SPDX-License-Identifier: BSD-3-Clause
// Least squares of a paraboloid over the cells of a window.
#include "sensor/paraboloid.hpp"

#include <agrisee/core/random.hpp>

#include <functional>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::sensor::detail;

namespace {

using Coefficients = Eigen::Matrix<double, 6, 1>;

/// The sums over the cells of a window that `keeps(u, v)` admits.
ParaboloidSums sums_of(int half_width, const std::function<double(double, double)>& height,
                       const std::function<bool(int, int)>& keeps) {
  std::vector<Tap> taps;
  for (const Tap& tap : window_taps(half_width))
    if (keeps(tap.du, tap.dv)) taps.push_back(tap);
  ParaboloidSums sums;
  for (std::size_t from = 0; from < taps.size(); from += kLanes) {
    Lanes w = Lanes::Zero(), u = w, v = w, z = w;
    for (std::size_t k = from; k < std::min(from + kLanes, taps.size()); ++k) {
      const auto i = static_cast<Eigen::Index>(k - from);
      w[i] = static_cast<float>(taps[k].near), u[i] = static_cast<float>(taps[k].du);
      v[i] = static_cast<float>(taps[k].dv), z[i] = static_cast<float>(height(taps[k].du, taps[k].dv));
    }
    sums.add(w, u, v, z, z);
  }
  return sums;
}

bool everywhere(int, int) { return true; }

}  // namespace

TEST_CASE("paraboloid sums: a whole window gives back the paraboloid, and the variance of its height") {
  const Coefficients truth = 1e-3 * (Coefficients() << 1.0, -0.4, 0.3, 0.05, -0.02, 0.08).finished();
  const auto height = [&](double u, double v) {
    return truth.dot((Coefficients() << 1.0, u, v, u * u, u * v, v * v).finished());
  };
  for (const int w : {2, 4}) {
    const ParaboloidSums sums = sums_of(w, height, everywhere);
    Coefficients x;
    double variance = 0.0;
    REQUIRE(sums.solve(x, 0.0, &variance));
    CHECK((x - truth).cwiseAbs().maxCoeff() < 1e-7);
    CHECK(variance > 0.0);
    CHECK(variance < 0.5);
  }
}

TEST_CASE("paraboloid sums: of two rows of cells the slopes are found, though not the curvature across") {
  Rng rng(5);
  for (const int w : {2, 3, 4})
    for (int trial = 0; trial < 50; ++trial) {
      const double noise = 1e-4, tilt = 1e-3 * rng.normal();
      const auto height = [&](double u, double v) { return 0.002 + tilt * v + 1e-3 * u + noise * rng.normal(); };
      const ParaboloidSums sums = sums_of(w, height, [](int u, int) { return u == 0 || u == 1; });
      Coefficients x;
      REQUIRE(sums.solve(x, 1e-3 * sums.weight(), nullptr));
      CHECK(std::abs(x[2] - tilt) < 4.0 * noise);
      CHECK(std::abs(x[1] + x[3] - 1e-3) < 6.0 * noise);  // from one row to the other
      CHECK(std::abs(x[1] - x[3]) < 3e-3);
    }
}

TEST_CASE("paraboloid sums: of one row, or of nothing, no numbers without end come out") {
  const auto height = [](double, double v) { return 1e-3 * v; };
  Coefficients x;
  const ParaboloidSums row = sums_of(3, height, [](int u, int) { return u == 0; });
  if (row.solve(x, 1e-3 * row.weight(), nullptr)) CHECK(x.cwiseAbs().maxCoeff() < 0.01);
  CHECK_FALSE(ParaboloidSums().solve(x, 0.0, nullptr));
}
