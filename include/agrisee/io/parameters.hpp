// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters as YAML and JSON: the same names as in parameters.hpp, nested alike.
#pragma once

#include <agrisee/parameters.hpp>

#include <string>

namespace agrisee::io {

/// Read parameters from a YAML file. Keys that are absent keep the values of `base` or, where the file names one, of
/// its `preset`. The result is checked.
/// @throws FileError that names the file, the key and its line, for a file that cannot be read, an unknown key, a value
/// of the wrong type or out of range
Parameters read_parameters(const std::string& path, const Parameters& base = {});

/// The parameters as YAML, every key written; reading them back gives the same values.
std::string parameters_to_yaml(const Parameters& parameters);

/// The parameters as a JSON object.
std::string parameters_to_json(const Parameters& parameters);

/// Read them back: the same values.
/// @param text as of parameters_to_json
/// @param path the file that the text is from, for the message
/// @throws FileError as read_parameters does
Parameters parameters_from_json(const std::string& text, const std::string& path);

}  // namespace agrisee::io
