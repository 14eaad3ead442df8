// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/render.hpp>

#include <string>

#include "io/formats/text.hpp"
#include "io/picture/badges.hpp"
#include "io/picture/framing.hpp"
#include "io/picture/legend.hpp"
#include "io/picture/panel.hpp"

namespace agrisee::io {
namespace {

const Color kPaper(0.985f, 0.988f, 0.992f);
const Color kPanelTop(0.955f, 0.965f, 0.976f), kPanelBottom(0.845f, 0.868f, 0.895f);
const Color kAxisColors[3] = {Color(0.86f, 0.15f, 0.15f), Color(0.13f, 0.62f, 0.22f), Color(0.14f, 0.33f, 0.86f)};
const Color kUnlabelled(0.60f, 0.63f, 0.58f);

Rectangle rectangle(const Viewport& v) {
  return {Eigen::Vector2f(static_cast<float>(v.x), static_cast<float>(v.y)),
          Eigen::Vector2f(static_cast<float>(v.x + v.width), static_cast<float>(v.y + v.height))};
}

/// The outline of an ellipsoid: the ellipse in which rays from the eye touch it. In coordinates in which the ellipsoid
/// is the unit sphere and the eye is at e, it is a circle in the plane at the distance 1 / |e| from the center, towards
/// e.
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

/// Draw the axes of a pose on a white border.
void draw_frame(Panel& panel, const Pose& pose, double length, float width) {
  const Eigen::Vector3d o = pose.translation();
  int order[3] = {0, 1, 2};  // the axis with the farthest tip is drawn first
  std::sort(order, order + 3, [&](int a, int b) {
    return panel.axis(2).dot(pose.linear().col(a)) > panel.axis(2).dot(pose.linear().col(b));
  });
  for (const float extra : {2.5f, 0.0f})
    for (const int i : order)
      panel.line(o, o + length * pose.linear().col(i), extra > 0.0f ? Color::Ones().eval() : kAxisColors[i],
                 {width + extra, 1.0f, 1.0f}, Cap::round);
}

/// Draw what a panel shows, in its upper corner. @return what it covers
Rectangle draw_caption(Canvas& canvas, const Panel& panel, const std::string& text, float size) {
  const Viewport& v = panel.viewport();
  const Eigen::Vector2f at(static_cast<float>(v.x) + 2.0f * size, static_cast<float>(v.y) + 2.6f * size);
  canvas.text(at, 0.85f * size, text, kPanelTop, 0.5f);  // a rim, so that it can be read on leaves
  canvas.text(at, 0.85f * size, text, kFaint);
  return {at - Eigen::Vector2f(0.0f, size), at + Eigen::Vector2f(Canvas::text_width(0.85f * size, text), 0.4f * size)};
}

/// Draw outlines of bodies and pose frames; on top of everything else, the ids beside the origins of the frames.
/// @param size height of the digits  @param taken parts of the panel that the ids must not cover
void draw_fruit(Canvas& canvas, Panel& panel, const std::vector<Fruit>& fruits, float size,
                const std::vector<Rectangle>& taken) {
  for (const Fruit& fruit : fruits)
    if (fruit.body) {
      const Color c = mix(color(fruit_color(fruit.id)), kInk, 0.45f);
      panel.polyline(outline(*fruit.body, panel.eye()), c, {1.6f, 0.9f, 0.35f});
    }
  std::vector<const Fruit*> shown;
  std::vector<Badge> wanted;
  const float border = 1.2f;
  for (const Fruit& fruit : fruits) {
    if (!fruit.position().allFinite()) continue;
    draw_frame(panel, fruit.pose(), fruit.body ? 0.85 * fruit.body->radii.maxCoeff() : 0.03, 2.2f);
    const Eigen::Vector3f at = panel.project(fruit.position());
    const Rectangle panel_edges = rectangle(panel.viewport());
    if (!(at.z() > 0.05f) || !((at.head<2>().array() >= panel_edges.min.array()).all() &&
                               (at.head<2>().array() <= panel_edges.max.array()).all()))
      continue;
    const float width = Canvas::text_width(size, std::to_string(fruit.id));
    const float radius = std::max(0.5f * width + 0.55f * size, 1.05f * size);
    shown.push_back(&fruit);
    wanted.push_back({at.head<2>() - Eigen::Vector2f(1.9f * size, 1.3f * size), radius + border});
  }
  const std::vector<Badge> badges = place_badges(wanted, taken, rectangle(panel.viewport()));
  for (std::size_t i = 0; i < badges.size(); ++i)  // a line to the fruit that a badge had to leave
    if ((badges[i].center - wanted[i].center).norm() > badges[i].radius)
      canvas.line(badges[i].center, panel.pixel(shown[i]->position()), border, color(fruit_color(shown[i]->id)));
  for (std::size_t i = 0; i < badges.size(); ++i) {
    const std::string number = std::to_string(shown[i]->id);
    const Eigen::Vector2f& center = badges[i].center;
    canvas.disc(center, badges[i].radius, color(fruit_color(shown[i]->id)));
    canvas.disc(center, badges[i].radius - border, Color::Ones());
    canvas.text(center + Eigen::Vector2f(-0.5f * Canvas::text_width(size, number), 0.5f * size), size, number, kInk,
                0.16f);
  }
}

/// The color of view `i` of `n`: dark for the first, light for the last.
Color view_color(std::size_t i, std::size_t n) {
  const float share = n > 1 ? static_cast<float>(i) / static_cast<float>(n - 1) : 0.0f;
  return mix(Color(0.10f, 0.14f, 0.40f), Color(0.36f, 0.66f, 0.93f), share);
}

/// The field of view of the sensor: its position, then the four corners at the given depth (m). World frame.
std::vector<Eigen::Vector3d> frustum(const View& view, const sensor::Intrinsics& k, double depth) {
  std::vector<Eigen::Vector3d> points{view.world_T_optical.translation()};
  for (const auto& [u, v] : {std::pair{0, 0}, {k.width - 1, 0}, {k.width - 1, k.height - 1}, {0, k.height - 1}})
    points.push_back(view.world_T_optical * (depth * k.ray(u, v)));
  return points;
}

/// Draw the path of the sensor, and a frustum per view.
void draw_views(Panel& panel, const std::vector<View>& views, const sensor::Intrinsics& k) {
  for (std::size_t i = 1; i < views.size(); ++i)
    panel.line(views[i - 1].world_T_optical.translation(), views[i].world_T_optical.translation(),
               mix(view_color(i, views.size()), Color::Ones(), 0.35f), {1.3f, 0.9f, 0.25f});
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Color c = view_color(i, views.size());
    const std::vector<Eigen::Vector3d> f = frustum(views[i], k, 0.035);
    const LineStyle style{1.5f, 1.0f, 0.3f};
    for (std::size_t j = 1; j <= 4; ++j) {
      panel.line(f[0], f[j], c, style);
      panel.line(f[j], f[j % 4 + 1], c, style);
    }
    panel.line(f[0], f[0] + 1e-6 * panel.axis(0), c, {5.0f, 1.0f, 0.3f}, Cap::round);
  }
}

void draw_box(Panel& panel, const Aabb& box) {
  const std::vector<Eigen::Vector3d> c = corners(box);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t bit = 1; bit < 8; bit *= 2)
      if (!(i & bit)) panel.line(c[i], c[i | bit], Color(0.50f, 0.55f, 0.62f), {1.0f, 0.8f, 0.18f});
}

/// Draw a scale bar in the corner of a panel. Its length is true at the depth of `at`.
/// @return what it covers
Rectangle draw_scale(Canvas& canvas, const Panel& panel, const Eigen::Vector3d& at, float size) {
  const float per_metre = panel.scale(std::max(panel.project(at).z(), 0.05f));
  double length = 1e-3;
  for (const double step : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0})
    if (static_cast<float>(step) * per_metre < 0.22f * static_cast<float>(panel.viewport().width)) length = step;
  const float pixels = static_cast<float>(length) * per_metre;
  const Viewport& v = panel.viewport();
  const Eigen::Vector2f a(static_cast<float>(v.x) + 2.0f * size, static_cast<float>(v.y + v.height) - 2.0f * size);
  canvas.line(a, a + Eigen::Vector2f(pixels, 0.0f), 1.6f, kInk, 1.0f, Cap::butt);
  for (const float x : {0.0f, pixels})
    canvas.line(a + Eigen::Vector2f(x, -0.4f * size), a + Eigen::Vector2f(x, 0.4f * size), 1.6f, kInk);
  const std::string text = format(length * 1000.0) + " mm";
  canvas.text(a + Eigen::Vector2f(0.0f, -0.8f * size), 0.8f * size, text, kInk);
  const float width = std::max(pixels, Canvas::text_width(0.8f * size, text));
  return {a - Eigen::Vector2f(0.0f, 2.0f * size), a + Eigen::Vector2f(width, 0.5f * size)};
}

/// Draw the directions of the world axes in the other corner.
/// @return what they cover
Rectangle draw_triad(Canvas& canvas, const Panel& panel, float size) {
  const Viewport& v = panel.viewport();
  const Eigen::Vector2f o(static_cast<float>(v.x + v.width) - 5.0f * size,
                          static_cast<float>(v.y + v.height) - 3.2f * size);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2f tip(static_cast<float>(panel.axis(0)[i]), static_cast<float>(panel.axis(1)[i]));
    canvas.line(o, o + 2.6f * size * tip, 1.6f, kAxisColors[i]);
    const char name[] = {"xyz"[i], '\0'};
    const float width = Canvas::text_width(0.8f * size, name);
    if (tip.norm() > 0.25f)
      canvas.text(o + (2.6f + 0.9f / tip.norm()) * size * tip + Eigen::Vector2f(-0.5f * width, 0.3f * size),
                  0.8f * size, name, kAxisColors[i]);
  }
  const Eigen::Vector2f reach = Eigen::Vector2f::Constant(4.0f * size);
  return {o - reach, o + reach};
}

/// A number with a noun; digits in groups of three.
std::string count(std::size_t n, const char* noun, const char* plural) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits + " " + (n == 1 ? noun : plural);
}

/// Draw the name of the scene and the counts of the result. @param height height of the title
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
  const float used = canvas.text({end + 2.2f * size, base}, 0.9f * size, caption, kFaint);
  if (result.fruits.empty()) return;
  constexpr std::string_view kNote = "positions x, y, z in world below";
  const float width = Canvas::text_width(0.8f * size, kNote);
  const float start = static_cast<float>(canvas.width()) - left - width;
  if (start > used + 2.0f * size) canvas.text({start, base}, 0.8f * size, kNote, kFaint);  // else there is no room
}

/// The parts of the picture, in pixels.
struct Layout {
  float size;            ///< height of small capitals
  int title, legend;     ///< heights of the title at the top and the legend at the bottom
  Viewport left, right;  ///< the two views in between
};

Layout layout_of(const Canvas& canvas, const std::vector<Fruit>& fruits) {
  Layout layout;
  const int w = canvas.width(), h = canvas.height();
  layout.size = static_cast<float>(h) / 75.0f;
  const std::size_t rows = legend_rows(fruits, static_cast<float>(w), layout.size);
  layout.title = static_cast<int>(4.4f * layout.size);
  layout.legend = static_cast<int>((rows > 0 ? 1.0f + 2.15f * static_cast<float>(rows) : 0.6f) * layout.size);
  const int middle = w / 2, gap = 1, panel_height = h - layout.title - layout.legend;
  layout.left = {0, layout.title, middle - gap, panel_height};
  layout.right = {middle + gap, layout.title, w - middle - gap, panel_height};
  return layout;
}

/// The points of the cloud in the colors of their fruit.
Splats splats_of(const ScanResult& result) {
  Splats splats{result.cloud, {}, splat_radius(result.cloud)};
  splats.colors.reserve(result.cloud.size());
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    const int label = result.labels.empty() ? 0 : result.labels[i];
    splats.colors.push_back(label > 0 ? color(fruit_color(label)) : kUnlabelled);
  }
  return splats;
}

/// The middle of the box around the subjects, where the scale is true.
Eigen::Vector3d middle_of(const Framing& framing) {
  Aabb box;
  for (const Eigen::Vector3d& p : framing.subjects) box.extend(p);
  return box.center();
}

/// The left view: close up, from the front and slightly from above.
void draw_front(Canvas& canvas, const Layout& layout, const ScanResult& result, const Workcell& workcell,
                const Splats& splats, const Framing& framing) {
  Panel panel(canvas, layout.left, framing.forward - 0.06 * framing.up, framing.up, framing.subjects);
  panel.draw(splats);
  const char* const caption = workcell.scan_volume.empty() ? "from the front" : "from the front, as the robot sees it";
  const std::vector<Rectangle> taken{draw_scale(canvas, panel, middle_of(framing), layout.size),
                                     draw_triad(canvas, panel, layout.size),
                                     draw_caption(canvas, panel, caption, layout.size)};
  draw_fruit(canvas, panel, result.fruits, 1.15f * layout.size, taken);
}

/// The right view: oblique, with the scan volume and the poses of the sensor.
void draw_oblique(Canvas& canvas, const Layout& layout, const ScanResult& result, const Workcell& workcell,
                  const Splats& splats, const Framing& framing) {
  const bool volume = !workcell.scan_volume.empty();
  const Eigen::Vector3d up = framing.up, side = framing.forward.cross(up).normalized();
  std::vector<Eigen::Vector3d> subjects = volume ? corners(workcell.scan_volume) : framing.subjects;
  for (const View& view : result.views)
    if (is_rigid(view.world_T_optical)) {
      const auto f = frustum(view, workcell.sensor.intrinsics, 0.05);
      subjects.insert(subjects.end(), f.begin(), f.end());
    }
  Panel panel(canvas, layout.right, 0.62 * framing.forward - 0.70 * side - 0.42 * up, up, subjects);
  panel.draw(splats);
  if (volume) draw_box(panel, workcell.scan_volume);
  draw_views(panel, result.views, workcell.sensor.intrinsics);
  const char* const caption =
      result.views.empty() ? "from the side" : "from the side, with the sensor's path (first view dark)";
  const std::vector<Rectangle> taken{draw_scale(canvas, panel, middle_of(framing), layout.size),
                                     draw_triad(canvas, panel, layout.size),
                                     draw_caption(canvas, panel, caption, layout.size)};
  draw_fruit(canvas, panel, result.fruits, 0.8f * layout.size, taken);
}

void check(const ScanResult& result) {
  const Cloud& cloud = result.cloud;
  check_input(result.labels.empty() || result.labels.size() == cloud.size(), "render: not one label per point");
  check_input(cloud.normals.empty() || cloud.normals.size() == cloud.size(), "render: not one normal per point");
}

}  // namespace

Image render(const ScanResult& result, const Workcell& workcell, int width, int height) {
  check_parameter(width >= 640, "picture width", "640 or more", width);
  check_parameter(height >= 360, "picture height", "360 or more", height);
  check(result);
  Canvas canvas(width, height);
  const Layout layout = layout_of(canvas, result.fruits);
  canvas.fill(0, 0, canvas.width(), canvas.height(), kPaper, kPaper);
  for (const Viewport& v : {layout.left, layout.right})
    canvas.fill(v.x, v.y, v.x + v.width, v.y + v.height, kPanelTop, kPanelBottom);
  const Splats splats = splats_of(result);
  const Framing framing = frame(result, workcell);
  draw_front(canvas, layout, result, workcell, splats, framing);
  draw_oblique(canvas, layout, result, workcell, splats, framing);
  draw_title(canvas, result, workcell, layout.title, layout.size);
  draw_legend(canvas, result.fruits, canvas.height() - layout.legend, layout.size);
  return canvas.image();
}

void write_picture(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell) {
  write_png(path, render(result, workcell));
}

}  // namespace agrisee::io
