// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/center_errors.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::fuse;

namespace {

/// Views from an arc of 120 degrees that show one ball, each wrong along its sight line by an error of its own.
struct Scan {
  std::vector<sensor::SurfaceImage> images;
  std::vector<RegisteredView> views;
  Cloud cloud;  ///< all their points
};

const Eigen::Vector3d kCenter(0.1, 0.6, 0.3);
constexpr double kRadius = 0.035;

/// @param shared standard deviation of the error along the ray that all points of a view have (m)
/// @param single that of each point (m)
Scan scan_of_ball(int count, double shared, double single, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Scan scan;
  for (int v = 0; v < count; ++v) {
    const double angle = deg(-60.0 + 120.0 * v / std::max(1, count - 1)), rise = 0.3 * std::sin(2.0 * v);
    const Eigen::Vector3d to_sensor = Eigen::Vector3d(std::sin(angle), -std::cos(angle), rise).normalized();
    const double error = shared * normal(random);
    sensor::SurfaceImage image;
    image.world_T_optical.translation() = kCenter + 0.4 * to_sensor;
    while (image.points.size() < 150) {
      const Eigen::Vector3d n = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      if (n.dot(to_sensor) < 0.35) continue;
      const Eigen::Vector3d p = kCenter + kRadius * n + (error + single * normal(random)) * to_sensor;
      image.points.push_back(p.cast<float>());
      image.normals.push_back(n.cast<float>());
      scan.cloud.points.push_back(image.points.back());
      scan.cloud.normals.push_back(image.normals.back());
    }
    scan.images.push_back(std::move(image));
  }
  for (const auto& image : scan.images) scan.views.push_back({&image, image.world_T_optical});
  return scan;
}

EllipsoidFit fit_of(const Scan& scan, int max_points = FitParameters().max_points) {
  Indices all(scan.cloud.size());
  std::iota(all.begin(), all.end(), Index{0});
  FitParameters parameters;
  parameters.max_points = max_points;
  return *fit_ellipsoid(scan.cloud, all, Ellipsoid(Sphere{kCenter, kRadius}), parameters);
}

Eigen::Matrix3d errors_of(const Scan& scan) { return center_errors({fit_of(scan).body}, scan.views, {})[0]; }

}  // namespace

TEST_CASE("centers are as far off as the views' shared errors say") {
  for (const double shared : {0.0003, 0.001}) {
    double squares = 0.0, variances = 0.0;
    constexpr int kScans = 80;
    for (int k = 0; k < kScans; ++k) {
      const Scan scan = scan_of_ball(10, shared, 0.0002, static_cast<unsigned>(k));
      const EllipsoidFit fit = fit_of(scan);
      const Eigen::Matrix3d covariance = center_errors({fit.body}, scan.views, {})[0];
      squares += (fit.body.center - kCenter).squaredNorm() / kScans;
      variances += covariance.trace() / kScans;
    }
    // The variance of the shared errors counts twice, for what no disagreement shows; here there is no such error.
    INFO("errors of " << 1e3 * std::sqrt(squares) << " mm, predicted " << 1e3 * std::sqrt(variances) << " mm");
    CHECK(variances / squares > 1.0);
    CHECK(variances / squares < 4.0);
  }
}

TEST_CASE("centers are as far off as errors say that only neighboring points share") {
  constexpr double kError = 0.001;
  double squares = 0.0, variances = 0.0;
  constexpr int kScans = 80;
  for (int k = 0; k < kScans; ++k) {
    Scan scan = scan_of_ball(10, 0.0, 0.0, static_cast<unsigned>(k));
    std::mt19937 random(static_cast<unsigned>(k));
    std::normal_distribution<double> normal(0.0, kError);
    std::size_t next = 0;
    for (sensor::SurfaceImage& image : scan.images) {
      std::map<int, double> of_patch;
      for (std::size_t i = 0; i < image.points.size(); ++i, ++next) {
        const int bin = DirectionBins::bin(image.points[i].cast<double>() - kCenter);
        const double error = of_patch.try_emplace(bin, normal(random)).first->second;
        image.points[i] += static_cast<float>(error) * image.normals[i];
        scan.cloud.points[next] = image.points[i];
      }
    }
    const EllipsoidFit fit = fit_of(scan, static_cast<int>(scan.cloud.size()));
    squares += (fit.body.center - kCenter).squaredNorm() / kScans;
    variances += center_errors({fit.body}, scan.views, {})[0].trace() / kScans;
  }
  INFO("errors of " << 1e3 * std::sqrt(squares) << " mm, predicted " << 1e3 * std::sqrt(variances) << " mm");
  CHECK(variances / squares > 0.8);
  CHECK(variances / squares < 3.0);
}

TEST_CASE("more views with errors of their own make a center more certain; more points of the same views do not") {
  const double few = errors_of(scan_of_ball(6, 0.0006, 0.0001, 1)).trace();
  const double many = errors_of(scan_of_ball(24, 0.0006, 0.0001, 1)).trace();
  CHECK(many < 0.5 * few);
  Scan scan = scan_of_ball(6, 0.0006, 0.0001, 1);
  for (auto& image : scan.images) {
    const auto points = image.points, normals = image.normals;
    image.points.insert(image.points.end(), points.begin(), points.end());
    image.normals.insert(image.normals.end(), normals.begin(), normals.end());
  }
  CHECK(errors_of(scan).trace() == Approx(few).epsilon(0.01));
}

TEST_CASE("views that agree leave hardly any error") {
  CHECK(std::sqrt(errors_of(scan_of_ball(10, 0.0, 0.0001, 2)).trace()) < 0.0002);
}

TEST_CASE("poses that registration had to put right make a center less certain") {
  Scan scan = scan_of_ball(10, 0.0, 0.0001, 3);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.002);
  const double before = errors_of(scan).trace();
  for (RegisteredView& view : scan.views)
    view.reported.translation() += Eigen::Vector3d(normal(random), normal(random), normal(random));
  const double after = errors_of(scan).trace();
  CHECK(after > before + 3.0 * 0.5 * 0.002 * 0.002 / 10.0);
  // A shift that all views have alike is none between them.
  for (RegisteredView& view : scan.views) view.reported = view.image->world_T_optical;
  CHECK(errors_of(scan).trace() == Approx(before));
}

TEST_CASE("what too few views saw is not told") {
  CHECK(errors_of(scan_of_ball(2, 0.001, 0.0001, 4)).isZero());
  CHECK(center_errors({Ellipsoid(Sphere{kCenter + Eigen::Vector3d(1.0, 0.0, 0.0), kRadius})},
                      scan_of_ball(5, 0.001, 0.0001, 4).views, {})[0]
            .isZero());
  CHECK(center_errors({}, {}, {}).empty());
}
