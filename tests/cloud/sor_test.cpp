// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sor.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <limits>
#include <map>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

namespace sor_test {

namespace {

/// The paper's equations, word for word.
template <typename S>
Indices brute(const cases::Points<S>& cloud, int k, double alpha, bool sample) {
  std::vector<double> mean_distances;
  Indices of;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_finite(cloud[i])) continue;
    std::vector<S> d;
    for (std::size_t j = 0; j < cloud.size(); ++j)
      if (j != i && is_finite(cloud[j])) d.push_back(std::sqrt(distance_sq<S>(cloud[i], cloud[j])));
    std::sort(d.begin(), d.end());
    d.resize(std::min(d.size(), static_cast<std::size_t>(k)));
    double sum = 0.0;
    for (const S x : d) sum += static_cast<double>(x);
    mean_distances.push_back(d.empty() ? 0.0 : sum / static_cast<double>(d.size()));
    of.push_back(static_cast<Index>(i));
  }
  const auto n = static_cast<double>(of.size());
  double mu = 0.0, variance = 0.0;
  for (const double d : mean_distances) mu += d / n;
  for (const double d : mean_distances) variance += (d - mu) * (d - mu);
  const double sigma = n > 1 ? std::sqrt(variance / (sample ? n - 1 : n)) : 0.0;
  Indices kept;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (mean_distances[i] <= (mu + alpha * sigma) * (1 + 1e-12)) kept.push_back(of[i]);
  return kept;
}

template <typename S>
void check_brute(const std::string& kind) {
  const auto cloud = cases::cloud_of<S>(kind, 150);
  for (const int k : {1, 8, 20, 1000})
    for (const double alpha : {0.5, 2.0})
      for (const bool sample : {false, true}) {
        const SorParameters parameters{k, alpha, sample};
        const Indices expected = brute(cloud, k, alpha, sample);
        CHECK(remove_statistical_outliers(cloud, parameters) == expected);
        CHECK(remove_statistical_outliers(cloud, parameters, KdTree<S>(cloud)) == expected);
        CHECK(remove_statistical_outliers(cloud, parameters, Grid<S>(cloud, S(0.004))) == expected);
      }
}

}  // namespace

TEST_CASE("outlier removal equals the paper's equations") {
  for (const auto& kind : cases::kinds()) {
    INFO(kind);
    check_brute<float>(kind);
    check_brute<double>(kind);
  }
}

TEST_CASE("outlier removal obeys the laws") {
  for (const auto& kind : cases::kinds()) {
    if (!cases::irregular(kind)) continue;
    INFO(kind);
    cases::check_laws(
        cases::cloud_of<double>(kind),
        [](const auto& points, int threads) {
          std::vector<int> kept(points.size(), 0);
          for (const Index i : remove_statistical_outliers(points, {}, threads)) kept[static_cast<std::size_t>(i)] = 1;
          return kept;
        },
        [](const auto& a, const auto& b) { return a == b; });
  }
}

TEST_CASE("outlier removal drops what is astray") {
  auto cloud = cases::cloud_of<float>("spheres");
  for (int i = 0; i < 4; ++i) cloud.push_back({0.2f, 0.5f, 0.4f + 0.05f * static_cast<float>(i)});
  const Indices kept = remove_statistical_outliers(cloud);
  CHECK(kept.size() > 590);
  CHECK(kept.back() < 600);
}

TEST_CASE("outlier removal of next to nothing") {
  using P = cases::Points<float>;
  CHECK(remove_statistical_outliers(P{}).empty());
  CHECK(remove_statistical_outliers(P{{1, 2, 3}}) == Indices{0});
  CHECK(remove_statistical_outliers(P{{1, 2, 3}, {1, 2, 4}}) == Indices{0, 1});
  CHECK(remove_statistical_outliers(P(50, {1, 2, 3})).size() == 50);
  CHECK(remove_statistical_outliers(cases::cloud_of<float>("equal"), {20, 0.0, true}).size() == 600);
  const float nan = std::nanf("");
  CHECK(remove_statistical_outliers(P{{nan, 0, 0}, {1, 2, 3}, {0, nan, 0}}) == Indices{1});
  CHECK(remove_statistical_outliers(P(9, {nan, nan, nan})).empty());
  // A ring: all mean distances are equal but for rounding, and nothing goes even at alpha = 0.
  cases::Points<double> ring;
  for (int i = 0; i < 4; ++i) ring.push_back({std::cos(i * kPi / 2), std::sin(i * kPi / 2), 0});
  CHECK(remove_statistical_outliers(ring, {2, 0.0, false}).size() == 4);
}

TEST_CASE("outlier removal refuses bad parameters by name") {
  const cases::Points<float> cloud(3, {0, 0, 0});
  CHECK(cases::rejects("mean_k", [&] { remove_statistical_outliers(cloud, {0, 2.0, false}); }));
  CHECK(cases::rejects("std_ratio", [&] { remove_statistical_outliers(cloud, {20, -1.0, false}); }));
  CHECK_THROWS_AS(remove_statistical_outliers(cloud, {20, std::nan(""), false}), ParameterError);
  CHECK_THROWS_AS(remove_statistical_outliers(cloud, {}, KdTree(cases::Points<float>(2, {0, 0, 0}))), InputError);
}

TEST_CASE("mean distances to the nearest points of a line, by hand") {
  const cases::Points<double> line{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {7, 0, 0}};
  const std::map<int, std::vector<double>> expected{{0, {0, 0, 0, 0}},
                                                    {1, {1, 1, 2, 4}},
                                                    {2, {2, 1.5, 2.5, 5}},
                                                    {3, {11.0 / 3, 3, 3, 17.0 / 3}},
                                                    {9, {11.0 / 3, 3, 3, 17.0 / 3}}};
  for (const auto& [k, distances] : expected)
    for (const auto& found : {mean_neighbor_distances(line, k), mean_neighbor_distances(line, k, KdTree(line)),
                              mean_neighbor_distances(line, k, Grid<double>(line, 1.0), 2)}) {
      CAPTURE(k);
      REQUIRE(found.size() == 4);
      for (std::size_t i = 0; i < 4; ++i) CHECK(found[i] == Approx(distances[i]).margin(1e-12));
    }
}

TEST_CASE("mean distances on a grid are its edge and its diagonals") {
  cases::Points<double> grid;
  for (int i = 0; i < 125; ++i) grid.emplace_back(i % 5, i / 5 % 5, i / 25);
  for (const auto& found : {mean_neighbor_distances(grid, 6), mean_neighbor_distances(grid, 6, KdTree(grid))}) {
    CHECK(found[62] == Approx(1.0));                            // the middle
    CHECK(found[2 + 10] == Approx((5 + std::sqrt(2.0)) / 6));   // the middle of a face
    CHECK(found[2] == Approx((4 + 2 * std::sqrt(2.0)) / 6));    // of an edge
    CHECK(found[0] == Approx((3 + 3 * std::sqrt(2.0)) / 6));    // a corner, the first point
    CHECK(found[124] == Approx((3 + 3 * std::sqrt(2.0)) / 6));  // the last one
  }
}

TEST_CASE("mean distances of points alone, not finite, equal and far away") {
  const float nan = std::nanf(""), far = 1e30f;
  const auto both = [](const cases::Points<float>& cloud, int k, std::size_t i) {
    const double one = mean_neighbor_distances(cloud, k)[i],
                 other = mean_neighbor_distances(cloud, k, KdTree(cloud))[i];
    CHECK((one == other || (std::isnan(one) && std::isnan(other))));
    return one;
  };
  CHECK(both({{1, 2, 3}}, 5, 0) == 0.0);
  CHECK(std::isnan(both({{nan, 0, 0}, {1, 2, 3}}, 5, 0)));
  CHECK(both({{nan, 0, 0}, {1, 2, 3}}, 5, 1) == 0.0);
  CHECK(both({{1, 2, 3}, {1, 2, 3}, {1, 2, 5}}, 1, 0) == 0.0);
  CHECK(both({{1, 2, 3}, {1, 2, 3}, {1, 2, 5}}, 2, 1) == Approx(1.0));
  CHECK(std::isinf(both({{0, 0, 0}, {far, 0, 0}}, 1, 0)));
}

TEST_CASE("what deviates too much is dropped, by hand") {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const auto kept = [](const std::vector<double>& distances, double alpha, bool sample) {
    return detail::within_deviation(distances, {20, alpha, sample});
  };
  const std::vector<double> four{1, 5, 1, 1};  // mean 2, squares 12
  CHECK(kept(four, 3.0 / std::sqrt(3.0) - 0.01, false) == Indices{0, 2, 3});
  CHECK(kept(four, 3.0 / std::sqrt(3.0) + 0.01, false).size() == 4);
  CHECK(kept(four, 1.49, true) == Indices{0, 2, 3});
  CHECK(kept(four, 1.5, true).size() == 4);
  CHECK(kept({inf, 1, 5, nan, 1, 1}, 1.5, true) == Indices{1, 2, 4, 5});
  CHECK(kept({inf, 1, 5, nan, 1, 1}, 1.49, true) == Indices{1, 4, 5});
  CHECK(kept({inf, nan, inf}, 0.0, false) == Indices{0, 2});
  CHECK(kept({7}, 0.0, true) == Indices{0});
  CHECK(kept({nan}, 1.0, false).empty());
}

}  // namespace sor_test
