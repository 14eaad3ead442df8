// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/free_flight.hpp>
#include <agrisee/study/greedy_planner.hpp>
#include <agrisee/study/joint_path.hpp>
#include <agrisee/study/run_cell.hpp>
#include <agrisee/study/simulated_scan.hpp>

#include <algorithm>
#include <tuple>
#include <utility>

namespace agrisee::study {
namespace {

/// Number of fruit of a scene, and how many of them are generated to hang behind others.
std::pair<int, int> count_fruit(const Truth& truth) {
  std::pair<int, int> count{static_cast<int>(truth.fruits.fruits.size()), 0};
  for (const TrueFruit& f : truth.fruits.fruits) count.second += f.hidden.value_or(false);
  return count;
}

/// The planner `greedy`, which knows the truth; null for the planners that the pipeline makes.
std::unique_ptr<plan::Planner> study_planner(const Subject& subject, const std::string& name) {
  if (name != "greedy") return nullptr;
  return std::make_unique<GreedyPlanner>(
      subject.observability, std::shared_ptr<const Samples>(subject.truth, &subject.truth->samples),
      subject.workcell.scan_volume, subject.workcell.world_T_base.translation(), subject.workcell.arm.limits);
}

/// Simulate the scan of a cell. The record's figures after each view are filled in.
ScanResult scan_cell(const Subject& subject, const Cell& cell, const Parameters& parameters, JudgedAfterViews judged,
                     int threads, CellRecord& record) {
  SimulationOptions options;
  options.noise = parse_noise(cell.noise);
  options.seed = static_cast<std::uint64_t>(cell.trial);
  options.threads = threads;
  options.planner = study_planner(subject, cell.planner);
  if (cell.reach == "free") options.reach = free_flight();
  if (judged == JudgedAfterViews::scanned) {
    options.on_view = [&](const Pipeline& pipeline) {
      ScanResult now;
      now.raw = pipeline.raw();
      const Metrics m = evaluate(*subject.truth, now, subject.observability->observable, {}, threads);
      record.whole_after.push_back(m.scanned);
      record.scanned_after.push_back(m.scanned_obs);
    };
    return scan(subject.workcell, subject.truth->traced, parameters, std::move(options));
  }
  options.on_view = [&](const Pipeline& pipeline) {
    ScanResult now = pipeline.result();  // a copy: its computing time is not counted
    now.views.clear();                   // what the views saw is judged only at the end
    const Metrics m = evaluate(*subject.truth, now, subject.observability->observable, {}, threads);
    record.whole_after.push_back(m.scanned);
    record.scanned_after.push_back(m.scanned_obs);
    record.recall_after.push_back(m.recall_obs);
    record.true_after.push_back(m.n_true);
  };
  return scan(subject.workcell, subject.truth->traced, parameters, std::move(options));
}

/// Judge labels of a result's cloud, without the result's fruit.
StageAlone judge_alone(const Subject& subject, const ScanResult& result, Labels labels, int threads) {
  ScanResult alone;
  alone.cloud = result.cloud;
  alone.labels = std::move(labels);
  const Metrics m = evaluate(*subject.truth, alone, subject.observability->observable, {}, threads);
  return {m.n_det, m.object_precision, m.object_recall, m.miou_surface};
}

/// What each of the two segmentation stages of [1] makes of the filtered cloud alone, and how many points the first
/// leaves to the second.
void judge_stages(const Subject& subject, const ScanResult& result, const SplitParameters& parameters, int threads,
                  CellRecord& record) {
  const Cloud& cloud = result.cloud;
  if (cloud.empty()) return;
  const auto stages = stages_for(estimate_spacing(cloud), parameters);
  if (!stages) return;
  Labels regions = grow_regions(cloud, cloud.normals, stages->growing,
                                detail::curvatures_for(cloud, stages->growing, threads), threads);
  record.residual = residual(regions).size();
  record.growing = judge_alone(subject, result, std::move(regions), threads);
  Labels clusters = dbscan(cloud, stages->clustering);
  drop_small(clusters, stages->min_cluster);
  record.clustering = judge_alone(subject, result, std::move(clusters), threads);
}

/// Where each true fruit was located; in the order of `metrics.fruits`.
std::vector<LocatedFruit> located_fruits(const Truth& truth, const ScanResult& result, const Metrics& metrics) {
  std::vector<LocatedFruit> out;
  for (std::size_t i = 0; i < metrics.fruits.size(); ++i) {
    LocatedFruit located;
    located.id = metrics.fruits[i].id;
    located.hidden = truth.fruits.fruits[i].hidden.value_or(false);
    for (const Fruit& f : result.fruits) {
      if (f.id != metrics.fruits[i].instance) continue;
      located.found_by = f.found_by;
      located.centroid = f.centroid;
      located.centroid_cluster = f.centroid_cluster;
      located.sigma = f.sigma;
    }
    out.push_back(located);
  }
  return out;
}

}  // namespace

Subject make_subject(std::string name, std::string fingerprint, const Scene& scene, const Workcell& workcell,
                     const std::optional<GroundTruth>& known, int threads) {
  Subject s{std::move(name), std::move(fingerprint), workcell, nullptr, nullptr};
  s.truth = std::make_shared<Truth>(make_truth(scene, known, workcell.sensor));
  s.observability =
      std::make_shared<Observability>(observable(s.truth->traced, s.truth->samples, workcell, {}, threads));
  return s;
}

SceneRecord judge_scene(const Subject& subject) {
  const Truth& truth = *subject.truth;
  const Observability& seen = *subject.observability;
  SceneRecord r;
  r.scene = subject.name;
  r.fingerprint = subject.fingerprint;
  std::tie(r.total, r.hidden) = count_fruit(truth);
  for (const TrueFruit& f : truth.fruits.fruits)
    if (f.hidden.value_or(false) && f.visible_share)
      r.hidden_share_most = std::max(r.hidden_share_most, *f.visible_share);
  if (seen.views.empty()) return r;
  r.observable_least = 1.0;
  for (const TrueFruit& f : truth.fruits.fruits)
    r.observable_least = std::min(r.observable_least, share(truth.samples, seen.observable, f.id));
  r.observable = share(truth.samples, seen.observable);
  const GreedyOrder order = frontal_order(seen, truth.samples, subject.workcell);
  const auto views = [&](double part) { return static_cast<int>(order.views_for(part).value_or(0)); };
  r.views_90 = views(0.90);
  r.views_95 = views(0.95);
  r.views_98 = views(0.98);
  r.views_99 = views(0.99);
  return r;
}

CellRecord run_cell(const Subject& subject, const Cell& cell, Parameters parameters, int threads,
                    JudgedAfterViews judged) {
  if (cell.reach != "arm" && cell.reach != "free")
    throw ParameterError("reach: must be arm or free, got " + cell.reach);
  const Truth& truth = *subject.truth;
  CellRecord r;
  r.cell = cell;
  std::tie(r.total, r.hidden) = count_fruit(truth);
  if (cell.planner != "greedy") parameters.planner = cell.planner;
  const ScanResult result = scan_cell(subject, cell, parameters, judged, threads, r);
  r.stop_reason = to_string(result.stop_reason);
  r.views = static_cast<int>(result.views.size());
  r.merged = result.raw.size();
  r.filtered = result.cloud.size();
  r.seconds = result.seconds;
  r.path = joint_path_length(subject.workcell.start, result.views);
  r.shortest_path = shortest_joint_path(subject.workcell.start, result.views).length;
  if (result.completeness) {
    r.believed_seen = result.completeness->seen;
    r.believed_observable = result.completeness->observable;
  }
  r.metrics = evaluate(truth, result, subject.observability->observable, {}, threads);
  judge_stages(subject, result, parameters.split, threads, r);
  r.fruits = located_fruits(truth, result, r.metrics);
  return r;
}

}  // namespace agrisee::study
