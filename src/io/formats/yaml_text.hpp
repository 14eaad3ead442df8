// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes texts and lists of numbers as YAML.
#pragma once

#include <agrisee/core/error.hpp>

#include <Eigen/Core>

#include <cmath>
#include <string>

#include "io/formats/text.hpp"

namespace agrisee::io {

/// A text as a YAML scalar in double quotes.
std::string yaml_quoted(const std::string& text);

/// The numbers of an Eigen vector as "[1, 2, 3]", which reads back to the same. @throws InputError if one is not finite
template <typename V>
std::string yaml_list(const V& values) {
  std::string out = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    check_input(std::isfinite(values[i]), "a value that is to be written as YAML is not finite");
    out += (i ? ", " : "") + format(static_cast<double>(values[i]));
  }
  return out + "]";
}

}  // namespace agrisee::io
