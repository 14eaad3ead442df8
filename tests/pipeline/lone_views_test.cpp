// SPDX-License-Identifier: BSD-3-Clause
// When single views that show more fruit than all together are told.
#include "lone_views.hpp"

#include "catch.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

const Eigen::Vector3d kSensor(0.0, 0.1, 0.2);

/// What the sensor sees of `count` balls of 3 cm beside each other, with normals.
Cloud balls(int count) {
  Cloud cloud;
  for (int b = 0; b < count; ++b) {
    const Sphere ball{{0.08 * b - 0.08, 0.5, 0.2}, 0.03};
    test::add_sphere(cloud, ball, 0.0024, [&](const Eigen::Vector3d& d) {
      return d.dot((kSensor - (ball.center + ball.radius * d)).normalized()) >= 0.2;
    });
  }
  return cloud;
}

/// Views that each show so many balls by themselves.
class LoneBalls : public fuse::Views {
 public:
  explicit LoneBalls(std::vector<int> counts) : counts_(std::move(counts)) {}
  Cloud alone(std::size_t view) const override { return balls(counts_[view]); }

  fuse::Observation look(const sensor::DepthFrame&, const Pose&) const override { return {}; }
  fuse::Change take(fuse::Observation, const Pose&) override { return {}; }
  fuse::Change skip(const sensor::DepthFrame&, const Pose&) override { return {}; }
  void filter(fuse::Change&) override {}
  Cloud cloud() const override { return {}; }
  Cloud all() const override { return {}; }
  const std::vector<sensor::SurfaceImage>& images() const override { return images_; }
  bool discarded(std::size_t) const override { return false; }
  Eigen::Vector3d shift_to_reported(const Eigen::Vector3d&) const override { return Eigen::Vector3d::Zero(); }
  std::vector<fuse::BodyErrors> body_errors(const std::vector<Ellipsoid>&, const FitParameters&) const override {
    return {};
  }
  fuse::CalibrationCheck check_calibration(const std::vector<Ellipsoid>&) const override { return {}; }

 private:
  std::vector<int> counts_;
  std::vector<sensor::SurfaceImage> images_;
};

/// What is told of views that each show so many balls, where all together show `fruits`.
std::string told(const std::vector<int>& counts, std::size_t fruits) {
  std::vector<View> views(counts.size());
  for (View& v : views) v.world_T_optical.translation() = kSensor, v.points_in = 1000;
  Aabb volume;
  volume.extend(Eigen::Vector3d(-0.2, 0.4, 0.0));
  volume.extend(Eigen::Vector3d(0.2, 0.7, 0.4));
  return doubt_of_agreement(LoneBalls(counts), views, {}, volume, fruits, 1).value_or("");
}

}  // namespace

TEST_CASE("views alone: three fruit more in two views are told, where at most one was found in all") {
  CHECK_THAT(told({3, 3, 3}, 0), test::says("view 0 alone shows 3 fruit and view 1 alone shows 3 fruit"));
  CHECK_THAT(told({4, 0, 4}, 1), test::says("but all views together show 1"));
  CHECK(told({4, 4, 4}, 2).empty());
  CHECK_FALSE(told({3, 3, 0}, 0).empty());
  CHECK(told({3, 3, 3}, 1).empty());
  CHECK(told({3, 2, 2}, 0).empty());
  CHECK(told({3, 3}, 0).empty());
}
