// SPDX-License-Identifier: BSD-3-Clause
// Rays against an oracle in exact integers: corners, origins and directions are small integers, so that it is certain
// whether a ray meets an edge, a corner, a sliver or passes by it. Borders belong to a triangle, triangles seen edge on
// are not met. tests/geometry/bvh_test.cpp compares the tree with all triangles by the library's own arithmetic.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

using Int = std::int64_t;
using Int3 = std::array<Int, 3>;

Int3 minus(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Int3 cross(const Int3& a, const Int3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Int dot(const Int3& a, const Int3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Eigen::Vector3f vector(const Int3& a) { return {float(a[0]), float(a[1]), float(a[2])}; }

/// Where a ray meets a triangle: t = above / below, or nothing.
struct Exact {
  Int above = 0, below = 0;  // below > 0 where it is met
};

Exact meet(const std::array<Int3, 3>& t, const Int3& o, const Int3& d) {
  const Int3 n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  Int below = dot(n, d), above = dot(n, minus(t[0], o));
  if (below == 0) return {};
  if (below < 0) below = -below, above = -above;
  if (above < 0) return {};
  // The point o + above / below d, times below, against the three edges.
  const Int3 hit{o[0] * below + above * d[0], o[1] * below + above * d[1], o[2] * below + above * d[2]};
  for (std::size_t i = 0; i < 3; ++i) {
    const Int3 &a = t[i], &b = t[(i + 1) % 3];
    const Int3 from{hit[0] - a[0] * below, hit[1] - a[1] * below, hit[2] - a[2] * below};
    const Int3 side = cross(minus(b, a), from);
    // dot(side, n) by signs: its value may be beyond 64 bits.
    const auto wide = [](Int x, Int y) { return static_cast<long double>(x) * static_cast<long double>(y); };
    if (wide(side[0], n[0]) + wide(side[1], n[1]) + wide(side[2], n[2]) < 0.0L) return {};
  }
  return {above, below};
}

struct Scene {
  std::vector<std::array<Int3, 3>> triangles;
  Mesh mesh;
  void add(const Int3& a, const Int3& b, const Int3& c) {
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {vector(a), vector(b), vector(c)});
    mesh.triangles.push_back({n, n + 1, n + 2});
    triangles.push_back({a, b, c});
  }
};

Int3 draw(Rng& rng, Int span) {
  const auto one = [&] { return Int(rng.below(std::uint64_t(2 * span + 1))) - span; };
  const Int x = one(), y = one();
  return {x, y, one()};
}

Int3 plus(const Int3& a, const Int3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

Scene scene_of(const std::string& kind) {
  Rng rng(41);
  Scene scene;
  if (kind == "random")
    for (int i = 0; i < 60; ++i) scene.add(draw(rng, 16), draw(rng, 16), draw(rng, 16));
  if (kind == "slivers")  // a unit across and hundreds long, of areas down to one half
    for (int i = 0; i < 60; ++i) {
      const Int3 a = draw(rng, 16), along = draw(rng, 100), b = plus(a, along);
      scene.add(a, b, plus(plus(b, along), draw(rng, 1)));
    }
  if (kind == "fan")  // all share a corner, and edges two by two
    for (int i = 0; i < 16; ++i) {
      const auto at = [](int k) {
        const int x[] = {4, 4, 3, 2, 0, -2, -3, -4, -4, -4, -3, -2, 0, 2, 3, 4};
        return Int3{x[k % 16], x[(k + 12) % 16], k % 3 - 1};
      };
      scene.add({0, 0, 2}, at(i), at(i + 1));
    }
  if (kind == "sheet")  // squares of two triangles in one plane, and one below
    for (int i = 0; i < 64; ++i) {
      const Int x = 2 * (i % 8) - 8, y = 2 * (i / 8) - 8;
      scene.add({x, y, 0}, {x + 2, y, 0}, {x + 2, y + 2, 0});
      scene.add({x, y, 0}, {x + 2, y + 2, 0}, {x, y + 2, i % 2 ? -2 : 0});
    }
  return scene;
}

}  // namespace

TEST_CASE("rays through corners, edges and slivers are met where exact arithmetic says") {
  const std::string kind = GENERATE("random", "slivers", "fan", "sheet");
  INFO(kind);
  const Scene scene = scene_of(kind);
  const Bvh bvh(scene.mesh);
  Rng rng(43);
  int met = 0, passed = 0, borders = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto& t = scene.triangles[rng.below(scene.triangles.size())];
    const Int3 o = draw(rng, 40);
    Int3 to = draw(rng, 40);
    if (i % 4 == 1) to = t[rng.below(3)];  // a corner
    if (i % 4 == 2) {                      // a point of an edge, which is an integer after doubling the direction
      const Int3 &a = t[0], &b = t[1 + rng.below(2)];
      to = plus(a, b);
      to = {to[0] - o[0], to[1] - o[1], to[2] - o[2]};
    }
    if (i % 4 == 3) to = plus(t[rng.below(3)], draw(rng, 1));  // beside a corner
    const Int3 d = minus(to, o);
    if (dot(d, d) == 0) continue;
    Exact first;
    for (const auto& triangle : scene.triangles) {
      const Exact hit = meet(triangle, o, d);
      if (hit.below == 0) continue;
      if (first.below == 0 || static_cast<long double>(hit.above) * static_cast<long double>(first.below) <
                                  static_cast<long double>(first.above) * static_cast<long double>(hit.below))
        first = hit;
    }
    const auto got = bvh.closest(vector(o), vector(d));
    INFO("ray " << i << " from " << o[0] << " " << o[1] << " " << o[2] << " along " << d[0] << " " << d[1] << " "
                << d[2]);
    REQUIRE(got.has_value() == (first.below != 0));
    REQUIRE(bvh.any(vector(o), vector(d)) == (first.below != 0));
    (got ? met : passed) += 1;
    if (!got) continue;
    const double t_exact = double(first.above) / double(first.below);
    REQUIRE(std::abs(double(got->t) - t_exact) <= 1e-6 * t_exact);
    const Exact of_it = meet(scene.triangles[got->triangle], o, d);
    REQUIRE(of_it.below != 0);
    REQUIRE(std::abs(double(of_it.above) / double(of_it.below) - t_exact) <= 1e-6 * t_exact);
    borders += got->u == 0.0f || got->v == 0.0f || got->u + got->v == 1.0f;
  }
  CHECK(met > 500);
  CHECK(passed > 500);
  CHECK(borders > 200);
}
