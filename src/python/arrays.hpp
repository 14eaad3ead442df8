// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// NumPy arrays as clouds, and vectors of the library as NumPy arrays, both without a copy.
#pragma once

#include <agrisee/core/cloud.hpp>

#include <cstdint>
#include <cstring>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <string>
#include <vector>

namespace agrisee::python {

namespace py = pybind11;

/// An N x 3 array of float32 or float64 of any strides, read where it is.
template <typename S>
struct ArrayPoints {
  const char* data = nullptr;      ///< first coordinate of the first point
  py::ssize_t row = 0;             ///< from a point to the next (bytes); may be negative
  py::ssize_t column = sizeof(S);  ///< from a coordinate to the next (bytes); may be negative
  std::size_t size = 0;            ///< number of points

  /// Row i.
  Vector3<S> operator[](std::size_t i) const {
    const char* p = data + static_cast<py::ssize_t>(i) * row;
    return {load(p), load(p + column), load(p + 2 * column)};
  }

 private:
  static S load(const char* p) {  // packed records need not be aligned
    S value;
    std::memcpy(&value, p, sizeof value);
    return value;
  }
};

/// Points with one normal each.
template <typename S>
struct ArrayCloud {
  ArrayPoints<S> points;   ///< m
  ArrayPoints<S> normals;  ///< unit, or zero if unknown; as many as points
};

/// A value as messages show it: its beginning, if it is long.
std::string short_repr(const py::handle& value);

/// Whether an argument is a masked array of numpy.ma, some of whose items are masked.
bool has_mask(const py::handle& argument);

/// @param name of the argument, for messages
/// @throws InputError for what has_mask
void refuse_mask(const py::handle& argument, const char* name);

/// An argument that has to be an N x 3 array of float32 or float64, as it is. Lists of lists of floats become one.
/// @param name of the argument, for messages
/// @throws pybind11::type_error for other types, InputError for another shape or masked items
py::array array_of_rows(const py::handle& argument, const char* name);

/// The rows, copied to the type of `other` if theirs differs.
py::array of_type(const py::array& rows, const py::array& other);

/// The same for normals of `points`: as many, copied to the type of the points if theirs differs, and scaled to unit
/// length. As in files, those that have no direction (zero, not finite) become zero.
/// @param name of the argument, for messages
/// @throws as above; InputError for another number of rows
py::array normals_of(const py::handle& argument, const py::array& points, const char* name = "normals");

/// Numbers in C order.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An argument as an array of numbers. Texts are none, even if they spell numbers, and neither are truth values.
/// @param name of the argument, for messages
/// @return none if the argument holds no numbers
/// @throws InputError for masked items
std::optional<Numbers> array_of_numbers(const py::handle& argument, const char* name);

/// An argument that has to be a list or an array of whole numbers, of any type that holds such. An empty list is one.
/// @param name of the argument, for messages
/// @throws pybind11::type_error for what holds no whole numbers, InputError for masked items or a number above 2^63 - 1
py::array_t<std::int64_t> array_of_whole_numbers(const py::handle& argument, const char* name);

/// An argument that has to be a list or an array of `count` numbers.
/// @param name of the argument, for messages
/// @throws pybind11::type_error for what holds no numbers, InputError for another count, masked items or numbers that
///   are not finite
std::vector<double> numbers_of(const py::handle& argument, std::size_t count, const char* name);

/// The same as a vector; None is no vector.
/// @throws as numbers_of
template <int N>
std::optional<Eigen::Matrix<double, N, 1>> vector_of(const py::handle& argument, const char* name) {
  if (argument.is_none()) return std::nullopt;
  Eigen::Matrix<double, N, 1> out;
  const std::vector<double> numbers = numbers_of(argument, N, name);
  for (int i = 0; i < N; ++i) out[i] = numbers[static_cast<std::size_t>(i)];
  return out;
}

/// A view of an array that array_of_rows returned, whose items are S.
template <typename S>
ArrayPoints<S> view_of(const py::array& a) {
  return {static_cast<const char*>(a.data()), a.strides(0), a.strides(1), static_cast<std::size_t>(a.shape(0))};
}

/// Whether the items of an array are float32.
inline bool is_float32(const py::array& a) { return a.itemsize() == sizeof(float); }

/// Calls f with the array as ArrayPoints<float> or ArrayPoints<double>.
template <typename F>
auto with_points(const py::array& points, F&& f) {
  return is_float32(points) ? f(view_of<float>(points)) : f(view_of<double>(points));
}

/// The rows as a vector of the library.
template <typename S>
std::vector<Vector3<S>> copied(const ArrayPoints<S>& rows) {
  std::vector<Vector3<S>> out(rows.size);
  for (std::size_t i = 0; i < rows.size; ++i) out[i] = rows[i];
  return out;
}

namespace detail {

template <typename S>
py::array array_on(const std::vector<Vector3<S>>& rows, const py::handle& owner) {
  static_assert(sizeof(Vector3<S>) == 3 * sizeof(S));
  return py::array_t<S>({static_cast<py::ssize_t>(rows.size()), py::ssize_t(3)},
                        reinterpret_cast<const S*>(rows.data()), owner);
}
template <typename T>
py::array array_on(const std::vector<T>& values, const py::handle& owner) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data(), owner);
}

}  // namespace detail

/// A read-only array that shows a vector of `owner`, which it keeps alive: N x 3 for points, else one number an item.
template <typename T>
py::array shown(const std::vector<T>& items, const py::handle& owner) {
  py::array out = detail::array_on(items, owner);
  out.attr("flags").attr("writeable") = false;
  return out;
}

/// An array that owns what it is given.
template <typename T>
py::array owned(std::vector<T>&& items) {
  auto* kept = new std::vector<T>(std::move(items));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return detail::array_on(*kept, owner);
}

}  // namespace agrisee::python

namespace agrisee {

/// Traits of arrays without normals.
template <typename S>
struct CloudTraits<python::ArrayPoints<S>> {
  using Scalar = S;  ///< type of a coordinate
  /// Number of points.
  static std::size_t size(const python::ArrayPoints<S>& c) { return c.size; }
  /// Point i (m).
  static Vector3<S> point(const python::ArrayPoints<S>& c, std::size_t i) { return c[i]; }
};

/// Traits of arrays with normals.
template <typename S>
struct CloudTraits<python::ArrayCloud<S>> {
  using Scalar = S;  ///< type of a coordinate
  /// Number of points.
  static std::size_t size(const python::ArrayCloud<S>& c) { return c.points.size; }
  /// Point i (m).
  static Vector3<S> point(const python::ArrayCloud<S>& c, std::size_t i) { return c.points[i]; }
  /// Unit normal i, or zero if it is not known.
  static Vector3<S> normal(const python::ArrayCloud<S>& c, std::size_t i) { return c.normals[i]; }
};

}  // namespace agrisee
