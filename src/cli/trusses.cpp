// SPDX-License-Identifier: BSD-3-Clause
// agrisee paper-scenes: the eleven trusses of the experiment; and trusses by name.
#include "trusses.hpp"

#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/paper_truss.hpp>

#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>

#include "commands.hpp"

namespace agrisee::cli {
namespace {

std::string truss_name(int total, int hidden) {
  return "truss_" + std::string(total < 10 ? "0" : "") + std::to_string(total) + "_" + std::to_string(hidden);
}

struct PaperScenesOptions {
  std::string output;
  bool force = false, json = false;
};

int run_paper_scenes(const PaperScenesOptions& options) {
  const std::filesystem::path folder = options.output;
  for (const std::string& name : paper_truss_names())
    if (!options.force && std::filesystem::exists(folder / name / "scene.yaml"))
      throw UsageError((folder / name).string() + ": already holds a scene; use --force to overwrite it");
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const std::string& name : paper_truss_names()) {
    const study::Truss truss = *truss_by_name(name);
    make_folder((folder / name).string());
    write_truss(folder / name, truss);
    double most = 0.0;
    int hidden = 0;
    for (const study::TrueFruit& f : truss.truth.fruits)
      if (*f.hidden) most = std::max(most, *f.visible_share), ++hidden;
    const std::string path = (folder / name / "scene.yaml").string();
    if (options.json) {
      out.push_back(
          {{"scene", path}, {"fruits", truss.truth.fruits.size()}, {"hidden", hidden}, {"hidden_share_most", most}});
    } else {
      std::cout << name << ": " << truss.truth.fruits.size() << " fruit, " << hidden << " hidden (at most "
                << std::fixed << std::setprecision(1) << 100.0 * most << " % seen from the front), in " << path
                << std::endl;
    }
  }
  if (options.json) std::cout << out.dump(2) << "\n";
  return kSuccess;
}

}  // namespace

std::vector<std::string> paper_truss_names() {
  std::vector<std::string> names;
  for (const study::PaperTruss& p : study::kPaperTrusses) names.push_back(truss_name(p.total, p.hidden));
  return names;
}

std::optional<study::Truss> truss_by_name(const std::string& name) {
  static const std::regex pattern("(?:truss_)?([0-9]{1,3})_([0-9]{1,3})(?:_s([0-9]{1,18}))?");
  std::smatch part;
  if (!std::regex_match(name, part, pattern)) return std::nullopt;
  const int total = std::stoi(part[1]), hidden = std::stoi(part[2]);
  try {
    study::Truss truss;
    if (part[3].matched) {
      study::TrussParameters parameters;
      parameters.total = total;
      parameters.hidden = hidden;
      parameters.seed = std::stoull(part[3]);
      truss = study::make_truss(parameters);
    } else {
      truss = study::make_paper_truss(total, hidden);
    }
    truss.workcell.name = truss_name(total, hidden) + (part[3].matched ? "_s" + part[3].str() : "");
    return truss;
  } catch (const ParameterError& e) {
    throw UsageError(name + ": " + e.what());
  }
}

void take_scene_name(std::set<std::string>& names, const std::string& name, const std::string& text) {
  if (!names.insert(name).second) throw UsageError(text + ": there are two scenes with the name " + name);
}

void write_truss(const std::filesystem::path& folder, const study::Truss& truss) {
  io::write_ground_truth(folder / "ground_truth.json", truss.truth);
  io::write_scene(folder / "scene.yaml", {truss.workcell, truss.scene, {}});
}

void add_paper_scenes(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("paper-scenes", "generate eleven trusses like those of the paper's experiment");
  auto options = std::make_shared<PaperScenesOptions>();
  command->add_option("-o,--output", options->output, "folder; each truss gets its own folder inside")->required();
  command->add_flag("--force", options->force, "overwrite existing scenes");
  command->add_flag("--json", options->json, "print the summary as JSON");
  command->footer("Example:\n  agrisee paper-scenes -o scenes");
  command->callback([options, &run] { run = [options] { return run_paper_scenes(*options); }; });
}

}  // namespace agrisee::cli
