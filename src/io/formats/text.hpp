// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parses and prints numbers and lines of text, independently of the locale of the process.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace agrisee::io {

/// Parse a decimal number, `nan` or `inf` at the start of [p, end).
/// @return the position behind the number, or nullptr if there is no number
const char* parse_number(const char* p, const char* end, double& value);

/// The number that `text` consists of; none if `text` is anything but a number.
std::optional<double> to_number(std::string_view text);
/// The integer that `text` consists of (at most 18 digits, no fraction, no exponent); none if it is anything else.
std::optional<long long> to_integer(std::string_view text);

/// The shortest decimal number that reads back as the same value; minus zero is printed as 0.
std::string format(double value);
/// The shortest decimal number that reads back as the same float.
std::string format(float value);

/// `text` without blanks at either end.
std::string_view trimmed(std::string_view text);
/// `text` without the byte order mark of UTF-8 at its beginning, as spreadsheets write it.
std::string_view without_byte_order_mark(std::string_view text);
/// `text` in lower case (ASCII).
std::string lower(std::string_view text);
/// `text` in quotes for an error message: at most 40 characters, unprintable ones replaced by `?`.
std::string excerpt(std::string_view text);

/// Of some words, the one that a mistyped word probably means: the one of which it is the beginning (of several the
/// shortest), or from which it differs least (letters added, left out, changed or swapped; at most a third of them).
/// None if no word is that near.
std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& words);

/// "; did you mean 'scan_volume'?", to be added to a message about an unknown word; empty if no word is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& words);

/// Whether `text` consists of decimal digits, at least one.
bool is_digits(std::string_view text);

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// Remove the next word from the front of `text` and return it; empty when none is left.
std::string_view next_word(std::string_view& text);

/// Iterates over the lines of a text and counts them. A byte order mark is no part of the first line.
class Lines {
 public:
  /// @param first number of the first line
  explicit Lines(std::string_view text, std::size_t first = 1) : rest_(without_byte_order_mark(text)), next_(first) {}
  /// Get the next line, without its line break. @return false at the end of the text
  bool next(std::string_view& line);
  /// Get the next line that is not blank, without blanks at its ends. @return false at the end of the text
  bool next_filled(std::string_view& line);
  /// Number of the line returned last.
  std::size_t number() const { return next_ - 1; }
  /// The text after the line returned last.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t next_;
};

}  // namespace agrisee::io
