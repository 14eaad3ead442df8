// SPDX-License-Identifier: BSD-3-Clause
// Frontier frames: the frame moves with the cloud and the sensor, and does not depend on scale or copies of the points
// with k times as many neighbors. Where the axis of the neighborhood is told (the two least variances differ) and the
// side is not grazing; there the way into the unseen is told too, unless both tangents are as far from the mean.
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/see/frontier.hpp>

#include "properties/oracles.hpp"

using namespace agrisee;

namespace frontier_test {

namespace {

/// A cap of a sphere on irregular doubles: nothing ties.
laws::Points<double> cap() {
  Rng rng(47);
  laws::Points<double> out;
  while (out.size() < 900) {
    const Eigen::Vector3d d = rng.direction();
    if (d.y() < -0.4) out.push_back(Eigen::Vector3d(0.02, 0.45, 0.1) + (0.035 + 1e-5 * rng.normal()) * d);
  }
  return out;
}

see::Parameters with(double scale, double k) {
  see::Parameters p;
  p.radius = 0.012 * scale;
  p.upsilon *= scale;
  p.rho = (k - 0.5) / (4.0 / 3.0 * kPi * p.radius * p.radius * p.radius);
  return p;
}

std::vector<see::Frontier> frames(const laws::Points<double>& cloud, const Indices& of, const Eigen::Vector3d& eye,
                                  const see::Parameters& parameters) {
  const KdTree<double> search(cloud);
  see::FrameScratch<double> scratch;
  std::vector<see::Frontier> out;
  for (const Index i : of) {
    const auto frame = see::frontier_frame(cloud, search, i, eye, see::Observation(), parameters, scratch);
    REQUIRE(frame);
    out.push_back(*frame);
  }
  return out;
}

}  // namespace

TEST_CASE("frontier frames move with the cloud, and keep their directions when it is scaled or copied") {
  const auto cloud = cap();
  const Eigen::Vector3d eye(0.05, 0.05, 0.15);
  Indices of;
  const auto classes = oracle::classify(cloud, 0.012, 66).classes;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (classes[i] == see::PointClass::frontier) of.push_back(static_cast<Index>(i));
  REQUIRE(of.size() > 50);
  const auto straight = frames(cloud, of, eye, with(1.0, 66));
  for (const auto& f : straight) {
    Eigen::Matrix3d m;
    m << f.direction, f.boundary, f.normal;
    CHECK((m.transpose() * m).isIdentity(1e-9));
    CHECK(m.determinant() == Approx(1.0));
  }
  const auto check = [&](const std::vector<see::Frontier>& got, const Pose& motion, double by) {
    REQUIRE(got.size() == straight.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      INFO(i);
      CHECK((got[i].point - motion * (by * straight[i].point)).norm() < 1e-9 * by);
      CHECK((got[i].normal - motion.linear() * straight[i].normal).norm() < 1e-6);
      CHECK((got[i].direction - motion.linear() * straight[i].direction).norm() < 1e-6);
      CHECK((got[i].boundary - motion.linear() * straight[i].boundary).norm() < 1e-6);
    }
  };
  Rng rng(53);
  for (int i = 0; i < 8; ++i) {
    const Pose motion = pose_from_xyz_rpy(rng.direction(), 3.0 * rng.direction());
    laws::Points<double> moved;
    for (const auto& p : cloud) moved.push_back(motion * p);
    check(frames(moved, of, motion * eye, with(1.0, 66)), motion, 1.0);
  }
  for (const double by : {0.01, 3.0, 1000.0})
    check(frames(laws::scaled(cloud, by), of, by * eye, with(by, 66)), Pose::Identity(), by);
  Indices of_copies;
  for (const Index i : of) of_copies.push_back(3 * i);
  check(frames(laws::repeated(cloud, 3), of_copies, eye, with(1.0, 198)), Pose::Identity(), 1.0);
  const Indices order = laws::shuffled(cloud.size());
  Indices where(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) where[static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
  check(frames(laws::pick(cloud, order), laws::pick(where, of), eye, with(1.0, 66)), Pose::Identity(), 1.0);
}

}  // namespace frontier_test
