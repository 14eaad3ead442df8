// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/results.hpp>

#include <array>
#include <cmath>

#include "io/formats/csv.hpp"
#include "io/results/result_texts.hpp"

namespace agrisee::io {
namespace {

constexpr std::array<const char*, 23> kColumns = {"view", "x",  "y",  "z",  "dx",        "dy",         "dz",    "ox",
                                                  "oy",   "oz", "qx", "qy", "qz",        "qw",         "q1",    "q2",
                                                  "q3",   "q4", "q5", "q6", "points_in", "points_new", "plan_s"};
/// Indices of the first column of each value.
enum Column { kView = 0, kPosition = 1, kTarget = 7, kRotation = 10, kJoints = 14, kIn = 20, kNew = 21, kPlan = 22 };

void check_view(const View& v) {
  check_input(is_rigid(v.world_T_optical), "write_views: a view's pose is not rigid");
  check_input(v.target.allFinite(), "write_views: a view's target is not finite");
  check_input(!v.joints || v.joints->allFinite(), "write_views: a view's joints are not finite");
  check_input(std::isfinite(v.plan_seconds), "write_views: a view's planning time is not finite");
}

}  // namespace

std::string views_text(const std::vector<View>& views) {
  CsvWriter csv;
  for (const char* name : kColumns) csv.cell(name);
  csv.end_row();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& v = views[i];
    check_view(v);
    csv.cell(i);
    csv.cells(v.world_T_optical.translation());
    csv.cells(v.world_T_optical.linear().col(2));
    csv.cells(v.target);
    csv.cells(quaternion(v.world_T_optical.linear()).coeffs());
    if (v.joints)
      csv.cells(*v.joints);
    else
      csv.empty_cells(6);
    csv.cell(v.points_in);
    csv.cell(v.points_new);
    csv.cell(v.plan_seconds);
    csv.end_row();
  }
  return csv.text();
}

void write_views(const std::filesystem::path& path, const std::vector<View>& views) {
  write_file(path, views_text(views));
}

std::vector<View> read_views(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  Lines lines(bytes.view());
  std::string_view line;
  std::vector<std::string> cells;
  if (!lines.next_filled(line)) fail(path, "is empty");
  split_csv(line, cells);
  std::array<std::size_t, kColumns.size()> where{};
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    const auto found = std::find(cells.begin(), cells.end(), kColumns[c]);
    if (found == cells.end()) fail(path, lines.number(), std::string("no column '") + kColumns[c] + "'");
    where[c] = static_cast<std::size_t>(found - cells.begin());
  }
  const std::size_t width = cells.size();
  std::vector<View> views;
  while (lines.next_filled(line)) {
    if (!split_csv(line, cells) || cells.size() != width)
      fail(path, lines.number(), "expected " + std::to_string(width) + " cells, got " + std::to_string(cells.size()));
    const auto number = [&](std::size_t c) {
      const auto value = to_number(trimmed(cells[where[c]]));
      if (!value || !std::isfinite(*value))
        fail(path, lines.number(), std::string(kColumns[c]) + ": " + excerpt(cells[where[c]]) + " is not a number");
      return *value;
    };
    const auto count = [&](std::size_t c) {
      const auto value = to_integer(trimmed(cells[where[c]]));
      if (!value || *value < 0)
        fail(path, lines.number(), std::string(kColumns[c]) + ": " + excerpt(cells[where[c]]) + " is not a count");
      return static_cast<std::size_t>(*value);
    };
    const auto vector = [&](std::size_t c) { return Eigen::Vector3d(number(c), number(c + 1), number(c + 2)); };
    if (count(kView) != views.size()) fail(path, lines.number(), "view: expected " + std::to_string(views.size()));
    View view;
    Eigen::Quaterniond q(number(kRotation + 3), number(kRotation), number(kRotation + 1), number(kRotation + 2));
    if (std::abs(q.norm() - 1.0) > 1e-3) fail(path, lines.number(), "the quaternion is not of unit length");
    view.world_T_optical.linear() = q.normalized().toRotationMatrix();
    view.world_T_optical.translation() = vector(kPosition);
    view.target = vector(kTarget);
    std::size_t empty = 0;
    for (std::size_t j = 0; j < 6; ++j) empty += cells[where[kJoints + j]].empty() ? 1 : 0;
    if (empty < 6) {  // all six must be numbers then; number() rejects empty cells
      view.joints.emplace();
      for (std::size_t j = 0; j < 6; ++j) (*view.joints)[static_cast<Eigen::Index>(j)] = number(kJoints + j);
    }
    view.points_in = count(kIn);
    view.points_new = count(kNew);
    view.plan_seconds = number(kPlan);
    views.push_back(view);
  }
  return views;
}

}  // namespace agrisee::io
