// SPDX-License-Identifier: BSD-3-Clause
// Parameters from a parameter server: the names of the YAML files, a group's name before its fields'. Without ROS: a
// lookup answers for it.
#pragma once

#include <agrisee/parameters.hpp>

#include <set>
#include <string>
#include <type_traits>

namespace agrisee::robot {

/// Reads every field of a parameter struct. `lookup(name, field)` sets the field where the server has that name, and
/// throws ParameterError for a value of the wrong type; it is called with bool, int, double, std::string...
template <typename Lookup>
class FieldReader {
 public:
  /// @param separator between a group and its fields: "/" in ROS 1, "." in ROS 2
  /// @param known     receives every name that was asked for
  FieldReader(Lookup& lookup, std::string prefix, std::string separator, std::set<std::string>& known)
      : lookup_(lookup), prefix_(std::move(prefix)), separator_(std::move(separator)), known_(known) {}

  template <typename T>
  void operator()(const char* name, T& field) {
    const std::string key = prefix_ + name;
    if constexpr (std::is_same_v<T, RobustKernel>) {
      known_.insert(key);
      std::string text = to_string(field);
      lookup_(key, text);
      field = robust_kernel(text);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      known_.insert(key);
      lookup_(key, field);
      if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(field)) throw ParameterError(key + " has to be finite");
    } else {
      T::fields(field, FieldReader(lookup_, key + separator_, separator_, known_));
    }
  }

 private:
  Lookup& lookup_;
  std::string prefix_, separator_;
  std::set<std::string>& known_;
};

/// The parameters of a pipeline; names that the server lacks keep the values of its `preset`. Checked.
/// @throws ParameterError
template <typename Lookup>
Parameters read_parameters(Lookup&& lookup, const std::string& separator, std::set<std::string>& known) {
  std::string preset = "default";
  lookup("preset", preset);
  Parameters parameters = Parameters::named(preset);
  using L = std::remove_reference_t<Lookup>;
  Parameters::fields(parameters, FieldReader<L>(lookup, "", separator, known));
  parameters.check();
  return parameters;
}

}  // namespace agrisee::robot
