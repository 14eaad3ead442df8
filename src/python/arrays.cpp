// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <agrisee/core/unit_vector.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace agrisee::python {
namespace {

bool is_float(const py::array& a) {
  return a.dtype().kind() == 'f' && (a.itemsize() == sizeof(float) || a.itemsize() == sizeof(double)) &&
         a.dtype().attr("isnative").cast<bool>();
}

std::string shape_text(const py::array& a) { return py::str(a.attr("shape")).cast<std::string>(); }

/// The rows scaled to unit length, as io reads normals of files; zero where there is no direction.
template <typename S>
std::vector<Vector3<S>> unit_vectors(const ArrayPoints<S>& rows) {
  std::vector<Vector3<S>> out = copied(rows);
  for (Vector3<S>& v : out) make_unit_or_zero(v);
  return out;
}

}  // namespace

std::string short_repr(const py::handle& value) {
  return py::module_::import("reprlib").attr("repr")(value).cast<std::string>();
}

bool has_mask(const py::handle& argument) {
  const py::module_ masked = py::module_::import("numpy.ma");
  return py::isinstance(argument, masked.attr("MaskedArray")) && masked.attr("is_masked")(argument).cast<bool>();
}

void refuse_mask(const py::handle& argument, const char* name) {
  if (has_mask(argument))
    throw InputError(std::string(name) +
                     " has masked items: fill them (its method `filled`), or leave their rows out "
                     "(numpy.ma.compress_rows)");
}

py::array array_of_rows(const py::handle& argument, const char* name) {
  refuse_mask(argument, name);
  py::array a = py::array::ensure(argument);
  const bool is_object = a && a.dtype().kind() == 'O' && !py::isinstance<py::array>(argument);  // None, for instance
  if (!a || is_object) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + " must be an N x 3 array, got " +
                         py::str(py::type::of(argument).attr("__name__")).cast<std::string>());
  }
  if (a.size() == 0 && a.ndim() == 1) return py::array_t<float>(py::array::ShapeContainer{0, 3});  // an empty list
  const bool whole = a.dtype().kind() == 'i' || a.dtype().kind() == 'u';
  if (whole && !py::isinstance<py::array>(argument)) a = a.attr("astype")(py::dtype::of<double>());  // a list of lists
  if (!is_float(a))
    throw py::type_error(std::string(name) + " must be float32 or float64 in the machine's byte order, got " +
                         py::str(a.dtype()).cast<std::string>());
  if (a.ndim() != 2 || a.shape(1) != 3)
    throw InputError(std::string(name) + " must have the shape (N, 3), got " + shape_text(a));
  return a;
}

std::optional<Numbers> array_of_numbers(const py::handle& argument, const char* name) {
  refuse_mask(argument, name);
  const py::array a = py::array::ensure(argument);
  if (a && std::string_view("fiuO").find(a.dtype().kind()) != std::string_view::npos)
    if (Numbers out = Numbers::ensure(a)) return out;
  PyErr_Clear();
  return std::nullopt;
}

py::array_t<std::int64_t> array_of_whole_numbers(const py::handle& argument, const char* name) {
  refuse_mask(argument, name);
  py::array a = py::array::ensure(argument);
  if (a && a.size() == 0 && !py::isinstance<py::array>(argument)) a = py::array(a.attr("astype")("int64"));
  if (!a || (a.dtype().kind() != 'i' && a.dtype().kind() != 'u')) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + " must be an array of whole numbers");
  }
  if (a.dtype().kind() == 'u' && a.itemsize() == sizeof(std::uint64_t) && a.size() > 0) {
    const auto most = a.attr("max")().cast<std::uint64_t>();
    if (most > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      throw InputError(std::string(name) + " are out of range, got " + std::to_string(most));
  }
  return a;
}

std::vector<double> numbers_of(const py::handle& argument, std::size_t count, const char* name) {
  const auto given = array_of_numbers(argument, name);
  const std::string wanted = std::string(name) + " must be " + std::to_string(count) + " numbers, got ";
  if (!given) throw py::type_error(wanted + short_repr(argument));
  const Numbers& a = *given;
  if (a.ndim() != 1 || static_cast<std::size_t>(a.size()) != count) throw InputError(wanted + short_repr(argument));
  const std::vector<double> out(a.data(), a.data() + count);
  for (const double x : out)
    if (!std::isfinite(x)) throw InputError(std::string(name) + " must be finite");
  return out;
}

py::array of_type(const py::array& rows, const py::array& other) {
  return rows.itemsize() == other.itemsize() ? rows : py::array(rows.attr("astype")(other.dtype()));
}

py::array normals_of(const py::handle& argument, const py::array& points, const char* name) {
  const py::array a = array_of_rows(argument, name);
  if (a.shape(0) != points.shape(0))
    throw InputError(std::string(name) + " must have as many rows as points, got " + std::to_string(a.shape(0)) +
                     " for " + std::to_string(points.shape(0)) + " points");
  return with_points(of_type(a, points), [](const auto& rows) { return owned(unit_vectors(rows)); });
}

}  // namespace agrisee::python
