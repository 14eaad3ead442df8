// SPDX-License-Identifier: BSD-3-Clause
#include "season/overview.hpp"

#include <agrisee/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <unordered_map>

#include "season/schema.hpp"
#include "season/sqlite.hpp"

namespace agrisee::season {
namespace {

constexpr const char* kDigits = "0123456789";

/// The number at the beginning of a text, as its length without zeros before it and its digits, which is removed.
std::pair<std::size_t, std::string_view> take_number(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of(kDigits), text.size());
  const std::size_t zeros = std::min(text.find_first_not_of('0'), end);
  const std::string_view digits = text.substr(zeros, end - zeros);
  text.remove_prefix(end);
  return {digits.size(), digits};
}

bool begins_with_digit(std::string_view text) { return !text.empty() && text[0] >= '0' && text[0] <= '9'; }

/// Whether a row comes before another: numbers before words.
bool row_before(const std::string& a, const std::string& b) {
  const bool digit = begins_with_digit(a);
  return digit == begins_with_digit(b) ? InOrder()(a, b) : digit;
}

}  // namespace

bool InOrder::operator()(const std::string& a, const std::string& b) const {
  std::string_view left = a, right = b;
  while (!left.empty() && !right.empty()) {
    if (begins_with_digit(left) && begins_with_digit(right)) {
      const auto one = take_number(left), other = take_number(right);
      if (one != other) return one < other;
    } else {
      if (left[0] != right[0]) return static_cast<unsigned char>(left[0]) < static_cast<unsigned char>(right[0]);
      left.remove_prefix(1);
      right.remove_prefix(1);
    }
  }
  return left.empty() != right.empty() ? left.empty() : a < b;
}

Tally& Tally::operator+=(const Tally& other) {
  scans += other.scans;
  failed += other.failed;
  fruit += other.fruit;
  sized += other.sized;
  mass += other.mass;
  for (std::size_t i = 0; i < ripe.size(); ++i) ripe[i] += other.ripe[i];
  for (std::size_t i = 0; i < kBins; ++i) diameters[i] += other.diameters[i];
  return *this;
}

std::size_t Tally::colored() const {
  std::size_t sum = 0;
  for (const std::size_t n : ripe) sum += n;
  return sum;
}

std::optional<double> Tally::diameter(double share) const {
  if (sized == 0) return std::nullopt;
  const double wanted = share * static_cast<double>(sized);
  double below = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) {
    const auto here = static_cast<double>(diameters[i]);
    if (here > 0.0 && below + here >= wanted)
      return static_cast<double>(i) + std::clamp((wanted - below) / here, 0.0, 1.0);
    below += here;
  }
  return static_cast<double>(kBins);
}

std::optional<double> Tally::ripe_share() const {
  if (colored() == 0) return std::nullopt;
  return static_cast<double>(ripe[4] + ripe[5]) / static_cast<double>(colored());
}

std::vector<std::string> Overview::rows() const {
  std::vector<std::string> out;
  for (const auto& [row, dates] : cells) out.push_back(row);
  std::sort(out.begin(), out.end(), row_before);
  return out;
}

std::vector<std::string> Overview::dates() const {
  std::set<std::string, InOrder> out;
  for (const auto& [row, dates] : cells)
    for (const auto& [date, tally] : dates) out.insert(date);
  return {out.begin(), out.end()};
}

std::string Overview::last_date(const std::string& row) const {
  std::string out;
  if (const auto found = cells.find(row); found != cells.end())
    for (const auto& [date, tally] : found->second)
      if (tally.scans > 0) out = date;
  return out;
}

std::string Overview::last_date() const {
  std::string out;
  for (const auto& [row, dates] : cells) out = std::max(out, last_date(row), InOrder());
  return out;
}

Tally Overview::of(const std::string& row, const std::string& date) const {
  const auto found = cells.find(row);
  if (found == cells.end()) return {};
  const auto tally = found->second.find(date);
  return tally == found->second.end() ? Tally() : tally->second;
}

Tally Overview::of_date(const std::string& date) const {
  Tally sum;
  for (const auto& [row, dates] : cells)
    if (const auto found = dates.find(date); found != dates.end()) sum += found->second;
  return sum;
}

Tally Overview::all() const {
  Tally sum;
  for (const auto& [row, dates] : cells)
    for (const auto& [date, tally] : dates) sum += tally;
  return sum;
}

Overview read_overview(const std::string& database) {
  std::error_code error;
  if (!std::filesystem::exists(database, error)) throw FileError(database + ": no such file");
  const Connection connection(database, Connection::Mode::read);
  connection.run("BEGIN");  // all questions see the same state, though another process may write
  check_schema(connection);
  Overview out;
  std::unordered_map<long long, Tally*> tallies;  // of each scan
  Statement scans(connection, "SELECT id, status, \"row\", date FROM scans");
  while (scans.step()) {
    Tally& tally = out.cells[scans.text(2)][scans.text(3)];
    ++(scans.text(1) == "ok" ? tally.scans : tally.failed);
    tallies[scans.integer(0)] = &tally;  // references into a map stay
  }
  Statement fruit(connection, "SELECT scan, diameter, mass, ripeness FROM fruit");
  long long scan = -1;
  Tally* tally = nullptr;
  while (fruit.step()) {
    if (fruit.integer(0) != scan || !tally) {
      scan = fruit.integer(0);
      const auto found = tallies.find(scan);
      if (found == tallies.end()) throw FileError(database + ": has fruit of a scan that it does not have");
      tally = found->second;
    }
    ++tally->fruit;
    tally->mass += fruit.number(2);
    if (!fruit.is_null(1)) {
      ++tally->sized;
      const double mm = std::clamp(1e3 * fruit.number(1), 0.0, static_cast<double>(Tally::kBins - 1));
      ++tally->diameters[static_cast<std::size_t>(mm)];
    }
    if (!fruit.is_null(3))
      if (const auto grade = ripeness_named(fruit.text(3))) ++tally->ripe[static_cast<std::size_t>(*grade)];
  }
  Statement versions(connection,
                     "SELECT version FROM versions WHERE id IN (SELECT version FROM scans) ORDER BY version");
  while (versions.step()) out.versions.push_back(versions.text(0));
  out.parameter_sets = static_cast<std::size_t>(connection.integer("SELECT count(DISTINCT parameters) FROM scans"));
  return out;
}

}  // namespace agrisee::season
