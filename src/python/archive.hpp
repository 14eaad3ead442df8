// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Results as bytes, for pickling. They read back to exactly the same values, by the same version on a machine of the
/// same byte order.
#pragma once

#include <agrisee/result.hpp>

#include <string>

namespace agrisee::python {

/// Everything of a result, fruit or view as bytes.
template <typename T>
std::string to_bytes(const T& value);

/// The value that to_bytes returned.
/// @throws InputError for bytes of another version, or such as are no value of that type
template <typename T>
T from_bytes(const std::string& bytes);

}  // namespace agrisee::python
