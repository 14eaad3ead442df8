// SPDX-License-Identifier: BSD-3-Clause
// Parameters from a parameter server. Their names are those of the YAML files: the name of a group, a separator, the
// name of the field. The file does not depend on ROS: a function that looks up a name is handed in.
#pragma once

#include <agrisee/parameters.hpp>

#include <set>
#include <string>
#include <type_traits>

namespace agrisee::robot {

/// Reads every field of a parameter struct. `lookup(name, field)` sets the field if the server has that name, and
/// throws ParameterError for a value of the wrong type. It is called with bool, int, double and std::string.
template <typename Lookup>
class FieldReader {
 public:
  /// @param separator between a group and its fields: "/" in ROS 1, "." in ROS 2
  /// @param known     receives every name that is looked up
  FieldReader(Lookup& lookup, std::string prefix, std::string separator, std::set<std::string>& known)
      : lookup_(lookup), prefix_(std::move(prefix)), separator_(std::move(separator)), known_(known) {}

  /// Reads one field, or those of a struct. Its range is not tested here.
  template <typename T, typename... Rule>
  void operator()(const char* name, T& field, const Rule&...) {
    const std::string key = prefix_ + name;
    if constexpr (has_fields<T>) {
      T::fields(field, FieldReader(lookup_, key + separator_, separator_, known_));
    } else {
      known_.insert(key);
      if constexpr (std::is_same_v<T, RobustKernel>) {
        std::string text = to_string(field);
        lookup_(key, text);
        try {
          field = robust_kernel(text);
        } catch (const ParameterError& e) {
          throw ParameterError(key + ": " + e.what());
        }
      } else {
        lookup_(key, field);
      }
    }
  }

 private:
  Lookup& lookup_;
  std::string prefix_, separator_;
  std::set<std::string>& known_;
};

/// The parameters of a pipeline. Names that the server does not have keep the values of its `preset`.
/// @throws ParameterError for a value of the wrong type or out of its range; it names the parameter as the server does
template <typename Lookup>
Parameters read_parameters(Lookup&& lookup, const std::string& separator, std::set<std::string>& known) {
  std::string preset = "default";
  lookup("preset", preset);
  Parameters parameters = Parameters::named(preset);
  using L = std::remove_reference_t<Lookup>;
  Parameters::fields(parameters, FieldReader<L>(lookup, "", separator, known));
  check_fields(parameters, "", separator);
  return parameters;
}

}  // namespace agrisee::robot
