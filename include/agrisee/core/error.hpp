// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The exceptions that AgriSEE throws, two checks that throw them, and numbers as their messages show them.
#pragma once

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace agrisee {

/// Base of all exceptions that the library throws. `what()` names the file, key or value at fault.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A parameter is out of range. `what()` names the field and its value.
struct ParameterError : Error {
  using Error::Error;
};

/// Input data that cannot be processed: sizes that disagree, poses that are not finite, invalid meshes and so on.
struct InputError : Error {
  using Error::Error;
};

/// A file cannot be read, parsed or written. `what()` begins with its path.
struct FileError : Error {
  using Error::Error;
};

/// The caller asked for the work to stop; see core/cancellation.hpp.
struct Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

/// A number as messages show it, to at most 17 significant digits.
inline std::string number_text(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// Throws ParameterError("<field> must be <rule>, got <value>") unless `ok`. Rules say "3 or more", not ">= 3".
template <typename T>
void check_parameter(bool ok, const char* field, const char* rule, const T& value) {
  if (ok) return;
  std::string got;
  if constexpr (std::is_floating_point_v<T>)
    got = number_text(static_cast<double>(value), 9);
  else
    got = std::to_string(value);
  throw ParameterError(std::string(field) + " must be " + rule + ", got " + got);
}

/// Throws InputError(message) unless `ok`.
inline void check_input(bool ok, const char* message) {
  if (!ok) throw InputError(message);
}

/// A length (m) as messages show it: "0.0125 m".
inline std::string metres(double length) { return number_text(length, 3) + " m"; }

/// A share (0..1) as messages show it: "34 %".
inline std::string percentage(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

}  // namespace agrisee
