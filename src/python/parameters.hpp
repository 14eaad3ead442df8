// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameter structs as Python objects: their fields become attributes, with the names of YAML files.
#pragma once

#include <agrisee/cloud/robust.hpp>
#include <agrisee/parameters.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <pybind11/pybind11.h>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"

namespace agrisee::python {

namespace py = pybind11;

/// A parameter struct and where it stands among all parameters.
template <typename T>
struct Group {
  std::shared_ptr<T> value;  ///< shares its ownership with the struct that it is part of
  std::string prefix;        ///< before the names of its fields in messages, such as "split.bodies."
};

/// What `agrisee.Parameters` is.
using ParametersObject = Group<Parameters>;

/// The names of the fields of a parameter struct.
template <typename T>
std::vector<std::string> field_names() {
  std::vector<std::string> names;
  T value{};
  T::fields(value, [&](const char* name, auto&, const auto&...) { names.push_back(name); });
  return names;
}

/// "unknown key 'gain.candidats'; did you mean 'candidates'?"
std::string unknown_key(const std::string& prefix, const std::string& name, const std::vector<std::string>& names);

/// A whole number. @throws pybind11::type_error that names the key for what is none
long long integer_of(const py::handle& value, const std::string& key);
/// A number. @throws pybind11::type_error that names the key for what is none
double number_of(const py::handle& value, const std::string& key);
/// True or false, of Python or NumPy. @throws pybind11::type_error that names the key for what is neither
bool bool_of(const py::handle& value, const std::string& key);
/// A text. @throws pybind11::type_error that names the key for what is none
std::string text_of(const py::handle& value, const std::string& key);

/// A dict, or any other mapping (collections.abc.Mapping) as one; none for other objects.
std::optional<py::dict> dict_of(const py::handle& value);
/// The same for an argument that has to be one. @param name of the argument, for messages
/// @throws pybind11::type_error
py::dict mapping_of(const py::handle& argument, const char* name);

template <typename T>
void set_fields(T& out, const py::dict& values, const std::string& prefix);

/// Set a field to a Python value of its type, or to a dict of the fields within it. Ranges are not tested.
/// @throws pybind11::type_error or ParameterError that name the key
template <typename T>
void set_field(T& out, const py::handle& value, const std::string& key) {
  if constexpr (std::is_same_v<T, bool>) {
    out = bool_of(value, key);
  } else if constexpr (std::is_integral_v<T>) {
    const long long n = integer_of(value, key);
    if (n < std::numeric_limits<T>::min() || n > std::numeric_limits<T>::max())
      throw FieldError(key, "is out of range, got " + std::to_string(n));
    out = static_cast<T>(n);
  } else if constexpr (std::is_floating_point_v<T>) {
    out = static_cast<T>(number_of(value, key));
  } else if constexpr (std::is_same_v<T, std::string>) {
    out = text_of(value, key);
  } else if constexpr (std::is_same_v<T, RobustKernel>) {
    try {
      out = robust_kernel(text_of(value, key));
    } catch (const ParameterError&) {
      throw FieldError(key, "must be none, huber or tukey, got " + text_of(value, key));
    }
  } else if (const auto values = dict_of(value)) {
    set_fields(out, *values, key + ".");
  } else if (py::isinstance<Group<T>>(value)) {
    out = *value.cast<const Group<T>&>().value;
  } else {
    throw py::type_error(key + " must be a dict of parameters, got " + short_repr(value));
  }
}

/// Set the fields that a dict names; names may be dotted. Ranges are not tested.
/// @throws pybind11::type_error or ParameterError that name the whole key
template <typename T>
void set_fields(T& out, const py::dict& values, const std::string& prefix) {
  for (const auto& [key, value] : values) {
    std::string name = text_of(key, "a key of the parameters");
    py::object item = py::reinterpret_borrow<py::object>(value);
    if (const std::size_t dot = name.find('.'); dot != std::string::npos) {
      py::dict rest;
      rest[py::str(name.substr(dot + 1))] = item;
      item = rest;
      name.resize(dot);
    }
    bool found = false;
    T::fields(out, [&](const char* field, auto& member, const auto&...) {
      if (name != field) return;
      set_field(member, item, prefix + name);
      found = true;
    });
    if (!found) throw ParameterError(unknown_key(prefix, name, field_names<T>()));
  }
}

/// A field as a Python value; a struct as a dict.
template <typename T>
py::object value_of(const T& field) {
  if constexpr (std::is_same_v<T, RobustKernel>) {
    return py::str(to_string(field));
  } else if constexpr (has_fields<T>) {
    py::dict out;
    T::fields(field, [&](const char* name, const auto& member, const auto&...) { out[name] = value_of(member); });
    return std::move(out);
  } else {
    return py::cast(field);
  }
}

/// The parameters of a stage, from keyword arguments with the names of its fields.
/// @throws pybind11::type_error, ParameterError
template <typename T>
T stage_parameters(const py::kwargs& values) {
  T out{};
  set_fields(out, values, "");
  out.check();
  return out;
}

/// Parameters from an argument: None (the defaults), agrisee.Parameters, or a mapping as of Parameters.from_dict.
Parameters parameters_of(const py::object& argument);

}  // namespace agrisee::python
