// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/parameters.hpp>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

#include "yaml_map.hpp"

namespace agrisee::io {
namespace {

std::string number(double x) { return nlohmann::json(x).dump(); }

struct YamlWriter {
  std::string& out;
  int depth;
  template <typename T>
  void operator()(const char* name, const T& value) {
    out += std::string(static_cast<std::size_t>(2 * depth), ' ') + name + ":";
    if constexpr (std::is_same_v<T, bool>) {
      out += value ? " true\n" : " false\n";
    } else if constexpr (std::is_same_v<T, std::string>) {
      out += " " + value + "\n";
    } else if constexpr (std::is_same_v<T, RobustKernel>) {
      out += std::string(" ") + to_string(value) + "\n";
    } else if constexpr (std::is_floating_point_v<T>) {
      out += " " + number(value) + "\n";
    } else if constexpr (std::is_integral_v<T>) {
      out += " " + std::to_string(value) + "\n";
    } else {
      out += "\n";
      T::fields(value, YamlWriter{out, depth + 1});
    }
  }
};

struct JsonWriter {
  nlohmann::ordered_json& out;
  template <typename T>
  void operator()(const char* name, const T& value) {
    if constexpr (std::is_same_v<T, RobustKernel>) {
      out[name] = to_string(value);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      out[name] = value;
    } else {
      out[name] = nlohmann::ordered_json::object();
      T::fields(value, JsonWriter{out[name]});
    }
  }
};

std::string place(const std::string& path, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? path : path + ":" + std::to_string(mark.line + 1);
}

struct YamlReader {
  const std::string& path;
  const YAML::Node& node;
  const std::string prefix;
  std::set<std::string>& known;
  template <typename T>
  void operator()(const char* name, T& value) {
    known.insert(name);
    const YAML::Node child = node[name];
    if (!child.IsDefined()) return;
    const std::string key = prefix + name;
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string> || std::is_same_v<T, RobustKernel>) {
      try {
        if (!child.IsScalar()) throw YAML::BadConversion(child.Mark());
        if constexpr (std::is_same_v<T, RobustKernel>)
          value = robust_kernel(child.as<std::string>());
        else
          value = child.as<T>();
        if constexpr (std::is_floating_point_v<T>)
          if (!std::isfinite(value)) throw ParameterError("has to be finite, got " + child.Scalar());
      } catch (const YAML::Exception&) {
        throw FileError(place(path, child) + ": '" + key + "' has a value of the wrong type");
      } catch (const ParameterError& e) {
        throw FileError(place(path, child) + ": '" + key + "': " + e.what());
      }
    } else {
      read(path, child, key + ".", value);
    }
  }

  template <typename T>
  static void read(const std::string& path, const YAML::Node& map, const std::string& prefix, T& value) {
    if (!map.IsMap()) {
      const std::string what = prefix.empty() ? "the file" : "'" + prefix.substr(0, prefix.size() - 1) + "'";
      throw FileError(place(path, map) + ": " + what + " must be a map of parameters");
    }
    std::set<std::string> keys;
    T::fields(value, YamlReader{path, map, prefix, keys});
    for (const auto& entry : map) {
      const std::string name = entry.first.IsScalar() ? entry.first.as<std::string>() : "?";
      if (!keys.count(name)) throw FileError(place(path, entry.first) + ": unknown key '" + prefix + name + "'");
    }
  }
};

Parameters parameters_of(const std::string& path, const YAML::Node& root, const Parameters& base) {
  Parameters parameters = base;
  if (root.IsNull()) return parameters;
  try {
    if (root.IsMap() && root["preset"].IsDefined() && root["preset"].IsScalar())
      parameters = Parameters::named(root["preset"].as<std::string>());
    YamlReader::read(path, root, "", parameters);
    parameters.check();
  } catch (const ParameterError& e) {
    throw FileError(path + ": " + e.what());
  }
  return parameters;
}

}  // namespace

Parameters read_parameters(const std::string& path, const Parameters& base) {
  return parameters_of(path, load_yaml(path, true), base);
}

Parameters parameters_from_json(const std::string& text, const std::string& path) {
  return parameters_of(path, parse_yaml(path, text), {});  // JSON is YAML
}

std::string parameters_to_yaml(const Parameters& parameters) {
  std::string out;
  Parameters::fields(parameters, YamlWriter{out, 0});
  return out;
}

std::string parameters_to_json(const Parameters& parameters) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  Parameters::fields(parameters, JsonWriter{out});
  return out.dump();
}

}  // namespace agrisee::io
