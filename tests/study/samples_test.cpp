// SPDX-License-Identifier: BSD-3-Clause
// MeshMoments, samples, visibility and matching against closed forms and brute force.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/matching.hpp>
#include <agrisee/study/mesh_moments.hpp>
#include <agrisee/study/truss_mesh.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>
#include <numeric>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

Mesh ellipsoid(const Eigen::Vector3d& radii, const Pose& pose) {
  FruitShape ball;
  ball.equatorial = ball.polar = 1.0;
  ball.lobe_amplitude = ball.dimple_depth = 0.0;
  Mesh mesh = fruit_mesh(ball, 96, 64);
  for (Eigen::Vector3f& v : mesh.vertices) v = v.cwiseProduct(radii.cast<float>());
  return transformed(mesh, pose);
}

double best_by_trying(const Eigen::MatrixXd& score) {
  const Eigen::MatrixXd s = score.rows() <= score.cols() ? score : Eigen::MatrixXd(score.transpose());
  std::vector<int> order(std::size_t(s.cols()));
  std::iota(order.begin(), order.end(), 0);
  double best = 0.0;
  do {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < s.rows(); ++i) sum += std::max(0.0, s(i, order[std::size_t(i)]));
    best = std::max(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

}  // namespace

TEST_CASE("moments of ellipsoids") {
  const Pose pose = pose_from_xyz_rpy({0.3, -0.2, 0.7}, {0.4, 0.9, -1.2});
  const Eigen::Vector3d radii(0.03, 0.05, 0.04);
  Mesh mesh = ellipsoid(radii, pose);
  for (const bool inside_out : {false, true}) {
    if (inside_out)
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    const MeshMoments m = mesh_moments(mesh);
    CHECK(m.closed);
    CHECK(m.volume == Approx(4.0 / 3.0 * kPi * radii.prod()).epsilon(0.003));
    CHECK((m.center - pose.translation()).norm() < 1e-6);
    CHECK((m.radii - Eigen::Vector3d(0.05, 0.04, 0.03)).norm() < 1e-4);
    CHECK(std::abs(m.axes.col(0).dot(pose.linear().col(1))) > 0.9999);
    CHECK(std::abs(m.axes.col(2).dot(pose.linear().col(0))) > 0.9999);
    CHECK(m.axes.determinant() == Approx(1.0));
  }
  SECTION("a mesh with a hole falls back to its surface") {
    mesh.triangles.resize(mesh.triangles.size() * 3 / 4);
    const MeshMoments m = mesh_moments(mesh);
    CHECK_FALSE(m.closed);
    CHECK(m.volume == 0.0);
    CHECK((m.center - pose.translation()).norm() < 0.03);
    CHECK(m.radii[0] > 0.03);
    CHECK(m.radii[0] < 0.07);
  }
  SECTION("what has no area is refused") {
    CHECK_THROWS_AS(mesh_moments(Mesh{}), InputError);
    CHECK_THROWS_AS(mesh_moments(Mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}), InputError);
    CHECK_THROWS_AS(mesh_moments(Mesh{{{0, 0, 0}}, {{0, 1, 2}}}), InputError);
    CHECK_THROWS_AS(mesh_moments(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, std::nanf(""), 0}}, {{0, 1, 2}}}), InputError);
  }
}

TEST_CASE("ground truth of a scene refuses ids that are no ids") {
  const Mesh mesh = ellipsoid({0.03, 0.03, 0.03}, Pose::Identity());
  CHECK_THROWS_AS(ground_truth(Scene{{{0, ObjectClass::fruit, mesh}}}), InputError);
  CHECK_THROWS_AS(ground_truth(Scene{{{2, ObjectClass::fruit, mesh}, {2, ObjectClass::fruit, mesh}}}), InputError);
  CHECK(ground_truth(Scene{{{0, ObjectClass::stem, mesh}}}).fruits.empty());
}

TEST_CASE("samples are one per 10 mm2, even, on the surface and facing out") {
  const Eigen::Vector3d center(0.1, 0.5, 0.2);
  Mesh mesh = ellipsoid({0.035, 0.035, 0.035}, pose_from_xyz_rpy(center, {0, 0, 0}));
  if (GENERATE(false, true))
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const Samples samples = fruit_samples(Scene{{{0, ObjectClass::stem, mesh}, {5, ObjectClass::fruit, mesh}}});
  CHECK(double(samples.size()) == Approx(area(mesh) / 1e-5).margin(1.0));
  const Bvh tree(mesh);
  int octant[8] = {};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d d = samples.points[i].cast<double>() - center;
    CHECK(tree.nearest(samples.points[i])->distance < 1e-6f);
    CHECK(double(samples.normals[i].cast<double>().dot(d.normalized())) > 0.99);
    CHECK(samples.fruit[i] == 5);
    ++octant[(d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0)];
  }
  for (const int n : octant) CHECK(double(n) == Approx(double(samples.size()) / 8).epsilon(0.05));
  const Samples again = fruit_samples(Scene{{{5, ObjectClass::fruit, mesh}}});
  CHECK(again.points == samples.points);
  SampleParameters other;
  other.seed = 2;
  CHECK(fruit_samples(Scene{{{5, ObjectClass::fruit, mesh}}}, other).points != samples.points);
  other.area = 0.0;
  CHECK_THROWS_AS(fruit_samples(Scene{{{5, ObjectClass::fruit, mesh}}}, other), ParameterError);
  other.area = 10.0;
  CHECK(fruit_samples(Scene{{{5, ObjectClass::fruit, mesh}}}, other).size() == 1);
}

TEST_CASE("the visible cap of a ball has the area that geometry gives") {
  const double r = 0.035, d = 0.38;
  const Mesh ball = ellipsoid({r, r, r}, Pose::Identity());
  const Scene scene{{{1, ObjectClass::fruit, ball}}};
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  const Eigen::Vector3d eye(0, -d, 0);
  CHECK(share(samples, visible_from(traced, samples, eye), 1) == Approx(0.5 * (1.0 - r / d)).margin(0.01));
  // Incidence i at the angle theta from the axis: d sin(i - theta) = r sin i.
  const double theta = deg(80) - std::asin(r / d * std::sin(deg(80)));
  const Flags steep = visible_from(traced, samples, eye, deg(80));
  CHECK(share(samples, steep, 1) == Approx(0.5 * (1.0 - std::cos(theta))).margin(0.01));
  CHECK(share(samples, steep, 2) == 0.0);
  // The sensor sees the same as long as it looks there and is in range.
  const sensor::DepthCamera l515 = sensor::l515();
  CHECK(visible_to(traced, samples, look_along(eye, {0, 1, 0}), l515) == steep);
  CHECK(visible_to(traced, samples, look_along(eye, {0, 1, 0}), l515, 3) == steep);
  CHECK(share(samples, visible_to(traced, samples, look_along(eye, {0, -1, 0}), l515), 1) == 0.0);
  CHECK(share(samples, visible_to(traced, samples, look_along({0, -0.2, 0}, {0, 1, 0}), l515), 1) == 0.0);
  // Half of the cap is in the image when its border passes through the middle.
  const double half =
      share(samples, visible_to(traced, samples, look_along(eye, {std::sin(deg(35)), std::cos(deg(35)), 0}), l515), 1);
  CHECK(half == Approx(0.5 * share(samples, steep, 1)).margin(0.01));
  // Another ball in front hides it.
  const Scene two{{{1, ObjectClass::fruit, ball},
                   {2, ObjectClass::fruit, ellipsoid({r, r, r}, pose_from_xyz_rpy({0, -2 * r, 0}, {0, 0, 0}))}}};
  const Samples of_two = fruit_samples(two);
  CHECK(share(of_two, visible_from(TracedScene(two), of_two, eye), 1) == 0.0);
}

TEST_CASE("matching is one to one and the best of all") {
  Rng rng(3);
  for (int round = 0; round < 300; ++round) {
    const auto rows = Eigen::Index(1 + rng.below(6)), cols = Eigen::Index(1 + rng.below(6));
    Eigen::MatrixXd score(rows, cols);
    for (Eigen::Index i = 0; i < score.size(); ++i)
      score.data()[i] = rng.uniform() < 0.3 ? 0.0 : round % 3 ? rng.uniform(-0.2, 1.0) : double(rng.below(3));
    const std::vector<int> match = best_matching(score);
    REQUIRE(match.size() == std::size_t(rows));
    double sum = 0.0;
    std::vector<int> used;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const int j = match[std::size_t(i)];
      if (j < 0) continue;
      REQUIRE(score(i, j) > 0.0);
      REQUIRE(std::count(used.begin(), used.end(), j) == 0);
      used.push_back(j);
      sum += score(i, j);
    }
    REQUIRE(sum == Approx(best_by_trying(score)).margin(1e-12));
  }
  CHECK(best_matching(Eigen::MatrixXd(0, 3)).empty());
  CHECK(best_matching(Eigen::MatrixXd(2, 0)) == std::vector<int>{-1, -1});
  CHECK(best_matching(Eigen::MatrixXd::Zero(2, 2)) == std::vector<int>{-1, -1});
  CHECK_THROWS_AS(best_matching(Eigen::MatrixXd::Constant(2, 2, std::nan(""))), InputError);
  // The greedy choice (0.9 + 0.1) loses to 0.8 + 0.8.
  Eigen::MatrixXd trap(2, 2);
  trap << 0.9, 0.8, 0.8, 0.1;
  CHECK(best_matching(trap) == std::vector<int>{1, 0});
}
