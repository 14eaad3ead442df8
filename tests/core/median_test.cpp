// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/median.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("the median is the middle value, the upper one of two, and 0 without values") {
  std::vector<double> none, one{-3.0}, two{5.0, 1.0}, three{2.0, 9.0, 4.0}, four{7.0, 1.0, 3.0, 5.0};
  CHECK(median(none) == 0.0);
  CHECK(median(one) == -3.0);
  CHECK(median(two) == 5.0);
  CHECK(median(three) == 4.0);
  CHECK(median(four) == 5.0);
}

TEST_CASE("the median is that of the sorted values, and no value is lost") {
  Rng rng(1);
  for (std::size_t n = 1; n < 40; ++n) {
    std::vector<float> values(n);
    for (float& v : values) v = static_cast<float>(rng.below(10));
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    CHECK(median(values) == sorted[n / 2]);
    std::sort(values.begin(), values.end());
    CHECK(values == sorted);
  }
}
