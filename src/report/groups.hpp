// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sorts the records of an experiment into groups (a preset, planner and noise model), rows (a scene) and trials.
#pragma once

#include <agrisee/study/experiment.hpp>

#include <string>
#include <vector>

namespace agrisee::report {

using study::CellRecord;
using study::FruitMetrics;
using study::SceneRecord;

/// The trials of one scene within a group.
struct Row {
  std::string scene;                      ///< name
  int total = 0, hidden = 0;              ///< number of fruit, and of hidden fruit
  std::vector<const CellRecord*> trials;  ///< in the order of their numbers
};

/// All scans with the same preset, planner, noise model and reach.
struct Group {
  std::string preset, planner, noise, reach = "arm";
  std::vector<Row> rows;  ///< sorted by number of fruit, number of hidden fruit, and name

  /// "preset / planner / noise", and whether the camera flies.
  std::string name() const {
    return preset + " / " + planner + " / " + noise + (reach == "free" ? " / free flight" : "");
  }
  /// The number of scans.
  std::size_t scans() const;
};

/// The sorted records of an experiment. The pointers refer to the records of the caller.
struct Data {
  std::vector<Group> groups;               ///< sorted by preset, planner and noise model (mildest first)
  std::vector<const SceneRecord*> scenes;  ///< sorted by number of fruit, number of hidden fruit, and name
  std::string folder;                      ///< name of the folder of the attachments, as part of a URL
};

/// Sort the records. @throws InputError for the records that write_experiment_report rejects
Data arrange(const std::vector<CellRecord>& cells, const std::vector<SceneRecord>& scenes);

/// The groups that a report shows in detail, one per preset: `default` with the noise model l515 and `paper` with
/// gaussian:0.01, each with the planner of the preset. If this group is missing, the one that is most like it.
std::vector<const Group*> main_groups(const Data& data);
/// One group per preset and noise model: that with the planner of the preset (default: gain, paper: see) or, if it is
/// missing, the first one.
std::vector<const Group*> own_planner_groups(const Data& data);
/// The different values of a member of the groups, in the order of the groups.
std::vector<std::string> distinct(const Data& data, std::string Group::*member);
/// The names of the noise models: none, l515, rough, gaussian by its standard deviation, then unknown ones by name.
std::vector<std::string> noises(const Data& data);
/// The noise model under which most combinations of preset and planner were run.
std::string comparison_noise(const Data& data);

}  // namespace agrisee::report
