// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/results.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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

namespace {

/// The rows of a views.csv, with the values that its columns have.
class ViewTable {
 public:
  explicit ViewTable(const std::filesystem::path& path) : path_(path), bytes_(read_bytes(path)), lines_(bytes_.view()) {
    std::string_view line;
    if (!lines_.next_filled(line)) fail(path, "is empty");
    separator_ = csv_separator(line);
    split_csv(line, cells_, separator_);
    for (std::string& cell : cells_) cell = std::string(trimmed(cell));
    width_ = cells_.size();
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto found = std::find(cells_.begin(), cells_.end(), kColumns[c]);
      if (found != cells_.end()) where_[c] = static_cast<std::size_t>(found - cells_.begin());
    }
    require(kView, 1);
    require(kPosition, 3);
    for (const auto& [first, count] : {std::pair{kTarget, 3}, {kRotation, 4}, {kJoints, 6}})
      if (has(first, count)) require(first, count);
  }

  /// Go to the next row. @return false at the end
  bool next() {
    std::string_view line;
    if (!lines_.next_filled(line)) return false;
    if (!split_csv(line, cells_, separator_) || cells_.size() != width_)
      bad("expected " + std::to_string(width_) + " cells, got " + std::to_string(cells_.size()));
    return true;
  }
  /// Whether any of `count` columns from `first` on is there.
  bool has(int first, int count = 1) const {
    return std::any_of(where_.begin() + first, where_.begin() + first + count, [](const auto& w) { return !!w; });
  }
  bool is_empty(int column) const { return trimmed(text(column)).empty(); }
  double number(int column) const {
    const auto value = to_number(trimmed(text(column)));
    if (!value || !std::isfinite(*value)) bad(name(column) + ": " + excerpt(text(column)) + " is not a number");
    return *value;
  }
  std::size_t count(int column) const {
    const auto value = to_integer(trimmed(text(column)));
    if (!value || *value < 0) bad(name(column) + ": " + excerpt(text(column)) + " is not a count");
    return static_cast<std::size_t>(*value);
  }
  Eigen::Vector3d vector(int first) const { return {number(first), number(first + 1), number(first + 2)}; }
  [[noreturn]] void bad(const std::string& message) const { fail(path_, lines_.number(), message); }

 private:
  static std::string name(int column) { return kColumns[static_cast<std::size_t>(column)]; }
  const std::string& text(int column) const { return cells_[*where_[static_cast<std::size_t>(column)]]; }
  void require(int first, int count) const {
    for (int c = first; c < first + count; ++c)
      if (!has(c)) bad("no column '" + name(c) + "'");
  }

  const std::filesystem::path path_;
  const Bytes bytes_;
  Lines lines_;
  std::vector<std::string> cells_;
  char separator_ = ',';
  std::size_t width_ = 0;
  std::array<std::optional<std::size_t>, kColumns.size()> where_;  // of each column in a row, where it is there
};

View view_of(const ViewTable& row) {
  View view;
  if (row.has(kRotation)) {
    const Eigen::Quaterniond q(row.number(kRotation + 3), row.number(kRotation), row.number(kRotation + 1),
                               row.number(kRotation + 2));
    if (std::abs(q.norm() - 1.0) > 1e-3) row.bad("the quaternion is not of unit length");
    view.world_T_optical.linear() = q.normalized().toRotationMatrix();
  }
  view.world_T_optical.translation() = row.vector(kPosition);
  if (row.has(kTarget)) view.target = row.vector(kTarget);
  int empty = 0;
  for (int j = 0; j < 6 && row.has(kJoints); ++j) empty += row.is_empty(kJoints + j) ? 1 : 0;
  if (row.has(kJoints) && empty < 6) {  // all six must be numbers then; number() rejects empty cells
    view.joints.emplace();
    for (int j = 0; j < 6; ++j) (*view.joints)[j] = row.number(kJoints + j);
  }
  if (row.has(kIn)) view.points_in = row.count(kIn);
  if (row.has(kNew)) view.points_new = row.count(kNew);
  if (row.has(kPlan)) view.plan_seconds = row.number(kPlan);
  return view;
}

}  // namespace

std::vector<View> read_views(const std::filesystem::path& path) {
  ViewTable table(path);
  std::vector<View> views;
  while (table.next()) {
    if (table.count(kView) != views.size()) table.bad("view: expected " + std::to_string(views.size()));
    views.push_back(view_of(table));
  }
  return views;
}

}  // namespace agrisee::io
