// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs one cell of the experiment: a simulated scan, judged after every view and at the end. World frame, metres.
/// Cost: the scan, and some 0.3 s per view for judging it, which no record counts as computing time.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/study/experiment.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/scene.hpp>
#include <agrisee/workcell.hpp>

#include <memory>
#include <optional>
#include <string>

namespace agrisee::study {

struct Observability;  // study/limit.hpp
struct Truth;          // study/evaluate.hpp

/// A scene prepared for any number of cells.
struct Subject {
  std::string name;                                    ///< of the scene
  std::string fingerprint;                             ///< of the scene and of all else that its records depend on
  Workcell workcell;                                   ///< of the scene
  std::shared_ptr<const Truth> truth;                  ///< what results are judged by
  std::shared_ptr<const Observability> observability;  ///< what the arm can see
};

/// Prepare a scene.
/// @param name of the scene
/// @param fingerprint of the scene and of all else that its records depend on
/// @param scene its objects
/// @param workcell of the scene
/// @param known the ground truth, if more is known than the meshes tell
/// @param threads number of threads; the result does not depend on it
/// @throws InputError as make_truth() does
Subject make_subject(std::string name, std::string fingerprint, const Scene& scene, const Workcell& workcell,
                     const std::optional<GroundTruth>& known, int threads = 1);

/// What can be seen of a scene at all, and in how few views.
SceneRecord judge_scene(const Subject& subject);

/// What is judged after each view of a scan.
enum class JudgedAfterViews {
  all,      ///< all that a record holds
  scanned,  ///< only `whole_after` and `scanned_after`, which need no segmentation
};

/// Scan a scene and judge the scan.
/// @param subject the scene
/// @param cell what is run
/// @param parameters of the cell's preset; the planner is that of the cell
/// @param threads number of threads; the result does not depend on it
/// @param judged what is judged after each view; at the end all is
/// @return the record, without fingerprint
/// @throws ParameterError for an unknown planner, noise model or reach; InputError as scan() does
CellRecord run_cell(const Subject& subject, const Cell& cell, Parameters parameters, int threads = 1,
                    JudgedAfterViews judged = JudgedAfterViews::all);

}  // namespace agrisee::study
