// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <deque>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

namespace {

/// Ester et al.'s algorithm as published: clusters expanded one by one, noise taken back as border.
template <typename S>
Labels textbook(const cases::Points<S>& cloud, S eps, std::size_t min_points) {
  const auto neighbors = [&](std::size_t i) {
    std::vector<std::size_t> out;
    for (std::size_t j = 0; j < cloud.size(); ++j)
      if (is_finite(cloud[i]) && is_finite(cloud[j]) && distance_sq<S>(cloud[j], cloud[i]) <= eps * eps)
        out.push_back(j);
    return out;
  };
  constexpr int kUnvisited = -1;
  Labels labels(cloud.size(), kUnvisited);
  int cluster = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (labels[i] != kUnvisited) continue;
    const auto around = neighbors(i);
    if (around.size() < min_points) {
      labels[i] = 0;
      continue;
    }
    labels[i] = ++cluster;
    std::deque<std::size_t> seeds(around.begin(), around.end());
    while (!seeds.empty()) {
      const std::size_t j = seeds.front();
      seeds.pop_front();
      if (labels[j] == 0) labels[j] = cluster;
      if (labels[j] != kUnvisited) continue;
      labels[j] = cluster;
      const auto next = neighbors(j);
      if (next.size() >= min_points) seeds.insert(seeds.end(), next.begin(), next.end());
    }
  }
  return labels;
}

template <typename S>
void check_textbook(const std::string& kind) {
  const auto cloud = cases::cloud_of<S>(kind);
  for (const double eps : {0.00390625, 0.007, 0.1})  // the first is the spacing of "gridded": ties at eps
    for (const int min_points : {1, 2, 7, 20}) {
      INFO(eps << " " << min_points);
      const Labels expected = textbook<S>(cloud, S(eps), static_cast<std::size_t>(min_points));
      const DbscanParameters parameters{eps, min_points};
      CHECK(dbscan(cloud, parameters) == expected);
      CHECK(dbscan(cloud, parameters, KdTree<S>(cloud)) == expected);
    }
}

}  // namespace

TEST_CASE("DBSCAN equals the textbook algorithm") {
  for (const auto& kind : cases::kinds()) {
    INFO(kind);
    check_textbook<float>(kind);
    check_textbook<double>(kind);
  }
}

TEST_CASE("DBSCAN obeys the laws, border points aside") {
  for (const auto& kind : cases::kinds()) {
    if (!cases::irregular(kind)) continue;
    INFO(kind);
    const auto same = [](const Labels& a, const Labels& b) { return cases::canonical(a) == cases::canonical(b); };
    const auto points = cases::cloud_of<double>(kind);
    // With two points to a core there is no border between clusters: the partition is the same whatever the order.
    cases::check_laws(
        points,
        [](const auto& p, int threads) {
          return dbscan(p, {0.004, 2}, threads);
        },
        same);
    // With more, core points and noise are.
    cases::check_laws(
        points,
        [](const auto& p, int threads) {
          Labels labels = dbscan(p, {0.007, 12}, threads);
          for (int& label : labels) label = label > 0;
          return labels;
        },
        same);
  }
}

TEST_CASE("DBSCAN border points go to the first cluster in index order") {
  // Two rows of four within eps of one another, and a point between that is near the end of each and is core of
  // neither.
  cases::Points<double> cloud{{0.5, 0, 0}};
  for (int i = 0; i < 4; ++i) cloud.push_back({1.5 + 0.1 * i, 0, 0});
  for (int i = 0; i < 4; ++i) cloud.push_back({-0.5 - 0.1 * i, 0, 0});
  CHECK(dbscan(cloud, {1.0, 4}) == Labels{1, 1, 1, 1, 1, 2, 2, 2, 2});
  std::reverse(cloud.begin(), cloud.end());
  CHECK(dbscan(cloud, {1.0, 4}) == Labels{1, 1, 1, 1, 2, 2, 2, 2, 1});
}

TEST_CASE("DBSCAN of next to nothing, and bad parameters") {
  using P = cases::Points<float>;
  CHECK(dbscan(P{}).empty());
  CHECK(dbscan(P{{1, 2, 3}}) == Labels{0});
  CHECK(dbscan(P{{1, 2, 3}}, {0.007, 1}) == Labels{1});
  CHECK(dbscan(P(60, {1, 2, 3})) == Labels(60, 1));
  CHECK(dbscan(P(59, {1, 2, 3})) == Labels(59, 0));
  CHECK(dbscan(P(70, {std::nanf(""), 2, 3})) == Labels(70, 0));
  CHECK(cases::rejects("eps", [&] { dbscan(P{}, {0.0, 60}); }));
  CHECK(cases::rejects("eps", [&] { dbscan(P{}, {-1.0, 60}); }));
  CHECK(cases::rejects("min_points", [&] { dbscan(P{}, {0.007, 0}); }));
  const Grid<float> search(P{}, 1.0f);
  CHECK(cases::rejects("eps", [&] { dbscan(P{}, {0.0, 60}, search); }));
  CHECK(cases::rejects("min_points", [&] { dbscan(P{}, {0.007, 0}, search); }));
  CHECK_THROWS_AS(dbscan(P{}, {}, Grid<float>(P(2, {0, 0, 0}), 1.0f)), InputError);
}
