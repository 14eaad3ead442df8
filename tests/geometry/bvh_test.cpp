// SPDX-License-Identifier: BSD-3-Clause
// Every answer of the tree equals that of testing all triangles one by one, on awkward scenes too.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/traced_scene.hpp>

#include "catch.hpp"
#include "support/says.hpp"
#include "support/shapes.hpp"

using namespace agrisee;
using Eigen::Vector3f;
using test::says;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Triangle corners(const Mesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

bool usable(const Triangle& t) {
  return is_finite(t[0]) && is_finite(t[1]) && is_finite(t[2]) && area_normal(t).norm() > 0.0;
}

std::optional<Bvh::Hit> brute_closest(const Mesh& mesh, const Vector3f& o, const Vector3f& d, float t_min,
                                      float t_max) {
  std::optional<Bvh::Hit> best;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = corners(mesh, i);
    TriangleHit hit;
    if (!usable(triangle) || !SeenTriangle(triangle, o.cast<double>()).meets(d.cast<double>(), hit)) continue;
    const auto t = static_cast<float>(hit.t);
    if (t >= t_min && t <= t_max && (!best || t < best->t))
      best = Bvh::Hit{t, static_cast<std::uint32_t>(i), float(hit.u), float(hit.v)};
  }
  return best;
}

std::optional<Bvh::SurfacePoint> brute_nearest(const Mesh& mesh, const Vector3f& p, float max_distance) {
  std::optional<Bvh::SurfacePoint> best;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = corners(mesh, i);
    if (!usable(triangle)) continue;
    const Eigen::Vector3d on = nearest_point(triangle, p.cast<double>());
    const auto distance = static_cast<float>((on - p.cast<double>()).norm());
    if (distance <= max_distance && (!best || distance < best->distance))
      best = Bvh::SurfacePoint{distance, static_cast<std::uint32_t>(i), on.cast<float>()};
  }
  return best;
}

Vector3f random_vector(Rng& rng, double scale) {
  return Eigen::Vector3d(rng.uniform(-scale, scale), rng.uniform(-scale, scale), rng.uniform(-scale, scale))
      .cast<float>();
}

void add(Mesh& mesh, const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({n, n + 1, n + 2});
}

Mesh scene_of(const std::string& kind) {
  Rng rng(3);
  Mesh mesh;
  if (kind == "random" || kind == "degenerate")
    for (int i = 0; i < 400; ++i) {
      const Vector3f a = random_vector(rng, 1.0);
      add(mesh, a, a + random_vector(rng, 0.3), a + random_vector(rng, 0.3));
    }
  if (kind == "degenerate")
    for (int i = 0; i < 60; ++i) {
      const Vector3f a = random_vector(rng, 1.0), b = random_vector(rng, 1.0);
      if (i % 5 == 0) add(mesh, a, a, b);
      if (i % 5 == 1) add(mesh, a, a, a);
      if (i % 5 == 2) add(mesh, Vector3f(0, 0, 0), Vector3f(1, 1, 1), Vector3f(0.5f, 0.5f, 0.5f));
      if (i % 5 == 3) add(mesh, a, b, Vector3f(kNan, 0, 0));
      if (i % 5 == 4) add(mesh, a, b, Vector3f(kInf, 0, 0));
    }
  if (kind ==
      "grid")  // unit squares in the planes x, y and z = -2..2, each shared edge and plane exactly representable
    for (int axis = 0; axis < 3; ++axis)
      for (int k = -2; k <= 2; ++k)
        for (int i = -2; i < 2; ++i)
          for (int j = -2; j < 2; ++j) {
            const auto at = [&](int x, int y) {
              Vector3f p;
              p[axis] = float(k);
              p[(axis + 1) % 3] = float(x);
              p[(axis + 2) % 3] = float(y);
              return p;
            };
            add(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
            add(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
          }
  if (kind == "slivers")
    for (int i = 0; i < 300; ++i) {
      const Vector3f a = random_vector(rng, 1.0), b = random_vector(rng, 1.0);
      add(mesh, a, b, b + random_vector(rng, 1e-4));
    }
  if (kind == "equal")  // one triangle many times over: ties, and centers that coincide
    for (int i = 0; i < 100; ++i) add(mesh, Vector3f(-1, -1, 0), Vector3f(1, -1, 0), Vector3f(0, 1, 0));
  if (kind == "scales") {  // sizes and places over 12 powers of ten
    for (int i = 0; i < 240; ++i) {
      const double s = std::pow(10.0, -5.0 + 0.05 * i);
      const Vector3f a = random_vector(rng, s);
      add(mesh, a, a + random_vector(rng, s), a + random_vector(rng, s));
    }
  }
  if (kind == "one") add(mesh, Vector3f(-1, -1, 0), Vector3f(1, -1, 0), Vector3f(0, 1, 0));
  return mesh;
}

// Coordinates and directions with many exact coincidences on scenes over integers.
Vector3f half_steps(Rng& rng, int span) {
  const auto draw = [&] { return 0.5f * float(int(rng.below(std::uint64_t(4 * span + 1))) - 2 * span); };
  const float x = draw(), y = draw();
  return {x, y, draw()};
}

}  // namespace

TEST_CASE("rays find what brute force finds") {
  const std::string kind = GENERATE("random", "degenerate", "grid", "slivers", "equal", "scales", "one");
  INFO(kind);
  const Mesh mesh = scene_of(kind);
  const Bvh bvh(mesh);
  REQUIRE(bvh.size() == mesh.triangles.size());
  Rng rng(5);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    Vector3f o = random_vector(rng, 2.0), d = random_vector(rng, 1.0);
    if (i % 2) {  // exact coincidences: along axes and diagonals, in planes and through corners
      o = half_steps(rng, 3);
      d = half_steps(rng, 1);
    } else if (i % 4 == 0) {  // at a point of a triangle
      const Triangle t = corners(mesh, rng.below(mesh.triangles.size()));
      d = 0.4f * t[0] + 0.3f * t[1] + 0.3f * t[2] - o;
    }
    const float t_min = i % 3 ? 0.0f : 0.4f, t_max = i % 5 ? kInf : 1.5f;
    const auto expected = d.isZero(0.0f) || !is_finite(d) ? std::nullopt : brute_closest(mesh, o, d, t_min, t_max);
    const auto hit = bvh.closest(o, d, t_min, t_max);
    REQUIRE(hit.has_value() == expected.has_value());
    REQUIRE(bvh.any(o, d, t_min, t_max) == expected.has_value());
    if (!hit) continue;
    ++hits;
    REQUIRE(hit->t == expected->t);
    REQUIRE(hit->triangle == expected->triangle);
    REQUIRE(hit->u == expected->u);
    REQUIRE(hit->v == expected->v);
    REQUIRE(hit->u >= 0.0f);
    REQUIRE(hit->v >= 0.0f);
    REQUIRE(hit->u + hit->v <= 1.0f + 1e-6f);
  }
  REQUIRE(hits > 20);
}

TEST_CASE("the nearest point is what brute force finds") {
  const std::string kind = GENERATE("random", "degenerate", "grid", "slivers", "equal", "scales", "one");
  INFO(kind);
  const Mesh mesh = scene_of(kind);
  const Bvh bvh(mesh);
  Rng rng(6);
  for (int i = 0; i < 1500; ++i) {
    const Vector3f p = i % 2 ? half_steps(rng, 3) : random_vector(rng, 2.0);
    const float max_distance = i % 3 ? kInf : 0.2f;
    const auto expected = brute_nearest(mesh, p, max_distance);
    const auto found = bvh.nearest(p, max_distance);
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) continue;
    REQUIRE(found->distance == expected->distance);
    REQUIRE(found->triangle == expected->triangle);
    REQUIRE(found->point == expected->point);
    REQUIRE(double((found->point - p).norm()) == Approx(double(found->distance)).margin(1e-6));
  }
}

TEST_CASE("the nearest point of a triangle is on it and no sample is nearer") {
  Rng rng(8);
  for (int i = 0; i < 200; ++i) {
    const Triangle t{random_vector(rng, 1.0), random_vector(rng, 1.0), random_vector(rng, 1.0)};
    const Eigen::Vector3d p = random_vector(rng, 2.0).cast<double>();
    const double distance = (nearest_point(t, p) - p).norm();
    double sampled = 1e9;
    constexpr int kSteps = 60;
    for (int a = 0; a <= kSteps; ++a)
      for (int b = 0; a + b <= kSteps; ++b) {
        const double u = double(a) / kSteps, v = double(b) / kSteps;
        const Eigen::Vector3d q = (1 - u - v) * t[0].cast<double>() + u * t[1].cast<double>() + v * t[2].cast<double>();
        sampled = std::min(sampled, (q - p).norm());
      }
    REQUIRE(distance <= sampled + 1e-9);
    REQUIRE(sampled - distance < 0.06);  // the samples' spacing
  }
}

TEST_CASE("a sphere is hit where it is") {
  const Mesh mesh = shapes::sphere({0.1, 0.5, 0.2}, 0.04, 64);
  const Bvh bvh(mesh);
  Rng rng(9);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d c(0.1, 0.5, 0.2), o = c + 0.4 * rng.direction(), aim = c + 0.06 * rng.direction();
    const Eigen::Vector3d d = (aim - o).normalized();
    const double along = (c - o).dot(d), miss = (c - o - along * d).norm();
    const auto hit = bvh.closest(o.cast<float>(), d.cast<float>());
    if (miss > 0.04) REQUIRE_FALSE(hit);
    if (miss < 0.035) {
      REQUIRE(hit);
      REQUIRE(double(hit->t) == Approx(along - std::sqrt(0.04 * 0.04 - miss * miss)).margin(3e-4));
    }
    const Eigen::Vector3d p = c + rng.uniform(0.0, 0.1) * rng.direction();
    const auto near = bvh.nearest(p.cast<float>());
    REQUIRE(near);
    REQUIRE(double(near->distance) == Approx(std::abs((p - c).norm() - 0.04)).margin(2e-4));
  }
  REQUIRE(bvh.bounds().min.isApprox(Eigen::Vector3d(0.06, 0.46, 0.16), 1e-2));
  REQUIRE(bvh.bounds().max.isApprox(Eigen::Vector3d(0.14, 0.54, 0.24), 1e-2));
}

TEST_CASE("no ray slips through the seams of a closed surface") {
  const Mesh mesh = shapes::sphere({0, 0, 0}, 0.05, 40);
  const Bvh bvh(mesh);
  Rng rng(10);
  for (int i = 0; i < 20000; ++i) {  // from inside, at points of edges and at corners
    const Triangle t = corners(mesh, rng.below(mesh.triangles.size()));
    const float s = i % 10 == 0 ? 0.0f : float(rng.uniform());
    const Vector3f o = 0.2f * random_vector(rng, 0.05);
    REQUIRE(bvh.any(o, t[0] + s * (t[1] - t[0]) - o));
  }
}

TEST_CASE("rays and queries that make no sense meet nothing") {
  const Bvh bvh(scene_of("one"));
  const Vector3f o(0, 0, -1), d(0, 0, 1);
  REQUIRE(bvh.closest(o, d));
  REQUIRE(bvh.closest(o, d)->t == 1.0f);
  REQUIRE(bvh.closest(o, 4.0f * d)->t == 0.25f);
  REQUIRE_FALSE(bvh.closest(o, -d));
  REQUIRE_FALSE(bvh.closest(o, d, -5.0f, 0.5f));
  REQUIRE_FALSE(bvh.closest(Vector3f(0, 0, 1), d, -5.0f));  // negative t is never met
  REQUIRE(bvh.closest(o, d, 1.0f, 1.0f));                   // limits are inclusive
  REQUIRE_FALSE(bvh.closest(o, d, 2.0f, 0.5f));
  REQUIRE_FALSE(bvh.closest(o, Vector3f::Zero()));
  REQUIRE_FALSE(bvh.closest(o, Vector3f(0, kNan, 1)));
  REQUIRE_FALSE(bvh.closest(o, Vector3f(0, 0, kInf)));
  REQUIRE_FALSE(bvh.closest(Vector3f(kNan, 0, 0), d));
  REQUIRE_FALSE(bvh.closest(o, d, kNan));
  REQUIRE_FALSE(bvh.closest(o, d, 0.0f, kNan));
  REQUIRE_FALSE(bvh.any(o, d, 0.0f, kNan));
  REQUIRE_FALSE(bvh.nearest(Vector3f(kNan, 0, 0)));
  REQUIRE_FALSE(bvh.nearest(o, -1.0f));
  REQUIRE_FALSE(bvh.nearest(o, kNan));
  REQUIRE_FALSE(bvh.nearest(o, 0.999f));
  REQUIRE(bvh.nearest(o, 1.0f));
}

TEST_CASE("meshes that are empty, degenerate or broken") {
  REQUIRE_FALSE(Bvh().closest(Vector3f::Zero(), Vector3f::UnitX()));
  REQUIRE_FALSE(Bvh(Mesh()).any(Vector3f::Zero(), Vector3f::UnitX()));
  REQUIRE_FALSE(Bvh(Mesh()).nearest(Vector3f::Zero()));
  REQUIRE(Bvh(Mesh()).bounds().empty());
  REQUIRE(Bvh(scene_of("degenerate")).degenerate() == 60);
  REQUIRE(Bvh(scene_of("random")).degenerate() == 0);
  Mesh flat;
  for (int i = 0; i < 5; ++i) add(flat, Vector3f::Zero(), Vector3f::Zero(), Vector3f::UnitX());
  REQUIRE(Bvh(flat).degenerate() == 5);
  REQUIRE_FALSE(Bvh(flat).nearest(Vector3f::Zero()));
  Mesh broken = scene_of("one");
  broken.triangles.push_back({0, 1, 3});
  REQUIRE_THROWS_AS(Bvh(broken), InputError);
  REQUIRE_THROWS_WITH(Bvh(broken), says("triangle 1") && says("vertex 3"));
}

TEST_CASE("visit reaches every triangle of the boxes that are kept, and stops when told") {
  const Mesh mesh = scene_of("random");
  const Bvh bvh(mesh);
  std::vector<bool> seen(mesh.triangles.size());
  bvh.visit([](const Vector3f& min, const Vector3f&) { return min.x() <= 0.0f; },
            [&](std::uint32_t i, const Triangle& t) {
              REQUIRE(t == corners(mesh, i));
              REQUIRE_FALSE(seen[i]);
              seen[i] = true;
              return true;
            });
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Triangle t = corners(mesh, i);
    if (std::min({t[0].x(), t[1].x(), t[2].x()}) <= 0.0f) REQUIRE(seen[i]);
  }
  int visited = 0;
  bvh.visit([](const Vector3f&, const Vector3f&) { return true; },
            [&](std::uint32_t, const Triangle&) { return ++visited < 7; });
  REQUIRE(visited == 7);
}

TEST_CASE("a tree of many pieces is the same on any number of threads, and right") {
  Mesh mesh = shapes::sphere({0.0, 0.5, 0.2}, 0.04, 160);  // more than a piece of work holds
  append(mesh, shapes::sphere({0.01, 0.5, 0.2}, 0.04, 160));
  REQUIRE(mesh.triangles.size() > 40000);
  struct Walk {
    std::vector<Vector3f> boxes;
    std::vector<std::uint32_t> triangles;
  };
  const auto walk = [&](const Bvh& bvh) {
    Walk all;
    bvh.visit(
        [&](const Vector3f& min, const Vector3f& max) {
          all.boxes.insert(all.boxes.end(), {min, max});
          return true;
        },
        [&](std::uint32_t i, const Triangle&) {
          all.triangles.push_back(i);
          return true;
        });
    return all;
  };
  const Bvh alone(mesh);
  const Walk one = walk(alone);
  for (const int threads : {2, 3}) {
    const Walk more = walk(Bvh(mesh, threads));
    REQUIRE((one.boxes == more.boxes && one.triangles == more.triangles));
  }
  std::vector<std::uint32_t> ids = one.triangles;
  std::sort(ids.begin(), ids.end());
  REQUIRE(ids.size() == mesh.triangles.size());
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids[i] != i) FAIL("triangle " << i << " is not in the tree once");
  Rng rng(5);
  for (int k = 0; k < 60; ++k) {
    const Vector3f o = random_vector(rng, 0.3), d = Vector3f(0.0f, 0.5f, 0.2f) + random_vector(rng, 0.04) - o;
    const auto hit = alone.closest(o, d);
    const auto expected = brute_closest(mesh, o, d, 0.0f, kInf);
    REQUIRE(hit.has_value() == expected.has_value());
    if (hit) REQUIRE((hit->triangle == expected->triangle && hit->t == expected->t));
  }
}

TEST_CASE("a traced scene knows the object and the normal of each triangle") {
  study::Scene scene;
  scene.objects.push_back({1, study::ObjectClass::fruit, shapes::sphere({-0.1, 0.5, 0.2}, 0.03, 16)});
  scene.objects.push_back({0, study::ObjectClass::other, Mesh()});
  scene.objects.push_back({2, study::ObjectClass::fruit, shapes::sphere({0.1, 0.5, 0.2}, 0.04, 16)});
  add(scene.objects[2].mesh, Vector3f::Zero(), Vector3f::Zero(), Vector3f::Zero());
  const study::TracedScene traced(scene);
  REQUIRE(traced.size() == scene.objects[0].mesh.triangles.size() + scene.objects[2].mesh.triangles.size());
  REQUIRE(traced.bvh().degenerate() == 1);
  REQUIRE(traced.normal(static_cast<std::uint32_t>(traced.size() - 1)).isZero(0.0f));
  for (const float x : {-0.1f, 0.1f}) {
    const auto hit = traced.bvh().closest(Vector3f(x, 0, 0.2f), Vector3f::UnitY());
    REQUIRE(hit);
    REQUIRE(traced.object(hit->triangle) == (x < 0 ? 0u : 2u));
    REQUIRE(traced.normal(hit->triangle).y() < -0.9f);
  }
  REQUIRE(study::TracedScene(study::Scene()).size() == 0);
  scene.objects[1].mesh.triangles.push_back({0, 0, 0});
  REQUIRE_THROWS_WITH(study::TracedScene(scene), says("object 1"));
}
