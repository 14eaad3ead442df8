// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Probabilities as log-odds, in which independent evidence adds up.
#pragma once

#include <algorithm>
#include <cmath>

namespace agrisee {

/// The log-odds log(p / (1 - p)) of a probability.
/// @param p probability, 0 to 1; taken to be no nearer to either than `least`
/// @param least keeps the result finite
inline double log_odds(double p, double least = 1e-6) {
  const double q = std::clamp(p, least, 1.0 - least);
  return std::log(q / (1.0 - q));
}

/// The probability 1 / (1 + exp(-x)) that has the log-odds x.
inline double from_log_odds(double x) { return 1.0 / (1.0 + std::exp(-x)); }

}  // namespace agrisee
