// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/contradiction.hpp>

#include "catch.hpp"
#include "fuse/by_hand.hpp"

using namespace agrisee;
using namespace agrisee::fuse;
using sensor::SurfaceImage;
using test::quarter;
using test::wall;

namespace {

void add(SurfaceImage& view, int u, int v, double z, int count = 1) {
  for (int i = 0; i < count; ++i) {
    view.points.push_back(test::at(view, u, v, z).cast<float>());
    view.normals.push_back(Eigen::Vector3f(0.0f, -1.0f, 0.0f));  // towards the camera
  }
}

}  // namespace

TEST_CASE("contradiction is the share of the evidence that refutes") {
  Evidence evidence{3, 1};
  CHECK(evidence.count() == 4);
  CHECK(evidence.contradiction() == 0.25);
  evidence += Evidence{1, 5};
  CHECK(evidence.agree == 4);
  CHECK(evidence.refute == 6);
  CHECK(evidence.contradiction() == 0.6);
  CHECK(Evidence{0, 1}.contradiction() == 1.0);
  CHECK(Evidence{1, 0}.contradiction() == 0.0);
  CHECK(Evidence{}.count() == 0);
  CHECK(Evidence{}.contradiction() == 0.0);
}

TEST_CASE("some thousand points of an image are compared") {
  const auto step = [](std::size_t points) {
    SurfaceImage image;
    image.points.resize(points);
    return compared_step(image);
  };
  CHECK(step(0) == 1);
  CHECK(step(999) == 1);
  CHECK(step(1999) == 1);
  CHECK(step(2000) == 2);
  CHECK(step(7500) == 7);
}

TEST_CASE("points that another view saw agree with it, points that it looked through are refuted") {
  SurfaceImage points = wall(9.0f);
  const SurfaceImage view = wall(2.0f);
  add(points, 3, 2, 2.0, 3);  // where the view saw the wall
  add(points, 3, 2, 1.0, 2);  // in front of it
  add(points, 0, 0, 1.0, 4);  // in front of it, too, but at the border of the image
  add(points, 0, 0, 2.0, 1);  // at the border the wall was seen
  add(points, 3, 2, 3.0, 8);  // hidden by it
  add(points, 9, 9, 1.0, 8);  // outside the image
  const Evidence evidence = compare(points, view, quarter());
  CHECK(evidence.agree == 4);
  CHECK(evidence.refute == 2);
}

TEST_CASE("two views are compared both ways") {
  SurfaceImage a = wall(2.0f), b = wall(2.0f);
  add(a, 3, 2, 2.0, 3);
  add(a, 3, 2, 1.0, 2);
  add(b, 4, 3, 2.0, 10);
  add(b, 4, 3, 1.0, 5);
  for (const Evidence& evidence : {compare(a, b, quarter()), compare(b, a, quarter())}) {
    CHECK(evidence.agree == 13);
    CHECK(evidence.refute == 7);
  }
  const Evidence with_nothing = compare(a, SurfaceImage{}, quarter());
  CHECK(with_nothing.count() == 0);
}

TEST_CASE("of many points every second or third is compared") {
  SurfaceImage points = wall(9.0f);
  const SurfaceImage view = wall(2.0f);
  for (int i = 0; i < 1000; ++i) {
    add(points, 3, 2, 2.0);
    add(points, 3, 2, 1.0);
  }
  const Evidence every_second = compare(points, view, quarter());
  CHECK(every_second.agree == 1000);
  CHECK(every_second.refute == 0);
  points.points.pop_back();
  points.normals.pop_back();
  const Evidence all = compare(points, view, quarter());
  CHECK(all.agree == 1000);
  CHECK(all.refute == 999);
}
