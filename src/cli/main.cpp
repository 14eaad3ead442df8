// SPDX-License-Identifier: BSD-3-Clause
#include <csignal>
#include <iostream>
#include <new>

#include "commands.hpp"
#include "version.hpp"
#include "words.hpp"

int main(int argc, char** argv) {
  using namespace agrisee;
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit on file sizes then fails with an error, not a signal
  CLI::App app{"AgriSEE: scan a truss with a robot arm, find every fruit, and report where it is."};
  app.set_version_flag("--version", cli::version_text, "print the version and how it was built");
  app.require_subcommand(1);
  const auto complaint = [](const std::string& what) {
    return "agrisee: " + what + "\nRun with --help for more information.\n";
  };
  app.failure_message([&](const CLI::App*, const CLI::Error& e) { return complaint(e.what()); });
  app.footer(
      "Examples:\n"
      "  agrisee make-truss --total 7 --hidden 1 --seed 1 -o truss\n"
      "  agrisee scan truss/scene.yaml -o result --noise l515 --seed 1\n"
      "  agrisee evaluate truss/scene.yaml result\n"
      "  agrisee limit truss/scene.yaml -o limit --base-search\n"
      "  agrisee process cloud_raw.ply -o result --views views.csv\n"
      "  agrisee process recorded/views.yaml -o result\n"
      "Exit codes: 0 success; 1 bad command line, whatever the inputs contain; 2 bad input: it is missing or damaged,\n"
      "or contradicts --viewpoint or itself; 3 a scan failed midway, or could not take any view.");
  cli::Run run;
  cli::add_scan(app, run);
  cli::add_process(app, run);
  cli::add_make_truss(app, run);
  cli::add_make_plant(app, run);
  cli::add_evaluate(app, run);
  cli::add_paper_scenes(app, run);
  cli::add_experiment(app, run);
  cli::add_limit(app, run);
  cli::add_faults(app, run);
  cli::add_merge(app, run);
  cli::add_season(app, run);
  cli::add_export_views(app, run);
  cli::add_parameters(app, run);
  cli::add_doctor(app, run);
  cli::add_completion(app, run);
  cli::add_manual(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0)
      if (const auto message = cli::wrong_word(app, {argv + 1, argv + argc})) {
        std::cerr << complaint(*message);
        return cli::kUsage;
      }
    return app.exit(e) == 0 ? cli::kSuccess : cli::kUsage;
  }
  try {
    return run();
  } catch (const cli::UsageError& e) {
    std::cerr << "agrisee: " << e.what() << "\n";
    return cli::kUsage;
  } catch (const cli::ScanFailed& e) {
    std::cerr << "agrisee: " << e.what() << "\n";
    return cli::kScanFailed;
  } catch (const std::bad_alloc&) {
    std::cerr
        << "agrisee: the memory does not suffice: is something in millimetres, and so a thousand times too large?\n";
    return cli::kBadInput;
  } catch (const std::exception& e) {
    std::cerr << "agrisee: " << cli::message_of(e) << "\n";
    return cli::kBadInput;
  }
}
