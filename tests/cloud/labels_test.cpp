// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/labels.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("points are listed by their label, those without one as residual") {
  const Labels labels{0, 2, 0, 4, 2};
  CHECK((indices_by_label(labels) == std::vector<Indices>{{}, {1, 4}, {}, {3}}));
  CHECK(residual(labels) == Indices{0, 2});
  CHECK(indices_by_label({}).empty());
  CHECK(indices_by_label({0, 0}).empty());
  CHECK(residual({}).empty());
  CHECK(residual({1}).empty());
}

TEST_CASE("small labels are dropped, the others keep their order") {
  Labels labels{3, 1, 0, 3, 2, 5, 3, 5};
  CHECK(drop_small(labels, 2) == 2);
  CHECK(labels == Labels{1, 0, 0, 1, 0, 2, 1, 2});
  CHECK(drop_small(labels, 1) == 2);
  CHECK(labels == Labels{1, 0, 0, 1, 0, 2, 1, 2});
  CHECK(drop_small(labels, 4) == 0);
  CHECK(labels == Labels(8, 0));
  Labels none;
  CHECK(drop_small(none, 1) == 0);
  CHECK(none.empty());
}
