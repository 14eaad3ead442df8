// SPDX-License-Identifier: BSD-3-Clause
// The tree and a 1024 x 768 depth frame on about 100,000 triangles, met by about one ray in seven, against Embree 3.
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/sensor/depth_camera.hpp>
#include <agrisee/study/raycast.hpp>

#ifdef PEERS_EMBREE
#include "../../tests/support/embree_scene.hpp"
#endif

#include "../../tests/support/shapes.hpp"
#include "peers.hpp"

using namespace agrisee;

namespace {

/// 30 spheres of 24 to 36 mm, 0.5 m in front of the sensor.
const Mesh& spheres() {
  static const Mesh all = [] {
    Mesh mesh;
    Rng rng(1);
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d center(rng.uniform(-0.13, 0.13), rng.uniform(0.42, 0.62), rng.uniform(0.06, 0.34));
      const Mesh one = shapes::sphere(center, rng.uniform(0.024, 0.036), 58 + 2 * (i % 2));
      const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), one.vertices.begin(), one.vertices.end());
      for (const auto& t : one.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    return mesh;
  }();
  return all;
}

const study::TracedScene& traced() {
  static const study::TracedScene scene(shapes::scene_of(spheres()));
  return scene;
}

Pose eye() { return look_along({0.0, 0.0, 0.2}, Eigen::Vector3d::UnitY()); }

std::vector<float> our_frame(int threads) {
  const sensor::DepthCamera l515 = sensor::l515();
  return study::raycast(traced(), l515.intrinsics, eye(), l515.range_min, l515.range_max, threads).range;
}

#ifdef PEERS_EMBREE
/// The directions of all pixels, made before anything is timed.
const std::vector<Eigen::Vector3f>& rays() {
  static const std::vector<Eigen::Vector3f> all = [] {
    const sensor::DepthCamera l515 = sensor::l515();
    std::vector<Eigen::Vector3f> out;
    for (int v = 0; v < l515.intrinsics.height; ++v)
      for (int u = 0; u < l515.intrinsics.width; ++u) out.push_back(study::ray_direction(l515.intrinsics, eye(), u, v));
    return out;
  }();
  return all;
}

const RTCScene& embree_scene() {
  static const shapes::EmbreeScene embree(spheres(), 1, RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE);
  static const RTCScene scene = embree.scene();
  return scene;
}

/// Whether Embree makes the scene.
bool built(int threads, RTCBuildQuality quality) {
  return shapes::EmbreeScene(spheres(), threads, quality, RTC_SCENE_FLAG_NONE).scene() != nullptr;
}

std::vector<float> embree_single(int threads) {
  const sensor::DepthCamera l515 = sensor::l515();
  const Eigen::Vector3f o = eye().translation().cast<float>();
  std::vector<float> range(rays().size(), 0.0f);
  parallel_for(
      range.size(), threads,
      [&](std::size_t i) {
        const Eigen::Vector3f& d = rays()[i];
        RTCRayHit query{};
        query.ray = {o.x(),       o.y(), o.z(), float(l515.range_min), d.x(), d.y(), d.z(), 0, float(l515.range_max),
                     0xFFFFFFFFu, 0,     0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcIntersect1(embree_scene(), &context, &query);
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) range[i] = query.ray.tfar;
      },
      4096);
  return range;
}

std::vector<float> embree_packets(int threads) {
  const sensor::DepthCamera l515 = sensor::l515();
  const Eigen::Vector3f o = eye().translation().cast<float>();
  std::vector<float> range(rays().size(), 0.0f);
  const auto width = static_cast<std::size_t>(l515.intrinsics.width);
  parallel_for(
      range.size() / 16, threads,
      [&](std::size_t packet) {  // 4 x 4 pixels
        const std::size_t across = width / 4, u = packet % across * 4, v = packet / across * 4;
        alignas(64) int valid[16];
        alignas(64) RTCRayHit16 query{};
        for (std::size_t k = 0; k < 16; ++k) {
          const Eigen::Vector3f& d = rays()[(v + k / 4) * width + u + k % 4];
          valid[k] = -1;
          query.ray.org_x[k] = o.x(), query.ray.org_y[k] = o.y(), query.ray.org_z[k] = o.z();
          query.ray.dir_x[k] = d.x(), query.ray.dir_y[k] = d.y(), query.ray.dir_z[k] = d.z();
          query.ray.tnear[k] = float(l515.range_min), query.ray.tfar[k] = float(l515.range_max);
          query.ray.mask[k] = 0xFFFFFFFFu;
          query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcIntersect16(valid, embree_scene(), &context, &query);
        for (std::size_t k = 0; k < 16; ++k)
          if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
            range[(v + k / 4) * width + u + k % 4] = query.ray.tfar[k];
      },
      256);
  return range;
}
#endif

void same_ranges(const std::vector<float>& theirs, const char* what) {
  const std::vector<float> mine = our_frame(1);
  std::size_t different = 0;
  for (std::size_t i = 0; i < mine.size(); ++i) different += std::abs(mine[i] - theirs[i]) > 1e-4f;
  peers::require(different < mine.size() / 10000, what);  // rays along an edge
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t triangles = spheres().triangles.size(), pixels = 1024 * 768;
  for (const int threads : {1, 2}) {
    peers::add("depth_frame", "ours", pixels, threads, our_frame, peers::Unchecked());
#ifdef PEERS_EMBREE
    peers::add("depth_frame", "Embree single rays", pixels, threads, embree_single,
               [](const auto& range) { same_ranges(range, "depth frame of Embree's single rays"); });
    peers::add("depth_frame", "Embree packets", pixels, threads, embree_packets,
               [](const auto& range) { same_ranges(range, "depth frame of Embree's packets"); });
    peers::add(
        "bvh_build", "Embree medium", triangles, threads, [](int t) { return built(t, RTC_BUILD_QUALITY_MEDIUM); },
        peers::Unchecked());
    peers::add(
        "bvh_build", "Embree low", triangles, threads, [](int t) { return built(t, RTC_BUILD_QUALITY_LOW); },
        peers::Unchecked());
#endif
    peers::add(
        "bvh_build", "ours", triangles, threads, [](int t) { return Bvh(spheres(), t).size(); }, peers::Unchecked());
  }
  return peers::main(argc, argv);
}
