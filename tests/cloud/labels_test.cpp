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

TEST_CASE("the first and the last point are listed, too") {
  CHECK((indices_by_label({1, 0, 2, 1}) == std::vector<Indices>{{0, 3}, {2}}));
  CHECK((indices_by_label({2}) == std::vector<Indices>{{}, {0}}));
  CHECK((indices_by_label({-1, 1, -7}) == std::vector<Indices>{{1}}));  // a negative label is none
  CHECK(residual({0, 1, 0}) == Indices{0, 2});
  CHECK(residual({-1, 0}) == Indices{1});
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

TEST_CASE("a label stays with as many points as are wanted, no fewer") {
  Labels labels{1, 2, 2, 3, 3, 3};
  CHECK(drop_small(labels, 3) == 1);
  CHECK(labels == Labels{0, 0, 0, 1, 1, 1});
  labels = {0, 0, 0, 1};
  CHECK(drop_small(labels, 2) == 0);  // points without a label are no label
  CHECK(labels == Labels(4, 0));
  labels = {4, 0, 4};
  CHECK(drop_small(labels, 1) == 1);
  CHECK(labels == Labels{1, 0, 1});
}
