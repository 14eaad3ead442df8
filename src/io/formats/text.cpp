// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace agrisee::io {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

char decimal_point() {
  const std::lconv* conventions = std::localeconv();
  return conventions && conventions->decimal_point && conventions->decimal_point[0] ? conventions->decimal_point[0]
                                                                                    : '.';
}

/// The value of a decimal number, by strtod.
double slow_number(const char* begin, const char* end) {
  std::string token(begin, end);
  const char point = decimal_point();
  if (point != '.')
    for (char& c : token)
      if (c == '.') c = point;
  return std::strtod(token.c_str(), nullptr);
}

/// Parse `nan`, `inf` or `infinity`, in upper or lower case. @return the position behind it, or nullptr
const char* parse_word(const char* p, const char* end, double& value) {
  const auto starts = [&](const char* word) {
    const std::size_t n = std::strlen(word);
    if (static_cast<std::size_t>(end - p) < n) return false;
    for (std::size_t i = 0; i < n; ++i)
      if (std::tolower(static_cast<unsigned char>(p[i])) != word[i]) return false;
    return true;
  };
  if (starts("nan")) {
    value = std::numeric_limits<double>::quiet_NaN();
    return p + 3;
  }
  value = std::numeric_limits<double>::infinity();
  if (starts("infinity")) return p + 8;
  if (starts("inf")) return p + 3;
  return nullptr;
}

/// `value` with the least number of digits, from `first` to `last`, that reads back as the same value.
template <typename T>
std::string shortest(T value, int first, int last) {
  if (value == T(0)) return "0";
  std::array<char, 40> text{};
  for (int digits = first; digits <= last; ++digits) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, static_cast<double>(value));
    if (static_cast<T>(std::strtod(text.data(), nullptr)) == value) break;
  }
  const char point = decimal_point();
  if (point != '.')
    for (char& c : text)
      if (c == point) c = '.';
  return text.data();
}

}  // namespace

const char* parse_number(const char* p, const char* end, double& value) {
  static constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* const begin = p;
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  std::uint64_t mantissa = 0;
  int digits = 0, exponent = 0;  // `digits` counts the significant ones
  bool any = false;
  const auto take = [&](char c, int shift) {
    any = true;
    if (digits < 19) {
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(c - '0');
      if (mantissa > 0) ++digits;
      exponent -= shift;
    } else {
      ++digits;
      exponent += 1 - shift;
    }
  };
  for (; p < end && is_digit(*p); ++p) take(*p, 0);
  if (p < end && *p == '.')
    for (++p; p < end && is_digit(*p); ++p) take(*p, 1);
  if (!any) {
    p = parse_word(begin + (begin < end && (*begin == '-' || *begin == '+') ? 1 : 0), end, value);
    if (p && negative) value = -value;
    return p;
  }
  if (p < end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool down = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+')) ++q;
    if (q < end && is_digit(*q)) {
      int e = 0;
      for (; q < end && is_digit(*q); ++q) e = e < 100000 ? 10 * e + (*q - '0') : e;
      exponent += down ? -e : e;
      p = q;
    }
  }
  // The result is exact if mantissa and power of ten are exact doubles (Clinger, PLDI 1990); otherwise use strtod.
  if (digits <= 19 && mantissa <= (std::uint64_t{1} << 53) && exponent >= -22 && exponent <= 22) {
    const auto m = static_cast<double>(mantissa);
    value = exponent < 0 ? m / kPowers[-exponent] : m * kPowers[exponent];
    if (negative) value = -value;
  } else {
    value = slow_number(begin, p);
  }
  return p;
}

std::optional<double> to_number(std::string_view text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  if (text.empty() || parse_number(text.data(), end, value) != end) return std::nullopt;
  return value;
}

bool is_digits(std::string_view text) {
  for (char c : text)
    if (!is_digit(c)) return false;
  return !text.empty();
}

std::optional<long long> to_integer(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  if (!is_digits(text) || text.size() > 18) return std::nullopt;
  long long value = 0;
  for (char c : text) value = 10 * value + (c - '0');
  return negative ? -value : value;
}

std::string format(double value) { return shortest(value, 15, 17); }
std::string format(float value) { return shortest(value, 6, 9); }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.substr(0, kMark.size()) == kMark ? text.substr(kMark.size()) : text;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out = "'";
  for (char c : text.substr(0, kLongest)) out += c >= ' ' && c < 127 ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

namespace {

/// How many letters have to be added, left out, changed or swapped with the next one to turn one word into the other
/// (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> table(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        table[i][j] = i + j;
        continue;
      }
      const std::size_t changed = table[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      table[i][j] = std::min({table[i - 1][j] + 1, table[i][j - 1] + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        table[i][j] = std::min(table[i][j], table[i - 2][j - 2] + 1);
    }
  return table[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& words) {
  constexpr std::size_t kLongest = 64;
  if (word.size() < 2 || word.size() > kLongest) return std::nullopt;
  std::optional<std::string> nearest;
  std::pair least(std::max<std::size_t>(1, word.size() / 3), kLongest);
  for (const std::string& candidate : words) {
    const std::size_t letters = distance(word, candidate);
    const bool begins = word.size() > 2 && candidate.compare(0, word.size(), word) == 0;
    const std::pair far(begins ? std::size_t{1} : letters, letters);  // of words that begin alike, the shortest
    if (far >= least) continue;
    least = far;
    nearest = candidate;
  }
  return nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& words) {
  const auto nearest = nearest_word(word, words);
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

std::string_view next_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

bool Lines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++next_;
  return true;
}

bool Lines::next_filled(std::string_view& line) {
  while (next(line)) {
    line = trimmed(line);
    if (!line.empty()) return true;
  }
  return false;
}

}  // namespace agrisee::io
