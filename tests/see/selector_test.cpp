// SPDX-License-Identifier: BSD-3-Clause
// The visibility graph and the selection of a view by hand.
#include <agrisee/see/selector.hpp>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::see;

namespace {

/// A graph of n nodes.
VisibilityGraph graph_of(int n) {
  VisibilityGraph graph;
  for (int i = 0; i < n; ++i) REQUIRE(graph.add() == i);
  return graph;
}

}  // namespace

TEST_CASE("graph: arcs are replaced as a whole, and those to a removed node do not count", "[see]") {
  VisibilityGraph graph = graph_of(4);
  graph.connect(0, {3, 1, 2});
  graph.connect(1, {0});
  CHECK(graph.out_degree(0) == 3);
  CHECK(graph.out_degree(2) == 0);
  CHECK(graph.arc(0, 1));
  CHECK_FALSE(graph.arc(1, 2));
  graph.remove(1);
  CHECK(graph.out_degree(0) == 2);
  CHECK_FALSE(graph.arc(0, 1));
  CHECK_FALSE(graph.arc(1, 0));
  CHECK(graph.add() == 4);  // its number is not used again
  graph.connect(0, {2});
  CHECK(graph.out_degree(0) == 1);
  CHECK_FALSE(graph.arc(0, 3));
}

TEST_CASE("selection: without arcs, or without views", "[see]") {
  CHECK_FALSE(select_view({}, {}));
  CHECK(select_view({{1, 0.3}, {0, 0.2}, {2, 0.2}}, graph_of(3)) == 1u);  // the first of the two nearest
}

TEST_CASE("selection: a view that sees the nearest one's frontier wins with strictly more arcs", "[see]") {
  VisibilityGraph graph = graph_of(5);
  const std::vector<ViewOption> views{{0, 0.1}, {1, 0.2}, {2, 0.4}, {3, 0.15}, {4, 0.12}};
  graph.connect(0, {1, 2});
  graph.connect(1, {0, 2});  // as many as the nearest: does not compete
  CHECK(select_view(views, graph) == 0u);
  graph.connect(2, {0, 1, 3});  // more
  CHECK(select_view(views, graph) == 2u);
  graph.connect(3, {1, 2, 4, 0});  // more per distance
  CHECK(select_view(views, graph) == 3u);
  graph.connect(3, {1, 2, 4});  // it no longer sees the nearest one's frontier; that the nearest saw it would not help
  CHECK(select_view(views, graph) == 2u);
}

TEST_CASE("selection: arcs per distance, with 1 mm added; of equal ones the first", "[see]") {
  VisibilityGraph graph = graph_of(6);
  graph.connect(1, {0, 2});
  graph.connect(2, {0, 1, 3, 4});
  // The nearest has no arcs. 2 / (0.009 + 0.001) is about 4 / (0.019 + 0.001).
  CHECK(select_view({{0, 0.0}, {1, 0.009}, {2, 0.0189}}, graph) == 2u);
  CHECK(select_view({{0, 0.0}, {1, 0.0091}, {2, 0.01905}}, graph) == 2u);
  CHECK(select_view({{0, 0.0}, {1, 0.009}, {2, 0.0191}}, graph) == 1u);
  graph.connect(3, {0, 4});
  CHECK(select_view({{0, 0.0}, {1, 0.009}, {3, 0.009}}, graph) == 1u);
  CHECK(select_view({{0, 0.0}, {3, 0.009}, {1, 0.009}}, graph) == 1u);  // position 1: that of node 3
}
