// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The records of the experiment ([1], 4). A cell is one simulated scan: a scene, a preset, a planner, a
/// noise model and a trial. Its record holds everything that the tables show. World frame, metres, radians, seconds.
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/study/metrics.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace agrisee::study {

/// A name turned into a file name: what could separate folders (`:`, `/`, `\`) becomes `-`.
inline std::string file_name(std::string name) {
  for (char& c : name)
    if (c == ':' || c == '/' || c == '\\') c = '-';
  return name;
}

/// Which scan. The trial is the seed of noise and planner, so `agrisee scan --seed TRIAL` repeats it.
struct Cell {
  std::string scene;               ///< name of the scene
  std::string preset = "default";  ///< name of the preset
  std::string planner = "gain";    ///< name of the planner, or `greedy` (greedy_planner.hpp)
  std::string noise = "none";      ///< noise model of the simulated sensor, as for scan --noise
  int trial = 1;                   ///< from 1
  std::string reach = "arm";       ///< who takes the views: `arm`, or `free` for a camera that flies (free_flight.hpp)

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("scene", p.scene);
    f("preset", p.preset);
    f("planner", p.planner);
    f("noise", p.noise);
    f("reach", p.reach);
    f("trial", p.trial);
  }
  /// A file name that no other cell has: scene, preset, planner, noise, `free` unless the arm takes the views, trial.
  std::string name() const {
    const std::string taker = reach == "arm" ? "" : "__" + reach;
    return file_name(scene + "__" + preset + "__" + planner + "__" + noise + taker + "__" + std::to_string(trial));
  }
};

/// What one of the two segmentation stages of [1] makes of the filtered cloud when it runs alone.
struct StageAlone {
  int n_det = 0;                  ///< number of instances found
  double object_precision = 0.0;  ///< see Metrics
  double object_recall = 0.0;     ///< see Metrics
  double miou = 0.0;              ///< Metrics::miou_surface

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("n_det", p.n_det);
    f("object_precision", p.object_precision);
    f("object_recall", p.object_recall);
    f("miou", p.miou);
  }
};

/// Where a true fruit was located. Kept beside its FruitMetrics; zero if no instance was matched to the fruit.
struct LocatedFruit {
  int id = 0;                                                  ///< of the true fruit
  bool hidden = false;                                         ///< generated to hang behind the others
  std::string found_by;                                        ///< method that found the instance; empty = not matched
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();          ///< mean of the instance's points (m, world)
  Eigen::Vector3d centroid_cluster = Eigen::Vector3d::Zero();  ///< the same (m, cluster frame {R})
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();             ///< standard deviation of the points per world axis (m)

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

/// A cell and what came of its scan.
struct CellRecord {
  Cell cell;                          ///< what was run
  std::string fingerprint;            ///< of scene, parameters and version; a record with another one is outdated
  int total = 0;                      ///< number of fruit in the scene
  int hidden = 0;                     ///< how many of them are generated to hang behind others
  std::string stop_reason;            ///< see StopReason
  int views = 0;                      ///< number of views taken
  std::size_t merged = 0;             ///< points of the merged cloud, before outlier removal
  std::size_t filtered = 0;           ///< points after outlier removal
  std::size_t residual = 0;           ///< how many of these region growing leaves to DBSCAN
  Timing seconds;                     ///< computing time per stage
  double path = 0.0;                  ///< length of the joint path from the start through all views (rad)
  double shortest_path = 0.0;         ///< the same of the shortest path, see shortest_joint_path() (rad)
  double believed_seen = 0.0;         ///< the planner's own estimate of `metrics.scanned`; 0 if it has none
  double believed_observable = 0.0;   ///< the same of `metrics.observable`
  Metrics metrics;                    ///< at the end of the scan
  StageAlone growing;                 ///< region growing alone, on the filtered cloud
  StageAlone clustering;              ///< DBSCAN alone, on the filtered cloud
  std::vector<LocatedFruit> fruits;   ///< one per true fruit, in the order of `metrics.fruits`
  std::vector<double> whole_after;    ///< Metrics::scanned if the scan had ended after each view
  std::vector<double> scanned_after;  ///< Metrics::scanned_obs after each view
  std::vector<double> recall_after;   ///< Metrics::recall_obs after each view; empty if only `scanned` was judged
  std::vector<int> true_after;        ///< Metrics::n_true after each view; empty if only `scanned` was judged

  /// f(name, field) for every field except `cell`.
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
    f("whole_after", p.whole_after);
    f("scanned_after", p.scanned_after);
    f("recall_after", p.recall_after);
    f("true_after", p.true_after);
  }
};

/// What can be seen of a scene at all, see limit.hpp.
struct SceneRecord {
  std::string scene;               ///< name of the scene
  std::string fingerprint;         ///< of scene and version; a record with another one is outdated
  int total = 0;                   ///< number of fruit
  int hidden = 0;                  ///< how many of them are generated to hang behind others
  double observable = 0.0;         ///< share of the fruit's surface that the arm can observe
  double observable_least = 0.0;   ///< the same share of the fruit that can be observed least
  double hidden_share_most = 0.0;  ///< largest share of a hidden fruit's surface that is seen from the front
  int views_90 = 0;                ///< greedy views (greedy.hpp) that cover 90 % of what is observable; 0 = none do
  int views_95 = 0;                ///< the same for 95 %
  int views_98 = 0;                ///< the same for 98 %
  int views_99 = 0;                ///< the same for 99 %

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
