// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/volume.hpp>
#include <agrisee/fuse/body_errors.hpp>
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

Eigen::Matrix3d errors_of(const Scan& scan) { return body_errors({fit_of(scan).body}, scan.views, {})[0].center; }

// Balls that are seen at the ends of their axes alone, so that all can be worked out by hand. Binary fractions.
const Sphere kSmall{{0.25, 0.5, -0.125}, 0.03125}, kOther{{0.5, 0.5, -0.125}, 0.03125};
constexpr double kOff = 1.0 / 2048.0;  // m

/// Points of a view at an end of an axis of a ball.
void add_end(sensor::SurfaceImage& image, const Sphere& ball, int axis, double side, double outwards, int count) {
  const Eigen::Vector3d normal = side * Eigen::Vector3d::Unit(axis);
  for (int i = 0; i < count; ++i) {
    image.points.push_back((ball.center + (ball.radius + outwards) * normal).cast<float>());
    image.normals.push_back(normal.cast<float>());
  }
}

/// Six views, each of one end of the axes of some balls.
/// @param outwards how far the points of each ball are outside of it (m)
std::vector<sensor::SurfaceImage> six_ends(const std::vector<Sphere>& balls, const std::vector<double>& outwards) {
  std::vector<sensor::SurfaceImage> images(6);
  for (int v = 0; v < 6; ++v)
    for (std::size_t b = 0; b < balls.size(); ++b)
      add_end(images[static_cast<std::size_t>(v)], balls[b], v / 2, v % 2 ? -1.0 : 1.0, outwards[b], 10);
  return images;
}

/// The views, each reported by so much (m) too far in the direction that it shows.
std::vector<RegisteredView> registered(const std::vector<sensor::SurfaceImage>& images, double too_far = 0.0) {
  std::vector<RegisteredView> views;
  for (const sensor::SurfaceImage& image : images) {
    Pose reported = image.world_T_optical;
    reported.pretranslate(Eigen::Vector3d(too_far * image.normals[0].cast<double>()));
    views.push_back({&image, reported});
  }
  return views;
}

/// What is due to uneven skin, and to the noise (m) that was smoothed: a third of all points measure along an axis, and
/// all count as `independent`.
double uneven(int independent = FitParameters().independent, double noise = 0.0) {
  return 3.0 * (0.0002 * 0.0002 + 0.01 * noise * noise) / independent;
}

void check_variance(const Eigen::Matrix3d& covariance, double variance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      CHECK(covariance(i, j) == Approx(i == j ? variance : 0.0).epsilon(1e-4).margin(1e-6 * variance));
}

}  // namespace

TEST_CASE("centers are as far off as the views' shared errors say") {
  for (const double shared : {0.0003, 0.001}) {
    double squares = 0.0, variances = 0.0;
    constexpr int kScans = 80;
    for (int k = 0; k < kScans; ++k) {
      const Scan scan = scan_of_ball(10, shared, 0.0002, static_cast<unsigned>(k));
      const EllipsoidFit fit = fit_of(scan);
      const Eigen::Matrix3d covariance = body_errors({fit.body}, scan.views, {})[0].center;
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
    variances += body_errors({fit.body}, scan.views, {})[0].center.trace() / kScans;
  }
  INFO("errors of " << 1e3 * std::sqrt(squares) << " mm, predicted " << 1e3 * std::sqrt(variances) << " mm");
  CHECK(variances / squares > 0.8);
  CHECK(variances / squares < 3.0);
}

TEST_CASE("centers are as far off as poses that are wrong in all directions, and were not put right") {
  for (const double error : {0.0, 0.0005, 0.001}) {
    double squares = 0.0, variances = 0.0, of_volumes = 0.0, volumes = 0.0;
    constexpr int kScans = 80;
    for (int k = 0; k < kScans; ++k) {
      Scan scan = scan_of_ball(6, 0.0, 0.0002, static_cast<unsigned>(k));
      std::mt19937 random(static_cast<unsigned>(k));
      std::normal_distribution<double> normal(0.0, error > 0.0 ? error : 1e-9);
      std::size_t next = 0;
      for (sensor::SurfaceImage& image : scan.images) {
        const Eigen::Vector3f off(float(normal(random)), float(normal(random)), float(normal(random)));
        for (Eigen::Vector3f& p : image.points) scan.cloud.points[next++] = p += off;
      }
      const EllipsoidFit fit = fit_of(scan, static_cast<int>(scan.cloud.size()));
      const BodyErrors errors = body_errors({fit.body}, scan.views, {})[0];
      squares += (fit.body.center - kCenter).squaredNorm() / kScans;
      variances += errors.center.trace() / kScans;
      volumes += std::pow(volume(fit.body) / volume(Ellipsoid(Sphere{kCenter, kRadius})) - 1.0, 2) / kScans;
      of_volumes += errors.volume * errors.volume / kScans;
    }
    INFO(error << ": errors of " << 1e3 * std::sqrt(squares) << " mm, predicted " << 1e3 * std::sqrt(variances)
               << " mm; " << std::sqrt(volumes) << ", predicted " << std::sqrt(of_volumes));
    if (error > 0.0) {
      CHECK(variances / squares > 0.8);
      CHECK(variances / squares < 3.0);
      CHECK(of_volumes / volumes > 0.8);
    } else {
      CHECK(std::sqrt(variances) < 0.00012);  // views that agree leave hardly any error
    }
  }
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
  const Scan scan = scan_of_ball(5, 0.001, 0.0001, 4);
  const Ellipsoid ball(Sphere{kCenter, kRadius}), nothing(Sphere{kCenter + Eigen::Vector3d(1.0, 0.0, 0.0), kRadius});
  const auto errors = body_errors({ball, nothing}, scan.views, {});
  CHECK(errors[0].volume > 0.0);
  CHECK(errors[1].center.isZero());
  CHECK(errors[1].volume == 0.0);
  CHECK(body_errors({}, {}, {}).empty());
}

TEST_CASE("skin that is uneven is all that is wrong with views that agree") {
  const auto images = six_ends({kSmall}, {0.0});
  for (const int independent : {1, 150}) {
    FitParameters parameters;
    parameters.independent = independent;
    check_variance(body_errors({Ellipsoid(kSmall)}, registered(images), parameters)[0].center, uneven(independent));
  }
}

TEST_CASE("the variance of views that disagree is shared by bodies and doubled") {
  // Six residuals of a size have the variance 6/5 of its square about 0. Twice that, of the mean of two views.
  const auto one = six_ends({kSmall}, {kOff});
  check_variance(body_errors({Ellipsoid(kSmall)}, registered(one), {})[0].center, 1.2 * kOff * kOff + uneven());
  const auto two = six_ends({kSmall, kOther}, {kOff, 0.0});
  for (const BodyErrors& errors : body_errors({Ellipsoid(kSmall), Ellipsoid(kOther)}, registered(two), {}))
    check_variance(errors.center, 0.6 * kOff * kOff + uneven());
}

TEST_CASE("what registration moved counts as disagreement and as an error of its own") {
  // A view reported too far in the direction of its normal had its points outside by as much.
  for (const double outwards : {0.0, kOff}) {
    const auto images = six_ends({kSmall}, {outwards});
    for (const double too_far : {-0.5 * kOff, 3.0 * kOff}) {
      const double before = outwards + too_far;
      check_variance(body_errors({Ellipsoid(kSmall)}, registered(images, too_far), {})[0].center,
                     1.2 * before * before + 1.2 * too_far * too_far / 3.0 / 6.0 + uneven());
    }
  }
  // Of two bodies, the shifts of one are those of the other.
  const auto two = six_ends({kSmall, kOther}, {0.0, 0.0});
  for (const BodyErrors& errors : body_errors({Ellipsoid(kSmall), Ellipsoid(kOther)}, registered(two, kOff), {}))
    check_variance(errors.center, 1.2 * kOff * kOff + kOff * kOff / 15.0 + uneven());
}

TEST_CASE("errors of poses, which show across the sight lines, are no errors that the points of a view share") {
  const auto images = six_ends({kSmall}, {kOff});
  for (const double aside : {0.5 * kOff, 4.0 * kOff}) {
    std::vector<RegisteredView> views = registered(images);
    for (RegisteredView& view : views) {
      const Eigen::Vector3d normal = view.image->normals[0].cast<double>();
      view.reported.pretranslate(Eigen::Vector3d(aside * Eigen::Vector3d(normal.z(), normal.x(), normal.y())));
    }
    // Six shifts of this length have the variance 6/5 of its square about 0, on two axes.
    const double shared = std::max(0.0, 1.2 * kOff * kOff - 0.6 * aside * aside);
    // Of the poses' variance registration leaves a quarter to six views; the center is the mean of two.
    const double left = 0.5 * 0.25 * 0.6 * aside * aside;
    check_variance(body_errors({Ellipsoid(kSmall)}, views, {})[0].center,
                   shared + left + aside * aside / 15.0 + uneven());
  }
}

TEST_CASE("smoothing more noise makes a center less certain") {
  auto images = six_ends({kSmall}, {0.0});
  for (std::size_t v = 0; v < images.size(); ++v) images[v].noise = v % 2 ? 0.001 : 0.003;
  check_variance(body_errors({Ellipsoid(kSmall)}, registered(images), {})[0].center, uneven(150, 0.002));
}

TEST_CASE("ends that are off in one view are errors of patches") {
  // Each view has both ends of an axis, shifted alike: one residual is the other's negative, so their variance about
  // their mean, 0, is twice the square; half of that for the mean of both.
  std::vector<sensor::SurfaceImage> images(3);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      add_end(images[static_cast<std::size_t>(axis)], kSmall, axis, side, side * kOff, 5);
  check_variance(body_errors({Ellipsoid(kSmall)}, registered(images), {})[0].center, kOff * kOff + uneven());
}

TEST_CASE("what one or two views saw has errors of the size that others tell") {
  // The second ball is seen by three of the six views, and by two.
  for (const std::size_t seen : {2u, 3u}) {
    auto images = six_ends({kSmall}, {kOff});
    for (std::size_t v = 0; v < seen; ++v) add_end(images[v], kOther, static_cast<int>(v), 1.0, 0.0, 10);
    const auto errors = body_errors({Ellipsoid(kSmall), Ellipsoid(kOther)}, registered(images), {});
    const double counted = seen == 2 ? 6.0 / 5.0 : 6.0 / 7.0;  // squares over degrees of freedom
    check_variance(errors[0].center, counted * kOff * kOff + uneven());
    CHECK(errors[1].center(0, 0) > 0.0);
    CHECK(errors[1].volume > 0.0);
  }
}

TEST_CASE("volumes are as far off as the lengths of three axes") {
  // Each semi-axis is the mean of two ends. Errors of the three add up in the logarithm of the volume.
  const auto volume_variance = [](double outwards, double noise) {
    auto images = six_ends({kSmall}, {outwards});
    for (sensor::SurfaceImage& image : images) image.noise = noise;
    const double error = body_errors({Ellipsoid(kSmall)}, registered(images), {})[0].volume;
    return error * error * kSmall.radius * kSmall.radius;
  };
  CHECK(volume_variance(0.0, 0.0) == Approx(3.0 * uneven()).epsilon(1e-3));
  CHECK(volume_variance(kOff, 0.0) == Approx(3.0 * (1.2 * kOff * kOff + uneven())).epsilon(1e-3));
  const double flattened = 0.1 * 0.002;  // all ends at once: three times as much of the volume
  CHECK(volume_variance(0.0, 0.002) == Approx(9.0 * flattened * flattened + 3.0 * uneven(150, 0.002)).epsilon(1e-3));
}

TEST_CASE("volumes are as far off as the views' shared errors say") {
  double squares = 0.0, variances = 0.0;
  constexpr int kScans = 80;
  for (int k = 0; k < kScans; ++k) {
    const Scan scan = scan_of_ball(10, 0.001, 0.0002, static_cast<unsigned>(k));
    const EllipsoidFit fit = fit_of(scan);
    squares += std::pow(volume(fit.body) / volume(Ellipsoid(Sphere{kCenter, kRadius})) - 1.0, 2) / kScans;
    variances += std::pow(body_errors({fit.body}, scan.views, {})[0].volume, 2) / kScans;
  }
  INFO("errors of " << std::sqrt(squares) << ", predicted " << std::sqrt(variances));
  CHECK(variances / squares > 1.0);  // doubled, as those of centers
  CHECK(variances / squares < 4.0);
}

TEST_CASE("three views of ten points are enough, of nine they are not") {
  const auto with = [](int count, std::size_t views) {
    std::vector<sensor::SurfaceImage> images(views);
    for (std::size_t v = 0; v < views; ++v) {
      add_end(images[v], kSmall, static_cast<int>(v), 1.0, 0.0, v == 0 ? count : 10);
      add_end(images[v], kSmall, static_cast<int>(v), 1.0, 0.01, 5);  // too far off to count
    }
    return body_errors({Ellipsoid(kSmall)}, registered(images), {})[0].center.trace();
  };
  CHECK(with(10, 3) > 0.0);
  CHECK(with(9, 3) == 0.0);
  CHECK(with(10, 2) == 0.0);
}

TEST_CASE("points with other normals than the body's do not count, parameters are checked") {
  auto images = six_ends({kSmall}, {0.0});
  for (sensor::SurfaceImage& image : images)
    for (std::size_t i = 0; i < 3; ++i) {  // of ten, so too few are left
      const Eigen::Vector3f n = image.normals[i];
      image.normals[i] = (0.6f * n + 0.8f * Eigen::Vector3f(n.y(), n.z(), n.x())).normalized();
    }
  CHECK(body_errors({Ellipsoid(kSmall)}, registered(images), {})[0].center.isZero());
  FitParameters wide;
  wide.max_angle = deg(60.0);
  CHECK_FALSE(body_errors({Ellipsoid(kSmall)}, registered(images), wide)[0].center.isZero());
  wide.noise = 0.0;
  CHECK_THROWS_AS(body_errors({}, {}, wide), ParameterError);
}

TEST_CASE("points count up to four standard deviations or a twentieth of the radius from the body") {
  FitParameters sharp;
  sharp.noise = 0.0001;
  const auto counts = [](double outwards, const FitParameters& parameters) {
    const auto images = six_ends({kSmall}, {outwards});
    return !body_errors({Ellipsoid(kSmall)}, registered(images), parameters)[0].center.isZero(0.0);
  };
  for (const double side : {-1.0, 1.0}) {
    CHECK(counts(side * 0.0039, {}));  // 4 x 1 mm
    CHECK_FALSE(counts(side * 0.0041, {}));
    CHECK(counts(side * 0.0015, sharp));  // 31.25 mm / 20
    CHECK_FALSE(counts(side * 0.0016, sharp));
  }
}
