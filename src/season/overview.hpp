// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a season's database holds, added up for rows and dates.
#pragma once

#include <agrisee/cloud/ripeness.hpp>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace agrisee::season {

/// Sums over some scans.
struct Tally {
  static constexpr std::size_t kBins = 300;             ///< of diameters, a millimetre each; the last holds all above
  std::size_t scans = 0;                                ///< with a result
  std::size_t failed = 0;                               ///< without one
  std::size_t fruit = 0;                                ///< found in them
  std::size_t sized = 0;                                ///< of these, with a diameter
  double mass = 0.0;                                    ///< of all fruit with a body (kg)
  std::array<std::size_t, kRipenessClasses> ripe = {};  ///< number of fruit in each class, from green to red
  std::vector<std::size_t> diameters = std::vector<std::size_t>(kBins);  ///< number of fruit per millimetre

  /// Add the sums of other scans.
  Tally& operator+=(const Tally& other);
  /// The number of fruit whose ripeness is known.
  std::size_t colored() const;
  /// The diameter (mm) below which a share (0..1) of the fruit lies, to about half a millimetre; none without
  /// diameters.
  std::optional<double> diameter(double share) const;
  /// The share of the fruit that are `light_red` or `red`; none where no ripeness is known.
  std::optional<double> ripe_share() const;
};

/// The order of texts in which runs of digits are numbers: "week9" before "week10".
struct InOrder {
  bool operator()(const std::string& a, const std::string& b) const;
};

/// Everything that the page of a season shows.
struct Overview {
  std::map<std::string, std::map<std::string, Tally, InOrder>> cells;  ///< by row, then by date; "" where not known
  std::vector<std::string> versions;                                   ///< of AgriSEE, of all scans
  std::size_t parameter_sets = 0;                                      ///< number of different parameters

  /// The rows, numbers first; the dates.
  std::vector<std::string> rows() const, dates() const;
  /// The last date with a result of a row; "" if there is none.
  std::string last_date(const std::string& row) const;
  /// The last date with a result of any row; "" if there is none.
  std::string last_date() const;
  /// The scans of a row on a date; of all rows on it; of everything, where fruit of several dates count several times.
  Tally of(const std::string& row, const std::string& date) const;
  Tally of_date(const std::string& date) const;
  Tally all() const;
};

/// Add up a database. A million fruit take about a second.
/// @throws FileError if it cannot be read, or is something else
Overview read_overview(const std::string& database);

}  // namespace agrisee::season
