// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Numbers and lines of text, independent of the process's locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace agrisee::io {

/// Parse a decimal number (`nan` and `inf` included) at the start of [p, end).
/// @return the position behind it, or nullptr where there is none
const char* parse_number(const char* p, const char* end, double& value);

/// The number that `text` consists of, none when there is anything else in it.
std::optional<double> to_number(std::string_view text);
/// The same for whole numbers without a fraction or exponent.
std::optional<long long> to_integer(std::string_view text);

/// The shortest decimal that reads back as the same value; minus zero prints as 0.
std::string format(double value);
std::string format(float value);

/// `text` without blanks at either end.
std::string_view trimmed(std::string_view text);
/// `text` in lower case (ASCII).
std::string lower(std::string_view text);
/// A piece of a file, fit to be quoted in an error message: short and printable.
std::string excerpt(std::string_view text);

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// Cuts the next word off the front of `text`; empty when none is left.
std::string_view next_word(std::string_view& text);

/// The lines of a text, with their numbers.
class Lines {
 public:
  /// @param first number of the first line
  explicit Lines(std::string_view text, std::size_t first = 1) : rest_(text), next_(first) {}
  /// Cut off the next line, its end mark taken away. False at the end of the text.
  bool next(std::string_view& line);
  /// The same, skipping blank lines; blanks at either end of the line are taken away.
  bool next_filled(std::string_view& line);
  /// Number of the line returned last.
  std::size_t number() const { return next_ - 1; }
  /// What has not been cut off.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t next_;
};

}  // namespace agrisee::io
