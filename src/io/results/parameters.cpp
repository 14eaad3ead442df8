// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/parameters.hpp>

#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

#include "io/formats/json_value.hpp"
#include "io/formats/text.hpp"
#include "io/formats/yaml_map.hpp"

namespace agrisee::io {
namespace {

std::string number(double x) { return nlohmann::ordered_json(x).dump(); }

/// Writes every field of a struct, one a line, indented by two spaces a level.
struct YamlWriter {
  std::string& out;
  int depth;
  template <typename T, typename... Rule>
  void operator()(const char* name, const T& value, const Rule&...) {
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

/// Writes every field of a struct into an object.
struct JsonWriter {
  nlohmann::ordered_json& out;
  template <typename T, typename... Rule>
  void operator()(const char* name, const T& value, const Rule&...) {
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

/// "<path>:<line>" of a node, the path alone where the line is not known.
std::string place(const std::string& path, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? path : path + ":" + std::to_string(mark.line + 1);
}

/// A hint for a key with dots, as messages and documents write it, if it begins with a key that is known:
/// "; write gain: {min_gain: ...}".
std::string how_to_nest(const std::string& name, const std::set<std::string>& known) {
  if (!known.count(name.substr(0, name.find('.'))) || name.back() == '.') return "";
  std::string nested, closing;
  for (std::size_t begin = 0, dot = 0; (dot = name.find('.', begin)) != std::string::npos; begin = dot + 1) {
    nested += name.substr(begin, dot - begin) + ": {";
    closing += "}";
  }
  if (nested.empty()) return "";
  return "; write " + nested + name.substr(name.rfind('.') + 1) + ": ..." + closing;
}

/// What the author of an unknown key may have meant; empty if nothing is like it.
std::string hint(const std::string& name, const std::set<std::string>& known) {
  const std::string nested = how_to_nest(name, known);
  return nested.empty() ? did_you_mean(name, {known.begin(), known.end()}) : nested;
}

/// A value of a file. YAML would read whole numbers that begin with 0 as octal or hexadecimal ones.
/// @throws ParameterError, or YAML::Exception, for a value of the wrong type
template <typename T>
T scalar_as(const YAML::Node& node) {
  if constexpr (std::is_same_v<T, RobustKernel>) {
    return robust_kernel(node.as<std::string>());
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    const auto number = to_integer(node.Scalar());
    if (!number) throw ParameterError(excerpt(node.Scalar()) + " is not a whole number");
    const T value = static_cast<T>(*number);
    if (value != *number) throw ParameterError(node.Scalar() + " is too large");
    return value;
  } else {
    return node.as<T>();
  }
}

/// Sets every field of a struct that a map names. Ranges are not tested here.
struct YamlReader {
  const std::string& path;
  const YAML::Node& node;
  const std::string prefix;
  std::set<std::string>& known;
  template <typename T, typename... Rule>
  void operator()(const char* name, T& value, const Rule&...) {
    known.insert(name);
    const YAML::Node child = node[name];
    if (!child.IsDefined()) return;
    const std::string key = prefix + name;
    if constexpr (has_fields<T>) {
      read(path, child, key + ".", value);
    } else {
      try {
        if (!child.IsScalar()) throw YAML::BadConversion(child.Mark());
        value = scalar_as<T>(child);
      } catch (const YAML::Exception&) {
        throw FileError(place(path, child) + ": '" + key + "' has a value of the wrong type");
      } catch (const ParameterError& e) {
        throw FileError(place(path, child) + ": '" + key + "': " + e.what());
      }
    }
  }

  /// Read a struct from a map.
  /// @throws FileError for what is no map, an unknown key or a value of the wrong type
  template <typename T>
  static void read(const std::string& path, const YAML::Node& map, const std::string& prefix, T& value) {
    if (!map.IsMap()) {
      const std::string what = prefix.empty() ? "the file" : "'" + prefix.substr(0, prefix.size() - 1) + "'";
      throw FileError(place(path, map) + ": " + what + " must be a map of parameters");
    }
    std::set<std::string> keys;
    T::fields(value, YamlReader{path, map, prefix, keys});
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const std::string name = entry.first.IsScalar() ? entry.first.as<std::string>() : "?";
      if (!seen.insert(name).second)
        throw FileError(place(path, entry.first) + ": '" + prefix + name + "' is given twice");
      if (!keys.count(name))
        throw FileError(place(path, entry.first) + ": unknown key '" + prefix + name + "'" + hint(name, keys));
    }
  }
};

/// Where a file has a dotted key or, if it does not name the key, the innermost of the maps about it; the path alone if
/// it has none of them. A key that is not in the file may be at fault, since some ranges depend on other fields.
std::string place_of(const std::string& path, const YAML::Node& map, const std::string& key, bool is_root = true) {
  const std::size_t dot = key.find('.');
  const YAML::Node child = map.IsMap() ? map[key.substr(0, dot)] : YAML::Node(YAML::NodeType::Undefined);
  if (!child.IsDefined()) return is_root ? path : place(path, map);
  return dot == std::string::npos ? place(path, child) : place_of(path, child, key.substr(dot + 1), false);
}

Parameters parameters_of(const std::string& path, const YAML::Node& root, const Parameters& base) {
  Parameters parameters = base;
  if (root.IsNull()) return parameters;
  try {
    if (root.IsMap() && root["preset"].IsDefined() && root["preset"].IsScalar())
      parameters = Parameters::named(root["preset"].as<std::string>());
    YamlReader::read(path, root, "", parameters);
    parameters.check();
  } catch (const FieldError& e) {
    throw FileError(place_of(path, root, e.key) + ": '" + e.key + "' " + e.complaint);
  }
  return parameters;
}

}  // namespace

Parameters read_parameters(const std::string& path, const Parameters& base) {
  return parameters_of(path, load_yaml(path, true), base);
}

Parameters parameters_from_yaml(const std::string& text, const std::string& path) {
  return parameters_of(path, parse_yaml(path, text, true), {});
}

Parameters parameters_from_json(const std::string& text, const std::string& path) {
  parse_json(path, text);
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
