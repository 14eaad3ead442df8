// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The exceptions that AgriSEE throws, and the check that throws them.
#pragma once

#include <stdexcept>
#include <string>

namespace agrisee {

/// Base of every exception thrown by the library. `what()` names the file, the key or the value at fault.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A parameter is out of its range; `what()` names the field and its value.
struct ParameterError : Error {
  using Error::Error;
};

/// Data that cannot be worked on (sizes that disagree, non-finite poses, a degenerate mesh...).
struct InputError : Error {
  using Error::Error;
};

/// A file that cannot be read, parsed or written; `what()` begins with its path.
struct FileError : Error {
  using Error::Error;
};

/// The work was stopped from outside: see core/cancellation.hpp.
struct Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

/// Throw ParameterError("<field> must be <rule>, got <value>") unless `ok`.
template <typename T>
void check_parameter(bool ok, const char* field, const char* rule, const T& value) {
  if (!ok) throw ParameterError(std::string(field) + " must be " + rule + ", got " + std::to_string(value));
}

/// Throw InputError(message) unless `ok`.
inline void check_input(bool ok, const char* message) {
  if (!ok) throw InputError(message);
}

}  // namespace agrisee
