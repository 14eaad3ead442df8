// SPDX-License-Identifier: BSD-3-Clause
#include "completion.hpp"

#include <agrisee/version.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <sstream>

#include "commands.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

/// The first clause of a description, in one line of at most some 70 letters.
std::string first_clause(const std::string& text) {
  constexpr std::size_t kLongest = 70;
  std::string out = text.substr(0, std::min({text.find(';'), text.find(" ("), text.find(": "), text.find('\n')}));
  if (out.size() <= kLongest) return out;
  return out.substr(0, out.rfind(' ', kLongest)) + " ...";
}

/// The values that an option is restricted to: those of one_of, which describes itself as
/// "{a,b,c}".
std::vector<std::string> choices_of(CLI::Option& option) {
  std::vector<std::string> out;
  for (int i = 0;; ++i) try {
      const std::string text = option.get_validator(i)->get_description();
      if (text.size() < 2 || text.front() != '{' || text.back() != '}') continue;
      std::istringstream list(text.substr(1, text.size() - 2));
      for (std::string value; std::getline(list, value, ',');) out.push_back(value);
    } catch (const CLI::OptionNotFound&) {
      return out;
    }
}

std::vector<Word> words_of(const CLI::App& command) {
  std::vector<Word> out;
  for (const CLI::Option* constant : command.get_options()) {
    auto* option = const_cast<CLI::Option*>(constant);  // reading its validators is not const in CLI11
    if (option->get_description().empty()) continue;
    Word word;
    for (const std::string& name : option->get_lnames()) word.names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) word.names.push_back("-" + name);
    word.text = first_clause(option->get_description());
    word.takes_value = option->get_items_expected_max() > 0;
    word.choices = choices_of(*option);
    out.push_back(word);
  }
  return out;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

/// All names of the options of a command.
std::vector<std::string> names_of(const CommandWords& command) {
  std::vector<std::string> out;
  for (const Word& word : command.words) out.insert(out.end(), word.names.begin(), word.names.end());
  return out;
}

std::vector<std::string> subcommands_of(const std::vector<CommandWords>& commands) {
  std::vector<std::string> out;
  for (const CommandWords& command : commands)
    if (!command.name.empty()) out.push_back(command.name);
  return out;
}

/// A text with a backslash before each of some letters.
std::string escaped(const std::string& text, const std::string& letters) {
  std::string out;
  for (const char c : text) {
    if (letters.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

/// A text within single quotes of sh and zsh.
std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

const std::string kOrigin = ", version " AGRISEE_VERSION ": written by `agrisee completion`.\n";

std::string bash_script(const std::vector<CommandWords>& commands) {
  std::ostringstream out;
  out << "# Completion of agrisee for bash" << kOrigin << R"(_agrisee() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command= words= list= i
  COMPREPLY=()
  if [[ $word == '=' ]]; then  # bash takes --name=value for three words
    word=
  elif [[ $before == '=' ]]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} == -* ]] || { command=${COMP_WORDS[i]}; break; }
  done
  case $command/$before in
)";
  for (const CommandWords& command : commands)
    for (const Word& word : command.words) {
      if (!word.takes_value || word.names.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : word.names) patterns.push_back(command.name + "/" + name);
      out << "    " << joined(patterns, "|") << ") ";
      if (word.choices.empty())
        out << "return ;;\n";  // a file, or a number
      else
        out << "words='" << joined(word.choices, " ") << "' ;;\n";
    }
  out << "    *) case $command in\n      '') words='" << joined(subcommands_of(commands), " ") << "' ;;\n";
  for (const CommandWords& command : commands)
    for (const Word& word : command.words)
      if (word.names.empty() && !word.choices.empty())
        out << "      " << command.name << ") words='" << joined(word.choices, " ") << "' ;;\n";
  out << "    esac ;;\n  esac\n  if [[ $word == -* ]]; then\n    case $command in\n";
  for (const CommandWords& command : commands)
    out << "      " << (command.name.empty() ? "''" : command.name) << ") words='" << joined(names_of(command), " ")
        << "' ;;\n";
  out << R"(    esac
  fi
  [[ $word != *,* ]] || list=${word%,*},
  COMPREPLY=($(compgen -P "$list" -W "$words" -- "${word##*,}"))
}
complete -o default -F _agrisee agrisee
)";
  return out.str();
}

/// A value in the syntax of zsh's _arguments: ":value:(a b)" or ":file:_files"; nothing for a flag.
std::string zsh_value(const Word& word) {
  if (!word.takes_value) return "";
  return word.choices.empty() ? ":file:_files" : ":value:(" + joined(word.choices, " ") + ")";
}

std::string zsh_arguments(const CommandWords& command) {
  std::ostringstream out;
  for (const Word& word : command.words) {
    const std::string text = "[" + escaped(word.text, "[]:\\") + "]";
    for (const std::string& name : word.names) {
      const bool is_long = name.compare(0, 2, "--") == 0;
      const std::string others = word.names.size() > 1 ? "(" + joined(word.names, " ") + ")" : "";
      out << " \\\n        "
          << single_quoted(others + name + (word.takes_value && is_long ? "=" : "") + text + zsh_value(word));
    }
    if (word.names.empty()) out << " \\\n        " << single_quoted("*" + zsh_value(word));
  }
  return out.str();
}

std::string zsh_script(const std::vector<CommandWords>& commands) {
  std::ostringstream out;
  out << "#compdef agrisee\n# Completion of agrisee for zsh" << kOrigin << R"(_agrisee() {
  local context state state_descr line
  local -a commands
  typeset -A opt_args
  commands=(
)";
  for (const CommandWords& command : commands)
    if (!command.name.empty())
      out << "    " << single_quoted(command.name + ":" + escaped(command.text, ":\\")) << "\n";
  out << "  )\n  _arguments -C" << zsh_arguments(commands.front())
      << " \\\n        '1:command:->command' '*::argument:->arguments' && return\n"
         "  case $state in\n    command) _describe command commands ;;\n    arguments) case $line[1] in\n";
  for (const CommandWords& command : commands)
    if (!command.name.empty()) out << "      " << command.name << ") _arguments" << zsh_arguments(command) << " ;;\n";
  out << R"(    esac ;;
  esac
}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  _agrisee "$@"  # found in $fpath
else
  compdef _agrisee agrisee
fi
)";
  return out.str();
}

std::string fish_script(const std::vector<CommandWords>& commands) {
  std::ostringstream out;
  out << "# Completion of agrisee for fish" << kOrigin;
  const auto quoted = [](const std::string& text) { return "'" + escaped(text, "'\\") + "'"; };
  for (const CommandWords& command : commands) {
    const std::string where =
        command.name.empty() ? "__fish_use_subcommand" : quoted("__fish_seen_subcommand_from " + command.name);
    if (!command.name.empty())
      out << "complete -c agrisee -n __fish_use_subcommand -f -a " << command.name << " -d " << quoted(command.text)
          << "\n";
    for (const Word& word : command.words) {
      if (word.names.empty() && word.choices.empty()) continue;  // fish completes file names by itself
      out << "complete -c agrisee -n " << where;
      for (const std::string& name : word.names)
        out << (name.compare(0, 2, "--") == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1));
      if (!word.choices.empty())
        out << (word.names.empty() ? " -f" : " -x") << " -a " << quoted(joined(word.choices, " "));
      else if (word.takes_value)
        out << " -r";
      out << " -d " << quoted(word.text) << "\n";
    }
  }
  return out.str();
}

}  // namespace

std::vector<CommandWords> commands_of(const CLI::App& app) {
  std::vector<CommandWords> out{{"", first_clause(app.get_description()), words_of(app)}};
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    out.push_back({command->get_name(), first_clause(command->get_description()), words_of(*command)});
  return out;
}

std::string completion_script(const std::string& shell, const std::vector<CommandWords>& commands) {
  return shell == "bash" ? bash_script(commands) : shell == "zsh" ? zsh_script(commands) : fish_script(commands);
}

void add_completion(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("completion", "print a script that completes words of agrisee in a shell");
  auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(one_of(std::vector<std::string>(std::begin(kShells), std::end(kShells))));
  command->footer(
      "To use it (installed packages have it already):\n"
      "  source <(agrisee completion bash)                                      # in ~/.bashrc\n"
      "  source <(agrisee completion zsh)                                       # in ~/.zshrc, after compinit\n"
      "  agrisee completion fish > ~/.config/fish/completions/agrisee.fish");
  command->callback([shell, &app, &run] {
    run = [shell, &app] {
      std::cout << completion_script(*shell, commands_of(app));
      return kSuccess;
    };
  });
}

}  // namespace agrisee::cli
