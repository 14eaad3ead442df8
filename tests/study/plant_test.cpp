// SPDX-License-Identifier: BSD-3-Clause
// Plants are what they are said to be: fruit that shrink and do not meet, leaves that hide as much as asked, nothing
// that floats or passes through a fruit, and a scene that can be written and read.
#include <agrisee/arm/collision.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/mesh_moments.hpp>
#include <agrisee/study/plant.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <map>

#include "../io/io_support.hpp"
#include "catch.hpp"
#include "support/meshes.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

/// Every edge belongs to as many triangles in one direction as in the other.
bool watertight(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  for (const auto& edge : edges)
    if (edge.second != 0) return false;
  return !edges.empty();
}

/// Whether an edge of a mesh passes through a surface.
bool meets(const Mesh& mesh, const Bvh& surface) {
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      if (surface.any(a, b - a, 0.0f, 1.0f)) return true;
    }
  return false;
}

/// Fruit area that the front sees: rays from the eye to the middle of each triangle. (with leaves, without leaves)
std::pair<double, double> seen_area(const Scene& scene, const Eigen::Vector3d& eye) {
  Scene bare;
  for (const Object& object : scene.objects)
    if (object.cls != ObjectClass::leaf) bare.objects.push_back(object);
  const TracedScene all(scene), without(bare);
  double with_leaves = 0.0, without_leaves = 0.0;
  for (const Object& object : scene.objects) {
    if (object.cls != ObjectClass::fruit) continue;
    for (const auto& t : object.mesh.triangles) {
      const Eigen::Vector3d a = object.mesh.vertices[t[0]].cast<double>(),
                            b = object.mesh.vertices[t[1]].cast<double>(),
                            c = object.mesh.vertices[t[2]].cast<double>();
      const Eigen::Vector3d normal = (b - a).cross(c - a), middle = (a + b + c) / 3.0;
      if (normal.dot(eye - middle) <= 0.0) continue;
      const auto open = [&](const TracedScene& traced) {
        const auto hit = traced.bvh().closest(eye.cast<float>(), (middle - eye).cast<float>());
        return hit && hit->t > 1.0f - 1e-4f;
      };
      if (open(all)) with_leaves += normal.norm();
      if (open(without)) without_leaves += normal.norm();
    }
  }
  return {with_leaves, without_leaves};
}

/// The first object of a class; the meshes of all of them are joined.
Mesh joined(const Scene& scene, ObjectClass cls) {
  Mesh mesh;
  for (const Object& object : scene.objects)
    if (object.cls == cls) append(mesh, object.mesh);
  return mesh;
}

int count(const Scene& scene, ObjectClass cls) {
  int n = 0;
  for (const Object& object : scene.objects) n += object.cls == cls;
  return n;
}

void check_plant(const Plant& plant, const PlantParameters& parameters) {
  const auto total = static_cast<std::size_t>(parameters.total);
  REQUIRE(plant.truth.fruits.size() == total);
  REQUIRE(count(plant.scene, ObjectClass::fruit) == parameters.total);
  const Mesh stems = joined(plant.scene, ObjectClass::stem), leaves = joined(plant.scene, ObjectClass::leaf);
  const Mesh others = joined(plant.scene, ObjectClass::other);
  const Bvh stem_tree(stems);
  std::vector<Bvh> trees;
  Aabb box;
  for (std::size_t i = 0; i < plant.scene.objects.size(); ++i) {
    const Object& object = plant.scene.objects[i];
    CHECK((object.cls == ObjectClass::fruit) == (i < total));
    CHECK(object.id == (i < total ? int(i) + 1 : 0));
    if (i >= total) continue;
    const TrueFruit& truth = plant.truth.fruits[i];
    CHECK(truth.id == object.id);
    CHECK(watertight(object.mesh));
    CHECK(volume(object.mesh) > 0.0);
    CHECK(volume(object.mesh) == Approx(truth.volume).epsilon(1e-4));
    CHECK((truth.radii - mesh_moments(object.mesh).radii).norm() < 1e-9);
    trees.emplace_back(object.mesh);
    const Aabb bounds = trees.back().bounds();
    box.extend(bounds.min);
    box.extend(bounds.max);
    CHECK(plant.workcell.scan_volume.contains(bounds.min));
    CHECK(plant.workcell.scan_volume.contains(bounds.max));
    REQUIRE(truth.growth_axis);
    CHECK(truth.growth_axis->z() > 0.0);
    CHECK(*truth.hidden == (*truth.visible_share < kHiddenBelow));
    // It hangs: its pedicel starts at the surface, and only there does the stem reach into it.
    const float top = trees.back().closest(truth.center.cast<float>(), truth.growth_axis->cast<float>())->t;
    const Eigen::Vector3d calyx = truth.center + double(top) * *truth.growth_axis;
    CHECK(stem_tree.nearest(calyx.cast<float>())->distance < 0.004f);
    CHECK(shapes::mesh_depth(stems, trees.back()) < 0.004);
    CHECK(shapes::mesh_depth(leaves, trees.back()) < 1e-4);
    CHECK(shapes::mesh_depth(others, trees.back()) == 0.0);
  }
  CHECK((box.center() - parameters.center).norm() < 2e-3);
  for (std::size_t i = 0; i < total; ++i)
    for (std::size_t j = 0; j < total; ++j)
      if (i != j) CHECK(shapes::mesh_depth(plant.scene.objects[i].mesh, trees[j]) <= 1e-3);
  // No leaf floats: each grows out of a stem.
  for (const Object& object : plant.scene.objects) {
    if (object.cls != ObjectClass::leaf) continue;
    CHECK(watertight(object.mesh));
    CHECK(volume(object.mesh) > 0.0);
    CHECK(meets(object.mesh, stem_tree));
  }
  const auto [with_leaves, without_leaves] = seen_area(plant.scene, frontal_eye(parameters.center));
  CHECK(1.0 - with_leaves / without_leaves == Approx(plant.foliage).margin(0.02));
  CHECK(plant.foliage == Approx(parameters.foliage).margin(0.05));
}

/// A plant whose generation does not take long.
PlantParameters small_plant(const std::string& kind = "tomato") {
  PlantParameters parameters = PlantParameters::of(kind);
  parameters.total = 4;
  parameters.leaves_behind = 1;
  return parameters;
}

bool equal(const Plant& a, const Plant& b) {
  if (a.scene.objects.size() != b.scene.objects.size() || a.foliage != b.foliage) return false;
  for (std::size_t i = 0; i < a.scene.objects.size(); ++i)
    if (a.scene.objects[i].mesh.vertices != b.scene.objects[i].mesh.vertices ||
        a.scene.objects[i].mesh.triangles != b.scene.objects[i].mesh.triangles)
      return false;
  return true;
}

}  // namespace

TEST_CASE("plants of all kinds are as asked") {
  const std::string kind = GENERATE(from_range(kPlantKinds.begin(), kPlantKinds.end()));
  for (const unsigned seed : {1u, 2u}) {
    INFO(kind << " " << seed);
    PlantParameters parameters = PlantParameters::of(kind);
    parameters.seed = seed;
    parameters.foliage = seed == 1 ? 0.15 : 0.35;
    Plant plant = make_plant(parameters);
    plant.workcell.name = kind;
    check_plant(plant, parameters);
    CHECK(count(plant.scene, ObjectClass::stem) == 1);
    CHECK(count(plant.scene, ObjectClass::other) == (kind == "strawberry" ? 1 : 0));  // its trough
    CHECK(count(plant.scene, ObjectClass::leaf) > 0);

    const test::TempFolder folder;
    io::write_scene(folder / "scene.yaml", {plant.workcell, plant.scene, {}});
    io::write_ground_truth(folder / "ground_truth.json", plant.truth);
    const io::SceneFile read = io::read_scene(folder / "scene.yaml");
    REQUIRE(read.scene.objects.size() == plant.scene.objects.size());
    for (std::size_t i = 0; i < read.scene.objects.size(); ++i) {
      CHECK(read.scene.objects[i].id == plant.scene.objects[i].id);
      CHECK(read.scene.objects[i].cls == plant.scene.objects[i].cls);
      CHECK(area(read.scene.objects[i].mesh) == Approx(area(plant.scene.objects[i].mesh)));
    }
    CHECK(io::read_ground_truth(folder / "ground_truth.json")->fruits.size() == plant.truth.fruits.size());
  }
}

TEST_CASE("the fruit of a plant shrink from the shoulder of a truss to its tip") {
  for (const char* kind : {"tomato", "cherry", "beefsteak", "strawberry"}) {
    INFO(kind);
    PlantParameters parameters = PlantParameters::of(kind);
    parameters.foliage = 0.0;
    parameters.leaves_behind = 0;
    const Plant plant = make_plant(parameters);
    CHECK(count(plant.scene, ObjectClass::leaf) == 0);
    CHECK(plant.foliage == 0.0);
    const std::vector<TrueFruit>& fruits = plant.truth.fruits;
    for (std::size_t i = 1; i < fruits.size(); ++i) CHECK(fruits[i].volume < 1.02 * fruits[i - 1].volume);
    // Fruit of one plant have one shape, so their volumes are as the cubes of their half widths.
    const double ratio = std::cbrt(fruits.front().volume / fruits.back().volume);
    CHECK(ratio == Approx(parameters.radius_shoulder / parameters.radius_tip).epsilon(0.05));
    CHECK(fruits.front().center.z() > fruits.back().center.z());
  }
  const PlantParameters tomato = PlantParameters::of("tomato");
  CHECK(tomato.radius_shoulder == 0.036);
  CHECK(tomato.radius_tip == 0.010);
}

TEST_CASE("the kinds have their shapes") {
  const auto truth_of = [](const char* kind) {
    PlantParameters parameters = small_plant(kind);
    parameters.foliage = 0.0;
    parameters.leaves_behind = 0;
    return make_plant(parameters).truth.fruits;
  };
  for (const TrueFruit& fruit : truth_of("beefsteak")) {  // flat: the shortest axis is the growth axis
    CHECK(fruit.radii[2] < 0.85 * fruit.radii[1]);
    CHECK(std::abs(fruit.axes.col(2).dot(*fruit.growth_axis)) > 0.97);
  }
  for (const TrueFruit& fruit : truth_of("apple")) CHECK(fruit.radii[2] > 0.8 * fruit.radii[0]);  // nearly round
  for (const char* kind : {"pear", "strawberry"})  // long: the longest axis is the growth axis
    for (const TrueFruit& fruit : truth_of(kind)) {
      CHECK(fruit.radii[0] > 1.05 * fruit.radii[1]);
      CHECK(std::abs(fruit.axes.col(0).dot(*fruit.growth_axis)) > 0.97);
    }
  // Around its growth axis, a pepper has three or four lobes.
  PlantParameters parameters = small_plant("pepper");
  parameters.foliage = 0.0;
  const Plant plant = make_plant(parameters);
  for (std::size_t i = 0; i < plant.truth.fruits.size(); ++i) {
    const TrueFruit& fruit = plant.truth.fruits[i];
    const Eigen::Vector3d z = *fruit.growth_axis, x = any_orthogonal(z), y = z.cross(x);
    const Bvh tree(plant.scene.objects[i].mesh);
    std::vector<double> radius;
    for (int k = 0; k < 72; ++k) {
      const double angle = kTwoPi * k / 72.0;
      const Eigen::Vector3d d = std::cos(angle) * x + std::sin(angle) * y;
      radius.push_back(double(tree.closest(fruit.center.cast<float>(), d.cast<float>())->t));
    }
    double wave[6] = {};  // amplitude at one to five periods around the fruit
    for (int lobes = 1; lobes < 6; ++lobes) {
      double a = 0.0, b = 0.0;
      for (int k = 0; k < 72; ++k) {
        a += radius[std::size_t(k)] * std::cos(kTwoPi * lobes * k / 72.0);
        b += radius[std::size_t(k)] * std::sin(kTwoPi * lobes * k / 72.0);
      }
      wave[lobes] = std::hypot(a, b) / 36.0;
    }
    const double largest = std::max(wave[3], wave[4]);
    CHECK(largest > 0.03 * fruit.radii[2]);
    CHECK(largest > 2.0 * std::max({wave[1], wave[2], wave[5]}));
  }
}

TEST_CASE("leaves hide as much as asked") {
  for (const double foliage : {0.0, 0.1, 0.3, 0.5}) {
    PlantParameters parameters = small_plant();
    parameters.foliage = foliage;
    parameters.seed = 3;
    INFO(foliage);
    check_plant(make_plant(parameters), parameters);
  }
}

TEST_CASE("two trusses, and objects that are no fruit") {
  for (const char* kind : {"tomato", "pepper", "strawberry"}) {
    INFO(kind);
    PlantParameters parameters = PlantParameters::of(kind);
    parameters.total = 6;
    parameters.trusses = 2;
    parameters.trunk = true;
    parameters.posts = 3;
    parameters.wires = 2;
    parameters.pots = 2;
    parameters.seed = 5;
    const Plant plant = make_plant(parameters);
    check_plant(plant, parameters);
    const bool trough = std::string(kind) == "strawberry";
    CHECK(count(plant.scene, ObjectClass::other) == 1 + 3 + 2 + 2 + 1 + (trough ? 1 : 0));  // with the bench
    for (const Object& object : plant.scene.objects)
      if (object.cls == ObjectClass::other) CHECK(watertight(object.mesh));
    // One truss hangs left of the other.
    double right = -1.0, left = 1.0;
    for (const Eigen::Vector3f& v :
         joined({{plant.scene.objects.begin(), plant.scene.objects.begin() + 3}}, ObjectClass::fruit).vertices)
      right = std::max(right, double(v.x()));
    for (const Eigen::Vector3f& v :
         joined({{plant.scene.objects.begin() + 3, plant.scene.objects.begin() + 6}}, ObjectClass::fruit).vertices)
      left = std::min(left, double(v.x()));
    CHECK(right < left);
  }
}

TEST_CASE("the arm starts outside of what keeps it away from wide plants") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    PlantParameters parameters = PlantParameters::of("tomato");
    parameters.trusses = 2;
    parameters.foliage = 0.0;
    parameters.seed = seed;
    const Workcell cell = make_plant(parameters).workcell;
    const KeepOut& cluster = cell.keep_out.back();
    CHECK(std::get<Cylinder>(cluster.shape).radius > 0.35);  // wider than usual
    CHECK_FALSE(arm::find_collision(cell.start, plan::mount_of(cell)));
  }
}

TEST_CASE("plants depend on their parameters and their seed alone") {
  const PlantParameters parameters = small_plant();
  const Plant a = make_plant(parameters);
  CHECK(equal(a, make_plant(parameters)));
  PlantParameters other = parameters;
  other.seed = 2;
  CHECK_FALSE(equal(a, make_plant(other)));
  other = parameters;
  other.posts = 1;
  CHECK_FALSE(equal(a, make_plant(other)));
}

TEST_CASE("impossible plants are refused by name") {
  const auto refuses = [](auto change, const std::string& field) {
    PlantParameters parameters;
    change(parameters);
    std::string said;
    try {
      make_plant(parameters);
    } catch (const ParameterError& error) {
      said = error.what();
    }
    INFO(said);
    CHECK(said.find(field) == 0);
  };
  refuses([](PlantParameters& p) { p.kind = "banana"; }, "kind must be tomato, cherry,");
  refuses([](PlantParameters& p) { p.total = 0; }, "total");
  refuses([](PlantParameters& p) { p.total = 13; }, "total");
  refuses([](PlantParameters& p) { p.trusses = 3; }, "trusses");
  refuses([](PlantParameters& p) { p.trusses = 2, p.total = 1; }, "total");
  refuses([](PlantParameters& p) { p.radius_tip = 0.005; }, "radius_tip");
  refuses([](PlantParameters& p) { p.radius_shoulder = 0.009; }, "radius_shoulder");
  refuses([](PlantParameters& p) { p.radius_shoulder = std::nan(""); }, "radius_shoulder");
  refuses([](PlantParameters& p) { p.foliage = 0.7; }, "foliage");
  refuses([](PlantParameters& p) { p.leaves_behind = -1; }, "leaves_behind");
  refuses([](PlantParameters& p) { p.posts = 4; }, "posts");
  refuses([](PlantParameters& p) { p.wires = 5; }, "wires");
  refuses([](PlantParameters& p) { p.pots = 3; }, "pots");
  refuses([](PlantParameters& p) { p.center.x() = std::nan(""); }, "center");
  CHECK_THROWS_AS(PlantParameters::of("banana"), FieldError);
}
