// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// JSON in and out: numbers that are finite, errors that name file and key.
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

/// The JSON document of a text. @throws nlohmann::json::exception; InputError when it nests deeper than 64 levels
Json parse_json(std::string_view text);

/// The JSON document of a file. @throws FileError
Json load_json(const std::filesystem::path& path);

/// Pretty-printed, text that is not UTF-8 repaired; lists of numbers stay on one line.
std::string dump(const Json& json);

/// A list of numbers. @throws InputError naming `what` when one is not finite
template <typename D>
Json json_list(const Eigen::MatrixBase<D>& values, const char* what) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    check_input(std::isfinite(values(i)), what);
    list.push_back(values(i) + 0.0);  // minus zero is zero
  }
  return list;
}

/// A JSON value together with the file and key it came from.
class JsonValue {
 public:
  JsonValue(const std::filesystem::path& path, const Json& json, std::string key)
      : path_(path), json_(json), key_(std::move(key)) {}

  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  JsonValue at(const char* key) const {
    if (!json_.is_object()) fail("expected an object");
    const auto found = json_.find(key);
    if (found == json_.end()) fail("missing key '" + std::string(key) + "'");
    return JsonValue(path_, *found, key_.empty() ? key : key_ + "." + key);
  }
  JsonValue at(std::size_t i) const { return JsonValue(path_, json_[i], key_ + "[" + std::to_string(i) + "]"); }
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
  template <int N>
  Eigen::Matrix<double, N, 1> numbers() const {
    if (list_size() != N) fail("expected a list of " + std::to_string(N) + " numbers");
    Eigen::Matrix<double, N, 1> out;
    for (int i = 0; i < N; ++i) out[i] = at(static_cast<std::size_t>(i)).number();
    return out;
  }
  const Json& json() const { return json_; }
  [[noreturn]] void fail(const std::string& message) const {
    io::fail(path_, key_.empty() ? message : key_ + ": " + message);
  }

 private:
  const std::filesystem::path& path_;
  const Json& json_;
  std::string key_;
};

}  // namespace agrisee::io
