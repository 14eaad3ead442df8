// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/sensor/points_to_frame.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;
using namespace agrisee::sensor;

namespace {

const std::vector<Sphere> kSpheres = {{{0.0, 0.5, 0.2}, 0.035}, {{0.06, 0.52, 0.22}, 0.03}, {{0.01, 0.60, 0.25}, 0.04}};
const Pose kPose = look_along({0.0, 0.1, 0.2}, {0.0, 1.0, 0.0});

Aabb volume() {
  Aabb box;
  box.extend({-0.2, 0.3, 0.0});
  box.extend({0.2, 0.8, 0.4});
  return box;
}

double distance_to_spheres(const Eigen::Vector3f& p) {
  double best = 1e9;
  for (const Sphere& s : kSpheres) best = std::min(best, std::abs((p.cast<double>() - s.center).norm() - s.radius));
  return best;
}

struct Quality {
  std::size_t cells = 0;
  double mean = 0.0, worst95 = 0.0, turned = 0.0;
};

Quality quality(const SurfaceImage& image) {
  Quality q;
  std::vector<double> errors;
  for (std::size_t c = 0; c < image.points.size(); ++c) {
    errors.push_back(distance_to_spheres(image.points[c]));
    q.mean += errors.back();
    const Eigen::Vector3d to_eye = image.world_T_optical.translation() - image.points[c].cast<double>();
    if (image.normals[c].cast<double>().dot(to_eye) <= 0.0) q.turned += 1.0;
    CHECK(image.normals[c].norm() == Approx(1.0f).margin(1e-4));
  }
  q.cells = errors.size();
  q.mean /= double(std::max<std::size_t>(1, q.cells));
  std::sort(errors.begin(), errors.end());
  if (!errors.empty()) q.worst95 = errors[errors.size() * 95 / 100];
  return q;
}

}  // namespace

TEST_CASE("the noise of normals is that of the middle image, without those that show nothing") {
  CHECK(normal_noise({}) == 0.0);
  std::vector<SurfaceImage> images(6);                // the last two hold no returns
  const double noise[] = {0.001, 0.004, 0.002, 0.0};  // the last one was discarded
  for (std::size_t i = 0; i < 4; ++i) images[i].noise = noise[i];
  for (std::size_t i = 0; i < 3; ++i) images[i].points = {{0.0f, 0.0f, 0.5f}};
  for (std::size_t i = 4; i < 6; ++i) images[i].depth = {0.0f};
  CHECK(normal_noise(images) == Approx(0.002 / 0.020));
}

TEST_CASE("a surface is recovered from noise that is larger than its detail") {
  const Intrinsics k = intrinsics_from_fov(640, 480, deg(50), deg(39));
  const auto [noise, mean_limit, limit95] = GENERATE(
      table<double, double, double>({{0.0, 0.0001, 0.0004}, {0.0015, 0.0003, 0.0008}, {0.010, 0.0009, 0.0025}}));
  INFO(noise);
  const SurfaceImage image = reconstruct_surface(test::render(kSpheres, k, kPose, noise), kPose, volume());
  const Quality q = quality(image);
  CHECK(q.cells > 1000);
  CHECK(q.mean < mean_limit);
  CHECK(q.worst95 < limit95);
  CHECK(q.turned == 0.0);
  if (noise > 0.0) {  // that of the cells' raw depths: medians of 4 x 4 pixels, some of them
    CHECK(image.noise < 0.5 * noise);
    std::vector<double> off;  // of neighbors along a row from their middle; slopes of spheres cancel
    for (std::size_t c = 1; c + 1 < image.depth.size(); ++c) {
      const double second = double(image.depth[c - 1]) - 2.0 * double(image.depth[c]) + double(image.depth[c + 1]);
      if (image.depth[c - 1] > 0 && image.depth[c] > 0 && image.depth[c + 1] > 0) off.push_back(std::abs(second));
    }
    std::nth_element(off.begin(), off.begin() + std::ptrdiff_t(off.size() / 2), off.end());
    CHECK(image.noise == Approx(1.4826 * off[off.size() / 2] / std::sqrt(6.0)).epsilon(0.15));
  }
}

TEST_CASE("a noisy surface keeps its shape where it leaves the scan volume") {
  // The plane z = 0.5 + x in the optical frame; the volume ends at z = 0.5. Of the pixels near the border only those
  // that their noise brings nearer lie inside.
  DepthFrame frame;
  frame.intrinsics = intrinsics_from_fov(640, 480, deg(50), deg(39));
  frame.depth.resize(frame.intrinsics.size());
  const auto width = static_cast<std::size_t>(frame.intrinsics.width);
  Rng rng(1);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const double x = frame.intrinsics.ray(double(i % width), double(i / width)).x();
    frame.depth[i] = static_cast<float>(0.5 / (1.0 - x) + 0.01 * rng.normal());
  }
  Aabb box;
  box.extend({-0.2, -0.1, 0.3});
  box.extend({0.2, 0.1, 0.5});
  const SurfaceImage image = reconstruct_surface(frame, Pose::Identity(), box);
  double off = 0.0, turned = 0.0;
  std::size_t near_border = 0;
  for (std::size_t i = 0; i < image.points.size(); ++i) {
    const Eigen::Vector3d p = image.points[i].cast<double>();
    CHECK(box.contains(p));
    if (p.z() < 0.485) continue;
    off += (p.z() - 0.5 - p.x()) / std::sqrt(2.0);
    turned += image.normals[i].cast<double>().dot(Eigen::Vector3d(1.0, 0.0, 1.0).normalized());
    ++near_border;
  }
  REQUIRE(near_border > 100);
  CHECK(std::abs(off) / double(near_border) < 0.0007);
  CHECK(std::abs(turned) / double(near_border) < 0.03);
}

TEST_CASE("the steep sides of a small fruit lie neither too deep nor too high") {
  // Over the image such a side is no paraboloid, and a plane through a few cells cuts through it.
  const double noise = GENERATE(0.0, 0.0005, 0.0015);
  const double radius = GENERATE(0.010, 0.015, 0.030);
  const Sphere fruit{{0.0, 0.45, 0.2}, radius};
  const Intrinsics k = intrinsics_from_fov(640, 480, deg(50), deg(39));
  const SurfaceImage image = reconstruct_surface(test::render({fruit}, k, kPose, noise), kPose, volume());
  double off[3] = {0.0, 0.0, 0.0}, turned[3] = {0.0, 0.0, 0.0};
  std::size_t count[3] = {0, 0, 0};
  for (std::size_t i = 0; i < image.points.size(); ++i) {
    const Eigen::Vector3d p = image.points[i].cast<double>(), q = p - fruit.center;
    const double angle = std::acos(-q.normalized().dot((p - kPose.translation()).normalized()));
    const std::size_t ring = angle < deg(40) ? 0 : angle < deg(60) ? 1 : 2;
    off[ring] += q.norm() - radius;
    turned[ring] += std::acos(std::min(1.0, q.normalized().dot(image.normals[i].cast<double>())));
    ++count[ring];
  }
  for (std::size_t ring = 0; ring < 3; ++ring) {
    CAPTURE(noise, radius, ring, count[ring], off[ring] / double(count[ring]), turned[ring] / double(count[ring]));
    REQUIRE(count[ring] > 8);
    CHECK(std::abs(off[ring]) / double(count[ring]) < 0.00006 + 0.06 * noise);
    CHECK(turned[ring] / double(count[ring]) < deg(4) + 100.0 * noise);
  }
}

TEST_CASE("cells and pixels agree where a point is seen") {
  const Intrinsics k = intrinsics_from_fov(640, 480, deg(50), deg(39));
  const SurfaceImage image = reconstruct_surface(test::render(kSpheres, k, kPose), kPose, volume());
  std::size_t agree = 0;
  for (const auto& p : image.points) {
    double z = 0.0;
    const std::ptrdiff_t c = image.cell(p.cast<double>(), &z);
    REQUIRE(c >= 0);
    agree += std::abs(double(image.depth[static_cast<std::size_t>(c)]) - z) < 0.006;
  }
  CHECK(agree > image.points.size() * 95 / 100);
  CHECK(image.cell({0.0, 0.0, 0.2}) == -1);  // behind the sensor
}

TEST_CASE("surfaces do not depend on threads") {
  const Intrinsics k = intrinsics_from_fov(320, 240, deg(50), deg(39));
  const DepthFrame frame = test::render(kSpheres, k, kPose, 0.005);
  const SurfaceImage a = reconstruct_surface(frame, kPose, volume(), {}, 1),
                     b = reconstruct_surface(frame, kPose, volume(), {}, 3);
  CHECK(a.points == b.points);
  CHECK(a.sigma == b.sigma);
}

TEST_CASE("frames without anything to see give nothing") {
  const Intrinsics k = intrinsics_from_fov(64, 48, deg(50), deg(39));
  DepthFrame frame;
  frame.intrinsics = k;
  for (const float fill : {0.0f, std::nanf(""), -1.0f, std::numeric_limits<float>::infinity(), 0.01f, 5.0f}) {
    frame.depth.assign(k.size(), fill);
    const SurfaceImage image = reconstruct_surface(frame, kPose, volume());
    CHECK(image.points_in == 0);
    CHECK(quality(image).cells == 0);
  }
  frame.depth.assign(k.size(), 0.0f);
  frame.depth[100] = 0.45f;  // a single return is no surface
  CHECK(quality(reconstruct_surface(frame, kPose, volume())).cells == 0);
}

TEST_CASE("unusable frames are refused") {
  DepthFrame frame;
  CHECK_THROWS_AS(reconstruct_surface(frame, kPose, volume()), InputError);
  frame.intrinsics = intrinsics_from_fov(64, 48, deg(50), deg(39));
  frame.depth.assign(7, 1.0f);
  CHECK_THROWS_AS(reconstruct_surface(frame, kPose, volume()), InputError);
  frame.depth.assign(64 * 48, 1.0f);
  Pose skewed = kPose;
  skewed.linear() *= 2.0;
  CHECK_THROWS_AS(reconstruct_surface(frame, skewed, volume()), InputError);
  SurfaceParameters bad;
  bad.spacing = 0.0;
  CHECK_THROWS_AS(reconstruct_surface(frame, kPose, volume(), bad), ParameterError);
}

TEST_CASE("unorganized points take the same path as a depth image") {
  const Intrinsics k = intrinsics_from_fov(320, 240, deg(50), deg(39));
  const DepthFrame frame = test::render(kSpheres, k, kPose);
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (frame.at(u, v) > 0) points.push_back(frame.point(u, v));
  points.push_back(Eigen::Vector3f::Constant(std::nanf("")));
  points.emplace_back(0.0f, 0.0f, -1.0f);
  const DepthFrame again = frame_from_points(points, k);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) CHECK(again.depth[i] == Approx(frame.depth[i]).margin(1e-6));
}
