// SPDX-License-Identifier: BSD-3-Clause
// The whole of `process`. To the bit: threads; points that are not finite, mixed in; doubles that are floats; scales
// that are powers of two with all lengths. Rigid motions, shuffles and copies choose other samples for what is derived
// from the cloud (spacing, noise, votes) and other seeds: the same fruit, centers within 0.3 mm of 35 mm, labels but
// for some points at the borders of bodies; gravity is told from z, so that the pose frames follow turns about z alone.
#include <agrisee/process.hpp>

#include "properties/laws.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

const Eigen::Vector3d kEye(0.02, 0.0, 0.25);

/// Four fruit, one half behind the others, and a stem, as one view shows them; on a lattice of 2^-20 m.
Cloud truss() {
  Cloud cloud;
  const std::vector<Sphere> fruit{
      {{0.0, 0.5, 0.2}, 0.035}, {{0.067, 0.5, 0.21}, 0.031}, {{0.03, 0.505, 0.145}, 0.033}, {{0.035, 0.55, 0.2}, 0.03}};
  for (std::size_t f = 0; f < fruit.size(); ++f)
    test::add_sphere(
        cloud, fruit[f], 0.0024,
        [&](const Eigen::Vector3d& d) {
          const Eigen::Vector3d p = fruit[f].center + fruit[f].radius * d, sight = (kEye - p).normalized();
          if (d.dot(sight) < 0.15) return false;
          for (std::size_t other = 0; other < fruit.size(); ++other) {
            const Eigen::Vector3d c = fruit[other].center - p;
            const double along = c.dot(sight);
            if (other != f && along > 0 && c.squaredNorm() - along * along < fruit[other].radius * fruit[other].radius)
              return false;
          }
          return true;
        },
        2e-4, f + 1);
  for (double z = 0.24; z < 0.32; z += 0.0024)
    for (double a = -1.2; a < 1.3; a += 0.6) {
      const Eigen::Vector3d n(std::sin(a), -std::cos(a), 0);
      cloud.points.push_back((Eigen::Vector3d(0.03, 0.5, z) + 0.004 * n).cast<float>());
    }
  for (auto& p : cloud.points) p = ((p * 0x1p20f).array().round() * 0x1p-20f).matrix();
  cloud.normals.clear();
  return cloud;
}

CloudOrigin from(const Eigen::Vector3d& eye) {
  CloudOrigin origin;
  origin.viewpoint = eye;
  return origin;
}

void require_same(const ScanResult& a, const ScanResult& b, double by = 1.0) {
  REQUIRE(a.labels == b.labels);
  REQUIRE(a.fruits.size() == b.fruits.size());
  for (std::size_t f = 0; f < a.fruits.size(); ++f) {
    const Fruit &x = a.fruits[f], &y = b.fruits[f];
    REQUIRE(x.points == y.points);
    REQUIRE(x.found_by == y.found_by);
    REQUIRE((by * x.centroid).isApprox(y.centroid, by == 1.0 ? 0.0 : 1e-14));
    REQUIRE((by * x.body->center).isApprox(y.body->center, by == 1.0 ? 0.0 : 1e-14));
    REQUIRE((by * x.body->radii).isApprox(y.body->radii, by == 1.0 ? 0.0 : 1e-12));
    REQUIRE(x.orientation.isApprox(y.orientation, by == 1.0 ? 0.0 : 1e-9));
    REQUIRE(by * by * by * x.body->volume == Approx(y.body->volume).epsilon(by == 1.0 ? 0.0 : 1e-9));
    REQUIRE(x.body->completeness == y.body->completeness);
    REQUIRE(x.body->confidence == Approx(y.body->confidence).epsilon(1e-9));
  }
}

/// The same fruit within `margin` (m), `b` having been moved; `from` is where the points of b were in a.
void require_like(const ScanResult& a, const ScanResult& b, const Pose& motion, double margin) {
  REQUIRE(a.fruits.size() == b.fruits.size());
  for (const Fruit& f : a.fruits) {
    double nearest = 1.0;
    const Fruit* like = nullptr;
    for (const Fruit& g : b.fruits) {
      const double d = (motion * f.body->center - g.body->center).norm();
      if (d < nearest) nearest = d, like = &g;
    }
    REQUIRE(nearest < margin);
    CHECK((f.body->radii - like->body->radii).norm() < 3.0 * margin);
  }
}

/// All lengths of the parameters that `process` uses.
Parameters scaled(double by) {
  Parameters p;
  for (double* length : {&p.surfels.separation, &p.normals.radius, &p.split.growing.radius, &p.split.clustering.eps,
                         &p.split.bodies.radius_min, &p.split.bodies.radius_max, &p.split.bodies.usual_radius,
                         &p.split.bodies.min_tolerance, &p.split.bodies.fit.noise, &p.free_space.margin})
    *length *= by;
  return p;
}

}  // namespace

TEST_CASE("process: threads, points that are not finite and precision change no bit") {
  const Cloud cloud = truss();
  const ScanResult straight = process(cloud, {}, from(kEye));
  REQUIRE(straight.fruits.size() == 4);
  require_same(straight, process(cloud, {}, from(kEye), {}, 3));
  std::vector<Eigen::Vector3d> doubles;
  for (const auto& p : cloud.points) doubles.push_back(p.cast<double>());
  require_same(straight, process(doubles, {}, from(kEye)));
  Cloud mixed;
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 3 == 0) mixed.points.emplace_back(nan, 0.1f, 0.2f);
    if (i % 5 == 0) mixed.points.emplace_back(0.1f, -inf, 0.2f);
    mixed.points.push_back(cloud.points[i]);
  }
  require_same(straight, process(mixed, {}, from(kEye)));
}

TEST_CASE("process: scaled by a power of two with its parameters, nothing but the scale changes") {
  const Cloud cloud = truss();
  for (const bool known : {true, false}) {  // with a viewpoint, and with normals that have to agree with one another
    const ScanResult straight = process(cloud, {}, known ? from(kEye) : CloudOrigin{});
    // A cloud without viewpoint counts as merged from many views, which would have seen more of the fourth.
    REQUIRE(straight.fruits.size() == (known ? 4 : 3));
    for (const double by : {0x1p-5, 2.0, 0x1p4}) {
      INFO("by " << by << ", viewpoint " << known);
      Cloud larger = cloud;
      larger.points = laws::scaled(larger.points, by);
      require_same(straight, process(larger, scaled(by), known ? from(by * kEye) : CloudOrigin{}), by);
    }
  }
}

TEST_CASE("process: moved, shuffled, copied, and with points astray, the fruit are the same") {
  const Cloud cloud = truss();
  const ScanResult straight = process(cloud, {}, from(kEye));
  constexpr double kMargin = 3e-4;
  Rng rng(59);
  for (int i = 0; i < 6; ++i) {
    const Pose motion = pose_from_xyz_rpy(rng.direction(), 3.0 * rng.direction());
    Cloud moved = cloud;
    for (auto& p : moved.points) p = (motion * p.cast<double>()).cast<float>();
    require_like(straight, process(moved, {}, from(motion * kEye)), motion, kMargin);
  }
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Cloud mixed = cloud;
    mixed.points = laws::pick(mixed.points, laws::shuffled(cloud.size(), seed));
    require_like(straight, process(mixed, {}, from(kEye)), Pose::Identity(), kMargin);
  }
  for (const std::size_t m : {2u, 4u}) {
    INFO(m << " of each point");
    Cloud copies = cloud;
    copies.points = laws::repeated(copies.points, m);
    const ScanResult got = process(copies, {}, from(kEye));
    require_like(straight, got, Pose::Identity(), kMargin);
  }
  for (const float far : {30.0f, 1e6f, 1e18f, 1e30f, std::numeric_limits<float>::max()}) {
    INFO("astray by " << far);
    Cloud astray = cloud;
    astray.points.emplace_back(far, 0.0f, 0.0f);
    astray.points.emplace_back(0.0f, -far, far);
    require_like(straight, process(astray, {}, from(kEye)), Pose::Identity(), kMargin);
  }
}

TEST_CASE("process: hostile clouds hold no fruit and end") {
  for (const auto& kind : laws::hostile_kinds())
    for (const bool known : {true, false}) {
      INFO(kind);
      Cloud cloud;
      cloud.points = laws::hostile_cloud<float>(kind);
      if (kind == std::string("far")) {  // single precision is too coarse, and no sensor sees as far as that
        CHECK_THROWS_AS(process(cloud, {}, known ? from(kEye) : CloudOrigin{}), InputError);
        continue;
      }
      CloudOrigin origin = known ? from(kEye) : CloudOrigin{};
      origin.trust_viewpoint = true;  // whatever the points say
      const ScanResult got = process(cloud, {}, origin);
      CHECK(got.labels.size() == got.cloud.size());
      CHECK(got.fruits.empty());
    }
}
