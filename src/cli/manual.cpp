// SPDX-License-Identifier: BSD-3-Clause
// agrisee manual: the page for `man agrisee`, made from the command's own list of options.
#include <agrisee/version.hpp>

#include <iostream>
#include <string>

#include "commands.hpp"

namespace agrisee::cli {
namespace {

/// A text as troff takes it: backslashes, hyphens and a leading dot or quote are letters, not requests.
std::string troff(const std::string& text) {
  std::string out;
  bool begin = true;  // of a line
  for (const char c : text) {
    if (begin && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    begin = c == '\n';
  }
  return out;
}

/// "--output, -o", or the name of a positional word.
std::string names_of(const CLI::Option& option) {
  std::string out;
  const auto add = [&](const std::string& name) { out += (out.empty() ? "" : ", ") + ("\\fB" + troff(name) + "\\fR"); };
  for (const std::string& name : option.get_lnames()) add("--" + name);
  for (const std::string& name : option.get_snames()) add("-" + name);
  return out.empty() ? "\\fI" + troff(option.get_name()) + "\\fR" : out;
}

void write_options(const CLI::App& command, std::ostream& out) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_description().empty()) continue;
    out << ".TP\n" << names_of(*option) << "\n" << troff(option->get_description());
    if (!option->get_default_str().empty()) out << " [" << troff(option->get_default_str()) << "]";
    out << "\n";
  }
}

/// A text whose lines stay as they are.
void write_lines(const std::string& text, std::ostream& out) {
  if (!text.empty()) out << ".PP\n.nf\n" << troff(text) << "\n.fi\n";
}

void write_manual(const CLI::App& app, std::ostream& out) {
  out << ".TH AGRISEE 1 \"\" \"agrisee " << AGRISEE_VERSION << "\" \"User Commands\"\n"
      << ".SH NAME\nagrisee \\- find the fruit of a truss with a robot's depth camera\n"
      << ".SH SYNOPSIS\n.B agrisee\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n"
      << ".SH DESCRIPTION\n"
      << troff(app.get_description()) << "\n"
      << ".SH OPTIONS\n";
  write_options(app, out);
  out << ".SH COMMANDS\n";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    out << ".SS " << troff(command->get_name()) << "\n" << troff(command->get_description()) << "\n";
    write_options(*command, out);
    write_lines(command->get_footer(), out);
  }
  out << ".SH EXAMPLES AND EXIT STATUS\n";
  write_lines(app.get_footer(), out);
}

}  // namespace

void add_manual(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("manual", "print the page for man, in troff");
  command->footer("To read it:\n  agrisee manual | man -l -");
  command->callback([&app, &run] {
    run = [&app] {
      write_manual(app, std::cout);
      return kSuccess;
    };
  });
}

}  // namespace agrisee::cli
