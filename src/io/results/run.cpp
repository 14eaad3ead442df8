// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/ply.hpp>
#include <agrisee/io/results.hpp>

#include <algorithm>

#include "io/formats/json_value.hpp"
#include "io/results/result_texts.hpp"

namespace agrisee::io {
namespace {

constexpr int kFormatVersion = 1;

Json parameters_of(const RunInfo& info) {
  if (info.parameters_json.empty()) return Json::object();
  try {
    return parse_json(info.parameters_json);
  } catch (const nlohmann::json::exception&) {
    throw InputError("write_run: parameters_json is not JSON");
  }
}

}  // namespace

std::string run_text(const ScanResult& result, const RunInfo& info) {
  Json j;
  j["format_version"] = kFormatVersion;
  j["scene"] = info.scene;
  j["version"] = info.version;
  if (!info.time.empty()) j["time"] = info.time;
  j["frame_id"] = info.frame_id;
  j["seed"] = info.seed;
  j["threads"] = info.threads;
  j["noise"] = info.noise;
  if (!info.detector.empty()) j["detector"] = info.detector;
  j["preset"] = info.preset;
  j["planner"] = info.planner;
  j["parameters"] = parameters_of(info);
  j["views"] = result.views.size();
  j["views_discarded"] =
      std::count_if(result.views.begin(), result.views.end(), [](const View& v) { return v.discarded; });
  j["discarded_views"] = Json::array();
  for (std::size_t v = 0; v < result.views.size(); ++v)
    if (result.views[v].discarded)
      j["discarded_views"].push_back({{"view", v}, {"reason", to_string(result.views[v].discard_reason)}});
  j["stop_reason"] = to_string(result.stop_reason);
  if (!result.warnings.empty()) j["warnings"] = result.warnings;
  const auto labelled = std::count_if(result.labels.begin(), result.labels.end(), [](int label) { return label > 0; });
  j["points"]["merged"] = result.raw.size();
  j["points"]["filtered"] = result.cloud.size();
  j["points"]["labelled"] = labelled;
  j["trusses"] = Json::array();
  for (const FoundTruss& truss : result.trusses) {
    const Pose& pose = truss.world_T_truss;
    j["trusses"].push_back({{"id", truss.id},
                            {"fruits", truss.fruits},
                            {"position_world", json_list(pose.translation(), "truss: position_world is not finite")},
                            {"orientation_world",
                             json_list(quaternion(pose.linear()).coeffs(), "truss: orientation_world is not finite")}});
    if (truss.ripeness) j["trusses"].back()["ripeness"] = ripeness_json(*truss.ripeness);
  }
  Json& bodies = j["bodies"];
  BodyCounts::fields(result.bodies, [&](const char* name, std::size_t count) { bodies[name] = count; });
  if (result.fruits.empty()) j["no_fruit"] = why_no_fruit(result);
  if (result.completeness) {
    j["completeness"]["seen"] = result.completeness->seen;
    j["completeness"]["observable"] = result.completeness->observable;
  }
  j["cluster_origin_world"] = json_list(result.cluster_origin, "the origin of the cluster frame is not finite");
  Json& seconds = j["seconds"];
  Timing::fields(result.seconds, [&](const char* stage, double value) {
    check_input(std::isfinite(value), "write_run: a time is not finite");
    seconds[stage] = value;
  });
  return dump(j);
}

void check_result(const ScanResult& result) {
  check_input(result.raw.views.empty() || result.raw.views.size() == result.raw.size(),
              "write_result: not one view per merged point");
  check_input(result.labels.empty() || result.labels.size() == result.cloud.size(),
              "write_result: not one label per point");
  check_input(result.cloud.normals.empty() || result.cloud.normals.size() == result.cloud.size(),
              "write_result: not one normal per point");
}

void write_run(const std::filesystem::path& path, const ScanResult& result, const RunInfo& info) {
  write_file(path, run_text(result, info));
}

void write_result(const std::filesystem::path& folder, const ScanResult& result, const RunInfo& info) {
  check_result(result);
  // Compose everything first: if a value is invalid, nothing is written.
  const std::string views = views_text(result.views), fruits = fruits_text(result.fruits),
                    table = fruits_csv_text(result.fruits), run = run_text(result, info);
  make_folder(folder);
  std::error_code error;
  std::filesystem::remove(folder / "run.json", error);
  write_file(folder / "views.csv", views);
  write_file(folder / "fruits.json", fruits);
  write_file(folder / "fruits.csv", table);
  write_raw_ply(folder / "cloud_raw.ply", result.raw);
  write_ply(folder / "cloud.ply", result.cloud, result.labels);
  make_durable(folder);
  write_file(folder / "run.json", run, Durability::now);
}

RunFile read_run(const std::filesystem::path& path) {
  const Json json = load_json(path);
  const JsonValue top(path, json, "");
  if (top.at("format_version").count() != kFormatVersion)
    top.at("format_version").fail("only version " + std::to_string(kFormatVersion) + " is known");
  RunFile run;
  run.info.scene = top.at("scene").text();
  run.info.version = top.at("version").text();
  if (top.has("time")) run.info.time = top.at("time").text();
  if (top.has("frame_id")) run.info.frame_id = top.at("frame_id").text();
  run.info.seed = top.at("seed").count();
  run.info.threads = static_cast<int>(std::min<std::uint64_t>(top.at("threads").count(), 1 << 20));
  run.info.noise = top.at("noise").text();
  if (top.has("detector")) run.info.detector = top.at("detector").text();
  run.info.preset = top.at("preset").text();
  run.info.planner = top.at("planner").text();
  run.info.parameters_json = top.at("parameters").json().dump();
  run.views = static_cast<std::size_t>(top.at("views").count());
  run.stop_reason = top.at("stop_reason").text();
  const JsonValue points = top.at("points");
  run.merged = static_cast<std::size_t>(points.at("merged").count());
  run.filtered = static_cast<std::size_t>(points.at("filtered").count());
  run.labelled = static_cast<std::size_t>(points.at("labelled").count());
  const JsonValue seconds = top.at("seconds");
  Timing::fields(run.seconds, [&](const char* stage, double& value) { value = seconds.at(stage).number(); });
  return run;
}

}  // namespace agrisee::io
