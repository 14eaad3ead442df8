// SPDX-License-Identifier: BSD-3-Clause
#include "words.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "io/formats/text.hpp"

namespace agrisee::cli {
namespace {

std::string unknown(const std::string& kind, const std::string& word, const std::vector<std::string>& known) {
  return "unknown " + kind + " '" + word + "'" + io::did_you_mean(word, known);
}

/// The options of a command as they are written: "--output", "-o".
std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
    for (const std::string& name : option->get_snames()) out.push_back("-" + name);
  }
  return out;
}

/// Whether a word is written like an option; "-" and negative numbers are not.
bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word != "--" && !std::isdigit(static_cast<unsigned char>(word[1])) &&
         word[1] != '.';
}

/// The first unknown option of a command, as a message.
std::optional<std::string> wrong_option(const CLI::App& command, const std::string& name,
                                        std::vector<std::string>::const_iterator word,
                                        std::vector<std::string>::const_iterator end) {
  const std::vector<std::string> known = options_of(command);
  for (; word != end && *word != "--"; ++word) {
    if (!is_option(*word)) continue;
    const bool is_long = word->compare(0, 2, "--") == 0;
    const std::string option = is_long ? word->substr(0, word->find('=')) : word->substr(0, 2);
    if (std::find(known.begin(), known.end(), option) == known.end())
      return name + ": " + unknown("option", is_long ? option : *word, known);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> wrong_word(const CLI::App& app, const std::vector<std::string>& words) {
  const auto word = std::find_if_not(words.begin(), words.end(), is_option);
  if (word == words.end()) return wrong_option(app, "agrisee", words.begin(), words.end());
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == *word) return wrong_option(*command, *word, word + 1, words.end());
    commands.push_back(command->get_name());
  }
  return unknown("command", *word, commands);
}

CLI::Validator one_of(const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& word : known) list += (list.empty() ? "" : ",") + word;
  return CLI::Validator(
      [known, list](std::string& word) {
        if (std::find(known.begin(), known.end(), word) != known.end()) return std::string();
        return unknown("value", word, known) + " (one of " + list + ")";
      },
      "{" + list + "}", "one of");
}

CLI::Validator not_negative() {
  return CLI::Validator(
      [](std::string& text) {
        if (text.find('-') != std::string::npos) return "must be 0 or more, got " + text;
        errno = 0;
        std::strtoull(text.c_str(), nullptr, 0);
        if (errno == ERANGE)
          return "must be at most " + std::to_string(std::numeric_limits<unsigned long long>::max()) + ", got " + text;
        return std::string();
      },
      ">= 0", "not negative");
}

CLI::Validator above_zero() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0.0;
        if (!CLI::detail::lexical_cast(text, value)) return "must be a number above 0, got " + text;
        return value > 0.0 && std::isfinite(value) ? std::string() : "must be above 0, got " + text;
      },
      "> 0", "above zero");
}

}  // namespace agrisee::cli
