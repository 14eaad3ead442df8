// SPDX-License-Identifier: BSD-3-Clause
// Which fruit the planner's model knows: how they are found, tracked and refused, and where they are.
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/plan/expected_surface.hpp>

#include "plan/fruit_cases.hpp"

using namespace cases;

TEST_CASE("found fruit: the area is that of the fitted bodies, and so is the extent") {
  Scan scan;
  add_fruit(scan, kFruit);
  add_fruit(scan, kFruit + Vector3d(0.1, 0.0, 0.02));
  const ExpectedSurface model = model_of(scan);
  REQUIRE(model.bodies().size() == 2);
  CHECK(model.area() == Approx(2 * kSurface).epsilon(1e-4));
  CHECK(model.covered_area() == 0.0);
  CHECK((model.center() - kFruit - Vector3d(0.05, 0.0, 0.01)).norm() < 1e-5);
  CHECK((model.extent().min - kFruit + Vector3d::Constant(kRadius)).norm() < 1e-5);
  CHECK((model.extent().max - kFruit - Vector3d(0.1, 0.0, 0.02) - Vector3d::Constant(kRadius)).norm() < 1e-5);
  for (const float area : model.areas()) CHECK(area == Approx(kSurface / 200).epsilon(1e-4));
}

TEST_CASE("found fruit: an update replaces what was before") {
  ExpectedSurfaceParameters p;
  Scan scan;
  add_fruit(scan, kFruit, [](const Vector3d& d) { return d.y() < 0.0; });
  const ExpectedSurface once = model_of(scan, p);
  ExpectedSurface twice = once;
  twice.update(scan.progress(), {}, {});
  CHECK(twice.areas().size() == once.areas().size());
  CHECK(twice.area() == Approx(once.area()).epsilon(1e-3));
  CHECK(twice.covered_area() == Approx(once.covered_area()).epsilon(1e-3));
  CHECK((twice.center() - once.center()).norm() < 1e-4);
  CHECK(twice.completeness(std::vector<char>(twice.areas().size(), 1)).fruits.size() == 1);
  const Pose front = look_at(kFruit, {0, 0.1, 0.2});
  CHECK(twice.shown(front).size() == once.shown(front).size());
}

TEST_CASE("found fruit: fruit are tracked until the cloud has grown by a quarter, then sought anew") {
  Scan scan;
  add_fruit(scan, kFruit);
  scan.cloud.points.resize(1600), scan.cloud.normals.resize(1600);
  ExpectedSurface model = model_of(scan);
  REQUIRE(model.bodies().size() == 1);
  CHECK(model.bodies()[0].found_by == "region_growing");
  const Cloud first = scan.cloud;
  const auto grow = [&](double depth, std::size_t size) {  // by a cap of a second fruit
    scan.cloud = first;
    add_fruit(scan, kFruit + Vector3d(0.1, 0, 0), [&](const Vector3d& d) { return d.y() < depth; });
    REQUIRE(scan.cloud.size() >= size);
    scan.cloud.points.resize(size), scan.cloud.normals.resize(size);
    model.update(scan.progress(), {}, {});
    REQUIRE(model.bodies().size() == 2);
    const bool fruit_first = (model.bodies()[0].fit.body.center - kFruit).norm() < 0.01;
    CHECK(model.bodies()[fruit_first ? 0 : 1].found_by == "region_growing");
    return model.bodies()[fruit_first ? 1 : 0].found_by;
  };
  CHECK(grow(-0.6, 1900) == "sphere_voting");   // only the tracker finds fruit by votes alone
  CHECK(grow(-0.4, 2000) == "sphere_voting");   // a quarter is not more than a quarter
  CHECK(grow(-0.4, 2001) == "region_growing");  // counted from the last segmentation
  CHECK(grow(-0.2, 2280) == "region_growing");  // and tracked again
}

TEST_CASE("found fruit: points without normals get them from the views that saw them") {
  for (const double scale : {1.0, 0.3}) {  // 3 mm apart, and less than 1 mm
    CAPTURE(scale);
    Scan scan;
    test::add_sphere(scan.cloud, {kFruit, scale * kRadius}, scale * 0.003,
                     [](const Vector3d& d) { return d.y() < 0.2; });
    scan.cloud.normals.clear();
    scan.cloud.views.assign(scan.cloud.size(), 1);
    scan.views.resize(2);
    scan.views[1].world_T_optical = look_at(kFruit, {0, 0.1, 0.2});
    const ExpectedSurface model = model_of(scan);
    Cloud estimated = scan.cloud;
    NormalParameters normals;
    normals.radius = 3.0 * estimate_spacing(estimated);
    estimated.normals = orient_normals_to_views(estimate_normals(estimated, normals), estimated, estimated.views,
                                                {Vector3d::Zero(), Vector3d(0, 0.1, 0.2)});
    const auto expected = split(estimated);
    REQUIRE(model.bodies().size() == 1);
    CHECK(model.bodies()[0].fit.body.center == expected.found.at(0).fit.body.center);
    CHECK((model.bodies()[0].fit.body.center - kFruit).norm() < 0.002);
  }
}

TEST_CASE("found fruit: bodies are fitted whatever stages the segmentation has") {
  Scan scan;
  add_fruit(scan, kFruit);
  ExpectedSurface model(camera(), box(kFruit, 0.12), bare());
  model.update(scan.progress(), SplitParameters::paper(), {});
  REQUIRE(model.bodies().size() == 1);
  CHECK(model.bodies()[0].fit.body.mean_radius() == Approx(kRadius).epsilon(1e-3));
}

TEST_CASE("found fruit: what a sight line went through is no fruit") {
  Scan scan;
  add_fruit(scan, kFruit, [](const Vector3d& d) { return d.y() < -0.6; });
  const Pose front = look_at(kFruit, {0, 0.1, 0.2});
  scan.images.push_back(flat_image(front, 0.0, 0.0));
  CHECK(model_of(scan).bodies().size() == 1);
  scan.images.back() = flat_image(front, 2.0);
  CHECK(model_of(scan).bodies().empty());
}

TEST_CASE("found fruit: a body that may be one counts by twice its probability, but as no fruit yet") {
  Scan scan;
  add_fruit(scan, kFruit);
  const auto model_with = [&](double log_odds) {  // of a second body, which masks propose
    MaskEvidence masks;
    masks.log_odds = [](const Ellipsoid&) { return 0.0; };
    masks.most = 4.0;
    masks.remaining = [&](const std::vector<Ellipsoid>&) {
      MaskBody body;
      body.fit.body = Ellipsoid(Sphere{{0.07, 0.5, 0.2}, kRadius});
      body.log_odds = log_odds;
      return std::vector<MaskBody>{body};
    };
    const Progress plain = scan.progress();
    ExpectedSurface model(camera(), box(kFruit, 0.12), bare());
    model.update({plain.cloud, plain.images, plain.views, plain.added, plain.observed, plain.kept, &masks}, {}, {});
    return model;
  };
  const auto fruits = [](const ExpectedSurface& model) {
    return model.completeness(std::vector<char>(model.areas().size(), 1)).fruits.size();
  };
  const ExpectedSurface sure = model_with(1.0), unsure = model_with(-1.0), hopeless = model_with(-3.0);
  CHECK(sure.area() == Approx(2 * kSurface).epsilon(1e-3));
  CHECK(fruits(sure) == 2);
  CHECK(unsure.area() == Approx((1.0 + 2.0 / (1.0 + std::exp(1.0))) * kSurface).epsilon(1e-3));
  CHECK(fruits(unsure) == 1);
  CHECK(hopeless.bodies().size() == 1);
}
