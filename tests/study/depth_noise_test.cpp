// SPDX-License-Identifier: BSD-3-Clause
// The noise models have the figures that they state, measured on the frames that they make.
#include <agrisee/study/depth_noise.hpp>

#include "catch.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

constexpr NoiseModel kGaussian{NoiseModel::Kind::gaussian, 0.01, Light::shade};
constexpr NoiseModel kL515{NoiseModel::Kind::l515_white, 0.0, Light::shade};
constexpr NoiseModel kRough{NoiseModel::Kind::rough, 0.0, Light::shade};

/// Differences (m) between measured and true ranges where something returns.
struct Statistics {
  double n = 0, mean = 0, sigma = 0;
};
Statistics statistics(const std::vector<float>& measured, const std::vector<float>& truth) {
  Statistics s;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!(measured[i] > 0.0f)) continue;
    const double d = double(measured[i]) - double(truth[i]);
    sum += d, squares += d * d, ++s.n;
  }
  s.mean = sum / s.n;
  s.sigma = std::sqrt(squares / s.n - s.mean * s.mean);
  return s;
}

const sensor::Intrinsics kCamera = sensor::intrinsics_from_fov(320, 240, deg(40), deg(31));

std::vector<float> all(float value) { return std::vector<float>(kCamera.size(), value); }

std::vector<float> measure(const NoiseModel& noise, const std::vector<float>& range,
                           const std::vector<float>& incidence, std::uint64_t seed = 1, std::uint64_t view = 0,
                           int threads = 1) {
  return measured_ranges(kCamera, {range, incidence, {}, {}, {}}, deg(80), noise, seed, view, threads);
}

/// Correlation of the errors of pixels that are `shift` columns (or rows) apart.
double correlation(const std::vector<float>& measured, double truth, int du, int dv) {
  double product = 0, square = 0, mean = 0;
  for (float r : measured) mean += double(r) - truth;
  mean /= double(measured.size());
  int n = 0;
  for (int v = 0; v + dv < kCamera.height; ++v)
    for (int u = 0; u + du < kCamera.width; ++u, ++n) {
      const double a = double(measured[std::size_t(v * kCamera.width + u)]) - truth - mean;
      const double b = double(measured[std::size_t((v + dv) * kCamera.width + u + du)]) - truth - mean;
      product += a * b, square += a * a;
    }
  return product / square;
}

}  // namespace

TEST_CASE("noise is named in text and back") {
  REQUIRE(parse_noise("none").kind == NoiseModel::Kind::none);
  REQUIRE(parse_noise("l515-white").kind == NoiseModel::Kind::l515_white);
  REQUIRE(parse_noise("l515").kind == NoiseModel::Kind::l515);
  REQUIRE(parse_noise("azure:sun").kind == NoiseModel::Kind::azure);
  REQUIRE(parse_noise("azure:sun").light == Light::sun);
  REQUIRE(to_string(parse_noise("d405:shade")) == "d405");
  REQUIRE(parse_noise("rough").kind == NoiseModel::Kind::rough);
  REQUIRE(parse_noise("gaussian:0.01").kind == NoiseModel::Kind::gaussian);
  REQUIRE(parse_noise("gaussian:0.01").sigma == 0.01);
  REQUIRE(parse_noise("gaussian:1e-3").sigma == 1e-3);
  REQUIRE(parse_noise("gaussian:0").sigma == 0.0);
  for (const char* text : {"none", "l515", "l515:sun", "azure", "d405:sun", "l515-white", "rough", "gaussian:0.01",
                           "gaussian:0", "gaussian:0.1234567890123"})
    REQUIRE(to_string(parse_noise(text)) == text);
  REQUIRE(parse_noise(to_string({NoiseModel::Kind::gaussian, 1.0 / 7.0, Light::shade})).sigma == 1.0 / 7.0);
  REQUIRE_THROWS_WITH(parse_noise("gaussian:2"), test::says("0.002 for 2 mm"));
  for (const char* text : {"", "gaussian", "gaussian:", "gaussian:-0.01", "gaussian:x", "gaussian:0.01m", "gaussian: 1",
                           "gaussian:nan", "gaussian:inf", "gaussian:1e999", "L515", "l515 ", "rough:1",
                           "none:", "rough:sun", "none:shade", "l515-white:sun", "l515:dusk", "l515:"}) {
    INFO(text);
    REQUIRE_THROWS_AS(parse_noise(text), ParameterError);
    REQUIRE_THROWS_WITH(parse_noise(text), test::says("'" + std::string(text) + "'"));
  }
  REQUIRE_THROWS_AS(noise_parameters({NoiseModel::Kind::rough, 0.0, Light::sun}), ParameterError);
  REQUIRE_THROWS_AS(noise_parameters({NoiseModel::Kind::gaussian, -1.0, Light::shade}), ParameterError);
}

TEST_CASE("no noise is the truth") { REQUIRE(measure({}, all(0.7f), all(0.3f)) == all(0.7f)); }

TEST_CASE("gaussian noise has its sigma, no mean and no correlation") {
  const auto measured = measure(kGaussian, all(0.7f), all(0.3f));
  const Statistics s = statistics(measured, all(0.7f));
  REQUIRE(s.n == double(kCamera.size()));
  REQUIRE(s.sigma == Approx(0.01).epsilon(0.015));
  REQUIRE(std::abs(s.mean) < 4 * 0.01 / std::sqrt(s.n));
  REQUIRE(std::abs(correlation(measured, 0.7, 1, 0)) < 0.015);
  REQUIRE(std::abs(correlation(measured, 0.7, 0, 1)) < 0.015);
}

TEST_CASE("the white l515's noise grows with the range as published") {
  REQUIRE(statistics(measure(kL515, all(1.0f), all(0.3f)), all(1.0f)).sigma == Approx(0.0025).epsilon(0.015));
  REQUIRE(statistics(measure(kL515, all(9.0f), all(0.3f)), all(9.0f)).sigma == Approx(0.0153).epsilon(0.015));
}

TEST_CASE("rough noise is correlated over three pixels and biased anew in every view") {
  const auto measured = measure(kRough, all(0.5f), all(0.3f));
  REQUIRE(statistics(measured, all(0.5f)).sigma == Approx(0.002).epsilon(0.03));
  for (int d : {1, 2, 3, 6}) {
    REQUIRE(correlation(measured, 0.5, d, 0) == Approx(std::exp(-d * d / 9.0)).margin(0.06));
    REQUIRE(correlation(measured, 0.5, 0, d) == Approx(std::exp(-d * d / 9.0)).margin(0.06));
  }
  double sum = 0, squares = 0;
  constexpr int kViews = 400;
  for (int view = 0; view < kViews; ++view) {  // a few pixels far apart average the noise away
    std::vector<float> range = all(0.0f);
    for (int v = 0; v < 3; ++v)
      for (int u = 0; u < 12; ++u) range[std::size_t(v * 20 * kCamera.width + u * 20)] = 0.5f;
    const double bias = statistics(measure(kRough, range, all(0.3f), 1, std::uint64_t(view)), range).mean;
    sum += bias, squares += bias * bias;
  }
  REQUIRE(std::abs(sum / kViews) < 4 * 0.0015 / std::sqrt(kViews));
  REQUIRE(std::sqrt(squares / kViews) == Approx(0.0015).epsilon(0.15));
}

TEST_CASE("returns are lost by incidence") {
  for (const double angle : {30.0, 59.9, 65.0, 70.0, 75.0, 79.9, 80.1, 89.0}) {
    INFO(angle);
    const double lost = std::clamp((angle - 60.0) / 20.0, 0.0, 1.0);
    for (const NoiseModel& noise : {kL515, kRough}) {
      const double share =
          1.0 - statistics(measure(noise, all(0.5f), all(float(deg(angle)))), all(0.5f)).n / double(kCamera.size());
      REQUIRE(share == Approx(lost).margin(0.01));
    }
    const auto measured = measure(kGaussian, all(0.5f), all(float(deg(angle))));
    REQUIRE(std::count(measured.begin(), measured.end(), 0.0f) == (angle > 80.0 ? std::ptrdiff_t(kCamera.size()) : 0));
  }
}

TEST_CASE("pixels at depth edges fly between the two surfaces") {
  // Left half at depth 0.5, right half at 0.6: both columns at the step are edges; a step of 8 mm below is none.
  std::vector<float> range(kCamera.size()), incidence = all(0.2f);
  const auto depth = [&](int u, int v) { return u >= 160 ? 0.6 : v >= 120 ? 0.508 : 0.5; };
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u)
      range[std::size_t(v * kCamera.width + u)] = float(depth(u, v) * kCamera.ray(u, v).norm());
  for (const auto& [noise, share] : {std::make_pair(kL515, 0.2), std::make_pair(kRough, 0.5)}) {
    double edge_pixels = 0, flying = 0, sum = 0, elsewhere = 0;
    for (std::uint64_t view = 0; view < 10; ++view) {
      const auto measured = measure(noise, range, incidence, 3, view);
      for (int v = 0; v < kCamera.height; ++v)
        for (int u = 0; u < kCamera.width; ++u) {
          const double z = double(measured[std::size_t(v * kCamera.width + u)]) / kCamera.ray(u, v).norm();
          const bool off = std::abs(z - depth(u, v)) > 0.015;
          const bool edge = u == 159 || u == 160;
          REQUIRE(z > 0.48);
          REQUIRE(z < 0.62);
          edge_pixels += edge, flying += edge && off, elsewhere += !edge && off;
          if (edge && off) sum += (z - 0.5) / 0.1;
        }
    }
    REQUIRE(elsewhere == 0);
    REQUIRE(flying / edge_pixels == Approx(share * 0.85).margin(0.03));  // 15 of 100 mm look like noise here
    REQUIRE(sum / flying == Approx(0.5).margin(0.03));
  }
}

TEST_CASE("an edge pixel may fly at any incidence") {
  std::vector<float> range = all(0.5f);
  for (std::size_t i = 0; i < range.size(); i += 2) range[i] = 0.7f;
  const Statistics s = statistics(measure(kL515, range, all(float(deg(89)))), range);
  REQUIRE(s.n / double(range.size()) == Approx(0.2).margin(0.01));
}

TEST_CASE("the rough sensor's pose is wrong by a little") {
  const Pose truth = look_along({0.1, 0.2, 0.3}, {0.3, 1.0, -0.2}, 0.4);
  REQUIRE(reported_pose(truth, kL515, 1, 0).matrix() == truth.matrix());
  REQUIRE(reported_pose(truth, kGaussian, 1, 0).matrix() == truth.matrix());
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  constexpr int kViews = 2000;
  for (int view = 0; view < kViews; ++view) {
    const Pose error = truth.inverse() * reported_pose(truth, kRough, 7, std::uint64_t(view));
    REQUIRE(is_rigid(error));
    shift += error.translation().cwiseAbs2();
    const Eigen::AngleAxisd rotation(error.linear());
    turn += (rotation.angle() * rotation.axis()).cwiseAbs2();
  }
  for (int a = 0; a < 3; ++a) {
    REQUIRE(std::sqrt(shift[a] / kViews) == Approx(0.0005).epsilon(0.06));
    REQUIRE(std::sqrt(turn[a] / kViews) == Approx(deg(0.1)).epsilon(0.06));
  }
}

TEST_CASE("noise depends on seed and view, not on threads or on what else is seen") {
  std::vector<float> range = all(0.5f);
  for (std::size_t i = 0; i < range.size(); ++i)
    if (i % 7 < 2) range[i] = 0.52f;
  for (const NoiseModel& noise : {kGaussian, kL515, kRough, parse_noise("l515"), parse_noise("azure:sun")}) {
    const auto one = measure(noise, range, all(float(deg(65))), 5, 6, 1);
    REQUIRE(measure(noise, range, all(float(deg(65))), 5, 6, 2) == one);
    REQUIRE(measure(noise, range, all(float(deg(65))), 5, 6, 3) == one);
    REQUIRE(measure(noise, range, all(float(deg(65))), 5, 7) != one);
    REQUIRE(measure(noise, range, all(float(deg(65))), 6, 6) != one);
    // Seen alone, a flat patch has the noise that it has in a full frame.
    const auto full = measure(noise, all(0.5f), all(0.3f), 5, 6);
    std::vector<float> patch = all(0.0f);
    for (int v = 100; v < 140; ++v)
      for (int u = 50; u < 90; ++u) patch[std::size_t(v * kCamera.width + u)] = 0.5f;
    const auto alone = measure(noise, patch, all(0.3f), 5, 6);
    for (int v = 0; v < kCamera.height; ++v)
      for (int u = 0; u < kCamera.width; ++u) {
        const auto i = std::size_t(v * kCamera.width + u);
        const bool rim = u == 50 || u == 89 || v == 100 || v == 139;  // its pixels may fly
        if (!(patch[i] > 0.0f && rim && noise_parameters(noise).skirt > 0.0))
          REQUIRE(alone[i] == (patch[i] > 0.0f ? full[i] : 0.0f));
      }
  }
}

TEST_CASE("images of the wrong size are refused") {
  const std::vector<std::uint32_t> object(kCamera.size(), 1);
  for (const TrueImage& truth : {TrueImage{{1.0f}, all(0.0f), {}, {}, {}}, TrueImage{all(1.0f), {}, {}, {}, {}},
                                 TrueImage{all(1.0f), all(0.0f), {0}, {ObjectClass::leaf}, {}},
                                 TrueImage{all(1.0f), all(0.0f), object, {ObjectClass::leaf}, {}},
                                 TrueImage{all(1.0f), all(0.0f), {}, {}, {1.0f}}})
    REQUIRE_THROWS_AS(measured_ranges(kCamera, truth, 1.0, {}, 1, 0), InputError);
  REQUIRE(measure(kRough, all(0.0f), all(0.0f)) == all(0.0f));
}
