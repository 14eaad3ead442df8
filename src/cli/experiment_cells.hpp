// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What `agrisee experiment` runs: the scenes, and the cells that its options ask for.
#pragma once

#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/run_cell.hpp>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// The options of the command.
struct ExperimentOptions {
  std::string output, report;
  std::string parameter_file;  ///< value of --params
  std::vector<std::string> presets{"paper", "default"}, planners, noises{"l515"}, groups, scenes;
  bool scanned_only = false;
  int trials = 3, paper_trials = 0, threads = 0, max_views = 0;

  int trials_of(const std::string& preset) const {
    return preset == "paper" && paper_trials > 0 ? paper_trials : trials;
  }
};

/// A scene of the experiment. Its costly part is computed when its first cell runs.
struct SceneJob {
  std::string name;
  std::filesystem::path path;  ///< of scene.yaml
  io::SceneFile file;
  std::string fingerprint;
  std::unique_ptr<std::once_flag> once = std::make_unique<std::once_flag>();
  std::optional<study::Subject> prepared;

  /// The scene, prepared for its cells. May be called by several threads at once.
  const study::Subject& subject() {
    std::call_once(*once, [&] {
      const auto known = io::read_ground_truth(path.parent_path() / "ground_truth.json");
      prepared = study::make_subject(name, fingerprint, file.scene, file.workcell, known);
    });
    return *prepared;
  }
};

/// Open all scenes. Trusses named by their counts are generated again, so that they are those of this version; other
/// scenes are read from their files.
/// @throws FileError, UsageError
std::vector<SceneJob> open_scenes(const ExperimentOptions& options);

/// A scan of the experiment.
struct CellJob {
  study::Cell cell;
  std::size_t scene = 0;  ///< number of its scene
  Parameters parameters;
  std::string fingerprint;     ///< of all that its record depends on
  std::filesystem::path path;  ///< of its record
  std::optional<study::CellRecord> record;
};

/// All cells that the options ask for, without records. @throws UsageError, ParameterError, FileError
std::vector<CellJob> list_cells(const ExperimentOptions& options, const std::vector<SceneJob>& scenes);

}  // namespace agrisee::cli
