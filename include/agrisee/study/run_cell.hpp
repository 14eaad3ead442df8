// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs the cells of the experiment: a simulated scan, judged after every view and at the end. World frame, metres.
/// Cost: the scan, and beside it some 0.3 s a view for judging, which no record counts as computing.
#pragma once

#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/experiment.hpp>
#include <agrisee/study/greedy_planner.hpp>
#include <agrisee/study/joint_path.hpp>
#include <agrisee/study/simulated_scan.hpp>

namespace agrisee::study {

/// A scene, ready for any number of cells: what it looks like, what is true of it, what can be seen of it.
struct Subject {
  std::string name;                                    ///< of the scene
  std::string fingerprint;                             ///< of the scene and whatever else its records depend on
  Workcell workcell;                                   ///< of the scene
  std::shared_ptr<const Truth> truth;                  ///< what evaluation reads
  std::shared_ptr<const Observability> observability;  ///< what the arm can see
};

/// @param name of the scene
/// @param fingerprint of whatever its records depend on
/// @param scene its objects
/// @param workcell of the scene
/// @param known the ground truth where more is known than the meshes tell
/// @param threads the result does not depend on it
/// @throws InputError as make_truth() does
inline Subject make_subject(std::string name, std::string fingerprint, const Scene& scene, const Workcell& workcell,
                            const std::optional<GroundTruth>& known, int threads = 1) {
  Subject s{std::move(name), std::move(fingerprint), workcell, nullptr, nullptr};
  s.truth = std::make_shared<Truth>(make_truth(scene, known, workcell.sensor));
  s.observability =
      std::make_shared<Observability>(observable(s.truth->traced, s.truth->samples, workcell, {}, threads));
  return s;
}

/// Fruit of a scene, and how many of them are made to be behind others.
inline std::pair<int, int> count_fruit(const Truth& truth) {
  std::pair<int, int> count{static_cast<int>(truth.fruits.fruits.size()), 0};
  for (const TrueFruit& f : truth.fruits.fruits) count.second += f.hidden.value_or(false);
  return count;
}

/// What can be seen of a scene at all.
inline SceneRecord judge_scene(const Subject& subject) {
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

namespace detail {

/// Judge labels of a result's cloud without its fruit.
inline StageAlone judge_alone(const Subject& subject, const ScanResult& result, Labels labels, int threads) {
  ScanResult alone;
  alone.cloud = result.cloud;
  alone.labels = std::move(labels);
  const Metrics m = evaluate(*subject.truth, alone, subject.observability->observable, {}, threads);
  return {m.n_det, m.object_precision, m.object_recall, m.miou_surface};
}

/// What either of the paper's stages makes of the clean cloud alone, and what the first leaves to the second.
inline void judge_stages(const Subject& subject, const ScanResult& result, const SplitParameters& parameters,
                         CellRecord& record, int threads) {
  const Cloud& cloud = result.cloud;
  if (cloud.empty()) return;
  const auto stages = stages_for(estimate_spacing(cloud), parameters);
  if (!stages) return;
  Labels regions = grow_regions(cloud, cloud.normals, stages->growing,
                                Grid<float>(cloud, static_cast<float>(stages->growing.radius)));
  record.residual = residual(regions).size();
  record.growing = judge_alone(subject, result, std::move(regions), threads);
  Labels clusters = dbscan(cloud, stages->clustering);
  drop_small(clusters, stages->min_cluster);
  record.clustering = judge_alone(subject, result, std::move(clusters), threads);
}

}  // namespace detail

/// The planner `cell.planner` of a subject: `greedy`, which knows the truth, or none for those that the pipeline makes.
inline std::unique_ptr<plan::Planner> study_planner(const Subject& subject, const std::string& name) {
  if (name != "greedy") return nullptr;
  return std::make_unique<GreedyPlanner>(subject.observability,
                                         std::shared_ptr<const Samples>(subject.truth, &subject.truth->samples),
                                         subject.workcell.scan_volume, subject.workcell.world_T_base.translation());
}

/// Scan a subject and judge the scan.
/// @param subject the scene
/// @param cell what is run
/// @param parameters of the cell's preset; the planner is the cell's
/// @param threads the result does not depend on it
/// @throws ParameterError for an unknown planner or noise; InputError as the scan does
inline CellRecord run_cell(const Subject& subject, const Cell& cell, Parameters parameters, int threads = 1) {
  const Truth& truth = *subject.truth;
  const Flags& observable = subject.observability->observable;
  CellRecord r;
  r.cell = cell;
  std::tie(r.total, r.hidden) = count_fruit(truth);
  if (cell.planner != "greedy") parameters.planner = cell.planner;
  SimulationOptions options;
  options.noise = sensor::parse_noise(cell.noise);
  options.seed = static_cast<std::uint64_t>(cell.trial);
  options.threads = threads;
  options.planner = study_planner(subject, cell.planner);
  options.on_view = [&](const Pipeline& pipeline) {
    ScanResult now = pipeline.result();  // its time counts for nobody
    now.views.clear();                   // what was seen from where is judged at the end alone
    const Metrics m = evaluate(truth, now, observable, {}, threads);
    r.scanned_after.push_back(m.scanned_obs);
    r.recall_after.push_back(m.recall_obs);
    r.true_after.push_back(m.n_true);
  };
  const ScanResult result = scan(subject.workcell, truth.traced, parameters, std::move(options));
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
  r.metrics = evaluate(truth, result, observable, {}, threads);
  detail::judge_stages(subject, result, parameters.split, r, threads);
  for (std::size_t i = 0; i < r.metrics.fruits.size(); ++i) {
    LocatedFruit located;
    located.id = r.metrics.fruits[i].id;
    located.hidden = truth.fruits.fruits[i].hidden.value_or(false);
    for (const Fruit& f : result.fruits) {
      if (f.id != r.metrics.fruits[i].instance) continue;
      located.found_by = f.found_by;
      located.centroid = f.centroid;
      located.centroid_cluster = f.centroid_cluster;
      located.sigma = f.sigma;
    }
    r.fruits.push_back(located);
  }
  return r;
}

}  // namespace agrisee::study
