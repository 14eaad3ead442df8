// SPDX-License-Identifier: BSD-3-Clause
#include "season/place.hpp"

#include <agrisee/core/error.hpp>

#include <cctype>
#include <cstdlib>

namespace agrisee::season {
namespace {

/// How regular expressions are read. The usual search of libstdc++ takes exponential time for some, such as (a+)+b, and
/// overflows the stack in long texts; that of libc++ gives up.
std::regex::flag_type syntax() {
  std::regex::flag_type flags = std::regex::ECMAScript | std::regex::icase;
#ifdef __GLIBCXX__
  flags |= std::regex_constants::__polynomial;
#endif
  return flags;
}

/// The rules for rows and dates where nothing else is asked for.
const PathPattern& usual_row() {
  static const PathPattern pattern("(?:^|[^a-z])row[ _-]?([0-9]+(?:[a-z](?![a-z]))?)");
  return pattern;
}
const PathPattern& usual_date() {
  static const PathPattern pattern(
      "(?:^|[^0-9])(20[0-9]{2})[-_]?(0[1-9]|1[0-2])[-_]?(0[1-9]|[12][0-9]|3[01])(?![0-9])");
  return pattern;
}

/// Whether year, month (01 to 12) and day (01 to 31) name a day.
bool is_day(const std::vector<std::string>& date) {
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const int year = std::atoi(date[0].c_str()), month = std::atoi(date[1].c_str()), day = std::atoi(date[2].c_str());
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return day <= kDays[month - 1] + (month == 2 && leap ? 1 : 0);
}

/// "07" as "7": without zeros before a digit.
std::string without_zeros(const std::string& text) {
  std::size_t begin = 0;
  while (begin + 1 < text.size() && text[begin] == '0' && std::isdigit(static_cast<unsigned char>(text[begin + 1])))
    ++begin;
  return text.substr(begin);
}

std::string joined(const std::vector<std::string>& groups) {
  std::string out;
  for (const std::string& group : groups) out += (out.empty() || group.empty() ? "" : "-") + group;
  return out;
}

}  // namespace

PathPattern::PathPattern(const std::string& text) : text_(text) {
  try {
    pattern_ = std::regex(text, syntax());
  } catch (const std::regex_error& e) {
    if (e.code() == std::regex_constants::error_complexity)
      throw ParameterError("'" + text + "' is too complex: references to groups (\\1) are not possible");
    throw ParameterError("'" + text + "' is not a regular expression: " + e.what());
  }
  if (pattern_.mark_count() == 0)
    throw ParameterError("'" + text + "' has no group: put what is to be stored in parentheses");
}

std::vector<std::vector<std::string>> PathPattern::matches(const std::string& path) const {
  std::vector<std::vector<std::string>> out;
  try {
    for (std::sregex_iterator i(path.begin(), path.end(), pattern_), end; i != end; ++i) {
      out.emplace_back();
      for (std::size_t group = 1; group < i->size(); ++group) out.back().push_back(i->str(group));
    }
  } catch (const std::regex_error&) {
    throw ParameterError("'" + text_ + "' is too complex to be looked for in '" + path + "'");
  }
  return out;
}

Place PlaceRules::of(const std::string& path) const {
  Place place;
  for (auto groups : (row ? *row : usual_row()).matches(path)) {
    for (std::string& group : groups) group = without_zeros(group);
    if (const std::string text = joined(groups); !text.empty()) place.row = text;
  }
  for (const auto& groups : (date ? *date : usual_date()).matches(path)) {
    const std::string text = joined(groups);
    if (text.empty() || (!date && !is_day(groups))) continue;
    if (!place.date.empty() && place.date != text) place.other_date = place.date;
    place.date = text;
  }
  return place;
}

}  // namespace agrisee::season
