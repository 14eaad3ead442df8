// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One cell of the experiment: a scene, a preset, a planner, a noise model and a trial, scanned and judged by
/// everything that the tables show (paper, Experiments; what it lacks beside). World frame, metres, radians, seconds.
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/study/metrics.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace agrisee::study {

/// A name as that of a file: it names no other folder.
inline std::string file_name(std::string name) {
  for (char& c : name)
    if (c == ':' || c == '/' || c == '\\') c = '-';
  return name;
}

/// Which scan. The seed of noise and planner is the trial, so that `agrisee scan --seed TRIAL` repeats it.
struct Cell {
  std::string scene;               ///< name of the scene
  std::string preset = "default";  ///< `default` or `paper`
  std::string planner = "gain";    ///< of the preset, or asked for
  std::string noise = "none";      ///< model of the simulated sensor's noise, as in scan --noise
  int trial = 1;                   ///< from 1

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("scene", p.scene);
    f("preset", p.preset);
    f("planner", p.planner);
    f("noise", p.noise);
    f("trial", p.trial);
  }
  /// Unlike that of any other cell, and fit for a file: scene, preset, planner, noise and trial.
  std::string name() const {
    return file_name(scene + "__" + preset + "__" + planner + "__" + noise + "__" + std::to_string(trial));
  }
};

/// What one of the paper's two stages makes of the clean cloud when it is alone.
struct StageAlone {
  int n_det = 0;                  ///< instances
  double object_precision = 0.0;  ///< as in Metrics
  double object_recall = 0.0;     ///< as in Metrics
  double miou = 0.0;              ///< by surface

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("n_det", p.n_det);
    f("object_precision", p.object_precision);
    f("object_recall", p.object_recall);
    f("miou", p.miou);
  }
};

/// A fruit as it was located, beside its FruitMetrics; fruit that no instance was matched to have no location.
struct LocatedFruit {
  int id = 0;                                                  ///< of the true fruit
  bool hidden = false;                                         ///< made to be behind the others
  std::string found_by;                                        ///< method; empty = not matched
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();          ///< mean of its points, world (m)
  Eigen::Vector3d centroid_cluster = Eigen::Vector3d::Zero();  ///< the same in the cluster frame {R} (m)
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();             ///< standard deviation of its points per world axis (m)

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("id", p.id);
    f("hidden", p.hidden);
    f("found_by", p.found_by);
    f("centroid", p.centroid);
    f("centroid_cluster", p.centroid_cluster);
    f("sigma", p.sigma);
  }
};

/// A cell and its figures.
struct CellRecord {
  Cell cell;                          ///< what was run
  std::string fingerprint;            ///< of scene, parameters and version: a record with another one is out of date
  int total = 0;                      ///< fruit of the scene
  int hidden = 0;                     ///< how many of them are made to be behind others
  std::string stop_reason;            ///< see StopReason
  int views = 0;                      ///< taken
  std::size_t merged = 0;             ///< points of the merged cloud, before SOR
  std::size_t filtered = 0;           ///< points after SOR
  std::size_t residual = 0;           ///< of them left by region growing to DBSCAN
  Timing seconds;                     ///< of computing; `capture` is the simulated sensor's, and not in `total`
  double path = 0.0;                  ///< joint-space path from the start through all views (rad)
  double shortest_path = 0.0;         ///< shortest open path from the start through the same joints (rad)
  double believed_seen = 0.0;         ///< what the planner believes of `metrics.scanned`; 0 where it believes nothing
  double believed_observable = 0.0;   ///< and of `metrics.observable`
  Metrics metrics;                    ///< at the end of the scan
  StageAlone growing;                 ///< region growing alone, on the clean cloud
  StageAlone clustering;              ///< DBSCAN alone, on the clean cloud
  std::vector<LocatedFruit> fruits;   ///< one a true fruit, in the order of `metrics.fruits`
  std::vector<double> scanned_after;  ///< Metrics::scanned_obs, were the scan to end after each view
  std::vector<double> recall_after;   ///< Metrics::recall_obs likewise
  std::vector<int> true_after;        ///< Metrics::n_true likewise

  /// All but `cell`.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("fingerprint", p.fingerprint);
    f("total", p.total);
    f("hidden", p.hidden);
    f("stop_reason", p.stop_reason);
    f("views", p.views);
    f("merged", p.merged);
    f("filtered", p.filtered);
    f("residual", p.residual);
    f("seconds", p.seconds);
    f("path", p.path);
    f("shortest_path", p.shortest_path);
    f("believed_seen", p.believed_seen);
    f("believed_observable", p.believed_observable);
    f("metrics", p.metrics);
    f("fruit_metrics", p.metrics.fruits);
    f("growing", p.growing);
    f("clustering", p.clustering);
    f("fruits", p.fruits);
    f("scanned_after", p.scanned_after);
    f("recall_after", p.recall_after);
    f("true_after", p.true_after);
  }
};

/// What can be seen of a scene at all.
struct SceneRecord {
  std::string scene;               ///< name
  std::string fingerprint;         ///< of scene and version
  int total = 0;                   ///< fruit
  int hidden = 0;                  ///< of them, made to be behind others
  double observable = 0.0;         ///< share of the fruit's surface that the arm can observe
  double observable_least = 0.0;   ///< the same of the fruit of which least can be observed
  double hidden_share_most = 0.0;  ///< largest share of a hidden fruit's surface that is seen from straight in front
  int views_90 = 0;                ///< views of the greedy planner that knows the truth, for 90 %; 0 = never
  int views_95 = 0;                ///< for 95 %
  int views_98 = 0;                ///< for 98 %
  int views_99 = 0;                ///< for 99 %

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("scene", p.scene);
    f("fingerprint", p.fingerprint);
    f("total", p.total);
    f("hidden", p.hidden);
    f("observable", p.observable);
    f("observable_least", p.observable_least);
    f("hidden_share_most", p.hidden_share_most);
    f("views_90", p.views_90);
    f("views_95", p.views_95);
    f("views_98", p.views_98);
    f("views_99", p.views_99);
  }
};

}  // namespace agrisee::study
