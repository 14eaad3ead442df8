// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/process.hpp>

#include <limits>

#include "catch.hpp"
#include "interop/same_result.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace process_test {

namespace {

const Eigen::Vector3d kEye(0.0, 0.0, 0.2);
const std::vector<Sphere> kFruit = {{{-0.05, 0.5, 0.2}, 0.035}, {{0.04, 0.52, 0.2}, 0.03}};

/// What the eye sees of the fruit, with normals and with view 0, about 2.4 mm apart.
Cloud seen(double noise = 0.0) {
  Cloud cloud;
  Rng rng(5);
  for (const Sphere& s : kFruit) {
    const auto n = static_cast<int>(4.0 * kPi * s.radius * s.radius / 5.8e-6);
    for (int i = 0; i < n; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / n, phi = 2.399963229728653 * i, q = std::sqrt(1.0 - z * z);
      const Eigen::Vector3d d(q * std::cos(phi), q * std::sin(phi), z),
          p = s.center + (s.radius + noise * rng.normal()) * d;
      if (d.dot((kEye - p).normalized()) < 0.2) continue;
      cloud.points.push_back(p.cast<float>());
      cloud.normals.push_back(d.cast<float>());
      cloud.views.push_back(0);
    }
  }
  return cloud;
}

void check_found(const ScanResult& result, double margin = 0.002) {
  REQUIRE(result.fruits.size() == kFruit.size());
  for (const Sphere& s : kFruit) {
    double nearest = 1.0;
    for (const Fruit& f : result.fruits) nearest = std::min(nearest, (f.body->center - s.center).norm());
    CHECK(nearest < margin);
  }
}

CloudOrigin from_eye(bool views) {
  CloudOrigin origin;
  if (views)
    origin.sensors = {kEye};
  else
    origin.viewpoint = kEye;
  origin.check_normals = true;
  return origin;
}

/// No point is an outlier, or seen at too much of a slant.
Parameters all_points() {
  Parameters parameters;
  parameters.sor.std_ratio = 1e6;
  parameters.max_incidence = kPi / 2;
  return parameters;
}

}  // namespace

TEST_CASE("normals that face away from viewpoint or view are turned, the others kept") {
  const Cloud cloud = seen();
  Cloud turned = cloud;
  for (auto& n : turned.normals) n = -n;
  for (const bool views : {false, true}) {
    check_found(process(turned, {}, from_eye(views)));
    const ScanResult result = process(turned, all_points(), from_eye(views));
    REQUIRE(result.cloud.size() == cloud.size());
    CHECK((result.cloud.normals == cloud.normals));
  }
  CHECK(process(turned).fruits.empty());  // trusted as they are when nothing else is known
  CloudOrigin unchecked = from_eye(true);
  unchecked.check_normals = false;
  CHECK(process(turned, {}, unchecked).fruits.empty());
}

TEST_CASE("positions of sensors in millimetres, or for points without views, are refused") {
  CloudOrigin far = from_eye(true), one = from_eye(false);
  for (auto& sensor : far.sensors) sensor *= 1000.0;
  *one.viewpoint *= 1000.0;
  CHECK_THROWS_WITH(process(seen(), {}, far), test::says("is its position in millimetres?"));
  CHECK_THROWS_WITH(process(seen(), {}, one), test::says("is its position in millimetres?"));
  Cloud bare = seen();
  bare.normals.clear();
  bare.views.clear();
  CHECK_THROWS_WITH(process(bare, {}, from_eye(true)), test::says("from which view each point comes"));
}

TEST_CASE("a point's view without a sensor position is refused, with normals and without") {
  Cloud cloud = seen();
  cloud.views.back() = -1;  // not known
  CloudOrigin origin = from_eye(true);
  for (const bool check_normals : {false, true}) {
    origin.check_normals = check_normals;
    for (const int view : {1, 7, std::numeric_limits<int>::max()}) {
      cloud.views[5] = view;
      CHECK_THROWS_WITH(process(cloud, {}, origin),
                        test::says("view " + std::to_string(view) + " of a point has no sensor position"));
      Cloud bare = cloud;
      bare.normals.clear();
      CHECK_THROWS_WITH(process(bare, {}, origin), test::says("has no sensor position"));
    }
    CHECK_THROWS_AS(check_origin(cloud, origin), InputError);
    CHECK_THROWS_AS(normals_facing_away(cloud, origin), InputError);
    cloud.views[5] = 0;
    check_found(process(cloud, {}, origin));
  }
}

TEST_CASE("arrays of different lengths are refused") {
  const auto with = [](auto&& change) {
    Cloud cloud = seen();
    change(cloud);
    return cloud;
  };
  for (const Cloud& wrong :
       {with([](Cloud& c) { c.normals.resize(3); }), with([](Cloud& c) { c.normals.emplace_back(0, 0, 1); }),
        with([](Cloud& c) { c.views.resize(2); }), with([](Cloud& c) { c.colors.resize(5); }),
        with([](Cloud& c) { c.instances.resize(1); })}) {
    CHECK_THROWS_WITH(process(wrong), test::says("there must be one for each point, or none"));
    CHECK_THROWS_AS(process(Cloud(wrong)), InputError);
    CHECK_THROWS_AS(thinned(wrong, {}), InputError);
    CHECK_THROWS_AS(split(wrong), InputError);
  }
  const Cloud few = with([](Cloud& c) { c.colors.resize(7); });
  CHECK_THROWS_WITH(process(few), test::says("the cloud has " + std::to_string(few.size()) + " points, but 7 colors"));
}

TEST_CASE("an origin that is not finite, or a detection without frame, is refused") {
  CloudOrigin nowhere, empty;
  nowhere.cluster_origin = Eigen::Vector3d(0.0, std::nan(""), 0.0);
  CHECK_THROWS_WITH(process(seen(), {}, nowhere), test::says("CloudOrigin::cluster_origin is not finite"));
  empty.detected.resize(1);
  CHECK_THROWS_WITH(process(seen(), {}, empty), test::says("CloudOrigin::detected: view 0 has no frame"));
}

TEST_CASE("points of pixels without return are left out, and counted") {
  Cloud cloud = seen();
  cloud.normals.clear();
  cloud.views.clear();
  const std::size_t measured = cloud.size();
  cloud.points.resize(3 * measured, Eigen::Vector3f::Zero());
  CloudOrigin origin;
  origin.viewpoint = kEye;
  const std::string rest = " of " + std::to_string(3 * measured) + " points lie at (0, 0, 0) or at the sensor";
  ScanResult result = process(cloud, {}, origin);
  check_found(result, 0.004);
  CHECK(result.raw.size() == measured);
  REQUIRE_FALSE(result.warnings.empty());
  CHECK_THAT(result.warnings[0], test::says(std::to_string(2 * measured) + rest));
  for (std::size_t i = measured; i < cloud.size(); ++i) cloud.points[i] = kEye.cast<float>();
  result = process(cloud, {}, origin);
  check_found(result, 0.004);
  CHECK(result.raw.size() == measured);
}

TEST_CASE("normals that are longer than unit normals are shortened") {
  Cloud cloud = seen();
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] *= 5.0f;
  check_found(process(cloud, {}, from_eye(true)));
}

TEST_CASE("a cloud in millimetres is refused, large clouds in metres are not") {
  Cloud cloud = seen(), scaled = cloud;
  for (auto& p : scaled.points) p *= 1000.0f;
  CHECK_THROWS_WITH(process(scaled),
                    test::says("apart, farther than the largest expected fruit (0.12 m): is it in millimetres?"));
  CHECK_THROWS_AS(check_units(scaled), InputError);
  std::vector<Eigen::Vector3f> foreign = scaled.points;
  CHECK_THROWS_AS(process(foreign), InputError);
  cloud.points.emplace_back(0.0f, 60.0f, 0.0f);  // what a sensor saw far behind
  cloud.normals.emplace_back(0.0f, -1.0f, 0.0f);
  cloud.views.push_back(0);
  check_found(process(cloud));
  scaled.points.resize(50);
  scaled.normals.resize(50);
  scaled.views.resize(50);
  CHECK_NOTHROW(check_units(scaled));  // too few to tell
}

TEST_CASE("a cloud too far from the origin for single precision is refused") {
  Cloud cloud = seen();
  for (auto& p : cloud.points) p.x() += 5e5f;
  CHECK_THROWS_WITH(process(cloud), test::says("from the origin, too far for coordinates in single precision"));
}

TEST_CASE("one viewpoint for points of several views is refused") {
  Cloud cloud = seen();
  const CloudOrigin eye = from_eye(false);
  CHECK_NOTHROW(check_origin(cloud, eye));
  CHECK(normals_facing_away(cloud, eye) == 0);
  cloud.views.front() = -1;  // not known
  CHECK_NOTHROW(check_origin(cloud, eye));
  cloud.views.back() = 3;
  CHECK_THROWS_WITH(process(cloud, {}, eye), test::says("several views (0 and 3, for instance)"));
  CHECK_NOTHROW(process(cloud));
  CloudOrigin behind;
  behind.viewpoint = Eigen::Vector3d(0.0, 1.5, 0.2);
  cloud.views.clear();
  CHECK(normals_facing_away(cloud, behind) > cloud.size() / 2);
  cloud.normals[0].setZero();
  cloud.normals.resize(1);
  cloud.points.resize(1);
  CHECK(normals_facing_away(cloud, behind) == 0);
}

TEST_CASE("a result without fruit says why") {
  CHECK(why_no_fruit(ScanResult()) == "there are no points: no view was taken, or the cloud has none that are finite");
  const ScanResult found = process(seen());
  CHECK(why_no_fruit(found).empty());
  CHECK(found.bodies.taken == 2);
  const auto with_radii = [](double smallest, double largest) {
    Parameters parameters;
    parameters.split.bodies.radius_min = smallest;
    parameters.split.bodies.radius_max = largest;
    return process(seen(), parameters);
  };
  const ScanResult small = with_radii(0.06, 0.09), large = with_radii(0.006, 0.012);
  REQUIRE(small.fruits.empty());
  CHECK(small.bodies.too_small >= 1);
  CHECK(why_no_fruit(small).find("smaller than the expected radii") != std::string::npos);
  REQUIRE(large.fruits.empty());
  CHECK(large.bodies.too_large >= 1);
  CHECK(why_no_fruit(large).find("larger than the expected radii") != std::string::npos);
  Cloud inverted = seen();
  for (auto& n : inverted.normals) n = -n;
  const ScanResult inside_out = process(inverted);
  REQUIRE(inside_out.fruits.empty());
  CHECK(inside_out.bodies.inside_out >= 2);
  CHECK(why_no_fruit(inside_out).find("face inwards") != std::string::npos);
  // A stem: round across, straight along.
  Cloud stem;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 40; ++j) {
      const double a = kPi * j / 40.0;
      const Eigen::Vector3d n(std::cos(a), -std::sin(a), 0.0);
      stem.points.push_back((Eigen::Vector3d(0.0, 0.5, 0.0024 * i) + 0.03 * n).cast<float>());
      stem.normals.push_back(n.cast<float>());
    }
  const ScanResult flat = process(stem);
  REQUIRE(flat.fruits.empty());
  CHECK(flat.bodies.too_flat >= 1);
  CHECK(why_no_fruit(flat).find("too flat") != std::string::npos);
  CHECK(why_no_fruit(flat).find("are its coordinates in metres?") == std::string::npos);
  for (auto& p : stem.points) p *= 39.37f;
  CHECK(why_no_fruit(process(stem)).find("The cloud is 6.17 m across: are its coordinates in metres?") !=
        std::string::npos);
  Cloud same;
  same.points.assign(500, Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  CHECK(why_no_fruit(process(same)).find("All points lie within 0 m: are their coordinates right") !=
        std::string::npos);
}

TEST_CASE("where no view saw the scan volume, the depths and distances say why") {
  const auto told = [](double depth, double distance) {
    ScanResult result;
    result.views.resize(3);
    for (View& v : result.views) v.median_depth = depth, v.volume_distance = distance;
    result.views[2].median_depth = 0.0;  // without a return
    return why_no_fruit(result);
  };
  const std::string nothing = "no view saw a point inside the scan volume";
  CHECK(told(0.52, 480.0) == nothing +
                                 ": the median depth is 0.52 m, and the sensor stood 480 m from the middle of the "
                                 "volume; are the poses in millimetres? They have to be in metres");
  for (const double depth : {5.2, 0.052}) CHECK_THAT(told(depth, 0.5), test::says("in another unit than metres"));
  CHECK_THAT(told(0.52, 0.5), test::says("is the camera turned to it?"));
  CHECK(told(0.0, 0.5) == nothing +
                              ": the views show no return at all; if points were given, are they in the optical "
                              "frame, with z forward?");
  CHECK(told(0.0, 0.0) == nothing);  // views that were read from a file
}

TEST_CASE("the cluster frame of a ready cloud is known without being asked for") {
  const Cloud cloud = seen();
  const ScanResult result = process(cloud);
  Eigen::Vector3f low = cloud.points[0], high = low;
  for (const auto& p : cloud.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  // As seen from the origin of the frame: the lowest corner, on the left, at the back.
  CHECK(result.cluster_origin.isApprox(Eigen::Vector3d(double(low.x()), double(high.y()), double(low.z())), 1e-6));
  REQUIRE(result.fruits.size() == kFruit.size());
  for (const Fruit& f : result.fruits) CHECK(f.position_cluster().isApprox(f.position() - result.cluster_origin, 1e-9));
  CloudOrigin origin;
  origin.cluster_origin = Eigen::Vector3d(1.0, 2.0, 3.0);
  const ScanResult told = process(cloud, {}, origin);
  CHECK(told.cluster_origin == *origin.cluster_origin);
  CHECK(told.fruits[0].position_cluster().isApprox(told.fruits[0].position() - *origin.cluster_origin, 1e-9));
  CHECK(process(Cloud()).cluster_origin.isZero());
}

TEST_CASE("one viewpoint is refused for points that hide one another, unless it is trusted") {
  Cloud cloud = seen(0.001);
  cloud.normals.clear();
  cloud.views.clear();
  CHECK(process(cloud, {}, from_eye(false)).warnings.empty());
  const std::size_t front = cloud.size();
  for (std::size_t i = 0; i < front; ++i) {  // the backs of the fruit
    const Eigen::Vector3f p = cloud.points[i], center = kFruit[p.x() > 0.0f ? 1 : 0].center.cast<float>();
    cloud.points.push_back(2.0f * center - p);
  }
  CHECK_THROWS_WITH(process(cloud, {}, from_eye(false)), test::says(" % of the points lie hidden behind others"));
  CloudOrigin trusted = from_eye(false);
  trusted.trust_viewpoint = true;
  const ScanResult result = process(cloud, {}, trusted);
  REQUIRE_FALSE(result.warnings.empty());
  CHECK_THAT(result.warnings[0], test::says(" % of the points lie hidden behind others"));
  CHECK(process(cloud).warnings.empty());  // without a viewpoint there is nothing to doubt
}

TEST_CASE("a viewpoint behind what was seen is refused, and invents no fruit") {
  Cloud cloud = seen(0.0005);
  cloud.normals.clear();
  cloud.views.clear();
  CloudOrigin behind;
  behind.viewpoint = Eigen::Vector3d(0.0, 1.2, 0.2);
  CHECK_THROWS_WITH(process(cloud, {}, behind), test::says("so it may lie behind the cloud"));
  behind.trust_viewpoint = true;
  const ScanResult result = process(cloud, {}, behind);
  REQUIRE(result.warnings.size() == 1);
  CHECK_THAT(result.warnings[0], test::says("what is curved as fruit is hollow"));
  CHECK(result.fruits.empty());
}

TEST_CASE("normals that are missing are estimated on their neighbors' side") {
  const Cloud cloud = seen();
  Cloud some = cloud, none = cloud;
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (i % 3 == 0) some.normals[i].setZero();
    if (i % 3 == 1) some.normals[i].setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  none.normals.assign(none.size(), Eigen::Vector3f::Zero());
  for (const CloudOrigin& origin : {CloudOrigin{}, from_eye(false), from_eye(true)})
    for (const Cloud* c : {&some, &none}) {
      const Cloud completed = process(*c, all_points(), origin).cloud;
      REQUIRE(completed.size() == cloud.size());
      std::size_t right = 0;
      for (std::size_t i = 0; i < cloud.size(); ++i) right += completed.normals[i].dot(cloud.normals[i]) > 0.8f;
      CHECK(static_cast<double>(right) > 0.98 * static_cast<double>(cloud.size()));
      check_found(process(*c, {}, origin));
    }
}

TEST_CASE("normals that are missing are turned to the sensor, whether others are checked or not") {
  const Eigen::Vector3d eye(0.0, 0.0, 0.5), middle(0.0, 0.0, 0.06);
  Cloud bowl;  // hollow towards the eye, so that neighbors would turn its normals outwards
  test::add_sphere(bowl, {middle, 0.06}, 0.0025, [](const Eigen::Vector3d& d) { return d.z() < -0.3; });
  bowl.normals.assign(bowl.size(), Eigen::Vector3f::Zero());
  Cloud beside = bowl;  // with normals of its own
  for (int i = 0; i < 1600; ++i) {
    beside.points.emplace_back(0.4f + 0.0025f * float(i % 40), 0.0025f * float(i / 40), 0.0f);
    beside.normals.push_back(Eigen::Vector3f::UnitZ());
  }
  CloudOrigin origin;
  origin.viewpoint = eye;
  origin.trust_viewpoint = true;
  for (const bool check : {false, true}) {
    origin.check_normals = check;
    for (const Cloud* c : {&bowl, &beside}) {
      const Cloud completed = process(*c, all_points(), origin).cloud;
      REQUIRE(completed.size() == c->size());
      for (std::size_t i = 0; i < completed.size(); ++i)
        CHECK(completed.normals[i].dot(eye.cast<float>() - completed.points[i]) > 0.0f);
    }
  }
}

TEST_CASE("fruit of different sizes in a cloud of merged views are measured each for itself") {
  Rng rng(11);
  Cloud cloud;
  const double radii[] = {0.034, 0.028, 0.022, 0.016, 0.011};
  for (std::size_t f = 0; f < 5; ++f)
    for (int i = 0; i < int(400.0 * std::pow(radii[f] / 0.02, 2)); ++i) {
      const Eigen::Vector3d n = rng.direction();
      if (n.y() > 0.3) continue;  // no view shows the back
      const Eigen::Vector3d noise(rng.normal(), rng.normal(), rng.normal());
      const Eigen::Vector3d center(0.0, 0.5, 0.3 - 0.06 * double(f));
      cloud.points.push_back((center + radii[f] * n + 0.0007 * noise).cast<float>());
    }
  const ScanResult result = process(cloud);
  REQUIRE(result.fruits.size() == 5);
  for (std::size_t f = 0; f < 5; ++f) {  // from top to bottom
    CHECK(std::abs(result.fruits[f].body->radii.mean() - radii[f]) < 0.0007);
    CHECK((result.fruits[f].body->center - Eigen::Vector3d(0.0, 0.5, 0.3 - 0.06 * double(f))).norm() < 0.0012);
  }
}

namespace {

/// A scrap of some 9 mm: the front of a small ball, with noise.
/// @param tilt how far the normals are off
Cloud scrap(std::uint64_t seed, double tilt) {
  Rng rng(seed);
  Cloud cloud;
  for (int i = 0; i < 90; ++i) {
    const Eigen::Vector3d n = rng.direction(), noise(rng.normal(), rng.normal(), rng.normal());
    const Eigen::Vector3d off(rng.normal(), rng.normal(), rng.normal());
    if (n.y() > 0.0) continue;
    cloud.points.push_back((Eigen::Vector3d(0.0, 0.5, 0.2) + 0.009 * n + 0.0006 * noise).cast<float>());
    cloud.normals.push_back((n + tilt * off).normalized().cast<float>());
  }
  return cloud;
}

}  // namespace

TEST_CASE("where the side of the normals is a guess, only sure bodies are fruit") {
  std::size_t unsure = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Cloud cloud = scrap(seed, 0.4);
    Cloud bare;
    bare.points = cloud.points;
    const ScanResult known = process(cloud), guessed = process(bare);
    for (const Fruit& f : guessed.fruits) CHECK(f.body->confidence >= 0.8);
    bare.normals.assign(bare.size(), Eigen::Vector3f::Zero());  // none either
    for (const Fruit& f : process(bare).fruits) CHECK(f.body->confidence >= 0.8);
    for (const Fruit& f : known.fruits) unsure += f.body->confidence < 0.8;
  }
  CHECK(unsure > 0);  // so 0.8 matters
}

TEST_CASE("of a large fruit several views see more than a little") {
  Cloud cloud;
  constexpr double kRadius = 0.045;
  const Eigen::Vector3d center(0.0, 0.5, 0.2);
  test::add_sphere(cloud, {center, kRadius}, 0.002, [](const Eigen::Vector3d& d) { return d.y() < -0.7; });
  const ScanResult merged = process(cloud);
  CHECK(merged.fruits.empty());
  CHECK(merged.bodies.taken == 0);
  CHECK(merged.bodies.little_seen >= 1);
  CloudOrigin origin;
  origin.viewpoint = center - Eigen::Vector3d(0.0, 0.4, 0.0);
  const ScanResult seen = process(cloud, {}, origin);
  CHECK(seen.fruits.size() == 1);
  CHECK(seen.bodies.taken == 1);
  // Discarded views show nothing.
  const Eigen::Vector3d eye = *origin.viewpoint;
  origin.viewpoint.reset();
  origin.sensors.assign(3, eye);
  cloud.views.assign(cloud.size(), 0);
  CHECK(process(cloud, {}, origin).fruits.size() == 1);
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.views[i] = int(i % 3);
  CHECK(process(cloud, {}, origin).fruits.empty());
}

TEST_CASE("from three views on small bodies that hang alone are doubtful at much noise, and fitted closely") {
  Parameters parameters;
  parameters.split = parameters.scan_split();
  parameters.split.bodies.normal_noise = 0.15;
  std::size_t lost = 0, moved = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud = scrap(seed, 0.4 + 0.02 * static_cast<double>(seed));
    for (std::size_t i = 0; i < cloud.size(); ++i) cloud.views.push_back(static_cast<int>(i % 3));
    CloudOrigin origin;
    origin.sensors.assign(3, kEye);
    const ScanResult three = process(cloud, parameters, origin);
    for (int& v : cloud.views) v = std::min(v, 1);
    const ScanResult two = process(cloud, parameters, origin);
    CHECK(three.fruits.size() <= two.fruits.size());
    const std::size_t gone = two.fruits.size() - three.fruits.size();
    CHECK(three.bodies.doubtful == two.bodies.doubtful + gone);
    CHECK(three.bodies.taken + gone == two.bodies.taken);
    lost += gone;
    if (gone > 0 || two.fruits.empty()) continue;
    CHECK(three.fruits[0].body->confidence < two.fruits[0].body->confidence);
    moved += three.fruits[0].body->center != two.fruits[0].body->center;
  }
  INFO(lost << " lost, " << moved << " moved");
  CHECK(lost > 0);
  CHECK(moved > 0);
}

TEST_CASE("a cloud's own noise widens its neighborhoods") {
  for (const double sigma : {0.0, 0.001, 0.002}) {
    const Cloud cloud = seen(sigma);
    const double noise = estimate_noise(cloud, KdTree<float>(cloud), 0.008, 0.0325);
    CHECK(noise == Approx(sigma).margin(2.5e-4 + 0.2 * sigma));
  }
  Cloud bare = seen(0.002);
  bare.normals.clear();
  check_found(process(bare, {}, from_eye(false)), 0.008);
}

TEST_CASE("of one viewpoint's cloud, what is seen at a slant is dropped") {
  const auto steepest = [](const Cloud& cloud) {
    double least = 1.0;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      least =
          std::min(least, cloud.normals[i].cast<double>().dot((kEye - cloud.points[i].cast<double>()).normalized()));
    return std::acos(least);
  };
  Parameters parameters = all_points();
  parameters.max_incidence = Parameters().max_incidence;
  const Cloud all = seen();
  REQUIRE(steepest(all) > deg(77));
  const ScanResult sure = process(all, parameters, from_eye(false));
  CHECK(steepest(sure.cloud) < deg(75.01));
  CHECK(steepest(sure.cloud) > deg(74));
  CHECK(sure.raw.size() == all.size());
  check_found(sure);
  CHECK(process(all, parameters, from_eye(true)).cloud.size() == all.size());  // views: merged clouds are left alone
  parameters.max_incidence = kPi / 2;
  CHECK(process(all, parameters, from_eye(false)).cloud.size() == all.size());
  parameters.max_incidence = 0.0;
  CHECK_THROWS_AS(process(all, parameters, from_eye(false)), ParameterError);
}

TEST_CASE("flying pixels behind the rim do not lengthen a fruit") {
  Cloud cloud = seen();
  Rng rng(7);
  for (const Sphere& s : kFruit) {
    const Eigen::Vector3d sight = (s.center - kEye).normalized(), right = sight.unitOrthogonal(),
                          up = sight.cross(right);
    for (int i = 0; i < 600; ++i) {
      const double turn = 2.0 * kPi * rng.uniform();
      const Eigen::Vector3d rim = s.center + s.radius * (std::cos(turn) * right + std::sin(turn) * up);
      cloud.points.push_back((rim + 0.02 * rng.uniform() * (rim - kEye).normalized()).cast<float>());
    }
  }
  cloud.normals.clear();
  cloud.views.clear();
  const auto longest = [&](double max_incidence) {
    Parameters parameters = all_points();
    parameters.max_incidence = max_incidence;
    const ScanResult result = process(cloud, parameters, from_eye(false));
    double sum = 0.0;
    for (const Fruit& f : result.fruits) sum += f.body->radii.maxCoeff();
    REQUIRE(result.fruits.size() == kFruit.size());
    return sum / 2.0;
  };
  const double with_them = longest(kPi / 2), without = longest(Parameters().max_incidence);
  INFO("mean of the longest semi-axes (m): " << with_them << ", " << without);
  CHECK(without < with_them - 0.001);
  CHECK(without == Approx(0.0325).margin(0.002));
}

TEST_CASE("thinned clouds keep the views of their points") {
  Cloud dense;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      dense.points.emplace_back(0.0005f * static_cast<float>(i), 0.5f, 0.0005f * static_cast<float>(j));
      dense.views.push_back(i < 30 ? 0 : 1);
    }
  const Cloud thin = thinned(dense, {});
  REQUIRE(thin.size() < dense.size() / 8);
  REQUIRE(thin.views.size() == thin.size());
  for (std::size_t i = 0; i < thin.size(); ++i)
    if (std::abs(thin.points[i].x() - 0.01475f) > 0.001f)
      CHECK(thin.views[i] == (thin.points[i].x() < 0.01475f ? 0 : 1));
}

TEST_CASE("points that nearly coincide derive no absurd parameters") {
  for (const float apart : {1e-30f, 1e-12f, 1e-7f}) {
    Cloud cloud;
    for (int i = 0; i < 300; ++i)
      cloud.points.emplace_back(apart * static_cast<float>(i % 7), apart * static_cast<float>(i % 11),
                                apart * static_cast<float>(i % 13));
    CHECK(process(cloud).fruits.empty());
    cloud.points.emplace_back(1.0f, 1.0f, 1.0f);
    CHECK(process(cloud).fruits.empty());
  }
}

TEST_CASE("vectors and maps of any stride are processed where they lie") {
  Cloud own = test::two_fruit();
  const ScanResult with_normals = process(own, {}, test::from_origin());
  PointCloud<double> twice;
  for (const auto& n : own.normals) twice.normals.push_back(n.cast<double>());
  own.normals.clear();
  const ScanResult expected = process(own, {}, test::from_origin());
  for (const auto& p : own.points) twice.points.push_back(p.cast<double>());
  test::check_same(process(own.points, {}, test::from_origin()), expected);
  test::check_same(process(twice.points, {}, test::from_origin()), expected);
  test::check_same(process(twice, {}, test::from_origin()), with_normals);

  // x y z and two numbers more a point, as many sensors send them; then all x, all y, all z.
  using Eigen::Dynamic;
  const auto n = static_cast<Eigen::Index>(own.size());
  Eigen::Matrix<float, 5, Dynamic> records = Eigen::Matrix<float, 5, Dynamic>::Constant(5, n, 7.0f);
  for (Eigen::Index i = 0; i < n; ++i) records.col(i).head<3>() = own.points[static_cast<std::size_t>(i)];
  const Eigen::Map<const Eigen::Matrix3Xf, 0, Eigen::OuterStride<>> strided(records.data(), 3, n,
                                                                            Eigen::OuterStride<>(5));
  test::check_same(process(strided, {}, test::from_origin()), expected);
  const Eigen::Matrix<double, Dynamic, 3> planes = strided.transpose().cast<double>();
  const Eigen::Map<const Eigen::Matrix3Xd, 0, Eigen::Stride<Dynamic, Dynamic>> by_plane(
      planes.data(), 3, n, Eigen::Stride<Dynamic, Dynamic>(1, n));
  test::check_same(process(planes, {}, test::from_origin()), expected);
  test::check_same(process(by_plane, {}, test::from_origin()), expected);
}

TEST_CASE("without bodies the border of the scan volume takes no fruit away") {
  Parameters parameters = all_points();
  parameters.split.fit_bodies = false;
  const Cloud cloud = seen();
  CloudOrigin origin = from_eye(true);
  const ScanResult free = process(cloud, parameters, origin);
  REQUIRE(free.fruits.size() == kFruit.size());
  for (int axis = 0; axis < 3; ++axis)  // faces through the first fruit
    for (const double to : {-0.02, 0.0, 0.02}) {
      origin.volume = bounding_box(cloud.points);
      origin.volume->max[axis] = kFruit[0].center[axis] + to;
      CHECK((process(cloud, parameters, origin).labels == free.labels));
    }
}

TEST_CASE("bodies that the border of the scan volume cuts are counted once") {
  // Beside the fruit an upright post that ends at the upper face.
  Cloud cloud = seen();
  constexpr double kPost = 0.03, kTop = 0.26;
  const Eigen::Vector3d foot(0.15, 0.5, 0.0);
  for (int i = 0; i < 6000; ++i) {
    const double phi = 2.4 * i;
    const Eigen::Vector3d n(std::cos(phi), std::sin(phi), 0.0);
    if (n.y() > 0.0) continue;  // not seen
    cloud.points.push_back((foot + kPost * n + Eigen::Vector3d(0, 0, kTop - 0.06 * i / 6000.0)).cast<float>());
    cloud.normals.push_back(n.cast<float>());
  }
  cloud.views.clear();
  CloudOrigin origin = from_eye(false);
  origin.volume = bounding_box(cloud.points);
  Parameters parameters = all_points();
  parameters.split.bodies.min_confidence = 0.0;
  parameters.split.bodies.min_roundness = 0.0;
  const ScanResult cut = process(cloud, parameters, origin);
  origin.volume->max.z() = kTop + 0.1;
  const ScanResult whole = process(cloud, parameters, origin);
  CHECK(cut.fruits.size() < whole.fruits.size());
  CHECK(cut.bodies.taken == cut.fruits.size());
  CHECK(whole.bodies.taken == whole.fruits.size());
  CHECK(cut.bodies.too_flat > whole.bodies.too_flat);
}

}  // namespace process_test
