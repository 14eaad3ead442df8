// SPDX-License-Identifier: BSD-3-Clause
// Which word of a command line is wrong, and which one was meant.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// A message about the first word of a command line that names no command or no option of its command, with the nearest
/// word that does: "unknown command 'proces'; did you mean 'process'?". None if all words are known.
/// @param words the command line without the program's name
std::optional<std::string> wrong_word(const CLI::App& app, const std::vector<std::string>& words);

/// For an option whose value is one of some words. For any other, the nearest of them is suggested.
CLI::Validator one_of(const std::vector<std::string>& known);

/// For an option whose value is a whole number, zero or more. (CLI11 takes -1, and what is too large, for the largest
/// number.)
CLI::Validator not_negative();

/// For an option whose value is a finite number above zero.
CLI::Validator above_zero();

}  // namespace agrisee::cli
