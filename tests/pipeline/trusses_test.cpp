// SPDX-License-Identifier: BSD-3-Clause
// Which fruit hang on one truss, how they are numbered, and the frames of their trusses.
#include <agrisee/process.hpp>
#include <agrisee/trusses.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

Fruit fruit_at(const Eigen::Vector3d& center, double radius = 0.035) {
  Fruit f;
  f.body.emplace();
  f.body->center = center;
  f.body->radii.setConstant(radius);
  return f;
}

/// Two trusses side by side, their fruit at alternating heights.
std::vector<Sphere> two_trusses() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 3; ++i) {
    spheres.push_back({{-0.13, 0.5, 0.30 - 0.075 * i}, 0.035});
    spheres.push_back({{0.13, 0.5, 0.27 - 0.075 * i}, 0.035});
  }
  return spheres;
}

}  // namespace

TEST_CASE("fruit are on one truss by way of others, as far as the gap reaches") {
  // Gaps of 40 mm and of 60 mm; the limit is 1.5 radii, 52.5 mm.
  const std::vector<Fruit> row = {fruit_at({0, 0, 0.33}), fruit_at({0, 0, 0.0}), fruit_at({0, 0, 0.22}),
                                  fruit_at({0, 0, 0.11}), fruit_at({0, 0.13, 0.33})};
  CHECK(trusses_of(row, 1.5) == std::vector<int>{0, 0, 0, 0, 1});
  CHECK(trusses_of(row, 2.0) == std::vector<int>{0, 0, 0, 0, 0});
  CHECK(trusses_of(row, 0.0) == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(trusses_of({}, 1.5).empty());
}

TEST_CASE("two trusses in one volume are numbered one after the other") {
  Cloud cloud;
  for (const Sphere& s : two_trusses())
    test::add_sphere(cloud, s, 0.0024, [](const Eigen::Vector3d& d) { return d.y() < 0.3; });
  const ScanResult result = process(cloud);
  REQUIRE(result.fruits.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) {
    const Fruit& f = result.fruits[i];
    CHECK(f.id == static_cast<int>(i) + 1);
    CHECK(f.truss == (i < 3 ? 1 : 2));
    CHECK((f.position() - Eigen::Vector3d(i < 3 ? -0.13 : 0.13, 0.5, (i < 3 ? 0.30 : 0.27) - 0.075 * double(i % 3)))
              .norm() < 0.002);
  }
  // The labels of the points follow the numbers.
  for (std::size_t p = 0; p < result.cloud.size(); ++p) {
    const int id = result.labels[p];
    if (id == 0) continue;
    CHECK((result.cloud.points[p].cast<double>() - result.fruits[std::size_t(id - 1)].position()).norm() < 0.04);
  }
  REQUIRE(result.trusses.size() == 2);
  for (std::size_t t = 0; t < 2; ++t) {
    const FoundTruss& truss = result.trusses[t];
    CHECK(truss.id == static_cast<int>(t) + 1);
    CHECK(truss.fruits == (t == 0 ? std::vector<int>{1, 2, 3} : std::vector<int>{4, 5, 6}));
    CHECK((truss.world_T_truss.translation() - Eigen::Vector3d(t == 0 ? -0.13 : 0.13, 0.5, t == 0 ? 0.225 : 0.195))
              .norm() < 0.002);
    CHECK(truss.world_T_truss.linear().col(2).z() > 0.999);  // strung upwards
    CHECK(truss.world_T_truss.linear().col(0).x() > 0.999);
  }
}

TEST_CASE("the growth frame follows the fruit's string, or their growth axes where they form none") {
  std::vector<Fruit> fruits;
  for (int i = 0; i < 4; ++i)
    fruits.push_back(fruit_at(Eigen::Vector3d(0.3, 0.5, 0.1) - 0.06 * i * Eigen::Vector3d(0.6, 0, 0.8)));
  const Eigen::Vector3d z = found_trusses(fruits).at(0).world_T_truss.linear().col(2);
  CHECK((z - Eigen::Vector3d(0.6, 0, 0.8)).norm() < 1e-9);
  fruits.resize(2);
  for (Fruit& f : fruits)  // their z axis is tilted by 30 degrees
    f.orientation = Eigen::AngleAxisd(deg(30), Eigen::Vector3d::UnitX()).toRotationMatrix();
  const FoundTruss two = found_trusses(fruits).at(0);
  CHECK((two.world_T_truss.linear().col(2) - fruits[0].orientation.col(2)).norm() < 1e-9);
  CHECK(is_rigid(two.world_T_truss));
  CHECK(found_trusses({}).empty());
}
