// SPDX-License-Identifier: BSD-3-Clause
// agrisee make-truss: generates a truss in the scene format, with its ground truth.
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "trusses.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

struct TrussOptions {
  study::TrussParameters truss;
  std::vector<double> radius;
  std::string output;
  bool force = false, json = false;
};

int run_make_truss(TrussOptions options) {
  if (!options.radius.empty()) {
    options.truss.radius_min = options.radius[0];
    options.truss.radius_max = options.radius[1];
  }
  const std::filesystem::path folder = options.output;
  if (!options.force && std::filesystem::exists(folder / "scene.yaml"))
    throw UsageError(options.output + ": already holds a scene; use --force to overwrite it");
  study::Truss truss = [&] {
    try {
      return study::make_truss(options.truss);
    } catch (const ParameterError& e) {  // the numbers came from the command line
      throw UsageError(e.what());
    }
  }();
  make_folder(options.output);
  truss.workcell.name = "truss_" + std::to_string(options.truss.total) + "_" + std::to_string(options.truss.hidden) +
                        "_s" + std::to_string(options.truss.seed);
  write_truss(folder, truss);
  if (options.json) {
    nlohmann::ordered_json out;
    out["scene"] = (folder / "scene.yaml").string();
    out["fruits"] = truss.truth.fruits.size();
    std::cout << out.dump(2) << "\n";
    return kSuccess;
  }
  std::cout << truss.workcell.name << ": " << truss.truth.fruits.size() << " fruit, " << options.truss.hidden
            << " hidden, in " << (folder / "scene.yaml").string() << "\n";
  return kSuccess;
}

}  // namespace

void add_make_truss(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("make-truss", "generate a truss in the scene format, with its ground truth");
  auto options = std::make_shared<TrussOptions>();
  command->add_option("--total", options->truss.total, "number of fruit")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  command
      ->add_option("--hidden", options->truss.hidden,
                   "number of fruit that hang behind the others, at most half of them")
      ->check(CLI::Range(0, 6))
      ->capture_default_str();
  command->add_option("--seed", options->truss.seed, "seed of the generator; each seed gives another truss")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("--leaflets", options->truss.leaflets, "number of leaflets")
      ->check(CLI::Range(0, 6))
      ->capture_default_str();
  command
      ->add_option("--radius", options->radius,
                   "smallest,largest semi-axis of a fruit, before elongation (m, from 0.005 to 0.06)")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option("--elongation", options->truss.elongation,
                   "factor on the length of the fruit along their growth axis")
      ->check(CLI::Range(0.5, 2.0))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "folder for the scene")->required();
  command->add_flag("--force", options->force, "overwrite an existing scene");
  command->add_flag("--json", options->json, "print the summary as JSON");
  command->footer("Example:\n  agrisee make-truss --total 7 --hidden 1 --seed 1 -o truss");
  command->callback([options, &run] { run = [options] { return run_make_truss(*options); }; });
}

}  // namespace agrisee::cli
