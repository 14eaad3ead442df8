// SPDX-License-Identifier: BSD-3-Clause
#include "report/records.hpp"

#include <optional>
#include <type_traits>

#include "io/formats/json_value.hpp"

namespace agrisee::report {
namespace {

using io::Json;
using io::JsonValue;

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <typename T>
struct IsVector : std::false_type {};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type {};

/// The JSON value of a number, text, vector, list or optional, or of a struct with `fields` of such types. Numbers that
/// are not finite, and optionals without a value, become null.
template <typename T>
Json to_json(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return Json(value);
  } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
    return Json::array({to_json(value.x()), to_json(value.y()), to_json(value.z())});
  } else if constexpr (IsOptional<T>::value) {
    return value ? to_json(*value) : Json(nullptr);
  } else if constexpr (IsVector<T>::value) {
    Json list = Json::array();
    for (const auto& item : value) list.push_back(to_json(item));
    return list;
  } else {
    Json object = Json::object();
    T::fields(value, [&](const char* name, const auto& field) { object[name] = to_json(field); });
    return object;
  }
}

/// Read what to_json wrote.
template <typename T>
void from_json(const JsonValue& json, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!json.json().is_boolean()) json.fail("expected true or false");
    value = json.json().get<bool>();
  } else if constexpr (std::is_floating_point_v<T>) {
    value = json.json().is_null() ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(json.number());
  } else if constexpr (std::is_arithmetic_v<T>) {
    if (!json.json().is_number_integer()) json.fail("expected a whole number");
    value = json.json().get<T>();
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = json.text();
  } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
    if (json.list_size() != 3) json.fail("expected a list of 3 numbers");
    for (Eigen::Index i = 0; i < 3; ++i) from_json(json.at(static_cast<std::size_t>(i)), value[i]);
  } else if constexpr (IsOptional<T>::value) {
    value.reset();
    if (!json.json().is_null()) from_json(json, value.emplace());
  } else if constexpr (IsVector<T>::value) {
    value.clear();
    for (std::size_t i = 0; i < json.list_size(); ++i) from_json(json.at(i), value.emplace_back());
  } else {
    T::fields(value, [&](const char* name, auto& field) { from_json(json.at(name), field); });
  }
}

template <typename Record>
void read_record(const std::filesystem::path& path, Record& record) {
  const Json json = io::load_json(path);
  const JsonValue top(path, json, "");
  if constexpr (std::is_same_v<Record, study::CellRecord>) from_json(top.at("cell"), record.cell);
  from_json(top, record);
}

}  // namespace

void write_record(const std::filesystem::path& path, const study::CellRecord& record) {
  Json json;
  json["cell"] = to_json(record.cell);
  json.update(to_json(record));
  io::write_file(path, io::dump(json));
}

void write_record(const std::filesystem::path& path, const study::SceneRecord& record) {
  io::write_file(path, io::dump(to_json(record)));
}

study::CellRecord read_cell_record(const std::filesystem::path& path) {
  study::CellRecord record;
  read_record(path, record);
  return record;
}

study::SceneRecord read_scene_record(const std::filesystem::path& path) {
  study::SceneRecord record;
  read_record(path, record);
  return record;
}

}  // namespace agrisee::report
