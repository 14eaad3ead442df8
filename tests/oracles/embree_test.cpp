// SPDX-License-Identifier: BSD-3-Clause
// Rays hit what Embree 3 says they hit: the same triangle but for ties and rays within 1e-6 of an edge, the same
// distance to 1e-5, and the same misses.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/geometry/primitives.hpp>
#include <agrisee/study/raycast.hpp>

#include <optional>

#include "catch.hpp"
#include "support/embree_scene.hpp"
#include "support/shapes.hpp"

using namespace agrisee;

namespace {

class Embree {
 public:
  explicit Embree(const Mesh& mesh) : scene_(mesh, 1, RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_ROBUST) {}

  std::optional<Bvh::Hit> closest(const Eigen::Vector3f& o, const Eigen::Vector3f& d, float t_min, float t_max) const {
    RTCRayHit query{};
    query.ray = ray(o, d, t_min, t_max);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.scene(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Bvh::Hit{query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
  }
  bool any(const Eigen::Vector3f& o, const Eigen::Vector3f& d, float t_min, float t_max) const {
    RTCRay query = ray(o, d, t_min, t_max);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.scene(), &context, &query);
    return query.tfar < 0.0f;
  }

 private:
  static RTCRay ray(const Eigen::Vector3f& o, const Eigen::Vector3f& d, float t_min, float t_max) {
    RTCRay r{};
    r.org_x = o.x(), r.org_y = o.y(), r.org_z = o.z();
    r.dir_x = d.x(), r.dir_y = d.y(), r.dir_z = d.z();
    r.tnear = t_min, r.tfar = t_max;
    r.mask = 0xFFFFFFFFu;
    return r;
  }
  shapes::EmbreeScene scene_;
};

Triangle corners(const Mesh& mesh, std::uint32_t i) {
  const auto& t = mesh.triangles[i];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

Mesh spheres() {
  Rng rng(2);
  Mesh mesh;
  for (int i = 0; i < 12; ++i)
    append(mesh, shapes::sphere(shapes::random_vector(rng, 0.15), rng.uniform(0.02, 0.05), 40));
  return mesh;
}

/// How far (m) inside of a triangle the line of a ray meets its plane: the distance to the nearest edge, negative
/// outside. In double, by a way of its own.
double distance_inside(const Triangle& triangle, const Eigen::Vector3f& o, const Eigen::Vector3f& d) {
  const Eigen::Vector3d a = triangle[0].cast<double>(), b = triangle[1].cast<double>(), c = triangle[2].cast<double>();
  Eigen::Matrix3d m;  // a + u (b - a) + v (c - a) = o + t d
  m << b - a, c - a, -d.cast<double>();
  const Eigen::Vector3d x = m.fullPivLu().solve(o.cast<double>() - a);
  const double doubled = area_normal(triangle).norm();
  return std::min({(1.0 - x[0] - x[1]) * doubled / (c - b).norm(), x[0] * doubled / (a - c).norm(),
                   x[1] * doubled / (b - a).norm()});
}

/// Distance (m) from a ray to the nearest edge of a triangle.
double distance_to_edge(const Triangle& triangle, const Eigen::Vector3f& o, const Eigen::Vector3f& d) {
  const Eigen::Vector3d from = o.cast<double>(), to = from + 9.0 * d.cast<double>();
  double nearest = 1e9;
  for (std::size_t i = 0; i < 3; ++i)
    nearest =
        std::min(nearest, segment_distance(from, to, triangle[i].cast<double>(), triangle[(i + 1) % 3].cast<double>()));
  return nearest;
}

struct Tally {
  int rays = 0, hits = 0, ties = 0, edges = 0;
};

/// Requires that both answers agree, up to ties and edges.
void agree(const Mesh& mesh, const std::optional<Bvh::Hit>& ours, const std::optional<Bvh::Hit>& theirs,
           const Eigen::Vector3f& o, const Eigen::Vector3f& d, Tally& tally) {
  constexpr double kEdge = 1e-6, kDistance = 1e-5, kRounding = 1e-10;  // m
  ++tally.rays;
  if (!ours && !theirs) return;
  ++tally.hits;
  if (ours && theirs && std::abs(double(ours->t) - double(theirs->t)) <= kDistance) {
    if (ours->triangle == theirs->triangle) return;
    ++tally.ties;  // both at one distance: the ray meets both triangles where they meet
    REQUIRE(distance_inside(corners(mesh, ours->triangle), o, d) > -kRounding);
    REQUIRE(distance_to_edge(corners(mesh, theirs->triangle), o, d) < kEdge);
    return;
  }
  if (ours && theirs &&
      ours->triangle == theirs->triangle) {  // almost within its plane: what is left is their rounding
    const Eigen::Vector3d normal = area_normal(corners(mesh, ours->triangle)).normalized();
    const Eigen::Vector3d to = o.cast<double>() + double(theirs->t) * d.cast<double>();
    REQUIRE(std::abs(normal.dot(to - mesh.vertices[mesh.triangles[ours->triangle][0]].cast<double>())) < kEdge);
    REQUIRE(std::abs(normal.dot(d.cast<double>())) < 0.01);
    ++tally.edges;
    return;
  }
  // One sees a triangle that the other misses: the ray passes by its edge, and ours is right about the side.
  const bool we_see_it = !theirs || (ours && ours->t < theirs->t);
  const Triangle triangle = corners(mesh, (we_see_it ? ours : theirs)->triangle);
  const double inside = distance_inside(triangle, o, d);
  REQUIRE(distance_to_edge(triangle, o, d) < kEdge);
  REQUIRE((we_see_it ? inside > -kRounding : inside < kRounding));
  ++tally.edges;
}

}  // namespace

TEST_CASE("random rays hit what Embree says") {
  const int kind = GENERATE(0, 1, 2, 3);
  const Mesh mesh = kind == 0   ? shapes::soup(200, 0.2, 1)
                    : kind == 1 ? shapes::soup(5000, 0.05, 2)
                    : kind == 2 ? shapes::soup(50000, 0.01, 3)
                                : spheres();
  const Bvh bvh(mesh);
  const Embree embree(mesh);
  Rng rng(4);
  Tally tally;
  int any_differs = 0;
  for (int i = 0; i < 100000; ++i) {
    const Eigen::Vector3d eye = i % 2 ? Eigen::Vector3d(0.7 * rng.direction()) : shapes::random_vector(rng, 0.3);
    const Eigen::Vector3f o = eye.cast<float>();
    const Eigen::Vector3f d = (shapes::random_vector(rng, 0.3) - eye).normalized().cast<float>();
    const float t_min = i % 3 ? 0.0f : 0.25f, t_max = i % 5 ? 9.0f : 0.6f;
    const auto ours = bvh.closest(o, d, t_min, t_max);
    agree(mesh, ours, embree.closest(o, d, t_min, t_max), o, d, tally);
    REQUIRE(bvh.any(o, d, t_min, t_max) == ours.has_value());
    any_differs += ours.has_value() != embree.any(o, d, t_min, t_max);
  }
  REQUIRE(tally.hits > 10000);
  REQUIRE(tally.ties + tally.edges < 50);
  REQUIRE(any_differs <= tally.edges);
}

TEST_CASE("a full frame is what Embree says") {
  const Mesh mesh = spheres();
  const study::TracedScene scene(shapes::scene_of(mesh));
  const Embree embree(mesh);
  const sensor::Intrinsics k = sensor::intrinsics_from_fov(512, 384, deg(70), deg(55));
  const Pose pose = look_along({0.05, -0.5, 0.02}, {-0.1, 1.0, 0.0}, 0.2);
  const study::RayImage image = study::raycast(scene, k, pose, 0.25, 9.0);
  const Eigen::Vector3f eye = pose.translation().cast<float>();
  Tally tally;
  std::size_t i = 0;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u, ++i) {
      const Eigen::Vector3f d = study::ray_direction(k, pose, u, v);
      std::optional<Bvh::Hit> ours;
      if (image.triangle[i] != study::kNoHit) ours = Bvh::Hit{image.range[i], image.triangle[i], 0.0f, 0.0f};
      agree(mesh, ours, embree.closest(eye, d, 0.0f, 9.0f), eye, d, tally);
    }
  REQUIRE(tally.hits > 5000);
  REQUIRE(tally.ties + tally.edges < 50);
}

TEST_CASE("rays at corners and edges hit what Embree says") {
  const Mesh mesh = spheres();
  const Bvh bvh(mesh);
  const Embree embree(mesh);
  Rng rng(5);
  Tally tally;
  for (int i = 0; i < 50000; ++i) {
    const Triangle t = corners(mesh, static_cast<std::uint32_t>(rng.below(mesh.triangles.size())));
    const Eigen::Vector3f o = (0.7 * rng.direction()).cast<float>();
    const Eigen::Vector3f d = (i % 2 ? t[0] : Eigen::Vector3f(0.5f * (t[0] + t[1]))) - o;
    agree(mesh, bvh.closest(o, d, 0.0f, 9.0f), embree.closest(o, d, 0.0f, 9.0f), o, d, tally);
  }
  REQUIRE(tally.hits > 45000);
  REQUIRE(tally.ties > 1000);
}
