// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Numbers, names, pictures and tables as Markdown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/figures.hpp"

namespace agrisee::report {

/// A number with that many decimals, whatever the locale; `-` if there is none or it is not finite.
std::string fixed(const std::optional<double>& value, int digits);
/// A name, escaped so that Markdown shows it verbatim, also inside of tables.
std::string text(const std::string& name);

/// A mean: `-` if there is none; followed by [have/of] if not all scans have a value, and by the value of [1] in
/// parentheses if there is one.
std::string shown(const Mean& mean, int digits, const std::optional<double>& paper = std::nullopt);
/// `mean / worst`; `-` if there is neither.
std::string pair(const std::optional<double>& mean, const std::optional<double>& worst, int digits);
/// `mean / worst row` of a figure over the scenes of a group.
std::string mean_and_worst(const Group& group, const Figure& figure);
/// Why the trials of a scene stopped; with counts if there are several reasons.
std::string stop_reasons(const Row& row);
/// Why the scans of a group stopped; with counts if there are several reasons.
std::string stop_reasons(const Group& group);
/// An embedded picture, in a paragraph of its own.
std::string picture(const Data& data, const std::string& file, const std::string& caption);

/// A Markdown table; the first column is aligned to the left, the others to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> head) : head_(std::move(head)) {}
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string markdown() const;

 private:
  std::vector<std::string> head_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace agrisee::report
