// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/raycast.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::study {

namespace {

void check_camera(const sensor::Intrinsics& k, const Pose& world_T_optical) {
  check_input(k.width > 0 && k.height > 0, "camera: width and height must be positive");
  check_input(std::isfinite(k.fx) && std::isfinite(k.fy) && k.fx > 0 && k.fy > 0, "camera: fx and fy must be positive");
  check_input(std::isfinite(k.cx) && std::isfinite(k.cy), "camera: cx and cy must be finite");
  check_input(is_rigid(world_T_optical), "camera: world_T_optical must be a rigid transform of finite numbers");
}

/// Rounds to single precision. It is not inlined, so that no caller computes on with the unrounded values.
[[gnu::noinline]] Eigen::Vector3f rounded(const Eigen::Vector3d& x) { return x.cast<float>(); }

/// A rectangle of pixels [u0, u1) x [v0, v1).
struct Tile {
  int u0, v0, u1, v1;
};

/// Traces the tiles of one image. Each thread has its own tracer, because the tracer holds buffers that its tiles
/// share.
class TileTracer {
 public:
  static constexpr int kEdge = 16;  ///< edge of a tile (pixels)

  TileTracer(const TracedScene& scene, const sensor::Intrinsics& k, const Pose& world_T_optical, float range_min,
             float range_max, RayImage& image)
      : bvh_(scene.bvh()),
        k_(k),
        world_T_optical_(world_T_optical),
        rotation_(world_T_optical.linear().transpose()),
        eye_(rounded(world_T_optical.translation())),
        range_min_(range_min),
        range_max_(range_max),
        image_(image) {}

  void trace(const Tile& tile) {
    if (!find_triangles(tile)) return trace_rays(tile);
    if (candidates_.empty()) return;
    directions_.clear();
    for (int v = tile.v0; v < tile.v1; ++v)
      for (int u = tile.u0; u < tile.u1; ++u)
        directions_.push_back(ray_direction(k_, world_T_optical_, u, v).cast<double>());
    for (const Candidate& c : candidates_) test_pixels(tile, c);
    drop_near(tile);
  }

 private:
  static constexpr int kTestsPerPixel = 48;  // with more tests than that, single rays are faster
  static constexpr std::size_t kMaxTriangles = 4096;

  /// A triangle that may be visible in a tile, and the pixels that it may cover.
  struct Candidate {
    const Triangle* corners;
    std::uint32_t triangle;
    Tile covers;
  };

  /// Collects the candidates of a tile. Returns false if there are too many.
  bool find_triangles(const Tile& tile) {
    candidates_.clear();
    // Planes through the eye, half a pixel outside the outermost rays; their normals point inwards.
    const double left = tile.u0 - 0.5, right = tile.u1 - 0.5, top = tile.v0 - 0.5, bottom = tile.v1 - 0.5;
    const auto corner = [&](double u, double v) { return Eigen::Vector3d(world_T_optical_.linear() * k_.ray(u, v)); };
    const Eigen::Vector3d a = corner(left, top), b = corner(right, top), c = corner(right, bottom),
                          d = corner(left, bottom);
    const Eigen::Vector3d planes[4] = {d.cross(a), a.cross(b), b.cross(c), c.cross(d)};
    const Eigen::Vector3d eye = eye_.cast<double>();
    const double reach_sq = double(range_max_) * double(range_max_) * (1.0 + 1e-6);
    const auto in_sight = [&](const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
      const Eigen::Vector3d lo = min.cast<double>() - eye, hi = max.cast<double>() - eye;
      for (const Eigen::Vector3d& n : planes) {
        double farthest = 0.0;
        for (int i = 0; i < 3; ++i) farthest += n[i] * (n[i] > 0.0 ? hi[i] : lo[i]);
        if (farthest < 0.0) return false;
      }
      return lo.cwiseMax(-hi).cwiseMax(0.0).squaredNorm() <= reach_sq;
    };
    const int budget = kTestsPerPixel * kEdge * kEdge;
    int tests = 0;
    bvh_.visit(in_sight, [&](std::uint32_t triangle, const Triangle& t) {
      const Tile covers = covered(tile, t);
      if (covers.u0 >= covers.u1 || covers.v0 >= covers.v1) return true;
      tests += (covers.u1 - covers.u0) * (covers.v1 - covers.v0);
      candidates_.push_back({&t, triangle, covers});
      return tests <= budget && candidates_.size() <= kMaxTriangles;
    });
    return tests <= budget && candidates_.size() <= kMaxTriangles;
  }

  /// The pixels of a tile that a triangle may cover: the bounding rectangle of its projection, with a margin that is
  /// larger than the rounding errors. A triangle that is partly behind the eye may cover the whole tile.
  Tile covered(const Tile& tile, const Triangle& t) const {
    double u_min = 1e300, u_max = -1e300, v_min = 1e300, v_max = -1e300;
    int behind = 0;
    for (const Eigen::Vector3f& corner : t) {
      const Eigen::Vector3d p = rotation_ * (corner.cast<double>() - eye_.cast<double>());
      if (!(p.z() > 1e-6 * p.cwiseAbs().maxCoeff())) {
        ++behind;
        continue;
      }
      const Eigen::Vector2d pixel = k_.project(p);
      u_min = std::min(u_min, pixel.x()), u_max = std::max(u_max, pixel.x());
      v_min = std::min(v_min, pixel.y()), v_max = std::max(v_max, pixel.y());
    }
    if (behind == 3) return {0, 0, 0, 0};
    if (behind > 0) return tile;
    const double margin_u = 0.01 + 1e-6 * (k_.fx + std::abs(k_.cx)), margin_v = 0.01 + 1e-6 * (k_.fy + std::abs(k_.cy));
    const auto first = [](double x, int low, int high) {
      return static_cast<int>(std::clamp(std::ceil(x), double(low), double(high)));
    };
    const auto last = [](double x, int low, int high) {
      return static_cast<int>(std::clamp(std::floor(x) + 1.0, double(low), double(high)));
    };
    return {first(u_min - margin_u, tile.u0, tile.u1), first(v_min - margin_v, tile.v0, tile.v1),
            last(u_max + margin_u, tile.u0, tile.u1), last(v_max + margin_v, tile.v0, tile.v1)};
  }

  /// Tests a candidate against each pixel that it may cover, with the arithmetic of Bvh::closest().
  void test_pixels(const Tile& tile, const Candidate& c) {
    const SeenTriangle seen(*c.corners, eye_.cast<double>());
    const int width = tile.u1 - tile.u0;
    for (int v = c.covers.v0; v < c.covers.v1; ++v) {
      const Eigen::Vector3d* direction =
          &directions_[static_cast<std::size_t>((v - tile.v0) * width + c.covers.u0 - tile.u0)];
      std::size_t pixel = index(c.covers.u0, v);
      for (int u = c.covers.u0; u < c.covers.u1; ++u, ++direction, ++pixel) {
        TriangleHit hit;
        if (!seen.meets(*direction, hit)) continue;
        const auto t = static_cast<float>(hit.t);
        if (t >= 0.0f && t <= range_max_) offer(pixel, t, c.triangle);
      }
    }
  }

  /// Stores a hit if it is nearer than the one stored so far; of equal ranges the lower triangle index wins.
  void offer(std::size_t pixel, float range, std::uint32_t triangle) {
    std::uint32_t& best = image_.triangle[pixel];
    if (best != kNoHit && (range > image_.range[pixel] || (range == image_.range[pixel] && triangle > best))) return;
    image_.range[pixel] = range;
    best = triangle;
  }

  /// Traces a tile ray by ray.
  void trace_rays(const Tile& tile) {
    for (int v = tile.v0; v < tile.v1; ++v)
      for (int u = tile.u0; u < tile.u1; ++u)
        if (const auto hit = bvh_.closest(eye_, ray_direction(k_, world_T_optical_, u, v), 0.0f, range_max_))
          offer(index(u, v), hit->t, hit->triangle);
    drop_near(tile);
  }

  /// Removes the hits that are nearer than the sensor can measure.
  void drop_near(const Tile& tile) {
    for (int v = tile.v0; v < tile.v1; ++v)
      for (std::size_t i = index(tile.u0, v); i < index(tile.u1, v); ++i)
        if (image_.triangle[i] != kNoHit && image_.range[i] < range_min_) {
          image_.triangle[i] = kNoHit;
          image_.range[i] = 0.0f;
        }
  }

  std::size_t index(int u, int v) const { return std::size_t(v) * std::size_t(k_.width) + std::size_t(u); }

  const Bvh& bvh_;
  const sensor::Intrinsics& k_;
  const Pose& world_T_optical_;
  Eigen::Matrix3d rotation_;  // optical_R_world
  Eigen::Vector3f eye_;
  float range_min_, range_max_;
  RayImage& image_;
  std::vector<Candidate> candidates_;
  std::vector<Eigen::Vector3d> directions_;  // of the rays through the tile's pixels
};

}  // namespace

Eigen::Vector3f ray_direction(const sensor::Intrinsics& intrinsics, const Pose& world_T_optical, double u, double v) {
  return rounded((world_T_optical.linear() * intrinsics.ray(u, v)).normalized());
}

RayImage raycast(const TracedScene& scene, const sensor::Intrinsics& intrinsics, const Pose& world_T_optical,
                 double range_min, double range_max, int threads) {
  check_camera(intrinsics, world_T_optical);
  check_parameter(range_min >= 0.0, "range_min", "zero or more", range_min);
  check_parameter(range_max >= range_min, "range_max", "range_min or more", range_max);
  RayImage image;
  image.range.assign(intrinsics.size(), 0.0f);
  image.triangle.assign(intrinsics.size(), kNoHit);
  constexpr int kEdge = TileTracer::kEdge;
  const int columns = (intrinsics.width + kEdge - 1) / kEdge, rows = (intrinsics.height + kEdge - 1) / kEdge;
  // A chunk is a row of tiles.
  parallel_chunks(
      std::size_t(columns) * std::size_t(rows), threads, std::size_t(columns), [&](std::size_t begin, std::size_t end) {
        TileTracer tracer(scene, intrinsics, world_T_optical, float(range_min), float(range_max), image);
        for (std::size_t i = begin; i < end; ++i) {
          const int u0 = int(i % std::size_t(columns)) * kEdge, v0 = int(i / std::size_t(columns)) * kEdge;
          tracer.trace({u0, v0, std::min(u0 + kEdge, intrinsics.width), std::min(v0 + kEdge, intrinsics.height)});
        }
      });
  return image;
}

}  // namespace agrisee::study
