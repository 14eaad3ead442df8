// SPDX-License-Identifier: BSD-3-Clause
// The UR3's kinematics: postures computed by hand, the round trip through all inverse solutions, singular poses,
// limits.
#include <agrisee/arm/ur.hpp>
#include <agrisee/core/random.hpp>

#include <limits>

#include "arm/postures.hpp"
#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::arm;
using test::joints;

namespace {

Joints random_joints(Rng& rng, double range) {
  Joints q;
  for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-range, range);
  return q;
}

double difference(const Pose& a, const Pose& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

/// Largest joint difference modulo 2 pi.
double difference(const Joints& a, const Joints& b) {
  double worst = 0.0;
  for (int j = 0; j < 6; ++j) worst = std::max(worst, std::abs(std::remainder(a[j] - b[j], kTwoPi)));
  return worst;
}

double nearest_difference(const std::vector<Joints>& solutions, const Joints& q) {
  double best = std::numeric_limits<double>::infinity();
  for (const Joints& s : solutions) best = std::min(best, difference(s, q));
  return best;
}

/// Every solution is in (-pi, pi], leads back to the pose, and is listed once.
void check_solutions(const std::vector<Joints>& solutions, const Pose& pose) {
  REQUIRE(solutions.size() <= 8);
  for (std::size_t i = 0; i < solutions.size(); ++i) {
    REQUIRE(difference(forward(solutions[i]), pose) < 1e-9);
    REQUIRE(solutions[i].maxCoeff() <= kPi);
    REQUIRE(solutions[i].minCoeff() > -kPi);
    for (std::size_t k = 0; k < i; ++k) REQUIRE(difference(solutions[i], solutions[k]) > kSameSolution);
  }
}

}  // namespace

TEST_CASE("UR3: postures computed by hand") {
  // All joints at zero: the arm lies along x of base_link, links end to end; the wrist hangs down and looks along y.
  const Pose zero = forward(Joints::Zero());
  CHECK((zero.translation() - Eigen::Vector3d(0.24365 + 0.21325, 0.11235 + 0.0819, 0.1519 - 0.08535)).norm() < 1e-12);
  CHECK((zero.linear().col(0) - Eigen::Vector3d(-1, 0, 0)).norm() < 1e-12);
  CHECK((zero.linear().col(1) - Eigen::Vector3d(0, 0, 1)).norm() < 1e-12);
  CHECK((zero.linear().col(2) - Eigen::Vector3d(0, 1, 0)).norm() < 1e-12);
  // Stretched upwards.
  const Pose up = forward(joints(0, -kPi / 2, 0, -kPi / 2, 0, 0));
  CHECK((up.translation() - Eigen::Vector3d(0, 0.11235 + 0.0819, 0.1519 + 0.24365 + 0.21325 + 0.08535)).norm() < 1e-12);
  // A quarter turn of the base takes x to y and y to -x.
  const Pose turned = forward(joints(kPi / 2, 0, 0, 0, 0, 0));
  CHECK((turned.translation() - Eigen::Vector3d(-0.19425, 0.4569, 0.06655)).norm() < 1e-12);
  // Link frames at zero: elbow and wrist on the way.
  const LinkFrames frames = link_frames(Joints::Zero());
  CHECK((frames[0].translation() - Eigen::Vector3d(0, 0, 0.1519)).norm() < 1e-12);
  CHECK((frames[2].translation() - Eigen::Vector3d(0.24365, 0, 0.1519)).norm() < 1e-12);
  CHECK((frames[3].translation() - Eigen::Vector3d(0.4569, 0.11235, 0.1519)).norm() < 1e-12);
  CHECK((frames[4].translation() - Eigen::Vector3d(0.4569, 0.11235, 0.06655)).norm() < 1e-12);
  for (const Pose& f : frames) CHECK(is_rigid(f));
}

TEST_CASE("UR3: every inverse solution leads back, and the sampled joints are among them") {
  Rng rng(3);
  std::size_t eights = 0;
  for (int i = 0; i < 10000; ++i) {
    const Joints q = random_joints(rng, kPi);
    const Pose pose = forward(q);
    const auto solutions = inverse(pose);
    REQUIRE(!solutions.empty());
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < 1e-7);
    eights += solutions.size() == 8;
  }
  CHECK(eights > 5000);
}

TEST_CASE("UR3: solutions come in one order") {
  Rng rng(4);
  for (int i = 0; i < 2000; ++i) {
    const Pose pose = forward(random_joints(rng, kPi));
    const auto s = inverse(pose);
    const auto again = inverse(pose);
    REQUIRE(s.size() == again.size());
    for (std::size_t k = 0; k < s.size(); ++k) REQUIRE(s[k] == again[k]);
    if (s.size() != 8) continue;
    for (std::size_t k = 0; k < 8; ++k) {
      REQUIRE(s[k][0] == s[k & 4][0]);  // joint 1 by halves
      REQUIRE((s[k][4] > 0) == ((k & 2) == 0));
      REQUIRE((s[k][2] > 0) == ((k & 1) == 0));
    }
  }
}

TEST_CASE("UR3: singular poses of the wrist leave joint 6 to the caller") {
  Rng rng(5);
  int as_desired = 0;
  for (int i = 0; i < 500; ++i) {
    Joints q = random_joints(rng, kPi);
    q[4] = i % 2 ? 0.0 : kPi;
    const Pose pose = forward(q);
    const auto solutions = inverse(pose, {}, q[5]);
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < 1e-6);
    // Another joint 6 is kept where the links reach; else the nearest that they do reach is taken.
    const double desired = rng.uniform(-kPi, kPi);
    const auto others = inverse(pose, {}, desired);
    REQUIRE_FALSE(others.empty());
    check_solutions(others, pose);
    const auto kept = [&](const Joints& s) { return s[5] == desired; };
    if (std::any_of(others.begin(), others.end(), kept)) {
      ++as_desired;
    } else {
      for (const Joints& s : others)  // the other side of the base is not singular
        if (std::abs(std::sin(s[4])) < 1e-9) {
          const double bend = std::min(std::abs(s[2]), kPi - std::abs(s[2]));
          REQUIRE(bend < 1e-4);  // stretched or folded: no nearer one can be reached
        }
    }
  }
  CHECK(as_desired > 250);
  CHECK(as_desired < 500);
}

TEST_CASE("UR3: solutions stay exact close to the wrist's singularity") {
  Rng rng(6);
  for (int i = 0; i < 1000; ++i) {
    Joints q = random_joints(rng, kPi);
    q[4] = (i % 2 ? 1.0 : -1.0) * std::pow(10.0, -4.0 - i % 9) + (i % 4 > 1 ? kPi : 0.0);
    const Pose pose = forward(q);
    const auto solutions = inverse(pose);
    REQUIRE_FALSE(solutions.empty());
    check_solutions(solutions, pose);
  }
}

TEST_CASE("UR3: the stretched and folded elbow is found close to the wrist's singularity too") {
  Rng rng(10);
  for (int i = 0; i < 9000; ++i) {
    const double away = std::pow(10.0, -2.0 - i % 9);  // down to kWristSingularity
    Joints q = random_joints(rng, kPi);
    q[4] = (i % 2 ? 1.0 : -1.0) * rng.uniform(1.0, 2.0) * away + (i % 4 > 1 ? kPi : 0.0);
    q[2] = (i % 5 ? 0.0 : kPi) + (i % 3 ? 0.0 : std::pow(10.0, -rng.uniform(4.0, 9.0)));
    const Pose pose = forward(q);
    const auto solutions = inverse(pose, {}, rng.uniform(-kPi, kPi));
    CAPTURE(away, i);
    REQUIRE_FALSE(solutions.empty());
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < std::max(1e-4, std::sqrt(2e-13 / away)));
  }
}

TEST_CASE("UR3: singular poses of the elbow, stretched and folded") {
  Rng rng(7);
  for (int i = 0; i < 500; ++i) {
    Joints q = random_joints(rng, kPi);
    q[2] = i % 2 ? 0.0 : kPi;
    const Pose pose = forward(q);
    const auto solutions = inverse(pose);
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < 1e-6);
  }
}

TEST_CASE("UR3: singular poses of the shoulder, the wrist's center at d4 from the base's axis") {
  Rng rng(8);
  for (int i = 0; i < 500; ++i) {
    Joints q = random_joints(rng, kPi);
    // The links bent so that they end above the shoulder but for a rest which wrist 2 makes up for.
    const double bend = rng.uniform(0.2, 1.2);
    q[1] = -kPi / 2 + bend;
    q[2] = -2.0 * bend;
    const double rest = UrModel{}.a2 * std::cos(q[1]) + UrModel{}.a3 * std::cos(q[1] + q[2]);
    REQUIRE(std::abs(rest) < UrModel{}.d5);
    q[3] = std::asin(-rest / UrModel{}.d5) - q[1] - q[2];
    const Pose pose = forward(q);
    const Eigen::Vector3d wrist = pose.translation() - UrModel{}.d6 * pose.linear().col(2);
    REQUIRE(wrist.head<2>().norm() == Approx(UrModel{}.d4).margin(1e-12));
    const auto solutions = inverse(pose);
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < 1e-5);
  }
}

TEST_CASE("UR3: the round numbers of a controller are poses like all others") {
  for (int code = 0; code < 4096; ++code) {
    Joints q;
    for (int j = 0, c = code; j < 6; ++j, c /= 4) q[j] = (c % 4) * kPi / 2 - kPi / 2;
    const Pose pose = forward(q);
    const auto solutions = inverse(pose, {}, q[5]);
    check_solutions(solutions, pose);
    REQUIRE(nearest_difference(solutions, q) < 1e-6);
  }
}

TEST_CASE("UR3: out of reach is an empty list") {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(1, 0, 0);
  CHECK(inverse(pose).empty());
  CHECK_FALSE(maybe_reachable(pose));
  // The wrist's center inside the cylinder of radius d4 about the base's axis.
  pose.translation() = Eigen::Vector3d(0.05, 0.0, 0.3);
  CHECK(inverse(pose).empty());
  CHECK_FALSE(maybe_reachable(pose));
  // Pulled outwards from the stretched arm.
  pose = forward(joints(0, 0, 0, -kPi / 2, 0.5, 0));
  CHECK_FALSE(inverse(pose).empty());
  pose.translation().x() += 1e-4;
  CHECK(inverse(pose).empty());
  // maybe_reachable never refuses what can be reached.
  Rng rng(6);
  for (int i = 0; i < 10000; ++i) REQUIRE(maybe_reachable(forward(random_joints(rng, kPi))));
}

TEST_CASE("UR3: limits cut solutions or turn them by a full turn") {
  const Joints q = joints(-0.3, -1.2, 1.1, 0.4, 0.9, -0.5);
  const Pose pose = forward(q);
  JointLimits limits;
  const auto all = inverse(pose);
  limits.min[2] = 0.0;
  for (const Joints& s : inverse(pose, limits)) CHECK(s[2] >= 0.0);
  CHECK(inverse(pose, limits).size() == all.size() / 2);
  limits.min[0] = kPi;  // joint 1 only in its second turn
  const auto second = inverse(pose, limits);
  CHECK_FALSE(second.empty());
  CHECK(nearest_difference(second, q) < 1e-9);
  for (const Joints& s : second) {
    CHECK(limits.contain(s));
    CHECK(difference(forward(s), pose) < 1e-9);
  }
  limits.min = limits.max = Joints::Constant(0.123);
  CHECK(inverse(pose, limits).empty());
}

TEST_CASE("UR3: the Jacobian is the derivative of the forward kinematics") {
  Rng rng(7);
  for (int i = 0; i < 500; ++i) {
    const Joints q = random_joints(rng, kPi);
    const auto j = jacobian(q);
    const Pose pose = forward(q);
    for (int k = 0; k < 6; ++k) {
      const double h = 1e-6;
      Joints up = q, down = q;
      up[k] += h;
      down[k] -= h;
      const Pose a = forward(up), b = forward(down);
      const Eigen::Vector3d velocity = (a.translation() - b.translation()) / (2 * h);
      const Eigen::Matrix3d spin = (a.linear() - b.linear()) / (2 * h) * pose.linear().transpose();
      REQUIRE((j.col(k).head<3>() - velocity).norm() < 1e-8);
      REQUIRE((j.col(k).tail<3>() - Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0))).norm() < 1e-8);
    }
  }
}

TEST_CASE("UR3: input that is no pose is refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Pose pose = forward(Joints::Zero());
  pose.translation().x() = nan;
  CHECK_THROWS_AS(inverse(pose), InputError);
  pose.translation().x() = inf;
  CHECK_THROWS_AS(inverse(pose), InputError);
  pose = forward(Joints::Zero());
  pose.linear() *= 1.01;
  CHECK_THROWS_AS(inverse(pose), InputError);
  pose.linear() = -Eigen::Matrix3d::Identity();
  CHECK_THROWS_AS(inverse(pose), InputError);
  CHECK_THROWS_AS(inverse(forward(Joints::Zero()), {}, nan), InputError);
  CHECK_THROWS_AS(forward(joints(0, 0, nan, 0, 0, 0)), InputError);
  CHECK_THROWS_AS(jacobian(joints(0, 0, 0, 0, inf, 0)), InputError);
}

/// base_link_T_tool0 by the product of Denavit-Hartenberg matrices: the maker's convention, independent of ours.
Pose by_denavit_hartenberg(const Joints& q, const UrModel& m) {
  const double d[] = {m.d1, 0, 0, m.d4, m.d5, m.d6}, a[] = {0, m.a2, m.a3, 0, 0, 0};
  const double alpha[] = {kPi / 2, 0, 0, kPi / 2, -kPi / 2, 0};
  Eigen::Isometry3d pose(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()));  // base_link to the controller's base
  for (int i = 0; i < 6; ++i)
    pose = pose * Eigen::AngleAxisd(q[i], Eigen::Vector3d::UnitZ()) * Eigen::Translation3d(a[i], 0, d[i]) *
           Eigen::AngleAxisd(alpha[i], Eigen::Vector3d::UnitX());
  return pose;
}

TEST_CASE("every model of the family moves as its Denavit-Hartenberg parameters say, and back") {
  CHECK(ur_models().size() == 4);
  for (const UrModel& model : ur_models()) {
    CAPTURE(std::string(model.name));
    Rng rng(7);
    for (int i = 0; i < 500; ++i) {
      const Joints q = random_joints(rng, kPi);
      const Pose pose = forward(q, model);
      REQUIRE(difference(pose, by_denavit_hartenberg(q, model)) < 1e-9);
      const auto solutions = inverse(pose, {}, q[5], model);
      double nearest = 1.0;
      for (const Joints& s : solutions) {
        REQUIRE(difference(forward(s, model), pose) < 1e-9);
        nearest = std::min(nearest, (s - q).unaryExpr([](double x) { return std::abs(wrap(x)); }).maxCoeff());
      }
      REQUIRE(nearest < 1e-6);
    }
  }
}

TEST_CASE("models are found by name") {
  CHECK(ur_model("UR5e").a2 == -0.425);
  CHECK(ur_model("ur10e").limits.velocity[0] == Approx(deg(120)));
  CHECK_THROWS_WITH(ur_model("ur7"), Catch::Matchers::Contains("known are ur3, ur3e, ur5e, ur10e"));
}
