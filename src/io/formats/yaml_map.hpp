// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads YAML strictly: unknown keys are errors, and every error names the file, the line and the key.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <yaml-cpp/yaml.h>

namespace agrisee::io {

/// Read and parse a YAML file. @throws FileError when it cannot be read or parsed, holds more than one document, or is
/// empty and `may_be_empty` is false
YAML::Node load_yaml(const std::filesystem::path& path, bool may_be_empty = false);
/// Parse a YAML text; `path` is named in errors. @throws FileError as load_yaml
YAML::Node parse_yaml(const std::filesystem::path& path, const std::string& text, bool may_be_empty = false);

/// A YAML value, with the file and the key that it came from. Its functions throw FileError for a value of the wrong
/// type.
class YamlValue {
 public:
  YamlValue(const std::filesystem::path& path, const YAML::Node& node, std::string key)
      : path_(path), node_(node), key_(std::move(key)) {}

  /// Check that the value is a map in which no key is repeated and all keys are among `known`.
  void check_keys(std::initializer_list<const char*> known) const;
  bool has(const char* key) const;
  bool is_list() const { return node_.IsSequence(); }
  bool is_text() const { return node_.IsScalar(); }
  /// The member `key`, which must exist.
  YamlValue at(const char* key) const;
  /// An item of a list.
  YamlValue at(std::size_t index) const;
  /// The length of the value, which must be a list.
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
  /// The path of keys from the document, such as "robot.base".
  const std::string& key() const { return key_; }
  /// "<path>:<line>: <key>", for messages about what the value refers to.
  std::string place() const;
  /// Throw FileError "<path>:<line>: <key>: <message>".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  /// @throws FileError if the value is not a map
  void expect_map() const;
  std::filesystem::path path_;
  YAML::Node node_;
  std::string key_;  // path of keys from the document, separated by dots; empty for the document itself
};

}  // namespace agrisee::io
