// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/alike_sizes.hpp>
#include <agrisee/cloud/bodies.hpp>

#include <algorithm>
#include <numeric>
#include <optional>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

/// Fruit of these radii (m), 0.2 m apart.
std::vector<KnownSize> fruit_of(const std::vector<double>& radii) {
  std::vector<KnownSize> known;
  for (std::size_t i = 0; i < radii.size(); ++i)
    known.push_back({Ellipsoid(Sphere{{0.2 * static_cast<double>(i), 0.0, 0.0}, radii[i]}), 1.0});
  return known;
}

/// What the known sizes say of another body of this radius (m).
double says_of(const std::vector<KnownSize>& known, double radius) {
  return alike_log_odds(known, Ellipsoid(Sphere{{0.0, 1.0, 0.0}, radius}), 0.008, 0.060);
}

/// What the known sizes say of each of the fruit themselves.
std::vector<double> says_of_own(const std::vector<KnownSize>& known) {
  std::vector<double> out;
  for (const KnownSize& k : known) out.push_back(alike_log_odds(known, k.body, 0.008, 0.060));
  return out;
}

/// The front of a sphere, as a camera that looks along y sees it.
void add_front(Cloud& cloud, const Eigen::Vector3d& center, double radius, double least, double noise = 0.0) {
  test::add_sphere(
      cloud, {center, radius}, 0.0022, [&](const Eigen::Vector3d& d) { return -d.y() > least; }, noise);
}

}  // namespace

TEST_CASE("sizes that agree speak against another size, and for their own") {
  const auto apples = fruit_of({0.036, 0.033, 0.038, 0.035, 0.037, 0.034, 0.036, 0.032, 0.039, 0.035});
  CHECK(says_of(apples, 0.035) > 0.7);
  CHECK(says_of(apples, 0.012) < -1.3);
  CHECK(says_of(apples, 0.068) < -1.0);
  CHECK(says_of(apples, 0.012) > -1.6);  // that of a kind of its own remains
}

TEST_CASE("without other fruit sizes say nothing") {
  CHECK(says_of({}, 0.03) == 0.0);
  CHECK(says_of_own(fruit_of({0.03})) == std::vector<double>{0.0});
  CHECK(std::abs(says_of(fruit_of({0.03}), 0.012)) < 0.3);  // of one, little
}

TEST_CASE("of mixed sizes none is doubted") {
  const auto truss = says_of_own(fruit_of({0.036, 0.031, 0.027, 0.022, 0.017, 0.013, 0.010}));
  CHECK(*std::min_element(truss.begin(), truss.end()) > -0.15);
  const auto strawberries = says_of_own(fruit_of({0.020, 0.018, 0.016, 0.014, 0.013, 0.011, 0.010}));
  CHECK(*std::min_element(strawberries.begin(), strawberries.end()) > -0.3);
  const auto two_kinds = says_of_own(fruit_of({0.036, 0.034, 0.037, 0.035, 0.013, 0.012, 0.014, 0.012}));
  CHECK(*std::min_element(two_kinds.begin(), two_kinds.end()) > -0.01);
}

TEST_CASE("a doubtful body beside fruit of another size is not believed, beside fruit of mixed sizes it is") {
  const Eigen::Vector3d doubtful(0.3, 0.5, 0.15);
  const auto confidence = [&](const std::vector<double>& radii, double alike) {
    Cloud cloud;
    std::vector<BodyCandidate> candidates{{Ellipsoid(Sphere{doubtful, 0.011}), "test"}};
    for (std::size_t i = 0; i < radii.size(); ++i) {
      const Eigen::Vector3d center(0.12 * static_cast<double>(i), 0.5, 0.0);
      add_front(cloud, center, radii[i], 0.2);
      candidates.push_back({Ellipsoid(Sphere{center, radii[i]}), "test"});
    }
    add_front(cloud, doubtful, 0.011, 0.45, 0.0006);
    const SeenOn single_view = [](const Ellipsoid&) { return 1.0; };
    BodyParameters parameters;
    parameters.alike = alike;
    parameters.min_confidence = 0.95;
    for (const FoundBody& f : find_bodies(cloud, candidates, parameters, {{}, single_view}))
      if ((f.fit.body.center - doubtful).norm() < 0.005) return f.confidence;
    return 0.0;
  };
  const std::vector<double> apples(8, 0.036), truss{0.036, 0.031, 0.027, 0.022, 0.017, 0.014, 0.012, 0.010};
  CHECK(confidence(apples, 0.0) > 0.95);
  CHECK(confidence(apples, 0.7) == 0.0);
  CHECK(confidence(truss, 0.7) > 0.95);
}

TEST_CASE("the other fruit tell the size of one, whatever a few say") {
  const Ellipsoid other(Sphere{{0.0, 1.0, 0.0}, 0.02});
  const auto apples = fruit_of({0.036, 0.033, 0.038, 0.035, 0.037, 0.060, 0.034});
  const auto prior = size_prior(apples, other);
  REQUIRE(prior);
  CHECK(prior->radius == Approx(0.036));
  CHECK(prior->spread == Approx(0.15));  // no size is known better than that
  CHECK_FALSE(size_prior(fruit_of({0.036, 0.035}), other));
  CHECK_FALSE(size_prior(fruit_of({0.04, 0.03, 0.02, 0.014, 0.010}), other));
  const auto three = fruit_of({0.036, 0.035, 0.034});
  CHECK_FALSE(size_prior(three, three.front().body));  // two others
}

TEST_CASE("fruit are fitted with the size of the others, however little their sizes count, unless not at all") {
  Cloud cloud;
  std::vector<BodyCandidate> candidates;
  for (int i = 0; i < 5; ++i) {
    const Sphere apple{{0.12 * i, 0.5, 0.0}, 0.036};
    add_front(cloud, apple.center, apple.radius, 0.2);
    candidates.push_back({Ellipsoid(apple), "test"});
  }
  for (const double alike : {0.0, 0.0005, 1.0}) {
    BodyParameters parameters;
    parameters.alike = alike;
    const auto found = find_bodies(cloud, candidates, parameters);
    REQUIRE(found.size() == 5);
    for (const FoundBody& f : found) {
      CHECK(f.fit.size_prior.has_value() == (alike > 0.0));
      if (alike > 0.0) CHECK(f.fit.size_prior->radius == Approx(0.036).epsilon(0.01));
    }
  }
}

TEST_CASE("a size that is known decides where points leave it open, and only there") {
  const Sphere truth{{0.0, 0.5, 0.0}, 0.036};
  const auto radius = [&](double least, const std::optional<SizePrior>& prior) {
    Cloud cloud;
    add_front(cloud, truth.center, truth.radius, least);
    Indices all(cloud.size());
    std::iota(all.begin(), all.end(), Index{0});
    FitParameters parameters;
    parameters.noise = 0.003;
    const auto fit = fit_ellipsoid(cloud, all, Ellipsoid(truth), parameters, prior);
    REQUIRE(fit);
    return fit->body.mean_radius();
  };
  const SizePrior larger{0.045, 0.05};
  CHECK(radius(0.0, larger) < 0.038);
  CHECK(radius(0.9, larger) > 0.042);
  CHECK(radius(0.9, {}) == Approx(truth.radius).margin(0.001));
}
