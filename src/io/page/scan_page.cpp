// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/collision.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/io/palette.hpp>
#include <agrisee/io/scan_page.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include <algorithm>
#include <cstring>

#include "io/formats/json_value.hpp"
#include "io/page/page_template.hpp"
#include "io/results/result_texts.hpp"

namespace agrisee::io {
namespace {

constexpr std::string_view kMark = "@REPORT_DATA@";

/// Bytes as base64 (RFC 4648).
std::string base64(const unsigned char* bytes, std::size_t size) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out((size + 2) / 3 * 4, '=');
  char* to = out.data();
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k, ++to)
      if (k <= left) *to = kDigits[group >> (18 - 6 * k) & 63u];
  }
  return out;
}

/// Numbers as base64 of their little-endian bytes.
template <typename T>
std::string base64(const std::vector<T>& values) {
  return base64(reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T));
}

std::string text(const Json& j) { return j.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Append the text of a JSON object by the members that `add` appends, each with a comma before it.
template <typename Add>
std::string extended(const Json& object, Add&& add) {
  std::string out = text(object);
  out.pop_back();
  add(out);
  return out += '}';
}

/// Append a member whose value is a text of base64; to make it a Json first would take longer than all else.
void append(std::string& out, const char* key, const std::string& digits) {
  out.append(",\"").append(key).append("\":\"").append(digits).append("\"");
}

/// A vector rounded to five decimals (10 um, or 1e-5 rad), which nobody can see; this keeps the page short.
Json rounded(const Eigen::Vector3d& v) {
  Json list = Json::array();
  for (int a = 0; a < 3; ++a) list.push_back(std::round(v[a] * 1e5) / 1e5 + 0.0);
  return list;
}

/// A color as `#rrggbb`.
std::string hex(const Rgb& color) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out = "#";
  for (const std::uint8_t c : color) out += {kDigits[c >> 4], kDigits[c & 15]};
  return out;
}

/// Indices of at most `max_points` points: every k-th of the finite points.
Indices shown(const std::vector<Eigen::Vector3f>& points, std::size_t max_points) {
  Indices finite, out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points[i])) finite.push_back(static_cast<Index>(i));
  const std::size_t step = (finite.size() + max_points - 1) / max_points;
  for (std::size_t i = 0; i < finite.size(); i += step) out.push_back(finite[i]);
  return out;
}

/// The coordinates as base64: 16 bits each, with `origin` and `step` added to `j`; single precision if the extent is
/// above 10 m.
std::string positions_to(Json& j, const std::vector<Eigen::Vector3f>& points) {
  constexpr double kSteps = 65535.0, kLargest = 10.0;
  const Aabb box = bounding_box(points);
  if (points.empty() || box.size().maxCoeff() > kLargest) {
    std::vector<float> values;
    for (const auto& p : points) values.insert(values.end(), p.data(), p.data() + 3);
    return base64(values);
  }
  const Eigen::Vector3d step = (box.size() / kSteps).cwiseMax(1e-12);
  std::vector<std::uint16_t> values;
  for (const auto& p : points)
    for (int a = 0; a < 3; ++a)
      values.push_back(static_cast<std::uint16_t>(
          std::clamp(std::round((static_cast<double>(p[a]) - box.min[a]) / step[a]), 0.0, kSteps)));
  j["origin"] = json_list(box.min, "");
  j["step"] = json_list(step, "");
  return base64(values);
}

/// A cloud as viewer/data.js reads it, as the text of a JSON object.
std::string cloud_text(const Cloud& cloud, const Labels& labels, std::size_t max_points) {
  const Indices index = shown(cloud.points, max_points);
  const auto at = [](const auto& values, Index i) { return values[static_cast<std::size_t>(i)]; };
  std::vector<Eigen::Vector3f> points;
  std::vector<std::int8_t> normals;
  std::vector<std::uint16_t> label;
  std::vector<std::int16_t> view;
  std::vector<std::uint8_t> color;
  for (const Index i : index) {
    points.push_back(at(cloud.points, i));
    if (!cloud.normals.empty()) {
      Eigen::Vector3f n = at(cloud.normals, i);
      if (!is_finite(n)) n.setZero();
      for (int a = 0; a < 3; ++a)
        normals.push_back(static_cast<std::int8_t>(std::lround(127.0f * std::clamp(n[a], -1.0f, 1.0f))));
    }
    if (!labels.empty()) label.push_back(static_cast<std::uint16_t>(std::clamp(at(labels, i), 0, 65535)));
    if (cloud.views.size() == cloud.size())
      view.push_back(static_cast<std::int16_t>(std::clamp(at(cloud.views, i), -1, 32767)));
    if (!cloud.colors.empty()) color.insert(color.end(), at(cloud.colors, i).begin(), at(cloud.colors, i).end());
  }
  Json j;
  j["count"] = points.size();
  j["total"] = cloud.size();
  // Discs of this radius (m) close the gaps between neighboring points, unless the cloud is sparse.
  const double spacing = points.size() > 1 ? estimate_spacing(points) : 0.0;
  j["radius"] = spacing > 0.0 ? std::clamp(0.95 * spacing, 1e-5, 0.05) : 0.002;
  const std::string positions = positions_to(j, points);
  return extended(j, [&](std::string& out) {
    append(out, "positions", positions);
    append(out, "normals", base64(normals));
    append(out, "labels", base64(label));
    append(out, "views", base64(view));
    if (!color.empty()) append(out, "colors", base64(color));
  });
}

/// The depth pictures as the text of a JSON list, one entry a view: at most kMostPictures bytes of them, evenly spread.
std::string pictures_text(const std::vector<DepthPicture>& pictures, std::size_t views) {
  constexpr std::size_t kMostPictures = 3000000;
  const std::size_t count = std::min(pictures.size(), views);
  std::size_t bytes = 0;
  for (std::size_t v = 0; v < count; ++v) bytes += pictures[v].png.size();
  const std::size_t step = bytes / kMostPictures + 1;
  std::string out = "[";
  for (std::size_t v = 0; v < count; ++v) {
    if (v > 0) out += ',';
    const DepthPicture& picture = pictures[v];
    if (v % step != 0 || picture.png.empty())
      out += "null";
    else
      out += extended({{"near", picture.nearest}, {"far", picture.farthest}}, [&](std::string& entry) {
        append(entry, "png", base64(reinterpret_cast<const unsigned char*>(picture.png.data()), picture.png.size()));
      });
  }
  return out += ']';
}

Json to_json(const Aabb& box) {
  if (box.empty()) return nullptr;
  return {{"min", json_list(box.min, "the scan volume is not finite")},
          {"max", json_list(box.max, "the scan volume is not finite")}};
}

Json to_json(const KeepOut& space) {
  Json j;
  if (const Box* box = std::get_if<Box>(&space.shape)) {
    j["box"] = {{"center", rounded(box->center)}, {"size", rounded(box->size)}};
  } else if (const Cylinder* c = std::get_if<Cylinder>(&space.shape)) {
    j["cylinder"] = {{"center", rounded(c->center)}, {"radius", c->radius}, {"height", c->height}};
  }
  return j;
}

/// A view; if its joints are known, with both ends of the axis of each piece of the arm.
Json to_json(const View& view, const arm::Mount& mount) {
  Json j;
  j["position"] = rounded(view.world_T_optical.translation());
  const Eigen::Quaterniond q = quaternion(view.world_T_optical.linear());
  j["rotation"] = json_list(q.coeffs(), "a view's pose is not finite");
  j["target"] = rounded(view.target);
  j["points_in"] = view.points_in;
  j["points_new"] = view.points_new;
  j["plan_seconds"] = view.plan_seconds;
  if (!view.joints) return j;
  for (const arm::Piece& piece : arm::pieces_in_world(*view.joints, mount)) {
    const Eigen::Vector3d half = 0.5 * piece.cylinder.height * piece.cylinder.axis;
    Json ends = rounded(piece.cylinder.center - half);
    for (const Json& value : rounded(piece.cylinder.center + half)) ends.push_back(value);
    j["arm"].push_back(ends);
  }
  return j;
}

/// All data that the page shows, as viewer/data.js reads them: the text of a JSON object.
std::string page_data(const ScanResult& result, const Workcell& workcell, const RunInfo& info,
                      const ScanHistory& history, std::size_t max_points) {
  Json j;
  j["run"] = parse_json(run_text(result, info));
  j["fruits"] = parse_json(fruits_text(result.fruits));
  j["fruits_csv"] = fruits_csv_text(result.fruits);
  if (history.running) j["running"] = true;
  j["colors"] = Json::object();
  for (const Fruit& fruit : result.fruits) j["colors"][std::to_string(fruit.id)] = hex(fruit_color(fruit.id));
  j["base"] = rounded(workcell.world_T_base.translation());
  j["scan_volume"] = to_json(workcell.scan_volume);
  j["keep_out"] = Json::array();
  for (const KeepOut& space : workcell.keep_out) j["keep_out"].push_back(to_json(space));
  const sensor::Intrinsics& k = workcell.sensor.intrinsics;
  for (const auto& [u, v] : {std::pair{0, 0}, {k.width - 1, 0}, {k.width - 1, k.height - 1}, {0, k.height - 1}})
    j["sensor_rays"].push_back(rounded(k.ray(u, v)));

  const arm::Mount mount = plan::mount_of(workcell);
  for (const arm::Piece& piece : arm::pieces_in_world(Joints::Zero(), mount))
    j["arm_radii"].push_back(piece.cylinder.radius);
  j["views"] = Json::array();
  for (const View& view : result.views) j["views"].push_back(to_json(view, mount));
  j["curves"] = Json::array();
  for (const auto& curve : history.curves) {
    Json values = Json::array();
    for (const double value : curve.values)
      values.push_back(std::isfinite(value) ? Json(std::round(value * 1e5) / 1e5) : Json(nullptr));
    j["curves"].push_back({{"name", curve.name}, {"values", values}});
  }

  Cloud frontier;
  frontier.points = history.frontier;
  return extended(j, [&](std::string& out) {
    out += ",\"cloud\":" + cloud_text(result.cloud, result.labels, max_points);
    out += ",\"merged\":" + cloud_text(result.raw, {}, max_points);
    out += ",\"frontier\":" + cloud_text(frontier, {}, max_points);
    out += ",\"depth\":" + pictures_text(history.depth, result.views.size());
  });
}

}  // namespace

std::string scan_page(const ScanResult& result, const Workcell& workcell, const RunInfo& info,
                      const ScanHistory& history, std::size_t max_points) {
  check_parameter(max_points > 0, "max_points", "positive", static_cast<double>(max_points));
  check_result(result);
  views_text(result.views);  // throws InputError for values that are not finite
  const std::string data = page_data(result, workcell, info, history, max_points);
  std::string page;
  for (std::size_t i = 0; i < kPageTemplatePieces; ++i) page += kPageTemplate[i];
  const std::size_t at = page.find(kMark);
  std::string out;
  out.reserve(page.size() + data.size() + 1024);
  out.append(page, 0, at);
  for (std::size_t from = 0; from < data.size();) {  // `<` occurs only in strings; escaped, it cannot end the element
    const std::size_t to = std::min(data.find('<', from), data.size());
    out.append(data, from, to - from);
    if (to < data.size()) out += "\\u003c";
    from = to + 1;
  }
  out.append(page, at + kMark.size(), std::string::npos);
  return out;
}

void write_scan_page(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell,
                     const RunInfo& info, const ScanHistory& history) {
  write_file(path, scan_page(result, workcell, info, history));
}

}  // namespace agrisee::io
