// SPDX-License-Identifier: BSD-3-Clause
// Scripts with which a shell completes the words of a command line, made from the command's own list of options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace agrisee::cli {

/// An option, flag or positional word, as a shell completes it.
struct Word {
  std::vector<std::string> names;    ///< "--output", "-o"; empty for a positional word
  std::string text;                  ///< what it is, in a few words
  std::vector<std::string> choices;  ///< its values, where only these are allowed; else file names are completed
  bool takes_value = false;          ///< false for flags
};

/// A command: `agrisee` itself, which has no name here, or a subcommand.
struct CommandWords {
  std::string name, text;
  std::vector<Word> words;
};

/// All commands of an application; the first is the application itself. Options without a description are left out.
std::vector<CommandWords> commands_of(const CLI::App& app);

/// The completion script of a shell. @param shell one of kShells
std::string completion_script(const std::string& shell, const std::vector<CommandWords>& commands);

/// The shells that are known.
constexpr const char* kShells[] = {"bash", "zsh", "fish"};

}  // namespace agrisee::cli
