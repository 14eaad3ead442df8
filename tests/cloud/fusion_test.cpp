// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/merge.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/sphere_voting.hpp>
#include <agrisee/cloud/surfels.hpp>
#include <agrisee/cloud/voxel.hpp>

#include <numeric>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("surfels average what was measured of one place by inverse variance") {
  SurfelMap map;
  const Eigen::Vector3f n(0, 0, 1);
  CHECK(map.add({0, 0, 0.0000f}, n, 0.001f, 0));
  CHECK_FALSE(map.add({0.0005f, 0, 0.0010f}, n, 0.001f, 1));  // within the separation: along the normal only
  REQUIRE(map.size() == 1);
  CHECK(map.surfels()[0].position.z() == Approx(0.0005f));
  CHECK(map.surfels()[0].position.x() == 0.0f);
  CHECK(map.surfels()[0].seen_by == 2);
  CHECK(map.surfels()[0].sigma() == Approx(0.001 / std::sqrt(2.0)));
  CHECK(map.add({0.003f, 0, 0}, n, 0.001f, 1));    // beside it
  CHECK(map.add({0, 0, 0.0005f}, -n, 0.001f, 1));  // the other side of a leaf
  CHECK(map.add({0, 0, 0.02f}, n, 0.001f, 1));     // far behind
  CHECK_FALSE(map.add({0, 0, std::nanf("")}, n, 0.001f, 1));
  CHECK_FALSE(map.add({0.1f, 0, 0}, n, 0.0f, 1));
  CHECK(map.size() == 4);
}

TEST_CASE("surfels of one surface keep their separation however often it is seen") {
  SurfelMap map;
  Rng rng(3);
  for (int view = 0; view < 5; ++view)
    for (int i = 0; i < 4000; ++i)
      map.add({static_cast<float>(rng.uniform(0, 0.05)), static_cast<float>(rng.uniform(0, 0.05)),
               static_cast<float>(0.0003 * rng.normal())},
              {0, 0, 1}, 0.0003f, view);
  const double separation = SurfelParameters{}.separation;
  const auto& s = map.surfels();
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) REQUIRE((s[i].position - s[j].position).head<2>().norm() > 0.95 * separation);
  double mean = 0.0;
  for (const auto& q : s) mean += std::abs(double(q.position.z())) / double(s.size());
  CHECK(mean < 0.0002);
}

TEST_CASE("merging by minimum separation keeps the first") {
  SeparatedCloud merged(0.01);
  CHECK(merged.add({0, 0, 0}, 0));
  CHECK_FALSE(merged.add({0.009f, 0, 0}, 1));
  CHECK(merged.add({0.011f, 0, 0}, 1));
  CHECK_FALSE(merged.add({std::nanf(""), 0, 0}, 1));
  merged.keep({1});
  CHECK(merged.cloud().size() == 1);
  CHECK(merged.add({0, 0, 0}, 2));
  CHECK(merged.cloud().views == std::vector<int>{1, 2});
  CHECK_THROWS_AS(SeparatedCloud(0.0), ParameterError);
}

TEST_CASE("voxels hold the mean of their points") {
  Cloud cloud;
  cloud.points = {{0.1f, 0.1f, 0.1f}, {0.3f, 0.1f, 0.1f}, {-0.1f, 0.1f, 0.1f}, {std::nanf(""), 0, 0}, {5, 5, 5}};
  std::vector<int> members;
  const Cloud thin = average_in_voxels(cloud, 1.0, &members);
  REQUIRE(thin.size() == 3);
  CHECK(thin.points[0].x() == Approx(-0.1f));
  CHECK(thin.points[1].x() == Approx(0.2f));
  CHECK(members == std::vector<int>{1, 2, 1});
  CHECK_THROWS_AS(average_in_voxels(cloud, 0.0), ParameterError);
  CHECK(average_in_voxels(Cloud{}, 1.0).empty());
}

TEST_CASE("the spacing of a cloud is the side of the square that a point stands for") {
  Cloud plane;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      plane.points.emplace_back(0.002f * static_cast<float>(x), 0.002f * static_cast<float>(y), 0.0f);
  CHECK(estimate_spacing(plane) == Approx(0.002).epsilon(0.2));
  CHECK(estimate_spacing(Cloud{}) == 0.0);
  plane.points = {{0, 0, 0}, {1, 0, 0}, {1e30f, 0, 0}};  // its squared distances overflow
  CHECK(estimate_spacing(plane) == Approx(std::sqrt(kPi / 2.0)));
}

TEST_CASE("votes of a part of a sphere meet at its centre") {
  Cloud cloud;
  const Sphere truth{{0.2, -0.1, 0.4}, 0.037};
  test::add_sphere(
      cloud, truth, 0.003, [](const Eigen::Vector3d& d) { return d.x() > 0.6; }, 0.0003);
  const auto centers = vote_for_centers(cloud, 0.02, 0.05, 20);
  REQUIRE_FALSE(centers.empty());
  CHECK((centers[0].center - truth.center).norm() < 0.004);
  CHECK(vote_for_centers(Cloud{}, 0.02, 0.05, 20).empty());
  CHECK_THROWS_AS(vote_for_centers(cloud, 0.0, 0.05, 20), ParameterError);
  CHECK_THROWS_AS(vote_for_centers(cloud, 0.05, 0.02, 20), ParameterError);
}

TEST_CASE("centroid and deviation by hand") {
  Cloud cloud;
  cloud.points = {{1, 2, 3}, {3, 2, 1}, {100, 100, 100}};
  const Centroid c = centroid(cloud, {0, 1});
  CHECK((c.mean - Eigen::Vector3d(2, 2, 2)).norm() < 1e-12);
  CHECK((c.sigma - Eigen::Vector3d(1, 0, 1)).norm() < 1e-12);
  CHECK(centroid(cloud, {}).mean.norm() == 0.0);
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
