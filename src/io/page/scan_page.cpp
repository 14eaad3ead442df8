// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/collision.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/io/palette.hpp>
#include <agrisee/io/scan_page.hpp>

#include <algorithm>
#include <cstring>

#include "io/formats/json_value.hpp"
#include "io/page/page_template.hpp"
#include "io/results/result_texts.hpp"

namespace agrisee::io {
namespace {

constexpr std::string_view kMark = "@REPORT_DATA@";

/// Numbers as base64 (RFC 4648) of their little-endian bytes.
template <typename T>
std::string base64(const std::vector<T>& values) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= left ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

/// A vector rounded to five decimals (10 um, or 1e-5 rad), which nobody can see; this keeps the page short.
Json rounded(const Eigen::Vector3d& v) {
  Json list = Json::array();
  for (int a = 0; a < 3; ++a) list.push_back(std::round(v[a] * 1e5) / 1e5 + 0.0);
  return list;
}

/// A colour as `#rrggbb`.
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
Json positions_to(Json& j, const std::vector<Eigen::Vector3f>& points) {
  constexpr double kSteps = 65535.0, kLargest = 10.0;
  Aabb box;
  for (const auto& p : points) box.extend(p.cast<double>());
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

/// A cloud as viewer/data.js reads it.
Json to_json(const Cloud& cloud, const Labels& labels, std::size_t max_points) {
  const Indices index = shown(cloud.points, max_points);
  const auto at = [](const auto& values, Index i) { return values[static_cast<std::size_t>(i)]; };
  std::vector<Eigen::Vector3f> points;
  std::vector<std::int8_t> normals;
  std::vector<std::uint16_t> label;
  std::vector<std::int16_t> view;
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
  }
  Json j;
  j["count"] = points.size();
  j["total"] = cloud.size();
  // Discs of this radius (m) close the gaps between neighbouring points, unless the cloud is sparse.
  const double spacing = points.size() > 1 ? estimate_spacing(points) : 0.0;
  j["radius"] = spacing > 0.0 ? std::clamp(0.95 * spacing, 1e-5, 0.05) : 0.002;
  j["positions"] = positions_to(j, points);
  j["normals"] = base64(normals);
  j["labels"] = base64(label);
  j["views"] = base64(view);
  return j;
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

/// All data that the page shows, as viewer/data.js reads them.
Json page_data(const ScanResult& result, const Workcell& workcell, const RunInfo& info, const ScanHistory& history,
               std::size_t max_points) {
  Json j;
  j["run"] = Json::parse(run_text(result, workcell, info));
  j["fruits"] = Json::parse(fruits_text(result.fruits));
  j["colors"] = Json::object();
  for (const Fruit& fruit : result.fruits) j["colors"][std::to_string(fruit.id)] = hex(fruit_color(fruit.id));
  j["base"] = rounded(workcell.world_T_base.translation());
  j["scan_volume"] = to_json(workcell.scan_volume);
  j["keep_out"] = Json::array();
  for (const KeepOut& space : workcell.keep_out) j["keep_out"].push_back(to_json(space));
  const sensor::Intrinsics& k = workcell.sensor.intrinsics;
  for (const auto& [u, v] : {std::pair{0, 0}, {k.width - 1, 0}, {k.width - 1, k.height - 1}, {0, k.height - 1}})
    j["sensor_rays"].push_back(rounded(k.ray(u, v)));

  arm::Mount mount;
  mount.world_T_base = workcell.world_T_base;
  mount.tool0_T_optical = workcell.tool0_T_optical;
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

  j["cloud"] = to_json(result.cloud, result.labels, max_points);
  j["merged"] = to_json(result.raw, {}, max_points);
  Cloud frontier;
  frontier.points = history.frontier;
  j["frontier"] = to_json(frontier, {}, max_points);
  return j;
}

}  // namespace

std::string scan_page(const ScanResult& result, const Workcell& workcell, const RunInfo& info,
                      const ScanHistory& history, std::size_t max_points) {
  check_parameter(max_points > 0, "max_points", "positive", static_cast<double>(max_points));
  check_result(result);
  views_text(result.views);  // throws InputError for values that are not finite
  const std::string data =
      page_data(result, workcell, info, history, max_points).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string page;
  for (std::size_t i = 0; i < kPageTemplatePieces; ++i) page += kPageTemplate[i];
  const std::size_t at = page.find(kMark);
  std::string out;
  out.reserve(page.size() + data.size() + 1024);
  out.append(page, 0, at);
  for (const char c : data)  // `<` occurs only inside of strings; escaped, it cannot end the script element
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  out.append(page, at + kMark.size(), std::string::npos);
  return out;
}

void write_scan_page(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell,
                     const RunInfo& info, const ScanHistory& history) {
  write_file(path, scan_page(result, workcell, info, history));
}

}  // namespace agrisee::io
