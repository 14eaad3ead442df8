// SPDX-License-Identifier: BSD-3-Clause
#include "parameters.hpp"

#include <agrisee/io/files.hpp>
#include <agrisee/io/parameters.hpp>

#include <cctype>
#include <filesystem>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.hpp"
#include "io/formats/text.hpp"

namespace agrisee::python {
namespace {

std::string shown(const py::handle& value) { return py::repr(value).cast<std::string>(); }

/// What a field may be, for its documentation.
template <typename T, typename... Rule>
std::string field_doc(const Rule&... rule) {
  if constexpr (std::is_same_v<T, bool>)
    return "true or false";
  else if constexpr (std::is_same_v<T, RobustKernel>)
    return "none, huber or tukey";
  else if constexpr (has_fields<T>)
    return "a group of parameters";
  else if constexpr (sizeof...(Rule) == 1)
    return std::string(std::is_integral_v<T> ? "whole number, " : "") + (rule.text() + ...);
  else
    return "";
}

/// Test one field of a struct against its range.
template <typename T>
void check_one(const T& value, const std::string& prefix, const char* wanted) {
  T::fields(value, [&](const char* name, const auto& field, const auto&... rule) {
    using F = std::decay_t<decltype(field)>;
    if (std::string_view(name) != wanted) return;
    if constexpr (has_fields<F>)
      check_fields(field, prefix + name + ".");
    else
      (agrisee::detail::check_field(prefix, name, field, rule), ...);
  });
}

/// "split.bodies." as the name of a class: SplitBodiesParameters.
std::string class_name(const std::string& prefix) {
  std::string out;
  bool upper = true;
  for (const char c : prefix) {
    if (c == '.' || c == '_') {
      upper = true;
      continue;
    }
    out += upper ? static_cast<char>(std::toupper(c)) : c;
    upper = false;
  }
  return out + "Parameters";
}

/// Refuse to change the name of the preset alone.
template <typename T>
void keep_preset(bool is_set) {
  if (std::is_same_v<T, Parameters> && is_set)
    throw ParameterError("preset cannot be changed afterwards: begin with Parameters('paper'), for instance");
}

template <typename T>
void update(Group<T>& group, const py::object& argument) {
  const py::dict values = mapping_of(argument, "values");
  keep_preset<T>(values.contains("preset"));
  T changed = *group.value;
  set_fields(changed, values, group.prefix);
  if constexpr (std::is_same_v<T, Parameters>)
    changed.check();
  else
    check_fields(changed, group.prefix);
  *group.value = changed;
}

/// The keys whose values differ, as "gain.min_gain=0.002".
template <typename T>
void list_differences(const T& value, const T& base, const std::string& prefix, std::string& out) {
  T::fields(value, [&](const char* name, const auto& field, const auto&...) {
    using F = std::decay_t<decltype(field)>;
    const auto* at = reinterpret_cast<const char*>(&base) +
                     (reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&value));
    const auto& other = *reinterpret_cast<const F*>(at);
    if constexpr (has_fields<F>) {
      list_differences(field, other, prefix + name + ".", out);
    } else if (!(field == other)) {
      out += ", " + prefix + name + "=" + shown(value_of(field));
    }
  });
}

template <typename T>
void bind_group(py::module_& m, const std::string& prefix);

/// A field of a struct: its name, and how far it is from the struct's beginning (bytes).
struct Field {
  const char* name;
  std::ptrdiff_t offset;

  template <typename F, typename T>
  F& of(T& value) const {
    return *reinterpret_cast<F*>(reinterpret_cast<char*>(&value) + offset);
  }
};

/// The value of a field, or an object that refers to the struct that it is.
template <typename F, typename T>
py::object get(const Group<T>& group, const Field& field) {
  F& value = field.of<F>(*group.value);
  if constexpr (has_fields<F>)
    return py::cast(Group<F>{std::shared_ptr<F>(group.value, &value), group.prefix + field.name + "."});
  else
    return value_of(value);
}

template <typename F, typename T>
void set(Group<T>& group, const Field& field, const py::object& value) {
  keep_preset<T>(std::string_view(field.name) == "preset");
  T changed = *group.value;
  set_field(field.of<F>(changed), value, group.prefix + field.name);
  check_one(changed, group.prefix, field.name);
  field.of<F>(*group.value) = field.of<F>(changed);
}

/// Attributes for the fields of a struct.
template <typename T>
void bind_fields(py::module_& m, py::class_<Group<T>>& group, const std::string& prefix) {
  T sample{};
  T::fields(sample, [&](const char* name, auto& member, const auto&... rule) {
    using F = std::decay_t<decltype(member)>;
    const Field field{name, reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&sample)};
    if constexpr (has_fields<F>) bind_group<F>(m, prefix + name + ".");
    group.def_property(
        name, [field](const Group<T>& self) { return get<F>(self, field); },
        [field](Group<T>& self, const py::object& value) { set<F>(self, field, value); },
        field_doc<F>(rule...).c_str());
  });
}

/// What all groups have beside their fields.
template <typename T>
void bind_access(py::class_<Group<T>>& group) {
  group
      .def("__setattr__",
           [](const py::object& self, const std::string& name, const py::object& value) {
             const auto& mine = self.cast<const Group<T>&>();
             for (const std::string& known : field_names<T>())
               if (known == name) {
                 if (PyObject_GenericSetAttr(self.ptr(), py::str(name).ptr(), value.ptr()) != 0)
                   throw py::error_already_set();
                 return;
               }
             throw py::attribute_error(unknown_key(mine.prefix, name, field_names<T>()));
           })
      .def("__getattr__",
           [](const Group<T>& self, const std::string& name) -> py::object {  // only for what is no attribute
             throw py::attribute_error(unknown_key(self.prefix, name, field_names<T>()));
           })
      .def(
          "to_dict", [](const Group<T>& self) { return value_of(*self.value); }, "All values, as nested dicts.")
      .def("update", &update<T>, py::arg("values"),
           "Set the values of a dict or another mapping (nested, or with dotted keys), then check all ranges; on an "
           "error nothing changes.")
      .def("__eq__", [](const Group<T>& self, const py::object& other) {
        return py::isinstance<Group<T>>(other) &&
               value_of(*self.value).equal(value_of(*other.cast<const Group<T>&>().value));
      });
  group.attr("__hash__") = py::none();
}

template <typename T>
void bind_group(py::module_& m, const std::string& prefix) {
  if (py::detail::get_type_info(typeid(Group<T>))) return;  // the same struct, under another key
  py::class_<Group<T>> group(m, class_name(prefix).c_str(), ("The parameters " + prefix + "*").c_str());
  bind_fields(m, group, prefix);
  bind_access(group);
  group.def("__repr__", [](const Group<T>& self) {
    return self.prefix.substr(0, self.prefix.size() - 1) + ": " + shown(value_of(*self.value));
  });
  group.def(py::pickle([](const Group<T>& self) { return py::make_tuple(self.prefix, value_of(*self.value)); },
                       [](const py::tuple& state) {
                         check_input(state.size() == 2, "a pickled group of parameters is no pair");
                         Group<T> out{std::make_shared<T>(), text_of(state[0], "the name of a pickled group")};
                         update(out, py::object(state[1]));
                         return out;
                       }));
}

ParametersObject object_of(Parameters parameters) { return {std::make_shared<Parameters>(std::move(parameters)), ""}; }

/// Parameters from a dict that may name a preset.
Parameters from_dict(const py::dict& values) {
  Parameters out;
  if (values.contains("preset")) out = Parameters::named(text_of(values["preset"], "preset"));
  set_fields(out, values, "");
  out.check();
  return out;
}

/// Parameters from YAML: a path, or a text, which contains a colon followed by a blank or a line break.
Parameters from_yaml(const py::object& source) {
  if (!py::isinstance<py::str>(source)) return io::read_parameters(source.cast<std::filesystem::path>().string());
  const auto text = source.cast<std::string>();
  if (text.find('\n') == std::string::npos && text.find(": ") == std::string::npos) return io::read_parameters(text);
  try {
    return io::parameters_from_yaml(text, "YAML");  // JSON is YAML, and it is read as such
  } catch (const FileError& e) {
    throw ParameterError(e.what());
  }
}

std::string repr(const ParametersObject& self) {
  std::string out;
  list_differences(*self.value, Parameters::named(self.value->preset), "", out);
  return "Parameters('" + self.value->preset + "'" + out + ")";
}

}  // namespace

std::string unknown_key(const std::string& prefix, const std::string& name, const std::vector<std::string>& names) {
  return "unknown key '" + prefix + name + "'" + io::did_you_mean(name, names);
}

std::optional<py::dict> dict_of(const py::handle& value) {
  if (py::isinstance<py::dict>(value)) return py::reinterpret_borrow<py::dict>(value);
  if (!py::isinstance(value, py::module_::import("collections.abc").attr("Mapping"))) return std::nullopt;
  return py::dict(py::reinterpret_borrow<py::object>(value));
}

py::dict mapping_of(const py::handle& argument, const char* name) {
  if (auto values = dict_of(argument)) return *std::move(values);
  throw py::type_error(std::string(name) + " must be a dict or another mapping, got " + short_repr(argument));
}

bool bool_of(const py::handle& value, const std::string& key) {
  if (PyBool_Check(value.ptr())) return value.ptr() == Py_True;
  const std::string type = py::type::of(value).attr("__name__").cast<std::string>();
  if (type != "bool_" && type != "bool") throw py::type_error(key + " must be True or False, got " + short_repr(value));
  return PyObject_IsTrue(value.ptr()) == 1;
}

long long integer_of(const py::handle& value, const std::string& key) {
  const bool may_be_one = !PyBool_Check(value.ptr()) && PyIndex_Check(value.ptr());
  const auto index = py::reinterpret_steal<py::object>(may_be_one ? PyNumber_Index(value.ptr()) : nullptr);
  if (!index) {
    PyErr_Clear();
    throw py::type_error(key + " must be a whole number, got " + short_repr(value));
  }
  int overflow = 0;
  const long long n = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0) throw FieldError(key, "is out of range, got " + short_repr(value));
  return n;
}

double number_of(const py::handle& value, const std::string& key) {
  const bool may_be_one = PyFloat_Check(value.ptr()) || PyIndex_Check(value.ptr()) || py::hasattr(value, "__float__");
  const double x = may_be_one ? PyFloat_AsDouble(value.ptr()) : 0.0;
  const bool is_refused = x == -1.0 && PyErr_Occurred() && PyErr_ExceptionMatches(PyExc_TypeError);  // by an array
  if (PyErr_Occurred() && !is_refused) throw py::error_already_set();
  PyErr_Clear();
  if (PyBool_Check(value.ptr()) || !may_be_one || is_refused)
    throw py::type_error(key + " must be a number, got " + short_repr(value));
  return x;
}

std::string text_of(const py::handle& value, const std::string& key) {
  if (!py::isinstance<py::str>(value)) throw py::type_error(key + " must be a text, got " + short_repr(value));
  return value.cast<std::string>();
}

Parameters parameters_of(const py::object& argument) {
  if (argument.is_none()) return {};
  if (py::isinstance<ParametersObject>(argument)) return *argument.cast<const ParametersObject&>().value;
  if (const auto values = dict_of(argument)) return from_dict(*values);
  throw py::type_error("parameters must be agrisee.Parameters or a dict, got " + short_repr(argument));
}

void bind_parameters(py::module_& m) {
  py::class_<ParametersObject> parameters(m, "Parameters",
                                          "The parameters of all stages; docs/parameters.md explains each. Metres, "
                                          "radians.\n\nA value out of range raises ParameterError, which names the "
                                          "whole key.");
  bind_fields(m, parameters, "");
  bind_access(parameters);
  parameters
      .def(py::init([](const std::string& preset, const py::kwargs& values) {
             Parameters out = Parameters::named(preset);
             set_fields(out, values, "");
             out.check();
             return object_of(std::move(out));
           }),
           py::arg("preset") = "default",
           "The values of a preset (default, paper, see). Keyword arguments replace values: numbers, texts, or dicts "
           "for groups.")
      .def_static(
          "from_dict", [](const py::object& values) { return object_of(from_dict(mapping_of(values, "values"))); },
          py::arg("values"),
          "The values of a nested dict or other mapping; all others are those of values['preset'], or the defaults.")
      .def_static(
          "from_yaml", [](const py::object& source) { return object_of(from_yaml(source)); }, py::arg("source"),
          "Read YAML from a file (given its path) or from a text. Raises FileError for a file, ParameterError for "
          "a text; both name line and key.")
      .def(
          "to_yaml", [](const ParametersObject& self) { return io::parameters_to_yaml(*self.value); },
          "All values as YAML, which `agrisee --params` reads.")
      .def(
          "expect_radii",
          [](ParametersObject& self, double smallest, double largest) { self.value->expect_radii(smallest, largest); },
          py::arg("smallest"), py::arg("largest"),
          "Expect fruit with radii (m) from smallest to largest, and adapt the lengths that depend on them.")
      .def(
          "check", [](const ParametersObject& self) { self.value->check(); },
          "Raise ParameterError for the first value that is out of its range.")
      .def(
          "copy", [](const ParametersObject& self) { return object_of(*self.value); }, "An independent copy.")
      .def("__copy__", [](const ParametersObject& self) { return object_of(*self.value); })
      .def("__deepcopy__", [](const ParametersObject& self, const py::dict&) { return object_of(*self.value); })
      .def("__repr__", &repr)
      .def(py::pickle([](const ParametersObject& self) { return py::dict(value_of(*self.value)); },
                      [](const py::dict& values) { return object_of(from_dict(values)); }));
}

}  // namespace agrisee::python
