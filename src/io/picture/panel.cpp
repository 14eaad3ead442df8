// SPDX-License-Identifier: BSD-3-Clause
#include "io/picture/panel.hpp"

#include <Eigen/Geometry>

#include <limits>

namespace agrisee::io {
namespace {

constexpr float kNear = 0.02f;     // least depth of what is drawn (m)
constexpr double kOpening = 0.30;  // half the field of view across the shorter side of the viewport (rad)
constexpr double kFilled = 0.94;   // share of the viewport that the subjects fill at most
constexpr float kFarAway = std::numeric_limits<float>::infinity();

}  // namespace

Panel::Panel(Canvas& canvas, const Viewport& viewport, const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
             const std::vector<Eigen::Vector3d>& subjects)
    : canvas_(canvas), viewport_(viewport) {
  const Eigen::Vector3d forward = direction.normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  rotation_.row(0) = right.transpose();
  rotation_.row(1) = forward.cross(right).transpose();
  rotation_.row(2) = forward.transpose();
  focal_ = static_cast<float>(0.5 * std::min(viewport.width, viewport.height) / std::tan(kOpening));
  cx_ = static_cast<float>(viewport.x) + 0.5f * static_cast<float>(viewport.width - 1);
  cy_ = static_cast<float>(viewport.y) + 0.5f * static_cast<float>(viewport.height - 1);
  depth_.assign(static_cast<std::size_t>(viewport.width) * static_cast<std::size_t>(viewport.height), kFarAway);

  // Find the nearest eye from which every subject projects into the viewport. Along each image axis the two outermost
  // planes of sight through the subjects bound the eye, and it is placed where these planes meet.
  if (subjects.empty()) return;
  const double inf = std::numeric_limits<double>::infinity();
  Eigen::Vector3d place(0.0, 0.0, inf);
  double nearest = inf;
  for (int axis = 0; axis < 2; ++axis) {
    const double tangent = 0.5 * kFilled * (axis == 0 ? viewport.width : viewport.height) / double(focal_);
    // For the eye (e, z0): x - e <= t (z - z0) and e - x <= t (z - z0) for all subjects.
    double above = -inf, below = inf;
    for (const Eigen::Vector3d& p : subjects) {
      const Eigen::Vector3d q = rotation_ * p;
      above = std::max(above, q[axis] - tangent * q.z());
      below = std::min(below, q[axis] + tangent * q.z());
      nearest = std::min(nearest, q.z());
    }
    place[axis] = 0.5 * (above + below);
    place.z() = std::min(place.z(), (below - above) / (2.0 * tangent));
  }
  place.z() = std::min(place.z(), nearest - 2.0 * double(kNear));
  eye_ = rotation_.transpose() * place;
}

Eigen::Vector3f Panel::project(const Eigen::Vector3d& p) const {
  const Eigen::Vector3f q = (rotation_ * (p - eye_)).cast<float>();
  const float z = std::max(q.z(), kNear);
  return {cx_ + focal_ * q.x() / z, cy_ + focal_ * q.y() / z, q.z()};
}

/// Call visit(i, j, row, point, normal, behind) for every row of pixels across every disc; i and j are the column and
/// row of the first. `normal` is turned towards the eye; `behind` says whether the disc is seen from its back.
template <typename Visit>
void Panel::rasterise(const Splats& splats, Visit&& visit) const {
  const Cloud& cloud = splats.cloud;
  const Eigen::Matrix3f rotation = rotation_.cast<float>();
  const float focal = focal_, inverse_focal = 1.0f / focal;
  const float cx = cx_ - static_cast<float>(viewport_.x), cy = cy_ - static_cast<float>(viewport_.y);
  constexpr float kSteepest = 0.25f;  // discs seen more edge-on than this cosine are turned, to close gaps
  Row row;
  for (std::size_t point = 0; point < cloud.size(); ++point) {
    if (!is_finite(cloud.points[point])) continue;
    const Eigen::Vector3f p = (rotation_ * (cloud.points[point].cast<double>() - eye_)).cast<float>();
    if (!(p.z() > kNear)) continue;
    const Eigen::Vector3f sight = p.normalized();
    Eigen::Vector3f n =
        cloud.normals.empty() ? Eigen::Vector3f::Zero().eval() : (rotation * cloud.normals[point]).eval();
    const bool known = n.squaredNorm() > 0.25f && n.allFinite();
    bool behind = false;
    Eigen::Vector3f plane = -sight;
    if (known) {
      behind = n.dot(sight) > 0.0f;
      if (behind) n = -n;
      plane = n;
      const float facing = -n.dot(sight);
      if (facing < kSteepest) plane = (n - (kSteepest - facing) * 1.1f * sight).normalized();
    } else {
      n = -sight;
    }
    const float scale = focal / p.z();
    const float drawn = std::clamp(splats.radius * scale, kSmallest, kLargest);
    const float radius = drawn / scale, inverse_sq = 1.0f / (radius * radius);
    const float u = cx + p.x() * scale, v = cy + p.y() * scale;
    if (!(std::abs(u) < 1e6f && std::abs(v) < 1e6f)) continue;
    const float distance = plane.dot(p);
    // A tilted disc appears as an ellipse. Perspective shifts its edge slightly; one pixel is added for that.
    const float half_i = drawn * std::sqrt(std::max(1.0f - plane.x() * plane.x(), 0.0f)) + 1.0f;
    const float half_j = drawn * std::sqrt(std::max(1.0f - plane.y() * plane.y(), 0.0f)) + 1.0f;
    const int i0 = std::max(0, static_cast<int>(std::ceil(u - half_i)));
    const int i1 = std::min(viewport_.width - 1, static_cast<int>(std::floor(u + half_i)));
    const int j0 = std::max(0, static_cast<int>(std::ceil(v - half_j)));
    const int j1 = std::min(viewport_.height - 1, static_cast<int>(std::floor(v + half_j)));
    if (i0 > i1) continue;
    for (int j = j0; j <= j1; ++j) {
      const float y = (static_cast<float>(j) - cy) * inverse_focal;
      for (int i = i0; i <= i1; ++i) {
        const float x = (static_cast<float>(i) - cx) * inverse_focal;
        const float z = distance / (plane.x() * x + plane.y() * y + plane.z());
        const float dx = z * x - p.x(), dy = z * y - p.y(), dz = z - p.z();
        row.depth[i - i0] = z;
        row.share[i - i0] = (dx * dx + dy * dy + dz * dz) * inverse_sq;
      }
      row.size = i1 - i0 + 1;
      visit(i0, j, row, point, n, behind);
    }
  }
}

/// Factors that darken gaps and contacts (eye-dome lighting; Boucheny, 2009), for the pixels [begin, end) of row j: 1
/// where no pixel nearby is nearer to the eye; smaller the more of them are, and the nearer, up to a difference of
/// depth of `deep` (m).
void Panel::openness(int j, int begin, int end, float deep, std::vector<float>& out) const {
  // Three rings of eight neighbors.
  static constexpr int kNeighbors[24][2] = {{2, 0},  {1, 1}, {0, 2},  {-1, 1}, {-2, 0},  {-1, -1}, {0, -2},  {1, -1},
                                            {5, 0},  {4, 4}, {0, 5},  {-4, 4}, {-5, 0},  {-4, -4}, {0, -5},  {4, -4},
                                            {11, 0}, {8, 8}, {0, 11}, {-8, 8}, {-11, 0}, {-8, -8}, {0, -11}, {8, -8}};
  const float inverse = 1.0f / deep;
  out.assign(static_cast<std::size_t>(viewport_.width), 0.0f);
  float* const sums = out.data();
  const float* const own = &depth_[cell(0, j)];
  for (const auto& [di, dj] : kNeighbors) {
    if (j + dj < 0 || j + dj >= viewport_.height) continue;
    const float* const other = &depth_[cell(0, j + dj)];
    const int last = std::min(end, viewport_.width - di);
    for (int i = std::max(begin, -di); i < last; ++i) {
      const float nearer = (own[i] - other[i + di]) * inverse;
      sums[i] += nearer > 0.0f ? (nearer < 1.0f ? nearer : 1.0f) : 0.0f;
    }
  }
  for (int i = begin; i < end; ++i) sums[i] = std::exp(-1.6f / 24.0f * sums[i]);
}

void Panel::draw(const Splats& splats) {
  Extent drawn;
  rasterise(splats, [&](int i0, int j, const Row& row, std::size_t, const Eigen::Vector3f&, bool) {
    drawn.extend(i0, j, row.size);
    float* const depth = &depth_[cell(i0, j)];
    for (int i = 0; i < row.size; ++i)
      depth[i] = row.share[i] < 1.0f && row.depth[i] < depth[i] ? row.depth[i] : depth[i];
  });
  // Blend the discs that are near the foremost one (Zwicker et al., "Surface Splatting", SIGGRAPH 2001).
  std::vector<Pixel> pixels(drawn.size());
  const float together = 1.5f * splats.radius;
  rasterise(splats, [&](int i0, int j, const Row& row, std::size_t point, const Eigen::Vector3f& n, bool behind) {
    Color c = splats.colors[point];
    if (behind) c = mix(c, Color(0.42f, 0.42f, 0.44f), 0.55f);
    const Eigen::Array4f color(c.x(), c.y(), c.z(), 1.0f), normal(n.x(), n.y(), n.z(), 0.0f);
    Pixel* const first = &pixels[drawn.at(i0, j)];
    const float* const depth = &depth_[cell(i0, j)];
    for (int i = 0; i < row.size; ++i) {
      if (!(row.share[i] < 1.0f)) continue;
      Pixel& pixel = first[i];
      if (row.depth[i] > depth[i] + together) {
        pixel.normal[3] = 1.0f;
        continue;
      }
      const float open = 1.0f - row.share[i], weight = open * open + 1e-3f;
      pixel.color += weight * color;
      pixel.normal += weight * normal;
    }
  });
  shade(pixels, drawn, 8.0f * splats.radius);
}

/// Light the pixels and put them onto the canvas. @param deep see openness()
void Panel::shade(const std::vector<Pixel>& pixels, const Extent& drawn, float deep) {
  constexpr float kOpaque = 0.08f;  // sum of weights; the border of a surface fades below it, where nothing is behind
  const Eigen::Vector3f light =
      Eigen::Vector3f(-0.45f, -0.60f, -0.66f).normalized();  // from behind the left shoulder of the viewer
  const Eigen::Vector3f halfway = (light + Eigen::Vector3f(0.0f, 0.0f, -1.0f)).normalized();
  std::vector<float> open;
  for (int j = drawn.top; j < drawn.bottom; ++j) {
    int begin = drawn.left, end = drawn.right;  // between the outermost pixels of the row that are drawn
    while (begin < end && pixels[drawn.at(begin, j)].weight() <= 0.0f) ++begin;
    while (begin < end && pixels[drawn.at(end - 1, j)].weight() <= 0.0f) --end;
    openness(j, begin, end, deep, open);
    for (int i = begin; i < end; ++i) {
      const Pixel& pixel = pixels[drawn.at(i, j)];
      const float weight = pixel.weight();
      if (weight <= 0.0f) continue;
      const Eigen::Vector3f n = pixel.normal.head<3>().matrix().normalized();
      const float facing = n.dot(light);
      const float diffuse = 0.42f + 0.62f * std::max(facing, 0.0f) + 0.08f * std::min(facing, 0.0f);
      const float x = std::max(n.dot(halfway), 0.0f), x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
      const float shine = 0.16f * x8 * x8 * x8 * x4 * x2;  // x to the power of 30
      const Color lit = pixel.color.head<3>().matrix() / weight * diffuse + Color::Constant(shine);
      const Color c = (lit * open[static_cast<std::size_t>(i)]).cwiseMin(1.0f);
      const float alpha = pixel.is_backed() ? 1.0f : std::min(weight / kOpaque, 1.0f);
      canvas_.blend(viewport_.x + i, viewport_.y + j, c, alpha);
    }
  }
}

void Panel::line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Color& c, const LineStyle& style, Cap cap) {
  Eigen::Vector3d p = rotation_ * (a - eye_), q = rotation_ * (b - eye_);
  if (!p.allFinite() || !q.allFinite()) return;
  if (p.z() < kNear && q.z() < kNear) return;
  if (p.z() < kNear) p = q + (p - q) * ((q.z() - kNear) / (q.z() - p.z()));
  if (q.z() < kNear) q = p + (q - p) * ((p.z() - kNear) / (p.z() - q.z()));
  const auto on_canvas = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector2f(cx_ + focal_ * static_cast<float>(v.x() / v.z()),
                           cy_ + focal_ * static_cast<float>(v.y() / v.z()));
  };
  const float near = 1.0f / static_cast<float>(p.z()), far = 1.0f / static_cast<float>(q.z());
  constexpr float kSlack = 0.0015f;  // m; so that a surface does not hide the lines on it
  canvas_.line(on_canvas(p), on_canvas(q), style.width, c, cap, [&](float t, int x, int y) {
    if (!inside(x, y)) return 0.0f;
    const float z = 1.0f / (near + t * (far - near));  // 1 / z is linear on the canvas
    return z > depth(x, y) + kSlack ? style.hidden : style.alpha;
  });
}

void Panel::polyline(const std::vector<Eigen::Vector3d>& points, const Color& c, const LineStyle& style) {
  for (std::size_t i = 1; i < points.size(); ++i) line(points[i - 1], points[i], c, style);
}

}  // namespace agrisee::io
