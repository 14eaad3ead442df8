// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// YAML read strictly: every key is asked for, every error names file, line and key.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <yaml-cpp/yaml.h>

namespace agrisee::io {

/// The one document of a YAML file. @throws FileError when it cannot be read or parsed, holds more than one document,
/// or is empty and must not be
YAML::Node load_yaml(const std::filesystem::path& path, bool may_be_empty = false);
/// The same of a text; `path` is what errors name.
YAML::Node parse_yaml(const std::filesystem::path& path, const std::string& text, bool may_be_empty = false);

/// A YAML value together with the file and key it came from.
class YamlValue {
 public:
  YamlValue(const std::filesystem::path& path, const YAML::Node& node, std::string key)
      : path_(path), node_(node), key_(std::move(key)) {}

  /// Check that it is a map with no key twice and none but these.
  void check_keys(std::initializer_list<const char*> known) const;
  bool has(const char* key) const;
  /// A member that has to be there.
  YamlValue at(const char* key) const;
  /// Item of a list.
  YamlValue at(std::size_t index) const;
  /// Length of what has to be a list.
  std::size_t list_size() const;

  std::string text() const;
  double number() const;
  long long integer() const;
  /// A list of exactly N numbers.
  template <int N>
  Eigen::Matrix<double, N, 1> numbers() const {
    if (list_size() != N) fail("expected a list of " + std::to_string(N) + " numbers");
    Eigen::Matrix<double, N, 1> out;
    for (int i = 0; i < N; ++i) out[i] = at(static_cast<std::size_t>(i)).number();
    return out;
  }
  /// Throw FileError "<path>:<line>: <key>: <message>".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::filesystem::path path_;
  YAML::Node node_;
  std::string key_;  // dotted, from the top; empty for the document itself
};

}  // namespace agrisee::io
