// SPDX-License-Identifier: BSD-3-Clause
// agrisee make-plant: generates a plant with foliage in the scene format, with its ground truth.
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/plant.hpp>

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "commands.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

struct PlantOptions {
  study::PlantParameters plant;
  std::optional<int> total;    // else as usual for the kind
  std::vector<double> radius;  // of the smallest and the largest fruit in any order, or empty
  std::string output;
  bool force = false, json = false;
};

/// The parameters that the options give; number and size of the fruit are those of the kind unless they are given.
study::PlantParameters parameters_of(const PlantOptions& options) {
  study::PlantParameters parameters = options.plant;
  const study::PlantParameters usual = study::PlantParameters::of(parameters.kind);
  parameters.total = options.total.value_or(usual.total);
  const std::vector<double> radii =
      options.radius.empty() ? std::vector<double>{usual.radius_shoulder, usual.radius_tip} : options.radius;
  std::tie(parameters.radius_tip, parameters.radius_shoulder) = std::minmax(radii[0], radii[1]);
  return parameters;
}

int run_make_plant(const PlantOptions& options) {
  const std::filesystem::path folder = options.output;
  if (!options.force && std::filesystem::exists(folder / "scene.yaml"))
    throw UsageError(options.output + ": already holds a scene; use --force to overwrite it");
  study::Plant plant;
  try {
    const study::PlantParameters parameters = parameters_of(options);
    plant = study::make_plant(parameters);
    plant.workcell.name =
        parameters.kind + "_" + std::to_string(parameters.total) + "_s" + std::to_string(parameters.seed);
  } catch (const ParameterError& e) {  // the values came from the command line
    throw UsageError(e.what());
  }
  make_folder(options.output);
  io::write_ground_truth(folder / "ground_truth.json", plant.truth);
  io::write_scene(folder / "scene.yaml", {plant.workcell, plant.scene, {}});
  if (options.json) {
    nlohmann::ordered_json out;
    out["scene"] = (folder / "scene.yaml").string();
    out["fruits"] = plant.truth.fruits.size();
    out["foliage"] = plant.foliage;
    std::cout << out.dump(2) << "\n";
    return kSuccess;
  }
  std::cout << plant.workcell.name << ": " << plant.truth.fruits.size() << " fruit; leaves hide " << std::fixed
            << std::setprecision(1) << 100.0 * plant.foliage << " % of what shows of them from the front; in "
            << (folder / "scene.yaml").string() << "\n";
  return kSuccess;
}

}  // namespace

void add_make_plant(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("make-plant", "generate a plant with leaves, with its ground truth");
  auto options = std::make_shared<PlantOptions>();
  study::PlantParameters& plant = options->plant;
  const std::vector<std::string> kinds(study::kPlantKinds.begin(), study::kPlantKinds.end());
  command->add_option("--kind", plant.kind, "kind of plant")->check(one_of(kinds))->capture_default_str();
  command->add_option("--total", options->total, "number of fruit, at most 12 per truss (default: usual for the kind)")
      ->check(CLI::Range(1, 24));
  command->add_option("--trusses", plant.trusses, "number of trusses, side by side")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command->add_option("--seed", plant.seed, "seed of the generator; each seed gives another plant")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option("--radius", options->radius,
                   "half width of the smallest,largest fruit, which are the last and the first of a truss (m, from "
                   "0.008 to 0.06; default: usual for the kind)")
      ->delimiter(',')
      ->expected(2);
  command->add_option("--foliage", plant.foliage, "share of the fruit surface, seen from the front, that leaves hide")
      ->check(CLI::Range(0.0, 0.6))
      ->capture_default_str();
  command->add_option("--leaves-behind", plant.leaves_behind, "number of leaves that hide no fruit")
      ->check(CLI::Range(0, 8))
      ->capture_default_str();
  command->add_flag("--trunk", plant.trunk, "put a trunk behind the plant");
  command->add_option("--posts", plant.posts, "number of posts beside the plant")
      ->check(CLI::Range(0, 3))
      ->capture_default_str();
  command->add_option("--wires", plant.wires, "number of wires behind the plant")
      ->check(CLI::Range(0, 4))
      ->capture_default_str();
  command->add_option("--pots", plant.pots, "number of pots below the plant")
      ->check(CLI::Range(0, 2))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "folder for the scene")->required();
  command->add_flag("--force", options->force, "overwrite an existing scene");
  command->add_flag("--json", options->json, "print the summary as JSON");
  command->footer("Example:\n  agrisee make-plant --kind pepper --foliage 0.3 --posts 2 --seed 1 -o plant");
  command->callback([options, &run] { run = [options] { return run_make_plant(*options); }; });
}

}  // namespace agrisee::cli
