// SPDX-License-Identifier: BSD-3-Clause
// By what bodies compete, and who gets a point.
#include <agrisee/cloud/split.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace competition_test {

TEST_CASE("regions that are too small, or hollow, propose nothing and are counted") {
  const auto counts = [](double radius, float outward) {  // of a ball, where fruit of 30 to 40 mm are expected
    Cloud cloud;
    test::add_sphere(cloud, {{0, 0.5, 0.2}, radius}, radius / 14.0, test::everywhere);
    for (auto& n : cloud.normals) n *= outward;
    SplitParameters p;
    p.bodies.radius_min = 0.030, p.bodies.radius_max = 0.040;
    const Split found = split(cloud, p);
    CHECK(found.regions_found == 1);
    CHECK(found.found.empty());
    return found.bodies;
  };
  CHECK(counts(0.014, 1.0f).too_small == 1);
  CHECK(counts(0.014, 1.0f).inside_out == 0);
  CHECK(counts(0.035, -1.0f).inside_out == 1);
}

TEST_CASE("balls overlap by their radii less their distance") {
  const Ellipsoid a(Sphere{{0, 0, 0}, 0.03});
  CHECK(detail::overlap(a, Ellipsoid(Sphere{{0.04, 0, 0}, 0.02})) == Approx(0.01));
  CHECK(detail::overlap(a, Ellipsoid(Sphere{{0, 0, -0.06}, 0.02})) == Approx(-0.01));
  CHECK(detail::overlap(a, a) == Approx(0.06));
}

TEST_CASE("of equally near bodies a point gets the first") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0.5, 0.2}, 0.035}, 0.01, test::everywhere);
  FoundBody body;
  body.fit.body = Ellipsoid(Sphere{{0, 0.5, 0.2}, 0.035});
  CHECK(assign_to_bodies(cloud, {body, body}) == Labels(cloud.size(), 1));
}

namespace {

const Eigen::Vector3d kCenter(0.0, 0.5, 0.2);
constexpr double kRadius = 0.03;

Ellipsoid ball(const Eigen::Vector3d& center = kCenter, double radius = kRadius) {
  return Ellipsoid(Sphere{center, radius});
}

Eigen::Vector3d aside(double x) { return kCenter + Eigen::Vector3d(x, 0, 0); }

void add_front(Cloud& cloud, const Eigen::Vector3d& center, double least, double noise = 0.0, double radius = kRadius) {
  test::add_sphere(
      cloud, {center, radius}, 0.0022, [least](const Eigen::Vector3d& d) { return -d.y() > least; }, noise);
}

/// What find_bodies says of some candidates, without regard to the sizes of the others.
struct Outcome {
  std::vector<FoundBody> found;
  BodyCounts counts;
};
Outcome compete(const Cloud& cloud, const std::vector<BodyCandidate>& candidates, BodyParameters parameters = {},
                const SeenThrough& through = {}, const SeenOn& on = {}) {
  parameters.alike = 0.0;
  Outcome out;
  out.found = find_bodies(cloud, candidates, parameters, {through, on}, &out.counts);
  return out;
}

const SeenOn kSeen = [](const Ellipsoid&) { return 1.0; };

}  // namespace

TEST_CASE("ellipsoids overlap along the line between their centers") {
  Ellipsoid egg = ball();
  egg.A = Eigen::Vector3d(25.0, 100.0 / 3.0, 50.0).asDiagonal();  // 40, 30 and 20 mm
  CHECK(detail::overlap(egg, ball(aside(0.06))) == Approx(0.01));
  CHECK(detail::overlap(ball(aside(-0.06)), egg) == Approx(0.01));
  CHECK(detail::overlap(egg, ball(kCenter + Eigen::Vector3d(0, 0, 0.06))) == Approx(-0.01));
  CHECK(detail::overlap(egg, egg) == Approx(2.0 * egg.mean_radius()));
}

TEST_CASE("a body has the size of a fruit by both means of its semi-axes") {
  BodyParameters p;
  p.radius_min = 0.02, p.radius_max = 0.04;
  CHECK(detail::plausible(ball(kCenter, 0.0171), p));
  CHECK_FALSE(detail::plausible(ball(kCenter, 0.0169), p));
  CHECK(detail::plausible(ball(kCenter, 0.0459), p));
  CHECK_FALSE(detail::plausible(ball(kCenter, 0.0461), p));
  Ellipsoid oblong = ball();
  oblong.A = Eigen::Vector3d(1 / 0.1, 1 / 0.021, 1 / 0.021).asDiagonal();  // means of 28.5 and 47.3 mm
  CHECK_FALSE(detail::plausible(oblong, p));
  p.radius_max = 0.045;
  CHECK(detail::plausible(oblong, p));
}

TEST_CASE("a body that is found has the coverage and the confidence of its own fit") {
  Cloud cloud;
  add_front(cloud, kCenter, 0.2, 0.0005);
  const Outcome out = compete(cloud, {{ball(aside(0.002)), "test"}});
  REQUIRE(out.found.size() == 1);
  CHECK(out.counts.taken == 1);
  CHECK(out.counts.rejected() == 0);
  const FoundBody& body = out.found[0];
  CHECK((body.fit.body.center - kCenter).norm() < 0.0005);
  CHECK(body.found_by == "test");
  CHECK_FALSE(body.by_mask);
  const BodyParameters p;
  const detail::Verdict v =
      detail::judge(cloud, Grid<float>(cloud, 0.006f), std::vector<char>(cloud.size(), 0), body.fit.body, p, {});
  CHECK(body.coverage == Approx(v.coverage));
  CHECK(body.confidence == Approx(detail::fruit_probability(v, body.fit, p)));
}

TEST_CASE("a body that lost points to a better one is fitted and judged again") {
  // Two balls, one 26 mm aside of the other; the points of each end up to 5 mm inside the other. Where they meet,
  // points of the first lie close enough to the second to pull its first fit, and the first takes points of the second.
  Cloud cloud;
  const Eigen::Vector3d other = aside(0.026);
  test::add_sphere(cloud, {kCenter, kRadius}, 0.002, [](const Eigen::Vector3d& d) { return d.x() < 0.6; });
  test::add_sphere(
      cloud, {other, kRadius}, 0.002, [](const Eigen::Vector3d& d) { return d.x() > -0.5 && d.y() < 0.3; }, 0.0003);
  BodyParameters p;
  p.alike = 0.0;
  p.max_overlap = 10.0;  // as deep as they like
  p.min_confidence = 0.01;
  const Outcome out = compete(cloud, {{ball(), "first"}, {ball(other), "second"}}, p);
  REQUIRE(out.found.size() == 2);
  CHECK(out.found[0].found_by == "first");
  CHECK(out.found[1].found_by == "second");
  CHECK(out.counts.taken == 2);
  const FoundBody& second = out.found[1];
  CHECK((second.fit.body.center - other).norm() < 0.001);
  // The first has the points in it, and those on it within 1.5 times the tolerance whose normals agree loosely.
  const Ellipsoid& first = out.found[0].fit.body;
  const double margin = 1.5 * p.near(first.mean_radius());
  std::vector<char> taken(cloud.size(), 0);
  Indices left;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto foot = first.foot(cloud.points[i].cast<double>());
    const bool agrees = foot.normal.dot(cloud.normals[i].cast<double>()) >= std::cos(1.6 * p.max_angle);
    taken[i] = foot.distance < margin && (foot.distance < -margin || agrees);
    if (!taken[i]) left.push_back(static_cast<Index>(i));
  }
  REQUIRE(left.size() > 200);
  const detail::Verdict v = detail::judge(cloud, Grid<float>(cloud, 0.006f), taken, second.fit.body, p, {});
  CHECK(second.coverage == Approx(v.coverage).epsilon(1e-12));
  CHECK(second.confidence == Approx(detail::fruit_probability(v, second.fit, p)).epsilon(1e-9));
  CHECK(second.fit.inliers <= left.size());
}

TEST_CASE("bodies that go too deep into a better one are counted as overlapping") {
  Cloud cloud;
  test::add_sphere(cloud, {kCenter, kRadius}, 0.002, test::everywhere);
  test::add_sphere(cloud, {aside(0.050), kRadius}, 0.002, [](const Eigen::Vector3d& d) { return d.x() > -0.5; });
  const std::vector<BodyCandidate> both{{ball(), "first"}, {ball(aside(0.050)), "second"}};
  BodyParameters p;
  p.max_overlap = 0.32;  // they overlap by a third of the radius
  Outcome out = compete(cloud, both, p);
  CHECK(out.found.size() == 1);
  CHECK(out.counts.taken == 1);
  CHECK(out.counts.overlapping == 1);
  p.max_overlap = 0.35;
  out = compete(cloud, both, p);
  CHECK(out.found.size() == 2);
  CHECK(out.counts.taken == 2);
  CHECK(out.counts.overlapping == 0);
}

TEST_CASE("candidates that end up at the same place enter once") {
  Cloud cloud;
  add_front(cloud, kCenter, 0.0);
  const Outcome out = compete(cloud, {{ball(), "first"}, {ball(aside(0.001)), "second"}, {ball(), "third"}});
  REQUIRE(out.found.size() == 1);
  CHECK(out.found[0].found_by == "first");
  CHECK(out.counts.taken == 1);
  CHECK(out.counts.rejected() == 0);
}

TEST_CASE("each candidate that is no fruit is counted by what speaks against it") {
  Cloud cloud;
  add_front(cloud, kCenter, 0.2);
  const auto counts = [&](const BodyCandidate& c, const BodyParameters& p = {}, const SeenThrough& through = {}) {
    const Outcome out = compete(cloud, {c}, p, through, kSeen);
    CHECK(out.found.size() == out.counts.taken);
    CHECK(out.counts.taken + out.counts.rejected() == 1);
    return out.counts;
  };
  const BodyCandidate good{ball(), "test"};
  CHECK(counts(good).taken == 1);
  BodyParameters p;
  CHECK(counts({ball(kCenter, 0.84 * p.radius_min), "test"}).too_small == 1);
  CHECK(counts({ball(kCenter, 1.16 * p.radius_max), "test"}).too_large == 1);
  CHECK(counts({ball(aside(0.5)), "test"}).not_fitted == 1);
  CHECK(counts({ball(aside(0.5)), "test", &BodyCounts::too_small}).too_small == 1);  // as its proposal was in doubt
  p.min_coverage = 0.5;                                                              // 40 % were seen
  CHECK(counts(good, p).little_seen == 1);
  CHECK(counts({ball(), "test", &BodyCounts::too_large}, p).too_large == 1);
  p.min_coverage = 0.3;
  CHECK(counts(good, p).taken == 1);
  CHECK(counts(good, p, [](const Ellipsoid&) { return 0.2; }).contradicted == 1);
  p = {};
  p.min_roundness = 1.0;
  CHECK(counts(good, p).too_flat == 1);
  p = {};
  p.radius_min = 0.036, p.radius_max = 0.05;  // its points are on a smaller one
  CHECK(counts({ball(kCenter, 0.031), "test"}, p).too_small == 1);
  p.radius_min = 0.01, p.radius_max = 0.0255;
  CHECK(counts({ball(kCenter, 0.029), "test"}, p).too_large == 1);
}

TEST_CASE("a scrap that the sizes of the fruit speak against is counted") {
  Cloud fruit;
  std::vector<BodyCandidate> candidates;
  const auto front = [](double least) { return [least](const Eigen::Vector3d& d) { return d.z() > least; }; };
  for (int i = 0; i < 6; ++i) {
    const Sphere sphere{{0.12 * i, 0.0, 0.0}, 0.045};
    test::add_sphere(fruit, sphere, 0.002, front(0.0));
    candidates.push_back({Ellipsoid(sphere), "fruit"});
  }
  const Sphere scrap{{0.0, 0.3, 0.0}, 0.010};
  candidates.push_back({Ellipsoid(scrap), "scrap"});
  for (std::uint64_t seed = 0; seed < 40; ++seed) {  // some are doubtful fruit until the sizes are known
    Cloud cloud = fruit;
    test::add_sphere(cloud, scrap, 0.002, front(0.5));
    Rng rng(seed);
    for (std::size_t i = fruit.size(); i < cloud.size(); ++i) {
      const Eigen::Vector3d tilt(rng.normal(), rng.normal(), rng.normal());
      cloud.points[i] += 0.0012f * float(rng.normal()) * cloud.normals[i];
      cloud.normals[i] = (cloud.normals[i] + 0.3f * tilt.cast<float>()).normalized();
    }
    BodyCounts counts;
    find_bodies(cloud, candidates, {}, {}, &counts);
    CHECK(counts.taken + counts.rejected() == 7);
  }
}

TEST_CASE("the body with the largest surface seen wins first") {
  Cloud cloud;
  add_front(cloud, kCenter, 0.5);
  add_front(cloud, aside(0.1), 0.0);
  add_front(cloud, aside(0.2), 0.0, 0.0, 0.04);
  const Outcome out =
      compete(cloud, {{ball(), "little"}, {ball(aside(0.1)), "half"}, {ball(aside(0.2), 0.04), "large"}});
  REQUIRE(out.found.size() == 3);
  CHECK(out.found[0].found_by == "large");
  CHECK(out.found[1].found_by == "half");
  CHECK(out.found[2].found_by == "little");
  CHECK(out.counts.taken == 3);
}

TEST_CASE("a body that leaves out a lobe of the fruit grows over it") {
  // Two caps of a fruit: the upper one belongs to a ball that is a fifth larger.
  Cloud cloud;
  test::add_sphere(cloud, {kCenter, kRadius}, 0.0022, [](const Eigen::Vector3d& d) { return d.z() < 0.0; });
  test::add_sphere(cloud, {kCenter, 1.2 * kRadius}, 0.0022, [](const Eigen::Vector3d& d) { return d.z() > 0.2; });
  const Outcome out = compete(cloud, {{ball(), "lower"}});
  REQUIRE(out.found.size() == 1);
  const Ellipsoid& body = out.found[0].fit.body;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(kCenter - Eigen::Vector3d(0, 0, kRadius)),
                                   Eigen::Vector3d(kCenter + Eigen::Vector3d(0, 0, 1.2 * kRadius))})
    CHECK(std::abs(body.distance(p)) < BodyParameters().near(kRadius));
}

TEST_CASE("bodies are refused without normals and with bad parameters") {
  Cloud cloud;
  add_front(cloud, kCenter, 0.5);
  BodyParameters p;
  p.min_coverage = 0.0;
  CHECK_THROWS_AS(find_bodies(cloud, {}, p), ParameterError);
  cloud.normals.pop_back();
  CHECK_THROWS_AS(find_bodies(cloud, {}), InputError);
}

}  // namespace competition_test
