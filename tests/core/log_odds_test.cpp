// SPDX-License-Identifier: BSD-3-Clause
// Log-odds and probabilities are inverse to each other, and never infinite.
#include <agrisee/core/log_odds.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("log-odds: known values, and the way back") {
  CHECK(log_odds(0.5) == 0.0);
  CHECK(log_odds(0.75) == Approx(std::log(3.0)));
  CHECK(log_odds(0.25) == Approx(-std::log(3.0)));
  CHECK(from_log_odds(0.0) == 0.5);
  for (const double p : {0.001, 0.2, 0.5, 0.9, 0.999}) CHECK(from_log_odds(log_odds(p)) == Approx(p));
  CHECK(from_log_odds(1000.0) == 1.0);
  CHECK(from_log_odds(-1000.0) == 0.0);
}

TEST_CASE("log-odds: certainty is limited") {
  CHECK(log_odds(1.0) == Approx(std::log(1e6)).epsilon(1e-6));
  CHECK(log_odds(0.0) == Approx(-log_odds(1.0)));
  CHECK(log_odds(0.99, 0.1) == Approx(std::log(9.0)));
  CHECK(log_odds(0.01, 0.1) == Approx(-std::log(9.0)));
}
