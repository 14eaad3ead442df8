// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters as YAML and JSON, with the names and the nesting of agrisee/parameters.hpp.
#pragma once

#include <agrisee/parameters.hpp>

#include <string>

namespace agrisee::io {

/// Read parameters from a YAML file. Keys that are absent keep the values of `base` or, where the file names a
/// `preset`, the values of that preset. The result is checked.
/// @throws FileError for a file that cannot be read, an unknown key, a value of the wrong type or out of its range; it
/// names file, line and the whole key: "params.yaml:7: 'gain.min_gain' must be zero or more, got -1"
Parameters read_parameters(const std::string& path, const Parameters& base = {});

/// The parameters as YAML, with every key. Reading them back gives the same values.
std::string parameters_to_yaml(const Parameters& parameters);

/// The parameters as a JSON object.
std::string parameters_to_json(const Parameters& parameters);

/// Parameters from a YAML text, as read_parameters reads them from a file.
/// @param text such as parameters_to_yaml returns
/// @param path what messages call the source of the text
/// @throws FileError as read_parameters does
Parameters parameters_from_yaml(const std::string& text, const std::string& path);

/// Parameters from a JSON object.
/// @param text as parameters_to_json returns it
/// @param path the file that the text is from, for messages
/// @throws FileError for a text that is not JSON, else as read_parameters does
Parameters parameters_from_json(const std::string& text, const std::string& path);

}  // namespace agrisee::io
