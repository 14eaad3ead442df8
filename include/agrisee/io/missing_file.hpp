// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The error of readers whose file does not exist, for programs that go on without it.
#pragma once

#include <agrisee/core/error.hpp>

#include <filesystem>
#include <string>
#include <utility>

namespace agrisee::io {

/// A file that is to be read does not exist. `what()` begins with its path.
struct MissingFile : FileError {
  /// @param file the path, as it was given
  /// @param message what follows the path and a colon
  MissingFile(std::filesystem::path file, const std::string& message)
      : FileError(file.string() + ": " + message), path(std::move(file)) {}

  std::filesystem::path path;  ///< as it was given
};

}  // namespace agrisee::io
