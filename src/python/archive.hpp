// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Results, views and workcells as bytes, for pickling. They read back to exactly the same values, by the same version
/// on a machine of the same byte order.
#pragma once

#include <pybind11/pybind11.h>
#include <string>

namespace agrisee::python {

/// Everything of a value as bytes. Defined for the structs in archive.cpp.
template <typename T>
std::string to_bytes(const T& value);

/// The value that to_bytes returned.
/// @throws InputError for bytes of another version, or such as are no value of that type
template <typename T>
T from_bytes(const std::string& bytes);

/// Lets objects of a class be pickled and copied, as bytes.
template <typename T, typename... Options>
void bind_pickle(pybind11::class_<T, Options...>& c) {
  c.def(pybind11::pickle([](const T& value) { return pybind11::bytes(to_bytes(value)); },
                         [](const pybind11::bytes& bytes) { return from_bytes<T>(bytes); }));
}

}  // namespace agrisee::python
