// SPDX-License-Identifier: BSD-3-Clause
// Trusses are what they are said to be: closed, touching, hidden where asked, the same for the same seed.
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/paper_truss.hpp>
#include <agrisee/study/traced_scene.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include <map>

#include "catch.hpp"
#include "support/meshes.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace truss_test {

namespace {

/// Every edge belongs to exactly two triangles, once in each direction.
bool watertight(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++edges[{t[std::size_t(i)], t[std::size_t((i + 1) % 3)]}];
  for (const auto& [edge, n] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (n != 1 || other == edges.end() || other->second != 1) return false;
  }
  return !edges.empty();
}

/// Share of a fruit's surface seen from a point, by closest hits of rays from the eye to the middle of each triangle,
/// weighted by area.
std::map<int, double> shares_from(const Scene& scene, const Eigen::Vector3d& eye) {
  const TracedScene traced(scene);
  std::map<int, double> out;
  for (const Object& object : scene.objects) {
    if (object.cls != ObjectClass::fruit) continue;
    double seen = 0.0, all = 0.0;
    for (const auto& t : object.mesh.triangles) {
      const Eigen::Vector3d a = object.mesh.vertices[t[0]].cast<double>(),
                            b = object.mesh.vertices[t[1]].cast<double>(),
                            c = object.mesh.vertices[t[2]].cast<double>();
      const Eigen::Vector3d normal = (b - a).cross(c - a), middle = (a + b + c) / 3.0;
      all += normal.norm();
      if (normal.dot(eye - middle) <= 0.0) continue;
      const auto hit = traced.bvh().closest(eye.cast<float>(), (middle - eye).cast<float>());
      if (hit && hit->t > 1.0f - 1e-4f) seen += normal.norm();
    }
    out[object.id] = seen / all;
  }
  return out;
}

void check_truss(const Truss& truss, int total, int hidden, const Eigen::Vector3d& center) {
  REQUIRE(truss.truth.fruits.size() == std::size_t(total));
  std::vector<Bvh> trees;
  int id = 0, hidden_seen = 0;
  const auto shares = shares_from(truss.scene, frontal_eye(center));
  for (const Object& object : truss.scene.objects) {
    if (object.cls != ObjectClass::fruit) continue;
    const TrueFruit& fruit = truss.truth.fruits[std::size_t(id)];
    REQUIRE(object.id == ++id);
    CHECK(fruit.id == id);
    CHECK(watertight(object.mesh));
    CHECK(object.mesh.triangles.size() >= 2000);
    CHECK(object.mesh.triangles.size() <= 4000);
    CHECK(volume(object.mesh) == Approx(fruit.volume).epsilon(1e-4));
    CHECK(fruit.volume == Approx(4.0 / 3.0 * kPi * fruit.radii.prod()).epsilon(0.03));
    const Aabb box = Bvh(object.mesh).bounds();
    CHECK(truss.workcell.scan_volume.contains(box.min));
    CHECK(truss.workcell.scan_volume.contains(box.max));
    // The calyx end is where the axis says: flatter than its opposite.
    REQUIRE(fruit.growth_axis);
    CHECK(fruit.growth_axis->norm() == Approx(1.0));
    CHECK(fruit.growth_axis->z() > 0.0);
    double calyx = 0.0, blossom = 0.0;
    for (const Eigen::Vector3f& v : object.mesh.vertices) {
      calyx = std::max(calyx, (v.cast<double>() - fruit.center).dot(*fruit.growth_axis));
      blossom = std::max(blossom, (fruit.center - v.cast<double>()).dot(*fruit.growth_axis));
    }
    CHECK(calyx < blossom);
    hidden_seen += *fruit.hidden;
    CHECK(shares.at(id) == Approx(*fruit.visible_share).margin(0.02));
    if (*fruit.hidden)
      CHECK(shares.at(id) < 0.15);
    else
      CHECK(shares.at(id) > 0.25);
    trees.emplace_back(object.mesh);
  }
  CHECK(id == total);
  CHECK(hidden_seen == hidden);
  for (int i = 0; i < total; ++i)
    for (int j = 0; j < total; ++j)
      if (i != j) CHECK(shapes::mesh_depth(truss.scene.objects[std::size_t(i)].mesh, trees[std::size_t(j)]) <= 1e-3);
  // Every fruit hangs: the stem comes as near as its calyx.
  const Object& stem = truss.scene.objects[std::size_t(total)];
  CHECK(stem.cls == ObjectClass::stem);
  const Bvh stem_tree(stem.mesh);
  for (const TrueFruit& fruit : truss.truth.fruits) {
    const double polar = 1.0 / (fruit.axes.transpose() * *fruit.growth_axis).cwiseQuotient(fruit.radii).norm();
    const Eigen::Vector3d calyx = fruit.center + 0.9 * polar * *fruit.growth_axis;
    CHECK(stem_tree.nearest(calyx.cast<float>())->distance < 0.12 * fruit.radii[0]);
  }
}

bool equal(const Truss& a, const Truss& b) {
  if (a.scene.objects.size() != b.scene.objects.size()) return false;
  for (std::size_t i = 0; i < a.scene.objects.size(); ++i)
    if (a.scene.objects[i].mesh.vertices != b.scene.objects[i].mesh.vertices ||
        a.scene.objects[i].mesh.triangles != b.scene.objects[i].mesh.triangles)
      return false;
  return true;
}

}  // namespace

TEST_CASE("fruit, tube, calyx and leaf meshes") {
  FruitShape ball;
  ball.equatorial = ball.polar = 0.04;
  ball.lobe_amplitude = ball.dimple_depth = 0.0;
  CHECK(watertight(fruit_mesh(ball)));
  CHECK(watertight(fruit_mesh(ball, 3, 2)));
  CHECK(volume(fruit_mesh(ball, 200, 100)) == Approx(4.0 / 3.0 * kPi * 6.4e-5).epsilon(1e-3));
  FruitShape tomato;
  const Mesh mesh = fruit_mesh(tomato);
  CHECK(watertight(mesh));
  CHECK(volume(mesh) > 0.0);
  for (const Eigen::Vector3f& v : mesh.vertices) CHECK(double(v.norm()) <= tomato.max_radius() + 1e-7);
  CHECK_THROWS_AS(fruit_mesh(tomato, 2, 9), ParameterError);

  const Mesh tube = tube_mesh({{0, 0, 0}, {0, 0, 0}, {0, 0, 0.1}, {0.1, 0, 0.1}}, 0.003, 0.003, 64);
  CHECK(watertight(tube));
  CHECK(volume(tube_mesh({{0, 0, 0}, {0, 0, 0.1}}, 0.003, 0.003, 64)) == Approx(kPi * 9e-7).epsilon(0.01));
  CHECK_THROWS_AS(tube_mesh({{1, 1, 1}, {1, 1, 1}}, 0.003, 0.003), InputError);
  CHECK(area(calyx_mesh(tomato, 5, 0.02, 0.004, 0.0)) > 5 * 0.02 * 0.002);
  CHECK(area(leaf_mesh(0.08, 0.04, 0.3, 0.01)) > 0.4 * 0.08 * 0.04);
}

TEST_CASE("trusses of all kinds are as asked") {
  struct Case {
    int total, hidden, leaflets;
    double radius_min, radius_max;
  };
  const auto c = GENERATE(values<Case>({{1, 0, 0, 0.028, 0.042},
                                        {2, 1, 0, 0.028, 0.042},
                                        {5, 1, 2, 0.028, 0.042},
                                        {7, 1, 0, 0.028, 0.042},
                                        {7, 3, 3, 0.028, 0.042},
                                        {9, 4, 0, 0.012, 0.016},
                                        {6, 2, 1, 0.035, 0.055},
                                        {12, 0, 0, 0.028, 0.042},
                                        {12, 6, 6, 0.028, 0.042}}));
  for (const unsigned seed : {1u, 7u}) {
    TrussParameters parameters;
    parameters.total = c.total;
    parameters.hidden = c.hidden;
    parameters.leaflets = c.leaflets;
    parameters.radius_min = c.radius_min;
    parameters.radius_max = c.radius_max;
    parameters.seed = seed;
    INFO(c.total << " " << c.hidden << " " << seed);
    const Truss truss = make_truss(parameters);
    check_truss(truss, c.total, c.hidden, parameters.center);
    CHECK(truss.scene.objects.size() == std::size_t(c.total + 1 + c.leaflets));
    for (const TrueFruit& fruit : truss.truth.fruits) {
      CHECK(fruit.radii[0] <= c.radius_max);
      CHECK(fruit.radii[2] >= 0.97 * c.radius_min);  // less the dimple
    }
  }
}

TEST_CASE("trusses depend on their seed and on nothing else") {
  TrussParameters parameters;
  parameters.leaflets = 2;
  const Truss a = make_truss(parameters);
  CHECK(equal(a, make_truss(parameters)));
  parameters.seed = 2;
  CHECK_FALSE(equal(a, make_truss(parameters)));
  CHECK(*a.truth.fruits[0].growth_axis != *make_truss(parameters).truth.fruits[0].growth_axis);
}

TEST_CASE("fruit of a truss touch") {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    TrussParameters parameters;
    parameters.seed = seed;
    parameters.hidden = 3;
    const Truss truss = make_truss(parameters);
    int contacts = 0;
    for (int i = 0; i < 7; ++i) {
      const Bvh tree(truss.scene.objects[std::size_t(i)].mesh);
      for (int j = 0; j < i; ++j) {
        float nearest = 1.0f;
        for (const auto& v : truss.scene.objects[std::size_t(j)].mesh.vertices)
          if (const auto on = tree.nearest(v, nearest)) nearest = on->distance;
        contacts += nearest < 0.0015f;
      }
    }
    CHECK(contacts >= 4);
  }
}

TEST_CASE("elongated fruit are longer along their growth axis, and still hang as asked") {
  TrussParameters parameters;
  parameters.total = 8;
  parameters.hidden = 2;
  parameters.radius_min = 0.018;
  parameters.radius_max = 0.022;
  parameters.elongation = 1.5;
  const Truss truss = make_truss(parameters);
  check_truss(truss, 8, 2, parameters.center);
  for (const TrueFruit& fruit : truss.truth.fruits) {
    CHECK(fruit.radii[0] > 1.25 * fruit.radii[1]);
    REQUIRE(fruit.growth_axis);
    CHECK(std::abs(fruit.axes.col(0).dot(*fruit.growth_axis)) > 0.97);
  }
}

TEST_CASE("impossible trusses are refused by name") {
  const auto refuses = [](auto change, const char* field) {
    TrussParameters parameters;
    change(parameters);
    std::string said;
    try {
      make_truss(parameters);
    } catch (const ParameterError& error) {
      said = error.what();
    }
    CHECK(said.find(field) == 0);
  };
  refuses([](TrussParameters& p) { p.total = 0; }, "total");
  refuses([](TrussParameters& p) { p.total = 13; }, "total");
  refuses([](TrussParameters& p) { p.hidden = 4; }, "hidden");
  refuses([](TrussParameters& p) { p.hidden = -1; }, "hidden");
  refuses([](TrussParameters& p) { p.radius_min = 0.0; }, "radius_min");
  refuses([](TrussParameters& p) { p.radius_max = 0.02; }, "radius_max");
  refuses([](TrussParameters& p) { p.radius_max = std::nan(""); }, "radius_max");
  refuses([](TrussParameters& p) { p.leaflets = 7; }, "leaflets");
  refuses([](TrussParameters& p) { p.elongation = 2.5; }, "elongation");
  refuses([](TrussParameters& p) { p.elongation = std::nan(""); }, "elongation");
  refuses([](TrussParameters& p) { p.center.y() = std::nan(""); }, "center");
  CHECK_THROWS_AS(make_paper_truss(7, 0), ParameterError);
}

TEST_CASE("the paper's trusses") {
  int leafy = 0;
  for (const PaperTruss& p : kPaperTrusses) {
    INFO(p.total << " " << p.hidden);
    const Truss truss = make_paper_truss(p.total, p.hidden);
    check_truss(truss, p.total, p.hidden, TrussParameters().center);
    leafy += truss.scene.objects.back().cls == ObjectClass::leaf;
  }
  CHECK(leafy >= 3);
  const Truss truss = make_paper_truss(7, 1);
  const Eigen::Vector3d table[] = {{0.060, 0.519, 0.154},  {-0.023, 0.521, 0.154}, {0.064, 0.555, 0.238},
                                   {-0.033, 0.550, 0.236}, {0.060, 0.577, 0.318},  {-0.035, 0.573, 0.331}};
  for (int i = 0; i < 6; ++i) CHECK((truss.truth.fruits[std::size_t(i)].center - table[i]).norm() < 0.005);
  CHECK(*truss.truth.fruits[6].hidden);
}

}  // namespace truss_test
