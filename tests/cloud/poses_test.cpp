// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/poses.hpp>
#include <agrisee/core/random.hpp>

#include <numeric>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("centroid and deviation by hand") {
  Cloud cloud;
  cloud.points = {{1, 2, 3}, {3, 2, 1}, {100, 100, 100}};
  const Centroid c = centroid(cloud, {0, 1});
  CHECK((c.mean - Eigen::Vector3d(2, 2, 2)).norm() < 1e-12);
  CHECK((c.sigma - Eigen::Vector3d(1, 0, 1)).norm() < 1e-12);
  CHECK(centroid(cloud, {}).mean.norm() == 0.0);
}

TEST_CASE("the highest point is the first of equally high ones") {
  Cloud cloud;
  CHECK(highest_point(cloud) == -1);
  cloud.points = {{0, 0, 3}, {1, 0, 1}, {2, 0, 3}};
  CHECK(highest_point(cloud) == 0);
  cloud.points[0].x() = std::nanf("");
  CHECK(highest_point(cloud) == 2);
}

TEST_CASE("the paper's pose frame looks at the highest point of the cloud") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 0.03}, 0.004, test::everywhere);
  cloud.normals.clear();
  Indices fruit(cloud.size());
  std::iota(fruit.begin(), fruit.end(), 0);
  cloud.points.emplace_back(0.1f, 0.0f, 0.5f);
  cloud.points.emplace_back(0.0f, -0.0301f, 0.0f);  // a dense spot at -y
  for (int i = 0; i < 30; ++i) {
    fruit.push_back(static_cast<Index>(cloud.size()));
    cloud.points.emplace_back(0.0f, -0.03f - 1e-5f * static_cast<float>(i), 0.0f);
  }
  const Eigen::Matrix3d frame = paper_pose_frame(cloud, fruit, Eigen::Vector3d::Zero());
  CHECK((frame.col(2) - Eigen::Vector3d(0.1, 0, 0.5).normalized()).norm() < 1e-6);
  CHECK(frame.col(0).y() < -0.95);
  CHECK(frame.determinant() == Approx(1.0));
  // Nothing to go by: still a frame.
  CHECK(frame_from_z_and_x(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).determinant() == Approx(1.0));
}

TEST_CASE("the densest point is the first of those with most others near, wherever it is") {
  Cloud cloud;
  cloud.points = {{9, 9, 9}, {5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 1, 0}, {7, 7, 7}, {5.5f, 0, 0}};
  const auto densest = [&](const Indices& indices, double radius) {
    return Eigen::Vector3d(densest_point(cloud, indices, radius));
  };
  CHECK(densest({1, 2, 3, 4, 5, 6}, 1.0) == Eigen::Vector3d(0, 0, 0));  // two within a metre; of the others one
  CHECK(densest({1, 3, 5, 6}, 1.0) == Eigen::Vector3d(5, 0, 0));        // the first of two
  CHECK(densest({5, 3, 1, 6}, 1.0) == Eigen::Vector3d(5, 1, 0));
  CHECK(densest({7, 1, 3, 5, 6}, 1.0) == Eigen::Vector3d(5, 0, 0));
  CHECK(densest({6, 2, 3}, 0.5) == Eigen::Vector3d(7, 7, 7));  // each alone: the first
  CHECK(densest({6}, 1.0) == Eigen::Vector3d(7, 7, 7));
  CHECK(densest({}, 1.0) == Eigen::Vector3d(0, 0, 0));
}

TEST_CASE("frames by hand") {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d expected;
  expected << y, -x, z;
  CHECK((frame_from_z_and_x({0, 0, 2}, {0, 3, 5}) - expected).norm() < 1e-12);
  expected << z, x, y;
  CHECK((frame_from_z_and_x(1e-9 * y, {0, -7, 1e-3}) - expected).norm() < 1e-9);  // short, but a direction
  const Eigen::Matrix3d up = frame_from_z_and_x(1e-13 * y, x);                    // too short: up
  CHECK((up - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  const Eigen::Matrix3d free = frame_from_z_and_x(y, {0, 4, 0});  // the hint says nothing
  CHECK((free.col(2) - y).norm() < 1e-12);
  CHECK((free.transpose() * free - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  CHECK(free.determinant() == Approx(1.0));
}

TEST_CASE("the paper's pose frame without a highest point has z up") {
  Cloud cloud;
  cloud.points = {{0, std::nanf(""), 0}};
  const Eigen::Matrix3d frame = paper_pose_frame(cloud, {}, Eigen::Vector3d(-1, 0, 3));
  CHECK((frame - Eigen::Matrix3d::Identity()).norm() < 1e-12);  // x away from the mean, level
}

TEST_CASE("the centroid of points far from the origin loses no digits") {
  PointCloud<double> cloud;
  const Eigen::Vector3d far(1e6, -2e6, 3e6);
  for (const double x : {-3e-3, 1e-3, 1e-3, 1e-3}) cloud.points.push_back(far + Eigen::Vector3d(x, 2 * x, 0));
  const Centroid c = centroid(cloud, {3, 0, 1, 2});
  CHECK((c.mean - far).norm() < 2e-9);
  CHECK(c.sigma.x() == Approx(std::sqrt(3.0) * 1e-3).epsilon(1e-5));
  CHECK(c.sigma.y() == Approx(std::sqrt(12.0) * 1e-3).epsilon(1e-5));
  CHECK(c.sigma.z() == 0.0);
  CHECK(centroid(cloud, {2}).sigma.norm() == 0.0);
}
