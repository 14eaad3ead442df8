// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How ripe the fruit of a scene are in truth, and how well a result says so. Shares are those of the surface that has
/// turned, 0..1; their classes are those of the United States Standards for Grades of Fresh Tomatoes, 7 CFR 51.1860.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/core/ripeness.hpp>
#include <agrisee/result.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/metrics.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee::study {

/// The share in the middle of a class: 0 for green.
double middle_share(RipenessClass ripeness);

/// Draw how ripe the fruit of a truss are, from the oldest, at the top, to the youngest. A truss is somewhere between
/// green and red; each fruit is on average half a class behind the one above it. Within its class a share is drawn from
/// the inner two thirds: at a border two graders differ.
/// @param fruits their number  @param rng random numbers
/// @return the share of each
std::vector<double> draw_ripeness(std::size_t fruits, Rng& rng);

/// Give the fruit of a scene the ripeness that draw_ripeness draws, truss by truss, with random numbers of its own.
/// @param scene, truth with the same fruit in the same order
/// @param trusses the number of fruit of each truss
/// @param seed of the random numbers
void ripen(Scene& scene, GroundTruth& truth, const std::vector<std::size_t>& trusses, std::uint64_t seed);

/// How well the ripeness of one fruit was found.
struct RipenessMetrics {
  int id = 0;                                  ///< of the true fruit
  double real_share = 0.0;                     ///< its share
  RipenessClass real = RipenessClass::green;   ///< its class
  double found_share = 0.0;                    ///< of the fruit that was found for it
  RipenessClass found = RipenessClass::green;  ///< the same, its class
  double probability = 0.0;                    ///< what the result gives this class

  /// By how many classes it is off.
  int off() const { return std::abs(static_cast<int>(found) - static_cast<int>(real)); }
};

/// Judge the ripeness of the fruit that were found.
/// @param truth fruit whose ripeness is not known are left out
/// @param metrics of the result: which fruit was found for which; true detections count
/// @param found the fruit of the result; those without a ripeness are left out
std::vector<RipenessMetrics> judge_ripeness(const GroundTruth& truth, const Metrics& metrics,
                                            const std::vector<Fruit>& found);

/// The figures of several fruit.
struct RipenessSummary {
  int judged = 0;            ///< number of fruit
  double right = 0.0;        ///< share of these with the right class
  double adjacent = 0.0;     ///< share with a class next to the right one
  double share_error = 0.0;  ///< mean magnitude of the error of the share
};

/// Sum up the figures of fruit.
RipenessSummary summarize(const std::vector<RipenessMetrics>& fruits);

}  // namespace agrisee::study
