// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/fit.hpp>
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

TEST_CASE("the growth axis points to the stem that meets the fruit") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 0.03}, 0.003, test::everywhere);
  Labels labels(cloud.size(), 1);
  const Eigen::Vector3d up = Eigen::Vector3d(0.5, 0.2, 1.0).normalized();
  for (int i = 0; i < 40; ++i) {
    cloud.points.push_back(((0.031 + 0.0004 * i) * up).cast<float>());
    labels.push_back(0);
  }
  EllipsoidFit ball;
  ball.body = Ellipsoid{Sphere{{0, 0, 0}, 0.03}};
  CHECK(std::acos(growth_axis(cloud, labels, ball).dot(up)) < deg(10));
  CHECK(growth_axis(Cloud{}, {}, ball).z() == Approx(1.0));  // nothing but gravity
}

TEST_CASE("the growth axis is the one about which the body is round") {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.4, -0.5, 1.0).normalized();
  for (const double polar : {0.85, 1.4}) {  // flat, and oblong
    INFO("polar semi-axis " << polar);
    const Eigen::Matrix3d along = axis * axis.transpose();
    const Eigen::Matrix3d A = (Eigen::Matrix3d::Identity() - along + along / polar) / 0.03;
    Ellipsoid truth{Sphere{{0.1, 0.5, 0.2}, 0.03}};
    truth.A = A;
    Cloud cloud;
    Rng rng(4);
    Indices indices;
    while (cloud.size() < 1500) {
      const Eigen::Vector3d p = truth.surface(rng.direction()), n = truth.normal(p);
      if (n.y() > 0.3) continue;  // unseen from behind
      indices.push_back(static_cast<Index>(cloud.size()));
      cloud.points.push_back((p + 0.0003 * rng.normal() * n).cast<float>());
      cloud.normals.push_back(n.cast<float>());
    }
    const auto fit = fit_ellipsoid(cloud, indices, Ellipsoid{Sphere{{0.1, 0.5, 0.2}, 0.031}});
    REQUIRE(fit);
    const BodyAxis round = symmetry_axis(*fit);
    const double off = std::acos(std::min(std::abs(round.direction.dot(axis)), 1.0));
    CHECK(off < deg(4));
    CHECK(off < 4.0 * std::sqrt(round.variance));
    CHECK(round.variance < deg(12) * deg(12));
    const Labels all(cloud.size(), 1);
    CHECK(std::acos(growth_axis(cloud, all, *fit).dot(axis)) < deg(6));
    // Stem points at the wrong place, some 50 degrees off, turn it by a few degrees only.
    Cloud more = cloud;
    Labels labels = all;
    const Eigen::Vector3d wrong = (axis + 1.2 * axis.unitOrthogonal()).normalized();
    for (int i = 0; i < 40; ++i) {
      more.points.push_back((truth.center + (truth.surface(wrong) - truth.center) * (1.02 + 0.01 * i)).cast<float>());
      labels.push_back(0);
    }
    CHECK(std::acos(growth_axis(more, labels, *fit).dot(axis)) < deg(15));
  }
  // A sphere has no such axis.
  EllipsoidFit ball;
  ball.body = Ellipsoid{Sphere{{0, 0, 0}, 0.03}};
  CHECK(!std::isfinite(symmetry_axis(ball).variance));
}
