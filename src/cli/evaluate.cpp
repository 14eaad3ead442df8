// SPDX-License-Identifier: BSD-3-Clause
// agrisee evaluate: compares a result with the true surfaces of its scene.
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/limit.hpp>
#include <agrisee/study/true_ripeness.hpp>

#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.hpp"
#include "inputs.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string scene, result;
  double threshold = 0.005;
  int threads = 0;
  bool json = false;
};

ScanResult read_result(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw FileError(folder.string() + ": is not a result folder");
  if (!fs::exists(folder / "cloud.ply") && fs::exists(folder / "scan.json"))
    throw FileError(folder.string() + ": is an unfinished scan; finish it with agrisee scan --resume " +
                    folder.string());
  ScanResult result;
  const io::CloudFile cloud = io::read_cloud(folder / "cloud.ply", io::NonFinite::keep);
  if (cloud.instance.size() != cloud.cloud.size())
    throw FileError((folder / "cloud.ply").string() + ": has no property 'instance'");
  result.cloud = cloud.cloud;
  result.labels = cloud.instance;
  if (fs::exists(folder / "cloud_raw.ply")) result.raw = io::read_cloud(folder / "cloud_raw.ply").cloud;
  if (fs::exists(folder / "views.csv")) result.views = io::read_views(folder / "views.csv");
  result.fruits = io::read_fruits(folder / "fruits.json");
  return result;
}

Json optional(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json to_json(const study::Metrics& m) {
  Json out;
  out["n_real"] = m.n_real;
  out["n_det"] = m.n_det;
  out["ce"] = m.counting_error;
  out["p_obj"] = m.object_precision;
  out["r_obj"] = m.object_recall;
  out["miou_surface"] = m.miou_surface;
  out["miou_point"] = m.miou_point;
  out["precision"] = m.precision;
  out["precision_2mm"] = m.precision_strict;
  out["precision_all"] = m.precision_all;
  out["recall"] = m.recall;
  out["recall_obs"] = m.recall_obs;
  out["scanned"] = m.scanned;
  out["scanned_obs"] = m.scanned_obs;
  out["observable"] = m.observable;
  out["f1"] = m.f1;
  out["fruits"] = Json::array();
  for (const study::FruitMetrics& f : m.fruits) {
    Json fruit;
    fruit["id"] = f.id;
    fruit["instance"] = f.instance;
    fruit["detected"] = f.detected;
    fruit["surface_iou"] = f.surface_iou;
    fruit["point_iou"] = f.point_iou;
    fruit["recall"] = f.recall;
    fruit["recall_obs"] = f.recall_obs;
    fruit["scanned"] = f.scanned;
    fruit["observable"] = f.observable;
    fruit["centroid_error_observable"] = optional(f.centroid_error);
    fruit["centroid_error_seen"] = optional(f.centroid_error_seen);
    fruit["center_error"] = optional(f.center_error);
    fruit["center_error_normalised"] = optional(f.center_error_normalised);
    fruit["radius_error"] = optional(f.radius_error);
    fruit["semi_axis_error"] = optional(f.semi_axis_error);
    fruit["axis_error"] = optional(f.axis_error);
    fruit["completeness_error"] = optional(f.completeness_error);
    out["fruits"].push_back(std::move(fruit));
  }
  return out;
}

/// The figures of the ripeness; null where it is not known in truth, or was not found.
Json ripeness_to_json(const std::vector<study::RipenessMetrics>& fruits) {
  if (fruits.empty()) return nullptr;
  const study::RipenessSummary all = study::summarize(fruits);
  Json out = {{"judged", all.judged},
              {"right", all.right},
              {"adjacent", all.adjacent},
              {"share_error", all.share_error},
              {"fruits", Json::array()}};
  for (const study::RipenessMetrics& f : fruits)
    out["fruits"].push_back({{"id", f.id},
                             {"real", to_string(f.real)},
                             {"found", to_string(f.found)},
                             {"real_share", f.real_share},
                             {"found_share", f.found_share},
                             {"probability", f.probability}});
  return out;
}

void print(const std::vector<study::RipenessMetrics>& fruits) {
  if (fruits.empty()) return;
  const study::RipenessSummary all = study::summarize(fruits);
  std::cout << std::fixed << std::setprecision(1) << "Ripeness of " << all.judged << " fruit: class right for "
            << 100.0 * all.right << " %, the next one for " << 100.0 * all.adjacent << " %, ripe share off by "
            << 100.0 * all.share_error << " % on average\n";
  for (const study::RipenessMetrics& f : fruits)
    if (f.off() > 0)
      std::cout << std::setw(4) << f.id << "  " << to_string(f.real) << " (" << 100.0 * f.real_share << " %) taken for "
                << to_string(f.found) << " (" << 100.0 * f.found_share << " %)\n";
}

void print(const study::Metrics& m) {
  if (m.n_real == 0) {
    std::cout << "Fruit: none in the scene, " << m.n_det << " found\n";
    return;
  }
  std::ostringstream out;
  out << std::fixed << std::setprecision(1);
  const auto percent = [&](double x) -> std::ostream& { return out << 100.0 * x << " %"; };
  out << "Fruit: " << m.n_real << " real, " << m.n_det << " found, counting error " << m.counting_error
      << ", precision ";
  percent(m.object_precision) << ", recall ";
  percent(m.object_recall) << "\nSurface: scanned ";
  percent(m.scanned) << ", recall ";
  percent(m.recall) << " (of what the arm can observe: ";
  percent(m.recall_obs) << "), precision ";
  percent(m.precision) << " (2 mm: ";
  percent(m.precision_strict) << "), F1 ";
  percent(m.f1) << "\nSegmentation: mIoU by surface ";
  percent(m.miou_surface) << ", by points ";
  percent(m.miou_point) << "\n";
  out << "  id  as    IoU   seen  recall  recall_obs  centroid error  center error  radius error  axis error\n";
  const auto mm = [&](const std::optional<double>& x, int width) {
    out << std::setw(width);
    if (x)
      out << 1e3 * *x << " mm";
    else
      out << "-"
          << "   ";
  };
  for (const study::FruitMetrics& f : m.fruits) {
    out << std::setw(4) << f.id << std::setw(4) << f.instance << std::setprecision(2) << std::setw(7) << f.surface_iou
        << std::setprecision(0) << std::setw(5) << 100.0 * f.scanned << " %" << std::setw(6) << 100.0 * f.recall << " %"
        << std::setw(10) << 100.0 * f.recall_obs << " %" << std::setprecision(1);
    mm(f.centroid_error_seen, 13);
    mm(f.center_error, 11);
    mm(f.radius_error, 11);
    if (f.axis_error)
      out << std::setw(8) << *f.axis_error * 180.0 / kPi << " deg";
    else
      out << std::setw(8) << "-";
    out << "\n";
  }
  std::cout << out.str();
}

/// Says on standard error that a result was made with a scene of another name.
void warn_of_other_scene(const fs::path& result, const std::string& scene) {
  if (!fs::exists(result / "run.json") || !fs::exists(result / "scan.json")) return;
  try {
    const std::string own = io::read_run(result / "run.json").info.scene;
    if (own != scene)
      std::cerr << "agrisee: " << result.string() << " is the result of the scene '" << own << "', compared with '"
                << scene << "'\n";
  } catch (const FileError&) {  // run.json is not needed for anything else
  }
}

int run_evaluate(const EvaluateOptions& options) {
  const std::string scene = scene_file(options.scene);
  const io::SceneFile file = io::read_scene(scene);
  const ScanResult result = read_result(options.result);
  const int threads = threads_of(options.threads);
  warn_of_other_scene(options.result, file.workcell.name);
  const auto known = io::read_ground_truth(fs::path(scene).parent_path() / "ground_truth.json");
  const study::Truth truth = study::make_truth(file.scene, known, file.workcell.sensor);
  const study::Observability observability = study::observable(truth.traced, truth.samples, file.workcell, {}, threads);
  study::MetricParameters parameters;
  parameters.threshold = options.threshold;
  const study::Metrics metrics = study::evaluate(truth, result, observability.observable, parameters, threads);
  const auto ripeness = study::judge_ripeness(truth.fruits, metrics, result.fruits);
  if (options.json) {
    Json out = to_json(metrics);
    if (Json judged = ripeness_to_json(ripeness); !judged.is_null()) out["ripeness"] = std::move(judged);
    std::cout << out.dump(2) << "\n";
  } else {
    print(metrics);
    print(ripeness);
  }
  return kSuccess;
}

}  // namespace

void add_evaluate(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("evaluate", "compare a result with the true scene");
  auto options = std::make_shared<EvaluateOptions>();
  command->add_option("scene", options->scene, "scene file (YAML), or a folder with scene.yaml")->required();
  command->add_option("result", options->result, "result folder")->required();
  command->add_option("--threshold", options->threshold, "a point lies on a surface if it is within this distance (m)")
      ->check(above_zero())
      ->capture_default_str();
  command->add_option("--threads", options->threads, "number of threads (0: one per core); does not change the result")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--json", options->json, "print the metrics as JSON");
  command->footer(
      "Columns of the table: id, the true fruit; as, its number in the result (0: missed); IoU, the overlap of the\n"
      "two surfaces; seen, the share of the true surface near any point (in JSON: scanned), which scan can only\n"
      "estimate; recall, the share of the true surface near points of a fruit; recall_obs, the same share of the\n"
      "surface that the arm can see.\n"
      "docs/formats.md explains all metrics.\n"
      "Example:\n  agrisee evaluate truss/scene.yaml result --json");
  command->callback([options, &run] { run = [options] { return run_evaluate(*options); }; });
}

}  // namespace agrisee::cli
