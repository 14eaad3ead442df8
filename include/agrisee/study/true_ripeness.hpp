// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The true ripeness of the fruit of a scene, and how well a result agrees with it. Shares are of ripe surface, 0..1;
/// the classes are those of the United States Standards for Grades of Fresh Tomatoes, 7 CFR 51.1860.
#pragma once

#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/result.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/metrics.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee::study {

/// The share in the middle of a class: 0 for green.
double middle_share(RipenessClass ripeness);

/// Draw the ripeness of the fruit of a truss, from the oldest, at the top, to the youngest. A truss is somewhere
/// between green and red; each fruit is on average half a class behind the one above it. Within its class a share is
/// drawn from the inner two thirds, because near a border graders disagree.
/// @param fruits their number  @param rng random numbers
/// @return the share of each
std::vector<double> draw_ripeness(std::size_t fruits, Rng& rng);

/// Set the ripeness of the fruit of a scene by draw_ripeness, truss by truss, with separate random numbers.
/// @param scene, truth with the same fruit in the same order
/// @param trusses the number of fruit of each truss
/// @param seed of the random numbers
void ripen(Scene& scene, GroundTruth& truth, const std::vector<std::size_t>& trusses, std::uint64_t seed);

/// The true ripeness of one fruit, and that of the result.
struct RipenessMetrics {
  int id = 0;                                  ///< of the true fruit
  double real_share = 0.0;                     ///< true ripe share
  RipenessClass real = RipenessClass::green;   ///< true class
  double found_share = 0.0;                    ///< ripe share of the fruit that was found for it
  RipenessClass found = RipenessClass::green;  ///< class of the fruit that was found for it
  double probability = 0.0;                    ///< of that class, according to the result

  /// Number of classes between the true class and the one found.
  int off() const { return std::abs(static_cast<int>(found) - static_cast<int>(real)); }
};

/// Compare the ripeness of the fruit found with the truth.
/// @param truth fruit whose ripeness is not known are left out
/// @param metrics of the result: which fruit was found for which; true detections count
/// @param found the fruit of the result; those without a ripeness are left out
std::vector<RipenessMetrics> judge_ripeness(const GroundTruth& truth, const Metrics& metrics,
                                            const std::vector<Fruit>& found);

/// Summary over several fruit.
struct RipenessSummary {
  int judged = 0;            ///< number of fruit
  double right = 0.0;        ///< share of these with the right class
  double adjacent = 0.0;     ///< share with a class next to the right one
  double share_error = 0.0;  ///< mean magnitude of the error of the share
};

/// Summarize the metrics of several fruit.
RipenessSummary summarize(const std::vector<RipenessMetrics>& fruits);

}  // namespace agrisee::study
