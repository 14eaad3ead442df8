// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/kdtree.hpp>
#include <agrisee/io/render.hpp>

#include <string>

#include "panel.hpp"
#include "text.hpp"

namespace agrisee::io {
namespace {

constexpr int kS = Canvas::kScale;
const Color kInk(0.13f, 0.16f, 0.20f), kFaint(0.45f, 0.49f, 0.54f), kPaper(0.985f, 0.988f, 0.992f);
const Color kAxisColors[3] = {Color(0.86f, 0.15f, 0.15f), Color(0.13f, 0.62f, 0.22f), Color(0.14f, 0.33f, 0.86f)};
const Color kUnlabelled(0.60f, 0.63f, 0.58f);

/// What the picture looks at, and from where.
struct Framing {
  std::vector<Eigen::Vector3d> subjects;  // corners of what has to be in sight
  Eigen::Vector3d forward = Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
};

std::vector<Eigen::Vector3d> corners(const Aabb& box) {
  std::vector<Eigen::Vector3d> out;
  for (int i = 0; i < 8; ++i)
    out.emplace_back(i & 1 ? box.max.x() : box.min.x(), i & 2 ? box.max.y() : box.min.y(),
                     i & 4 ? box.max.z() : box.min.z());
  return out;
}

/// The extent of the points, the outermost hundredth at each end left out, with a margin.
Aabb extent(const Cloud& cloud, const Labels* only_fruit) {
  Aabb box;
  std::vector<float> values;
  for (int a = 0; a < 3; ++a) {
    values.clear();
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (is_finite(cloud.points[i]) && (!only_fruit || (*only_fruit)[i] > 0)) values.push_back(cloud.points[i][a]);
    if (values.empty()) return {};
    const std::size_t cut = values.size() / 100;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cut), values.end());
    box.min[a] = double(values[cut]);
    std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(cut), values.end());
    box.max[a] = double(values[values.size() - 1 - cut]);
  }
  const double margin = 0.04 * box.size().norm() + 1e-3;
  box.min.array() -= margin;
  box.max.array() += margin;
  return box;
}

Framing frame(const ScanResult& result, const Workcell& workcell) {
  Framing framing;
  const bool volume = !workcell.scan_volume.empty();
  Aabb box = extent(result.cloud, volume && !result.labels.empty() ? &result.labels : nullptr);
  if (box.empty()) box = extent(result.cloud, nullptr);
  if (volume) {
    framing.forward = workcell.scan_volume.center() - workcell.world_T_base.translation();
    framing.forward.z() = 0.0;
    if (box.empty()) box = workcell.scan_volume;
  } else {
    if (box.empty()) box.min.setConstant(-0.2), box.max.setConstant(0.2);
    Eigen::Vector3f facing = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& n : result.cloud.normals)
      if (n.allFinite()) facing += n;
    const Eigen::Vector3f direction = facing.normalized();
    if (std::abs(direction.z()) > 0.8f) {  // a cloud in a sensor's own frame: z forward, y down
      framing.forward = Eigen::Vector3d(0.0, 0.0, direction.z() < 0.0f ? 1.0 : -1.0);
      framing.up = -Eigen::Vector3d::UnitY();
    } else {
      framing.forward = Eigen::Vector3d(-double(direction.x()), -double(direction.y()), 0.0);
    }
  }
  if (!(framing.forward.norm() > 1e-6)) framing.forward = Eigen::Vector3d::UnitY();
  framing.forward.normalize();
  framing.subjects = corners(box);
  for (const Fruit& fruit : result.fruits)
    if (fruit.body && fruit.body->radii.allFinite() && fruit.body->center.allFinite() && fruit.body->radii.norm() < 0.5)
      for (int k = 0; k < 6; ++k) {
        const Eigen::Vector3d axis = (k < 3 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(k % 3);
        framing.subjects.push_back(fruit.body->center + 1.15 * fruit.body->radii[0] * axis);
      }
  return framing;
}

/// A radius that closes the gaps: by the median distance to the nearest neighbours, at most 6 mm.
float splat_radius(const Cloud& cloud) {
  constexpr std::size_t kSample = 400;
  if (cloud.size() < 2) return 0.003f;
  const KdTree<float> tree(cloud);
  Neighbors<float> near;
  std::vector<float> distances;
  const std::size_t step = std::max<std::size_t>(cloud.size() / kSample, 1);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    tree.knn(cloud.points[i], 6, near);
    if (near.size() > 1) distances.push_back(near.back().distance);
  }
  if (distances.empty()) return 0.003f;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return std::clamp(1.15f * *middle, 0.00005f, 0.006f);
}

/// The ellipse along which sight lines touch an ellipsoid: in coordinates where that is the unit sphere, the circle on
/// the plane at 1 / |eye| towards the eye.
std::vector<Eigen::Vector3d> outline(const Body& body, const Eigen::Vector3d& eye) {
  constexpr int kSegments = 96;
  const Eigen::Matrix3d from_unit = body.axes * body.radii.asDiagonal();
  const Eigen::Vector3d e = body.radii.cwiseInverse().asDiagonal() * (body.axes.transpose() * (eye - body.center));
  const double distance = e.norm();
  std::vector<Eigen::Vector3d> points;
  if (!(distance > 1.0) || !std::isfinite(distance)) return points;
  const Eigen::Vector3d n = e / distance, u = any_orthogonal<double>(n), v = n.cross(u);
  const double r = std::sqrt(1.0 - 1.0 / (distance * distance));
  for (int i = 0; i <= kSegments; ++i) {
    const double angle = kTwoPi * i / kSegments;
    points.push_back(body.center + from_unit * (n / distance + r * (std::cos(angle) * u + std::sin(angle) * v)));
  }
  return points;
}

void draw_frame(Panel& panel, const Pose& pose, double length, float width) {
  const Eigen::Vector3d o = pose.translation();
  int order[3] = {0, 1, 2};  // farthest tip first
  std::sort(order, order + 3, [&](int a, int b) {
    return panel.axis(2).dot(pose.linear().col(a)) > panel.axis(2).dot(pose.linear().col(b));
  });
  for (const float extra : {2.5f, 0.0f})
    for (const int i : order)
      panel.line(o, o + length * pose.linear().col(i), extra > 0.0f ? Color::Ones().eval() : kAxisColors[i],
                 {width + extra, 1.0f, 1.0f}, Cap::round);
}

void draw_fruit(Canvas& canvas, Panel& panel, const std::vector<Fruit>& fruits, float size) {
  for (const Fruit& fruit : fruits)
    if (fruit.body) {
      const Color c = mix(color(fruit_color(fruit.id)), kInk, 0.45f);
      panel.polyline(outline(*fruit.body, panel.eye()), c, {1.6f * kS, 0.9f, 0.35f});
    }
  for (const Fruit& fruit : fruits)
    if (fruit.centroid.allFinite()) draw_frame(panel, fruit.pose(), 0.03, 2.2f * kS);
  for (const Fruit& fruit : fruits) {  // numbers beside the frames' origins, on top of everything
    if (!fruit.centroid.allFinite()) continue;
    const Eigen::Vector3f at = panel.project(fruit.centroid);
    if (!(at.z() > 0.05f)) continue;
    const std::string number = std::to_string(fruit.id);
    const float width = Canvas::text_width(size, number), radius = std::max(0.5f * width + 0.55f * size, 1.05f * size);
    const Eigen::Vector2f center = at.head<2>() - Eigen::Vector2f(1.9f * size, 1.3f * size);
    canvas.disc(center, radius + 1.2f * kS, color(fruit_color(fruit.id)));
    canvas.disc(center, radius, Color::Ones());
    canvas.text(center + Eigen::Vector2f(-0.5f * width, 0.5f * size), size, number, kInk, 0.16f);
  }
}

Color view_color(std::size_t i, std::size_t n) {
  const float share = n > 1 ? static_cast<float>(i) / static_cast<float>(n - 1) : 0.0f;
  return mix(Color(0.10f, 0.14f, 0.40f), Color(0.36f, 0.66f, 0.93f), share);
}

/// The sensor's pyramid of sight, drawn small.
std::vector<Eigen::Vector3d> frustum(const View& view, const sensor::Intrinsics& k, double depth) {
  std::vector<Eigen::Vector3d> points{view.world_T_optical.translation()};
  for (const auto& [u, v] : {std::pair{0, 0}, {k.width - 1, 0}, {k.width - 1, k.height - 1}, {0, k.height - 1}})
    points.push_back(view.world_T_optical * (depth * k.ray(u, v)));
  return points;
}

void draw_views(Panel& panel, const std::vector<View>& views, const sensor::Intrinsics& k) {
  for (std::size_t i = 1; i < views.size(); ++i)
    panel.line(views[i - 1].world_T_optical.translation(), views[i].world_T_optical.translation(),
               mix(view_color(i, views.size()), Color::Ones(), 0.35f), {1.3f * kS, 0.9f, 0.25f});
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Color c = view_color(i, views.size());
    const std::vector<Eigen::Vector3d> f = frustum(views[i], k, 0.035);
    const LineStyle style{1.5f * kS, 1.0f, 0.3f};
    for (std::size_t j = 1; j <= 4; ++j) {
      panel.line(f[0], f[j], c, style);
      panel.line(f[j], f[j % 4 + 1], c, style);
    }
    panel.line(f[0], f[0] + 1e-6 * panel.axis(0), c, {5.0f * kS, 1.0f, 0.3f}, Cap::round);
  }
}

void draw_box(Panel& panel, const Aabb& box) {
  const std::vector<Eigen::Vector3d> c = corners(box);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t bit = 1; bit < 8; bit *= 2)
      if (!(i & bit)) panel.line(c[i], c[i | bit], Color(0.50f, 0.55f, 0.62f), {1.0f * kS, 0.8f, 0.18f});
}

/// A bar of a round length in the corner of a panel, true at the depth of `at`.
void draw_scale(Canvas& canvas, const Panel& panel, const Eigen::Vector3d& at, float size) {
  const float per_metre = panel.scale(std::max(panel.project(at).z(), 0.05f));
  double length = 1e-3;
  for (const double step : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0})
    if (static_cast<float>(step) * per_metre < 0.22f * static_cast<float>(panel.viewport().width)) length = step;
  const float pixels = static_cast<float>(length) * per_metre;
  const Viewport& v = panel.viewport();
  const Eigen::Vector2f a(static_cast<float>(v.x) + 2.0f * size, static_cast<float>(v.y + v.height) - 2.0f * size);
  canvas.line(a, a + Eigen::Vector2f(pixels, 0.0f), 1.6f * kS, kInk, 1.0f, Cap::butt);
  for (const float x : {0.0f, pixels})
    canvas.line(a + Eigen::Vector2f(x, -0.4f * size), a + Eigen::Vector2f(x, 0.4f * size), 1.6f * kS, kInk);
  canvas.text(a + Eigen::Vector2f(0.0f, -0.8f * size), 0.8f * size, format(length * 1000.0) + " mm", kInk);
}

/// World's axes, in the other corner.
void draw_triad(Canvas& canvas, const Panel& panel, float size) {
  const Viewport& v = panel.viewport();
  const Eigen::Vector2f o(static_cast<float>(v.x + v.width) - 5.0f * size,
                          static_cast<float>(v.y + v.height) - 3.2f * size);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2f tip(static_cast<float>(panel.axis(0)[i]), static_cast<float>(panel.axis(1)[i]));
    canvas.line(o, o + 2.6f * size * tip, 1.6f * kS, kAxisColors[i]);
    const char name[] = {"xyz"[i], '\0'};
    const float width = Canvas::text_width(0.8f * size, name);
    if (tip.norm() > 0.25f)
      canvas.text(o + (2.6f + 0.9f / tip.norm()) * size * tip + Eigen::Vector2f(-0.5f * width, 0.3f * size),
                  0.8f * size, name, kAxisColors[i]);
  }
}

std::string count(std::size_t n, const char* noun, const char* plural) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits + " " + (n == 1 ? noun : plural);
}

void draw_title(Canvas& canvas, const ScanResult& result, const Workcell& workcell, int height, float size) {
  const float base = 0.5f * static_cast<float>(height) + 0.65f * size, left = 2.0f * size;
  const std::string name = workcell.name.empty() ? "AgriSEE" : workcell.name.substr(0, 48);
  const float end = canvas.text({left, base}, 1.3f * size, name, kInk, 0.15f);
  std::string caption =
      count(result.fruits.size(), "fruit", "fruit") + ",  " + count(result.cloud.size(), "point", "points");
  if (!result.views.empty()) caption = count(result.views.size(), "view", "views") + ",  " + caption;
  if (result.stop_reason != StopReason::not_stopped) {
    std::string reason = to_string(result.stop_reason);
    std::replace(reason.begin(), reason.end(), '_', ' ');
    caption += ",  stopped: " + reason;
  }
  canvas.text({end + 2.2f * size, base}, 0.9f * size, caption, kFaint);
  if (result.fruits.empty()) return;
  constexpr std::string_view kNote = "centroids x, y, z in world below";
  const float width = Canvas::text_width(0.8f * size, kNote);
  canvas.text({static_cast<float>(canvas.width()) - left - width, base}, 0.8f * size, kNote, kFaint);
}

/// One entry a fruit: its number and where it is, in columns.
void draw_legend(Canvas& canvas, const std::vector<Fruit>& fruits, int top, float size) {
  constexpr std::size_t kColumns = 6, kRows = 3;
  const auto w = static_cast<float>(canvas.width());
  const float left = 2.0f * size, column = (w - 2.0f * left) / static_cast<float>(kColumns), row = 2.15f * size;
  for (std::size_t i = 0; i < fruits.size(); ++i) {
    const Eigen::Vector2f at(left + column * static_cast<float>(i % kColumns),
                             static_cast<float>(top) + row * (0.95f + static_cast<float>(i / kColumns)));
    if (i + 1 == kColumns * kRows && fruits.size() > kColumns * kRows) {
      canvas.text(at + Eigen::Vector2f(0.0f, 0.4f * size), 0.8f * size,
                  "and " + std::to_string(fruits.size() - i) + " more", kFaint);
      return;
    }
    const Fruit& fruit = fruits[i];
    canvas.disc(at + Eigen::Vector2f(0.6f * size, 0.0f), 0.62f * size, color(fruit_color(fruit.id)));
    const Eigen::Vector2f text = at + Eigen::Vector2f(1.8f * size, 0.4f * size);
    const float end = canvas.text(text, 0.8f * size, std::to_string(fruit.id), kInk, 0.16f);
    if (!fruit.centroid.allFinite()) continue;
    std::string place;
    for (int a = 0; a < 3; ++a) place += (a ? ", " : "") + std::to_string(std::lround(1000.0 * fruit.centroid[a]));
    canvas.text({std::max(end, text.x() + 1.3f * size), text.y()}, 0.8f * size, place + " mm", kFaint);
  }
}

void check(const ScanResult& result) {
  const Cloud& cloud = result.cloud;
  check_input(result.labels.empty() || result.labels.size() == cloud.size(), "render: not one label per point");
  check_input(cloud.normals.empty() || cloud.normals.size() == cloud.size(), "render: not one normal per point");
}

}  // namespace

Image render(const ScanResult& result, const Workcell& workcell, int width, int height) {
  check_parameter(width >= 640, "picture width", ">= 640", width);
  check_parameter(height >= 360, "picture height", ">= 360", height);
  check(result);
  Canvas canvas(width, height);
  const int w = canvas.width(), h = canvas.height();
  const float size = static_cast<float>(h) / 75.0f;  // of small text
  const std::size_t rows = std::min<std::size_t>((result.fruits.size() + 5) / 6, 3);
  const int title = static_cast<int>(4.4f * size),
            legend = static_cast<int>((rows > 0 ? 1.0f + 2.15f * static_cast<float>(rows) : 0.6f) * size);
  const int middle = w / 2, gap = kS;
  canvas.fill(0, 0, w, h, kPaper, kPaper);
  const Viewport left{0, title, middle - gap, h - title - legend},
      right{middle + gap, title, w - middle - gap, h - title - legend};
  for (const Viewport& v : {left, right})
    canvas.fill(v.x, v.y, v.x + v.width, v.y + v.height, Color(0.955f, 0.965f, 0.976f), Color(0.845f, 0.868f, 0.895f));

  Splats splats{result.cloud, {}, splat_radius(result.cloud)};
  splats.colors.reserve(result.cloud.size());
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    const int label = result.labels.empty() ? 0 : result.labels[i];
    splats.colors.push_back(label > 0 ? color(fruit_color(label)) : kUnlabelled);
  }
  const Framing framing = frame(result, workcell);
  const Eigen::Vector3d up = framing.up, side = framing.forward.cross(up).normalized();
  const bool volume = !workcell.scan_volume.empty();
  Aabb box;
  for (const Eigen::Vector3d& p : framing.subjects) box.extend(p);

  Panel front(canvas, left, framing.forward - 0.06 * up, up, framing.subjects);
  front.draw(splats);
  draw_fruit(canvas, front, result.fruits, 1.15f * size);
  draw_scale(canvas, front, box.center(), size);
  draw_triad(canvas, front, size);

  std::vector<Eigen::Vector3d> wide = volume ? corners(workcell.scan_volume) : framing.subjects;
  for (const View& view : result.views)
    if (is_rigid(view.world_T_optical)) {
      const auto f = frustum(view, workcell.sensor.intrinsics, 0.05);
      wide.insert(wide.end(), f.begin(), f.end());
    }
  Panel oblique(canvas, right, 0.62 * framing.forward - 0.70 * side - 0.42 * up, up, wide);
  oblique.draw(splats);
  if (volume) draw_box(oblique, workcell.scan_volume);
  draw_views(oblique, result.views, workcell.sensor.intrinsics);
  draw_fruit(canvas, oblique, result.fruits, 0.8f * size);
  draw_scale(canvas, oblique, box.center(), size);
  draw_triad(canvas, oblique, size);

  const float line = static_cast<float>(title) + 2.6f * size;
  canvas.text({static_cast<float>(left.x) + 2.0f * size, line}, 0.85f * size,
              volume ? "from the front, as the robot sees it" : "from the front", kFaint);
  canvas.text({static_cast<float>(right.x) + 2.0f * size, line}, 0.85f * size,
              result.views.empty() ? "from the side" : "from the side, with the sensor's path (first view dark)",
              kFaint);
  draw_title(canvas, result, workcell, title, size);
  draw_legend(canvas, result.fruits, h - legend, size);
  return canvas.image();
}

void write_picture(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell) {
  write_png(path, render(result, workcell));
}

}  // namespace agrisee::io
