// SPDX-License-Identifier: BSD-3-Clause
// agrisee parameters: a parameter file with every key, its value and what it is.
#include <agrisee/io/parameters.hpp>
#include <agrisee/version.hpp>

#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string_view>

#include "commands.hpp"
#include "io/formats/text.hpp"
#include "words.hpp"

namespace agrisee::cli {

/// docs/parameters.md, embedded by CMake (cmake/EmbedText.cmake).
extern const std::string_view kParameterDocument;

namespace {

struct ParameterOptions {
  std::string preset = kPresetNames[0];
};

/// What is known of each parameter, by its whole key.
using Notes = std::map<std::string, std::string>;

/// A text of the document without its marks for code.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : io::trimmed(text))
    if (c != '`') out += c;
  return out;
}

/// Unit and meaning of every parameter, from the rows of the document's tables:
/// | `name` | default | paper | unit | what it is | ... |
Notes told_by_document() {
  Notes notes;
  std::istringstream lines{std::string(kParameterDocument)};
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, 3, "| `") != 0) continue;
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(plain(cell));
    if (cells.size() >= 5) notes[cells[0]] = (cells[3].empty() ? "" : cells[3] + "; ") + cells[4];
  }
  return notes;
}

/// Add the range of every field of a struct to what is known of it.
template <typename P>
void add_ranges(const P& parameters, const std::string& prefix, Notes& notes) {
  P::fields(parameters, [&](const char* name, const auto& value, const auto&... rule) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (has_fields<T>) {
      add_ranges(value, prefix + name + ".", notes);
    } else if constexpr (std::is_arithmetic_v<T>) {
      ((notes[prefix + name] += " (" + rule.text() + ")"), ...);
    }
  });
}

int run_parameters(const ParameterOptions& options) {
  const Parameters parameters = Parameters::named(options.preset);
  Notes notes = told_by_document();
  add_ranges(parameters, "", notes);
  std::cout << "# Parameters of agrisee " AGRISEE_VERSION ", preset " << options.preset
            << ". Keep the lines that you change, with the keys above them, and\n"
               "# delete the rest: keys that are left out keep their defaults. Use the file with --params FILE.\n"
               "# What happens when a value is too small or too large: docs/parameters.md\n";
  std::istringstream lines(io::parameters_to_yaml(parameters));
  std::vector<std::string> keys;  // of the maps around a line
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' '), colon = line.find(':');
    keys.resize(indent / 2);
    std::string key;
    for (const std::string& outer : keys) key += outer + ".";
    keys.push_back(line.substr(indent, colon - indent));
    key += keys.back();
    std::cout << line;
    if (const auto note = notes.find(key); colon + 1 < line.size() && note != notes.end())
      std::cout << std::string(line.size() < 32 ? 32 - line.size() : 0, ' ') << "  # " << note->second;
    std::cout << "\n";
  }
  return kSuccess;
}

}  // namespace

void add_parameters(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("parameters", "print a parameter file with every key, its default and meaning");
  auto options = std::make_shared<ParameterOptions>();
  command->add_option("--preset", options->preset, "preset whose values to print")
      ->check(one_of(preset_choices()))
      ->capture_default_str();
  command->footer("Example:\n  agrisee parameters > my.yaml");
  command->callback([options, &run] { run = [options] { return run_parameters(*options); }; });
}

}  // namespace agrisee::cli
