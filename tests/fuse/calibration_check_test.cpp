// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/volume.hpp>
#include <agrisee/fuse/calibration_check.hpp>

#include <cmath>
#include <functional>
#include <random>

#include "catch.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::fuse;

namespace {

const std::vector<Sphere> kThreeBalls{
    {{-0.04, 0.55, 0.25}, 0.03}, {{0.04, 0.56, 0.21}, 0.034}, {{0.0, 0.53, 0.16}, 0.025}};

/// The bodies that are found. @param larger than they are (m)
std::vector<Ellipsoid> found_bodies(double larger = 0.0) {
  std::vector<Ellipsoid> all;
  for (const Sphere& s : kThreeBalls) all.emplace_back(Sphere{s.center, s.radius + larger});
  return all;
}

struct MistakenScan {
  std::vector<sensor::SurfaceImage> images;
  std::vector<Pose> reported;

  /// The bodies that are fitted to all points.
  std::vector<Ellipsoid> fitted() const {
    Cloud cloud;
    for (const sensor::SurfaceImage& image : images) {
      cloud.points.insert(cloud.points.end(), image.points.begin(), image.points.end());
      cloud.normals.insert(cloud.normals.end(), image.normals.begin(), image.normals.end());
    }
    std::vector<Ellipsoid> all;
    for (const Sphere& s : kThreeBalls) {
      Indices near;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        if ((cloud.points[i].cast<double>() - s.center).norm() < 2.0 * s.radius) near.push_back(static_cast<Index>(i));
      all.push_back(fit_ellipsoid(cloud, near, Ellipsoid(s))->body);
    }
    return all;
  }

  CalibrationCheck check(const std::vector<Ellipsoid>& on = found_bodies()) const {
    std::vector<RegisteredView> views;
    for (std::size_t v = 0; v < images.size(); ++v) views.push_back({&images[v], reported[v], v});
    return check_calibration(views, on);
  }
};

/// Views of the fruit from an arc.
/// @param mistake changes a point of the surface in the optical frame (m) into the one that is measured there
/// @param reported changes a view's pose into the reported one
/// @param farther every second view is from so much farther away (m)
/// @param aside the views look this far beside the fruit, right and left in turns (m)
MistakenScan scan_with(
    const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& mistake,
    const std::function<Pose(const Pose&, std::size_t)>& reported = [](const Pose& p, std::size_t) { return p; },
    double noise = 0.0, std::size_t views = 8, double farther = 0.1, double aside = 0.0) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MistakenScan out;
  for (std::size_t v = 0; v < views; ++v) {
    const double angle = deg(-60.0 + 120.0 * static_cast<double>(v) / static_cast<double>(views - 1));
    const Eigen::Vector3d z =
        Eigen::Vector3d(std::sin(angle), std::cos(angle), 0.2 * std::sin(2.0 * angle)).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Pose pose = Pose::Identity();
    pose.linear() << x, z.cross(x), z;
    pose.translation() =
        Eigen::Vector3d(0.0, 0.55, 0.2) - (0.4 + (v % 2 ? farther : 0.0)) * z + (v % 2 ? -aside : aside) * x;
    out.reported.push_back(reported(pose, v));
    sensor::SurfaceImage image;
    image.world_T_optical = out.reported.back();
    for (const Sphere& s : kThreeBalls)
      for (int i = 0; i < 400; ++i) {
        const Eigen::Vector3d n = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        if (n.dot(z) > -0.3) continue;
        const Eigen::Vector3d seen = pose.inverse() * (s.center + s.radius * n);
        const Eigen::Vector3d measured = mistake(seen) * (1.0 + noise * normal(random));
        image.points.push_back((out.reported.back() * measured).cast<float>());
        image.normals.push_back((out.reported.back().linear() * pose.linear().transpose() * n).cast<float>());
      }
    out.images.push_back(std::move(image));
  }
  return out;
}

Eigen::Vector3d no_mistake(const Eigen::Vector3d& p) { return p; }

/// A pose as reported if the camera really sits elsewhere, in its own frame.
std::function<Pose(const Pose&, std::size_t)> without_hand_eye(const Pose& hand_eye) {
  return [hand_eye](const Pose& pose, std::size_t) { return pose * hand_eye.inverse(); };
}

}  // namespace

TEST_CASE("views of a calibrated camera agree, with noise too") {
  CHECK(scan_with(no_mistake).check().apart < 0.001);
  const CalibrationCheck noisy = scan_with(
                                     no_mistake, [](const Pose& p, std::size_t) { return p; }, 0.002)
                                     .check();
  CHECK(noisy.apart > 0.0003);
  CHECK(noisy.apart < 0.0015);
  CHECK(noisy.mistake.empty());
}

TEST_CASE("a wrong scale of the depths is told from a wrong focal length and from distances along the rays") {
  const CalibrationCheck depth = scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(0.95 * p); }).check();
  CHECK(depth.apart > 0.0015);
  CHECK(depth.mended < 0.3 * depth.apart);
  CHECK(depth.mistake == "all depths were multiplied by 1.05 (is the depth scale right?)");

  const CalibrationCheck focal =
      scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(1.2 * p.x(), 1.2 * p.y(), p.z()); }).check();
  CHECK(focal.mistake == "the focal lengths were multiplied by 1.2 (are the intrinsics those of the depth images?)");

  // Of what the middle of an image shows, distances along the rays hardly differ from depths.
  const auto along_rays = [](double aside) {
    return scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.norm() / p.z() * p); },
                     [](const Pose& p, std::size_t) { return p; }, 0.0, 8, 0.1, aside)
        .check();
  };
  CHECK(along_rays(0.0).apart < 0.0015);
  const CalibrationCheck rays = along_rays(0.12);
  CHECK(rays.apart > 0.0015);
  CHECK(rays.mistake == "the images held distances along the rays, not depths z");
}

TEST_CASE("a hand-eye transform that is left out is found, with its size") {
  Pose ahead = Pose::Identity();
  ahead.translation() = Eigen::Vector3d(0.0, 0.0, 0.02);
  CHECK(scan_with(no_mistake, without_hand_eye(ahead)).check(found_bodies(0.015)).mistake ==
        "the camera were 20 mm further ahead in its own frame (is the hand-eye transform right?)");
  Pose aside = Pose::Identity();
  aside.translation() = Eigen::Vector3d(-0.008, 0.0, 0.005);
  CHECK(scan_with(no_mistake, without_hand_eye(aside)).check().mistake ==
        "the camera were 8 mm further left, 5 mm further ahead in its own frame (is the hand-eye transform right?)");
  Pose turned = Pose::Identity();
  turned.rotate(Eigen::AngleAxisd(deg(1.0), Eigen::Vector3d::UnitY()));
  turned.rotate(Eigen::AngleAxisd(deg(1.0), Eigen::Vector3d::UnitX()));
  const CalibrationCheck check = scan_with(no_mistake, without_hand_eye(turned)).check();
  CHECK_THAT(check.mistake, test::says("turned by 1.4 degrees about (0.7"));
  CHECK(check.mended < 0.3 * check.apart);
}

TEST_CASE("a wrong calibration tells how far it puts bodies off") {
  const auto unchanged = [](const Pose& p, std::size_t) { return p; };
  Pose aside = Pose::Identity();
  aside.translation() = Eigen::Vector3d(-0.008, 0.0, 0.005);
  Pose turned = Pose::Identity();
  turned.rotate(Eigen::AngleAxisd(deg(2.0), Eigen::Vector3d(1.0, 1.0, 0.0).normalized()));
  const std::vector<MistakenScan> scans{
      scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(0.97 * p); }, unchanged, 0.0005),
      scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(1.04 * p); }, unchanged, 0.001),
      scan_with([](const Eigen::Vector3d& p) { return Eigen::Vector3d(1.15 * p.x(), 1.15 * p.y(), p.z()); }, unchanged),
      scan_with(no_mistake, without_hand_eye(aside)), scan_with(no_mistake, without_hand_eye(turned))};
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const std::vector<Ellipsoid> bodies = scans[k].fitted();
    const CalibrationCheck check = scans[k].check(bodies);
    CAPTURE(k, check.mistake);
    REQUIRE(check.misplaced.size() == bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const double off = (bodies[b].center - kThreeBalls[b].center).norm();
      const double growth = volume(Ellipsoid(kThreeBalls[b])) / volume(bodies[b]) - 1.0;
      CHECK(std::sqrt(check.misplaced[b].shift.trace()) == Approx(off).epsilon(0.4).margin(0.002));
      CHECK(check.misplaced[b].volume == Approx(std::abs(growth)).epsilon(0.4).margin(0.2));
    }
  }
  // A body that hardly any view shows is as far off as the others.
  std::vector<Ellipsoid> bodies = scans[0].fitted();
  bodies.emplace_back(Sphere{{1.0, 0.5, 0.2}, 0.03});
  const std::vector<Misplacement> all = scans[0].check(bodies).misplaced;
  REQUIRE(all.size() == 4);
  CHECK(all[3].volume == Approx((all[0].volume + all[1].volume + all[2].volume) / 3.0));
  CHECK(all[3].shift.isApprox((all[0].shift + all[1].shift + all[2].shift) / 3.0));
  CHECK(scan_with(no_mistake).check().misplaced.empty());
  CHECK(scan_with(no_mistake, [](const Pose& p,
                                 std::size_t v) { return v < 4 ? p : Pose(Eigen::Translation3d(0.008, 0.0, 0.0) * p); })
            .check()
            .misplaced.empty());
}

TEST_CASE("a plant that moves once is told from a camera that is not calibrated, with the views between") {
  const Eigen::Vector3d motion = GENERATE(Eigen::Vector3d(0.006, 0.0, 0.0), Eigen::Vector3d(0.0, -0.004, 0.008));
  const std::size_t before = GENERATE(1u, 3u, 7u);
  CAPTURE(motion.transpose(), before);
  const CalibrationCheck check =
      scan_with(
          no_mistake,
          [&](const Pose& p, std::size_t v) { return v < before ? p : Pose(Eigen::Translation3d(motion) * p); }, 0.001)
          .check();
  CHECK(check.mistake == "the plant had moved by " + number_text(1e3 * check.motion.norm(), 2) + " mm between views " +
                             std::to_string(before - 1) + " and " + std::to_string(before));
  CHECK((check.motion - motion).norm() < 5e-4);
  CHECK(check.mended < 0.5 * check.apart);
}

TEST_CASE("a plant that moves while each pose is a little wrong is not taken for a wrong hand-eye transform") {
  struct Case {
    double pose_error, motion;
    unsigned seed;
  };
  const Case c = GENERATE(Case{0.002, 0.008, 1}, Case{0.002, 0.015, 2}, Case{0.002, 0.03, 3});
  CAPTURE(c.pose_error, c.motion, c.seed);
  std::mt19937 random(c.seed);
  std::normal_distribution<double> normal(0.0, c.pose_error);
  const CalibrationCheck check = scan_with(
                                     no_mistake,
                                     [&](const Pose& p, std::size_t v) {
                                       Pose off = p;
                                       for (int a = 0; a < 3; ++a) off.translation()[a] += normal(random);
                                       return v < 4 ? off : Pose(Eigen::Translation3d(c.motion, 0.0, 0.0) * off);
                                     },
                                     0.001)
                                     .check();
  CHECK(check.mistake ==
        "the plant had moved by " + number_text(1e3 * check.motion.norm(), 2) + " mm between views 3 and 4");
  CHECK((check.motion - Eigen::Vector3d(c.motion, 0.0, 0.0)).norm() < 3.0 * c.pose_error);
  // Of what is seen before and after the motion; what all views show is less than 4 mm apart.
  CHECK(check.apart > std::min(0.0038, 0.48 * c.motion));
  CHECK(check.mended < 0.5 * check.apart);
}

TEST_CASE("a plant that moves by less than the views may differ is not told") {
  const CalibrationCheck check = scan_with(no_mistake, [](const Pose& p, std::size_t v) {
                                   return v < 4 ? p : Pose(Eigen::Translation3d(0.002, 0.0, 0.0) * p);
                                 }).check();
  CHECK(check.mistake.empty());
  CHECK(check.motion.isZero());
}

TEST_CASE("where two mistakes explain the views alike, both are told") {
  const auto smaller = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(0.95 * p); };
  const MistakenScan one_distance = scan_with(
      smaller, [](const Pose& p, std::size_t) { return p; }, 0.0, 8, 0.0);
  CHECK(one_distance.check().mistake ==
        "all depths were multiplied by 1.05 (is the depth scale right?), or if the camera were 20 mm further ahead in "
        "its own frame (is the hand-eye transform right?)");
}

TEST_CASE("poses that are wrong each in its own way have no common mistake") {
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0.0, 0.008);
  const CalibrationCheck check = scan_with(no_mistake, [&](const Pose& pose, std::size_t) {
                                   Pose off = pose;
                                   off.translation() += Eigen::Vector3d(normal(random), normal(random), normal(random));
                                   return off;
                                 }).check();
  CHECK(check.apart > 0.0015);
  CHECK(check.mistake.empty());
  CHECK(check.motion.isZero());
}

TEST_CASE("nothing is compared without fruit, or in a single view") {
  const auto smaller = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(0.95 * p); };
  const MistakenScan wrong = scan_with(smaller);
  CHECK(wrong.check({}).apart == 0.0);
  CHECK(wrong.check({Ellipsoid(Sphere{{1.0, 0.55, 0.2}, 0.03})}).apart == 0.0);
  MistakenScan single = wrong;
  single.images.resize(1);
  single.reported.resize(1);
  CHECK(single.check().apart == 0.0);
  CHECK(MistakenScan{}.check().mistake.empty());
}

TEST_CASE("what registration moved is taken back, and of many views some are compared") {
  // Registered views agree; as reported they do not.
  const auto smaller = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(0.97 * p); };
  MistakenScan many = scan_with(
      smaller, [](const Pose& p, std::size_t) { return p; }, 0.0, 30);
  const CalibrationCheck before = many.check();
  CHECK(before.mistake == "all depths were multiplied by 1.03 (is the depth scale right?)");
  for (sensor::SurfaceImage& image : many.images) {
    const Eigen::Vector3d shift = -0.004 * image.world_T_optical.linear().col(2);
    for (Eigen::Vector3f& p : image.points) p += shift.cast<float>();
    image.world_T_optical.pretranslate(shift);
  }
  CHECK(many.check().apart == Approx(before.apart).margin(5e-4));
  CHECK(many.check().mistake == before.mistake);
}
