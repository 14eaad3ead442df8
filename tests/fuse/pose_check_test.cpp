// SPDX-License-Identifier: BSD-3-Clause
// Poses that are no world_T_optical are recognized by how the views agree.
#include <agrisee/fuse/pose_check.hpp>

#include "catch.hpp"
#include "fuse/three_fruit.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

const Aabb kNowhere;

/// What the camera sees at five places; the poses are reported as report(pose).
template <typename Report>
std::vector<ViewSample> seen(Report&& report) {
  std::vector<ViewSample> views;
  for (int i = 0; i < 5; ++i) views.push_back(sample_of(frame_at(i), report(place(i))));
  return views;
}

Pose rotated(const Pose& pose, const Eigen::Matrix3d& by) {
  Pose out = pose;
  out.linear() = pose.linear() * by;
  return out;
}

Pose right(const Pose& pose) { return pose; }
Pose inverted(const Pose& pose) { return pose.inverse(Eigen::Isometry); }
/// Of the frame with x forward, y left and z up.
Pose of_body(const Pose& pose) { return rotated(pose, (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished()); }
/// Of the frame with z backward and y up.
Pose of_graphics(const Pose& pose) { return rotated(pose, Eigen::Vector3d(1, -1, -1).asDiagonal()); }
/// From a quaternion w x y z that is read as x y z w.
Pose of_w_first(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  Pose out = pose;
  out.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
  return out;
}

}  // namespace

TEST_CASE("right poses are believed, also when they are off by some millimetres") {
  for (const Aabb& volume : {kNowhere, kVolume}) {
    const PoseCheck check = check_poses(seen(right), volume);
    CHECK(check.mistake.empty());
    CHECK(check.as_reported > 0.7);
    CHECK(check.as_reported > check.mended);
  }
  int view = 0;
  const PoseCheck check =
      check_poses(seen([&](const Pose& pose) { return off_by(pose, 0.008 * Vector3d::Unit(view++ % 3)); }), kNowhere);
  CHECK(check.mistake.empty());
  CHECK(check.as_reported > 0.6);
}

TEST_CASE("poses that are inverted, or of other axes, are recognized") {
  const auto mistake = [](Pose (*report)(const Pose&), const Aabb& volume = kNowhere) {
    return check_poses(seen(report), volume).mistake;
  };
  for (const Aabb& volume : {kNowhere, kVolume}) {
    CHECK(mistake(inverted, volume) == "are inverted (optical_T_world)");
    CHECK(mistake(of_body, volume) == "are those of a frame with x forward and z up");
    CHECK(mistake(of_graphics, volume) == "are those of a frame with z backward and y up");
  }
}

TEST_CASE("quaternions whose w was taken for x are recognized from views of several sides") {
  std::vector<ViewSample> right_views, read_wrongly;
  for (const Vector3d& position :
       std::vector<Vector3d>{{0.25, 0.3, 0.2}, {-0.25, 0.3, 0.2}, {0, 0.25, 0.4}, {0, 0.25, 0}}) {
    const Pose pose = look_along(position, Vector3d(0.01, 0.55, 0.2) - position);
    right_views.push_back(sample_of(frame_from(pose), pose));
    read_wrongly.push_back(sample_of(frame_from(pose), of_w_first(pose)));
  }
  for (const Aabb& volume : {kNowhere, kVolume}) {
    CHECK(check_poses(right_views, volume).mistake.empty());
    CHECK(check_poses(read_wrongly, volume).mistake == "have quaternions in the order w x y z");
  }
}

TEST_CASE("of poses that no change mends none is named") {
  Rng rng(5);
  const std::vector<ViewSample> views = seen([&](const Pose& pose) {
    const Eigen::AngleAxisd turn(kPi * rng.uniform(), rng.direction());
    return rotated(pose, turn.toRotationMatrix());
  });
  for (const Aabb& volume : {kNowhere, kVolume}) {
    const PoseCheck check = check_poses(views, volume);
    CHECK(check.mistake.empty());
    CHECK(check.as_reported < 0.3);
  }
}

TEST_CASE("a single view tells by the scan volume alone") {
  const auto alone = [](Pose (*report)(const Pose&)) {
    return std::vector<ViewSample>{sample_of(frame_at(0), report(place(0)))};
  };
  CHECK(check_poses(alone(right), kVolume).mistake.empty());
  CHECK(check_poses(alone(inverted), kNowhere).mistake.empty());
  CHECK(check_poses(alone(of_body), kVolume).mistake == "are those of a frame with x forward and z up");
  Aabb elsewhere = kVolume;
  elsewhere.min.x() += 5.0;
  elsewhere.max.x() += 5.0;
  CHECK(check_poses(alone(right), elsewhere).mistake.empty());  // no change helps
}

TEST_CASE("views without points, or without others, agree with nothing") {
  CHECK(agreement({}, 0.01) == 0.0);
  CHECK(check_poses({}, kVolume).mistake.empty());
  std::vector<ViewSample> views = seen(right);
  for (std::size_t i = 1; i < views.size(); ++i) views[i].points.clear();
  CHECK(agreement(views, 0.01) == 0.0);
  CHECK(check_poses(views, kNowhere).mistake.empty());
}

TEST_CASE("agreement is the mean share of points that another view has") {
  ViewSample a, b;
  a.points = {{0, 0, 1}, {0.5f, 0, 1}};
  b.points = {{0, 0, 1}, {5, 0, 1}, {6, 0, 1}, {7, 0, 1}};
  CHECK(agreement({a, a}, 0.01) == 1.0);
  CHECK(agreement({a, b}, 0.01) == 0.5 * (0.5 + 0.25));
}

TEST_CASE("of many views some are compared, and poses far away are no trouble") {
  std::vector<ViewSample> many;
  for (int i = 0; i < 50; ++i) many.push_back(sample_of(frame_at(i % 5), place(i % 5)));
  CHECK(agreement(many, 0.01) > 0.9);
  for (ViewSample& view : many) view.world_T_optical.translation() *= 1e9;
  CHECK(check_poses(many, kVolume).mistake.empty());
}

TEST_CASE("a sample is spread over the whole image") {
  const sensor::DepthFrame& frame = frame_at(0);
  sensor::DepthFrame full = frame;
  full.depth.assign(full.depth.size(), 0.5f);
  const ViewSample sample = sample_of(full, place(0));
  CHECK(sample.points.size() > 3000);
  CHECK(sample.points.size() < 10000);
  CHECK(sample.points.front().x() < -0.17f);
  CHECK(sample.points.back().x() > 0.17f);
}

TEST_CASE("of a small frame every pixel is taken") {
  sensor::DepthFrame frame;
  frame.intrinsics = {3, 2, 1.0, 1.0, 0.0, 0.0};
  frame.depth.assign(6, 1.0f);
  CHECK(sample_of(frame, place(0)).points ==
        std::vector<Vector3f>{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {0, 1, 1}, {1, 1, 1}, {2, 1, 1}});
}

namespace {

ViewSample points_at(const std::vector<Vector3f>& points, const Vector3d& position = {0, 0, 0}) {
  ViewSample view;
  view.points = points;
  view.world_T_optical.translation() = position;
  return view;
}

/// Two views of ten places that are far apart. In the second, at kThere, the first `right` are as reported, the last
/// `inverted` as they are with poses inverted, and the others nowhere.
const Vector3d kThere(0.5, 0.7, 0.3);
std::vector<ViewSample> partly(int right, int inverted) {
  ViewSample a = points_at({}), b = points_at({}, kThere);
  for (int i = 0; i < 10; ++i) {
    const Vector3f place(3.0f * float(i) + 0.2f, 0.4f, 1.0f), there = kThere.cast<float>();
    a.points.push_back(place);
    const float sign = i < right ? -1.0f : i >= 10 - inverted ? 1.0f : 100.0f;
    b.points.push_back(place + sign * there);
  }
  return {a, b};
}

}  // namespace

TEST_CASE("points agree in cells that touch, on all sides") {
  const Vector3f place(0.5f, 0.5f, 0.5f);
  for (int n = 0; n < 27; ++n) {
    const Vector3f step(float(n % 3 - 1), float(n / 3 % 3 - 1), float(n / 9 - 1));
    CHECK(agreement({points_at({place}), points_at({place + step})}, 1.0) == 1.0);
    if (n == 13) continue;  // no step
    CHECK(agreement({points_at({place}), points_at({place + 2.0f * step})}, 1.0) == 0.0);
    CHECK(agreement({points_at({place}), points_at({place + step})}, 0.25) == 0.0);
  }
}

TEST_CASE("a view does not agree with itself, nor do views without points count") {
  const ViewSample twice = points_at({{0, 0, 1}, {0, 0, 1}}), elsewhere = points_at({{9, 0, 1}});
  CHECK(agreement({twice, elsewhere}, 0.01) == 0.0);
  CHECK(agreement({twice, {}, elsewhere, {}, twice}, 0.01) == Approx(2.0 / 3.0));
}

TEST_CASE("of up to sixteen views all are compared, of more sixteen that are evenly picked") {
  for (int count = 2; count <= 50; ++count) {
    std::vector<ViewSample> views;
    for (int i = 0; i < count; ++i)  // those with even numbers agree
      views.push_back(points_at({{i % 2 ? 9.0f + float(i) * 3.0f : 0.0f, 0, 1}}));
    const int used = std::min(count, 16);
    int even = 0;
    for (int k = 0; k < used; ++k) even += k * count / used % 2 == 0;
    CHECK(agreement(views, 0.01) == Approx(even > 1 ? double(even) / used : 0.0));
  }
}

TEST_CASE("views without points are not among those that are compared") {
  std::vector<ViewSample> views(34);
  for (std::size_t i = 1; i < views.size(); i += 3) views[i] = points_at({{0, 0, 1}});
  CHECK(agreement(views, 0.01) == 1.0);
  const std::vector<ViewSample> five = seen(inverted);
  views.assign(34, ViewSample());
  for (std::size_t i = 0; i < five.size(); ++i) views[3 * i + 1] = five[i];
  CHECK(check_poses(views, kNowhere).mistake == "are inverted (optical_T_world)");
}

TEST_CASE("a mistake is named if 40 % of the points agree with it, and twice as many as without") {
  const auto check = [](int right, int inverted) { return check_poses(partly(right, inverted), kNowhere); };
  const std::string named = "are inverted (optical_T_world)";
  CHECK(check(0, 4).mistake == named);
  CHECK(check(0, 3).mistake.empty());
  CHECK(check(2, 4).mistake == named);
  CHECK(check(3, 5).mistake.empty());
  CHECK(check(3, 6).mistake == named);
  CHECK(check(3, 6).as_reported == Approx(0.3));
  CHECK(check(3, 6).mended == Approx(0.6));
}

TEST_CASE("points are compared in cells of 2 % of their depth, at least 1 cm") {
  const auto agree = [](float depth, float x) {
    return check_poses({points_at({{0.005f, 0, depth}}), points_at({{x, 0, depth}})}, kNowhere).as_reported == 1.0;
  };
  CHECK(agree(1.0f, 0.039f));
  CHECK_FALSE(agree(1.0f, 0.041f));
  CHECK(agree(2.0f, 0.079f));
  CHECK_FALSE(agree(2.0f, 0.081f));
  CHECK(agree(0.3f, 0.019f));
  CHECK_FALSE(agree(0.3f, 0.021f));
}

TEST_CASE("a single view has to show nothing in the volume before it is mended, and 5 % after") {
  const Aabb volume{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  const Vector3d position(0.5, 0.7, 0.3);
  const auto mistake = [&](int inside, int outside, int as_reported = 0) {
    ViewSample view = points_at({}, position);
    for (int i = 0; i < inside; ++i) view.points.push_back(position.cast<float>());  // minus the position: the origin
    for (int i = 0; i < outside; ++i) view.points.emplace_back(5.0f, 6.0f, 7.0f);
    for (int i = 0; i < as_reported; ++i) view.points.push_back(-position.cast<float>());
    return check_poses({view}, volume).mistake;
  };
  CHECK(mistake(1, 19) == "are inverted (optical_T_world)");
  CHECK(mistake(1, 20).empty());
  CHECK(mistake(10, 9, 1).empty());
}

TEST_CASE("a large frame is sampled at equal steps, half a step from its border") {
  sensor::DepthFrame frame;
  frame.intrinsics = {400, 300, 100.0, 100.0, 0.0, 0.0};
  frame.depth.assign(120000, 1.0f);
  const std::vector<Vector3f> points = sample_of(frame, place(0)).points;  // steps of sqrt(120000 / 5000), about 5
  REQUIRE(points.size() == 80 * 60);
  CHECK(points[0] == Vector3f(0.02f, 0.02f, 1.0f));
  CHECK(points[1] == Vector3f(0.07f, 0.02f, 1.0f));
  CHECK(points[80] == Vector3f(0.02f, 0.07f, 1.0f));
  CHECK(points.back() == Vector3f(3.97f, 2.97f, 1.0f));
  frame.depth[frame.intrinsics.index(7, 2)] = 0.0f;
  CHECK(sample_of(frame, place(0)).points.size() == 80 * 60 - 1);
}

TEST_CASE("views with mended poses agree as much as with the right ones") {
  const double agree = check_poses(seen(right), kNowhere).as_reported;
  for (Pose (*report)(const Pose&) : {inverted, of_body, of_graphics})
    CHECK(check_poses(seen(report), kNowhere).mended == Approx(agree).margin(0.001));
}
