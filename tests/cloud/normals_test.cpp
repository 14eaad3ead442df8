// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <Eigen/SVD>

#include "cloud/cloud_cases.hpp"

using namespace agrisee;

namespace {

/// Normal and surface variation by the singular values of the centered neighborhood, sorted out of all points; and the
/// second variance, to know where a normal is defined.
struct Reference {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double curvature = 0.0, gap = 0.0;
};
template <typename S>
Reference reference(const cases::Points<S>& cloud, std::size_t i, S radius, std::size_t k) {
  std::vector<std::pair<S, std::size_t>> near;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const S d_sq = distance_sq<S>(cloud[j], cloud[i]);
    if (is_finite(cloud[i]) && is_finite(cloud[j]) && d_sq <= radius * radius) near.emplace_back(d_sq, j);
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), k));
  Reference out;
  if (near.size() < 3) return out;
  Eigen::Matrix3Xd m(3, static_cast<Eigen::Index>(near.size()));
  for (std::size_t j = 0; j < near.size(); ++j)
    m.col(static_cast<Eigen::Index>(j)) = cloud[near[j].second].template cast<double>();
  m.colwise() -= m.rowwise().mean().eval();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd s = svd.singularValues();
  if (!(s[1] > 1e-4 * s[0])) return out;
  out.normal = svd.matrixU().col(2);
  out.curvature = s[2] * s[2] / s.squaredNorm();
  out.gap = (s[1] - s[2]) / s[0];
  return out;
}

template <typename S>
void check_reference(const std::string& kind) {
  const auto cloud = cases::cloud_of<S>(kind);
  for (const NormalParameters parameters : {NormalParameters{0.006, 25}, {0.012, 9}, {0.1, 10000}}) {
    std::vector<S> curvatures, other;
    const auto normals = estimate_normals(cloud, parameters, 1, &curvatures);
    const auto by_tree = estimate_normals(cloud, parameters, KdTree<S>(cloud), 1, &other);
    REQUIRE(normals.size() == cloud.size());
    const double tolerance = std::is_same<S, float>::value ? 2e-5 : 1e-9;
    for (std::size_t i = 0; i < cloud.size(); i += 7) {
      const Reference r = reference(cloud, i, S(parameters.radius), static_cast<std::size_t>(parameters.max_neighbors));
      INFO(i);
      if (r.normal.isZero()) {
        CHECK(normals[i].isZero(0));
        CHECK(by_tree[i].isZero(0));
        CHECK(curvatures[i] == 0);
        continue;
      }
      CHECK(std::abs(double(curvatures[i]) - r.curvature) < tolerance);
      CHECK(std::abs(double(other[i]) - r.curvature) < tolerance);
      CHECK(double(normals[i].norm()) == Approx(1.0).epsilon(1e-6));
      if (r.gap < 1e-3) continue;  // round: any normal is as good
      CHECK(normals[i].template cast<double>().cross(r.normal).norm() < tolerance / r.gap);
      CHECK(by_tree[i].template cast<double>().cross(r.normal).norm() < tolerance / r.gap);
    }
    std::vector<S> from_lists;  // that reach farther
    const auto lists = nearest_neighbors(cloud, static_cast<std::size_t>(parameters.max_neighbors) + 5, 2);
    const auto by_lists = estimate_normals(cloud, parameters, lists, 2, &from_lists);
    for (std::size_t i = 0; i < cloud.size(); ++i) {  // the same but for the order in which they sum
      CHECK(by_lists[i].isZero(0) == normals[i].isZero(0));
      CHECK(std::abs(double(from_lists[i] - curvatures[i])) < tolerance);
      if (i % 7 == 0 &&
          reference(cloud, i, S(parameters.radius), static_cast<std::size_t>(parameters.max_neighbors)).gap > 1e-3)
        CHECK(by_lists[i].cross(normals[i]).norm() < S(tolerance));
    }
  }
}

cases::Points<double> outward(const cases::Points<double>& points) {  // of cases "spheres"
  const Eigen::Vector3d first(0.2, 0.5, 0.3), second(0.261, 0.5, 0.3);
  cases::Points<double> out;
  for (const auto& p : points)
    out.push_back(((p - first).norm() < (p - second).norm() ? p - first : p - second).normalized());
  return out;
}

}  // namespace

TEST_CASE("normals equal singular vectors of the neighborhood") {
  for (const auto& kind : cases::kinds()) {
    INFO(kind);
    check_reference<float>(kind);
    check_reference<double>(kind);
  }
}

TEST_CASE("normals obey the laws") {
  for (const auto& kind : cases::kinds()) {
    if (!cases::irregular(kind)) continue;
    INFO(kind);
    const auto points = cases::cloud_of<double>(kind);
    const auto same = [](const auto& a, const auto& b) {
      for (std::size_t i = 0; i < a.size(); ++i)
        if ((a[i] - b[i]).norm() > 1e-6 && (a[i] + b[i]).norm() > 1e-6) return false;
      return true;
    };
    const auto stage = [](const auto& p, int threads) { return estimate_normals(p, {0.015, 25}, threads); };
    cases::check_shuffle_and_threads(points, stage, same);
    cases::Points<double> turned;
    for (const auto& n : stage(points, 1)) turned.push_back(cases::some_motion().linear() * n);
    CHECK(same(stage(cases::moved(cases::some_motion(), points), 1), turned));
  }
}

TEST_CASE("normals of spheres and planes are what they should be") {
  const auto points = cases::cloud_of<double>("spheres", 6000);
  const auto normals = estimate_normals(points);
  const auto truth = outward(points);
  std::size_t good = 0;
  for (std::size_t i = 0; i < points.size(); ++i) good += std::abs(normals[i].dot(truth[i])) > std::cos(deg(15.0));
  CHECK(double(good) > 0.97 * double(points.size()));
  for (const auto& n : estimate_normals(cases::cloud_of<float>("plane")))
    CHECK((n.isZero(0) || std::abs(n.z()) == 1.0f));
}

TEST_CASE("normals face the views that saw their points") {
  const auto points = cases::cloud_of<double>("spheres", 2000);
  const auto truth = outward(points);
  cases::Points<double> flipped = truth;
  for (std::size_t i = 0; i < flipped.size(); i += 3) flipped[i] = -flipped[i];
  // Two sensors on either side; each point was seen by the one that it faces.
  const std::vector<Eigen::Vector3d> sensors{{0.2, 0.0, 0.3}, {0.2, 1.0, 0.3}};
  std::vector<int> views;
  for (std::size_t i = 0; i < points.size(); ++i) views.push_back((sensors[0] - points[i]).dot(truth[i]) > 0 ? 0 : 1);
  std::size_t wrong = 0;
  const auto turned = orient_normals_to_views(flipped, points, views, sensors);
  for (std::size_t i = 0; i < points.size(); ++i)
    wrong += (sensors[static_cast<std::size_t>(views[i])] - points[i]).dot(turned[i]) < 0;
  CHECK(wrong == 0);
  views[5] = -1;
  CHECK(orient_normals_to_views(flipped, points, views, sensors)[5].isZero(0));
  views[5] = 2;
  CHECK_THROWS_AS(orient_normals_to_views(flipped, points, views, sensors), InputError);
  views.pop_back();
  CHECK_THROWS_AS(orient_normals_to_views(flipped, points, views, sensors), InputError);
}

TEST_CASE("a normal is turned if it faces away by more than the limit") {
  const Eigen::Vector3d sight(0.0, 0.0, 0.5);
  const auto at = [](double angle) { return Eigen::Vector3d(std::sin(angle), 0.0, std::cos(angle)); };
  for (const double angle : {0.0, 40.0, 89.0}) CHECK(orient_towards(at(deg(angle)), sight) == at(deg(angle)));
  for (const double angle : {91.0, 150.0, 180.0}) CHECK(orient_towards(at(deg(angle)), sight) == -at(deg(angle)));
  const double least = std::cos(deg(100.0));
  CHECK(orient_towards(at(deg(99.0)), sight, least) == at(deg(99.0)));
  CHECK(orient_towards(at(deg(101.0)), sight, least) == -at(deg(101.0)));
  CHECK(orient_towards(Eigen::Vector3f(0, 0, 0), sight).isZero(0));
}

TEST_CASE("normals without views turn outwards, patch by patch") {
  const auto points = cases::cloud_of<double>("spheres", 6000);
  const auto truth = outward(points);
  Rng rng(5);
  auto random = truth;
  for (auto& n : random)
    if (rng.uniform() < 0.5) n = -n;
  // The spheres touch; a few points at the contact belong to either surface.
  const auto wrong = [](const auto& a, const auto& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i].dot(b[i]) < 0;
    return count;
  };
  const auto turned = orient_normals_consistently(random, points);
  CHECK(wrong(turned, truth) < 60);
  CHECK((orient_normals_consistently(random, points, {}, 3) == turned));
  const Indices order = cases::shuffled(points.size());
  CHECK(wrong(orient_normals_consistently(cases::pick(random, order), cases::pick(points, order)),
              cases::pick(truth, order)) < 60);
  CHECK(wrong(orient_normals_consistently(estimate_normals(points), points), truth) < 120);
  auto holed = random;
  holed[10].setZero();
  CHECK(orient_normals_consistently(holed, points)[10].isZero(0));
  // One sphere alone, its front half alone: caps face away from their own centroids.
  Indices one, front;
  for (std::size_t i = 1; i < points.size(); i += 2) one.push_back(static_cast<Index>(i));
  for (const Index i : one)
    if (truth[static_cast<std::size_t>(i)].y() < -0.2) front.push_back(i);
  for (const Indices& part : {one, front})
    CHECK(wrong(orient_normals_consistently(cases::pick(random, part), cases::pick(points, part)),
                cases::pick(truth, part)) < 3);
  // A plane has no outside: all agree with the first.
  const auto plane = cases::cloud_of<double>("plane", 900);
  cases::Points<double> mixed(plane.size(), Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < mixed.size(); i += 2) mixed[i] = -mixed[i];
  for (const auto& n : orient_normals_consistently(mixed, plane)) CHECK(n.z() == -1.0);
}

TEST_CASE("normals without views turn outwards on fruit between leaves") {
  Rng rng(3);
  std::size_t wrong = 0;
  for (int scene = 0; scene < 20; ++scene) {  // a fruit between two curled leaves that touch it
    const double radius = rng.uniform(0.01, 0.03);
    cases::Points<double> points;
    std::vector<Eigen::Vector3d> truth;
    const auto noise = [&]() -> Eigen::Vector3d {
      return 0.0007 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    };
    for (int i = 0; i < 1200; ++i) {
      const Eigen::Vector3d n = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
      if (std::abs(n.z()) > 0.8) continue;  // the leaves hide it
      truth.push_back(n);
      points.push_back(radius * n + noise());
    }
    for (const double side : {-1.0, 1.0}) {
      const double curl = rng.uniform(-15.0, 15.0);  // 1/m
      for (int i = 0; i < 3000; ++i) {
        const double x = rng.uniform(-0.05, 0.05), y = rng.uniform(-0.05, 0.05);
        points.push_back(Eigen::Vector3d(x, y, side * (0.85 * radius + curl * x * x)) + noise());
      }
    }
    const auto turned = orient_normals_consistently(estimate_normals(points), points);
    std::size_t inwards = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) inwards += turned[i].dot(truth[i]) < 0.0;
    wrong += 20 * inwards > truth.size();
  }
  CHECK(wrong == 0);
}

TEST_CASE("normals of next to nothing, and bad input") {
  using P = cases::Points<float>;
  const P none;
  CHECK(estimate_normals(none).empty());
  CHECK(orient_normals_consistently(none, none).empty());
  CHECK(estimate_normals(P{{1, 2, 3}})[0].isZero(0));
  CHECK(estimate_normals(P{{1, 2, 3}, {1, 2, 3.001f}})[1].isZero(0));
  CHECK(estimate_normals(P{{0, 0, 0}, {0.001f, 0, 0}, {0, 0.001f, 0}})[2].cwiseAbs() == Eigen::Vector3f::UnitZ());
  // Far from the origin the coordinates' rounding makes a line look like a strip; it is still a line.
  P far;
  for (int i = 0; i < 50; ++i) far.push_back({100.0f + 0.0001f * float(i), 200.0f + 0.00005f * float(i), 50.0f});
  for (const auto& n : estimate_normals(far)) CHECK(n.isZero(0));
  CHECK(cases::rejects("radius", [&] { estimate_normals(none, {0.0, 25}); }));
  CHECK(cases::rejects("radius", [&] { estimate_normals(none, {-0.1, 25}); }));
  CHECK(cases::rejects("max_neighbors", [&] { estimate_normals(none, {0.006, 2}); }));
  CHECK(cases::rejects("neighbors", [&] { orient_normals_consistently(none, none, {0, 0.01, 1.0}); }));
  CHECK(cases::rejects("max_distance", [&] { orient_normals_consistently(none, none, {9, 0.0, 1.0}); }));
  CHECK(cases::rejects("max_angle", [&] { orient_normals_consistently(none, none, {9, 0.01, 3.0}); }));
  CHECK_THROWS_AS(orient_normals_consistently(P(2, {0, 0, 1}), none), InputError);
  CHECK_THROWS_AS(estimate_normals(none, {}, KdTree(P(2, {0, 0, 1}))), InputError);

  const float nan = std::nanf("");
  const P cloud = {{nan, 0, 0}, {0, 0, 1}, {0, 0.001f, 1}, {0.001f, 0, 1}};
  CHECK(estimate_normals(cloud, {}, KdTree(cloud)) == estimate_normals(cloud));
  P other = cloud;
  for (auto& p : other) p.x() += 0.5f;  // of the same size
  CHECK_THROWS_WITH(estimate_normals(cloud, {}, KdTree(other)), "the search was built over another cloud");
  CHECK_THROWS_WITH(estimate_normals(cloud, {}, Grid(other, 0.01f)), "the search was built over another cloud");
  const P nothing(4, {nan, nan, nan});
  CHECK_THROWS_AS(estimate_normals(cloud, {}, KdTree(nothing)), InputError);
  CHECK(estimate_normals(nothing, {}, KdTree(nothing)) == P(4, {0, 0, 0}));
}
