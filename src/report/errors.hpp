// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Errors of the located fruit, and how far their centroids repeat from trial to trial.
#pragma once

#include <optional>
#include <vector>

#include "report/groups.hpp"

namespace agrisee::report {

/// Statistics of a set of errors; all empty without errors.
struct Errors {
  std::optional<double> mean, median, worst;
  std::size_t count = 0;  ///< number of errors
};
/// Statistics of these values; those that are not finite are left out.
Errors statistics(std::vector<double> values);
/// Statistics of the magnitude of an error, over all fruit in all trials of a scene.
Errors errors(const Row& row, std::optional<double> FruitMetrics::*error);
/// Statistics of the magnitude of an error, over all fruit in all scans of a group.
Errors errors(const Group& group, std::optional<double> FruitMetrics::*error);

/// One fruit in all trials of a scene.
struct FruitTrials {
  int id = 0;              ///< id of the true fruit
  bool hidden = false;     ///< whether it is a hidden fruit
  std::size_t trials = 0;  ///< number of scans of it
  /// Centroid in the world frame and standard deviation of its points per axis (m): one entry per scan that located the
  /// fruit.
  std::vector<Eigen::Vector3d> world, sigma;

  /// Root mean square distance of the centroids from their mean (m); none if fewer than two scans located the fruit.
  std::optional<double> rmse() const { return study::repeatability(world); }
};
/// The fruit of a scene, by id.
std::vector<FruitTrials> fruit_trials(const Row& row);
/// Statistics of FruitTrials::rmse (m) over the fruit of a scene.
Errors repeatability(const Row& row);
/// Statistics of FruitTrials::rmse (m) over the fruit of all scenes of a group.
Errors repeatability(const Group& group);

/// How many fruit were located; a fruit is counted once per scan.
struct Located {
  std::size_t found = 0, all = 0;
  /// The number of fruit that were not located.
  std::size_t missing() const { return all - found; }
};
/// Fruit located in the trials of a scene.
Located located(const Row& row);
/// Fruit located in the scans of a group.
Located located(const Group& group);

/// The smallest recall of the observable surface (0..1) of any fruit in the trials of a scene.
std::optional<double> least_recall(const Row& row);
/// The smallest recall of the observable surface (0..1) of any fruit in the scans of a group.
std::optional<double> least_recall(const Group& group);

}  // namespace agrisee::report
