// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes JSON. Errors name the file and the key.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/io/files.hpp>

#include <Eigen/Core>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace agrisee::io {

using Json = nlohmann::ordered_json;

/// Parse a JSON text. @throws nlohmann::json::exception for a text that is not JSON
/// @throws InputError for a text that is nested deeper than 64 levels
Json parse_json(std::string_view text);

/// The same for a text from a file. @throws FileError, which names the file, when it is not JSON
Json parse_json(const std::filesystem::path& path, std::string_view text);

/// Read and parse a JSON file. @throws FileError when it cannot be read or is not JSON
Json load_json(const std::filesystem::path& path);
/// The same for the bytes of a file that was read already. @param path for messages
Json load_json(const std::filesystem::path& path, const Bytes& bytes);
/// The same, but null for a file that cannot be read or is not JSON.
Json load_json_or_null(const std::filesystem::path& path);

/// The JSON text, indented, with lists of numbers on one line. Bytes that are not UTF-8 are replaced.
std::string dump(const Json& json);

/// A list of the coefficients. @throws InputError with the message `what` if one is not finite
template <typename D>
Json json_list(const Eigen::MatrixBase<D>& values, const char* what) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    check_input(std::isfinite(values(i)), what);
    list.push_back(values(i) + 0.0);  // minus zero is zero
  }
  return list;
}

/// A JSON value, with the file and the key that it came from. It holds references: both must outlive it.
class JsonValue {
 public:
  JsonValue(const std::filesystem::path& path, const Json& json, std::string key)
      : path_(path), json_(json), key_(std::move(key)) {}

  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  /// The member `key`, which must exist. @throws FileError, as all functions below for a value of the wrong type
  JsonValue at(const char* key) const {
    if (!json_.is_object()) fail("expected an object");
    const auto found = json_.find(key);
    if (found == json_.end()) fail("missing key '" + std::string(key) + "'");
    return JsonValue(path_, *found, key_.empty() ? key : key_ + "." + key);
  }
  JsonValue at(std::size_t i) const { return JsonValue(path_, json_[i], key_ + "[" + std::to_string(i) + "]"); }
  /// The length of the value, which must be a list.
  std::size_t list_size() const {
    if (!json_.is_array()) fail("expected a list");
    return json_.size();
  }
  std::string text() const {
    if (!json_.is_string()) fail("expected a text");
    return json_.get<std::string>();
  }
  bool boolean() const {
    if (!json_.is_boolean()) fail("expected true or false");
    return json_.get<bool>();
  }
  double number() const {
    if (!json_.is_number()) fail("expected a number");
    return json_.get<double>();
  }
  std::uint64_t count() const {
    if (!json_.is_number_unsigned()) fail("expected a whole number, 0 or above");
    return json_.get<std::uint64_t>();
  }
  /// A list of exactly N numbers.
  template <int N>
  Eigen::Matrix<double, N, 1> numbers() const {
    if (list_size() != N) fail("expected a list of " + std::to_string(N) + " numbers");
    Eigen::Matrix<double, N, 1> out;
    for (int i = 0; i < N; ++i) out[i] = at(static_cast<std::size_t>(i)).number();
    return out;
  }
  const Json& json() const { return json_; }
  /// Throw FileError "<path>: <key>: <message>".
  [[noreturn]] void fail(const std::string& message) const {
    io::fail(path_, key_.empty() ? message : key_ + ": " + message);
  }

 private:
  const std::filesystem::path& path_;
  const Json& json_;
  std::string key_;
};

}  // namespace agrisee::io
