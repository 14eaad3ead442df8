// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/ur.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/pick/picking.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/process.hpp>

#include "catch.hpp"
#include "pipeline/cell.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace pipeline_test {

namespace {

Workcell cell() {
  Workcell w = test::three_fruit_cell();
  w.keep_out.push_back({"platform", Box{{0, -0.1, -0.06}, {0.7, 0.7, 0.1}}});
  w.keep_out.push_back({"plant", Box{{0, 0.87, 0.3}, {1.2, 0.5, 1.6}}});
  w.keep_out.push_back({"cluster", Cylinder{{0.015, 0.545, 0.21}, 0.30, 0.9}});
  return w;
}

/// Runs a scan; `fault(view number, frame)` may spoil a frame, `refuse(number)` a motion.
template <typename Fault, typename Refuse>
ScanResult run(const Parameters& parameters, Fault&& fault, Refuse&& refuse, int* refusals = nullptr) {
  const Workcell w = cell();
  Pipeline pipeline(w, parameters);
  Joints joints = w.start;
  int asked = 0;
  while (const auto next = pipeline.next_view(joints)) {
    if (refuse(asked++)) {
      pipeline.refused();
      if (refusals) ++*refusals;
      continue;
    }
    joints = *next->joints;
    auto frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical, 0.001,
                              static_cast<std::uint64_t>(asked));
    fault(static_cast<int>(pipeline.views().size()), frame);
    pipeline.observe(frame, next->world_T_optical, joints);
  }
  return pipeline.result();
}

void no_fault(int, sensor::DepthFrame&) {}
bool never(int) { return false; }

void check_found(const ScanResult& result) {
  CHECK(result.fruits.size() == test::kThreeFruit.size());
  for (const Sphere& s : test::kThreeFruit) {
    double best = 1.0;
    for (const Fruit& f : result.fruits)
      if (f.body) best = std::min(best, (f.body->center - s.center).norm());
    CHECK(best < 0.002);
  }
}

}  // namespace

TEST_CASE("a scan finds every fruit, the hidden one too, and stops by itself") {
  const ScanResult result = run({}, no_fault, never);
  check_found(result);
  CHECK(result.views.size() < 15);
  CHECK(result.stop_reason != StopReason::not_stopped);
  CHECK(result.labels.size() == result.cloud.size());
  CHECK(result.raw.views.size() == result.raw.size());
  for (const Fruit& f : result.fruits) {
    CHECK((f.orientation * f.orientation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9);
    CHECK(f.orientation.determinant() == Approx(1.0));
    // The cluster frame: lower, left, far corner as seen from the base; axes parallel to world.
    CHECK((f.centroid_cluster - (f.centroid - Eigen::Vector3d(-0.17, 0.72, -0.02))).norm() < 1e-9);
    // The pose that a gripper takes is in the middle of the fruit; the centroid of what was seen is nearer to the
    // robot.
    CHECK(f.pose().translation() == f.body->center);
    CHECK(f.pose().linear() == f.orientation);
    CHECK(f.centroid_pose().translation() == f.centroid);
    CHECK(f.position_cluster().isApprox(f.body->center - Eigen::Vector3d(-0.17, 0.72, -0.02), 1e-9));
    CHECK(f.centroid.y() < f.position().y() - 0.001);
    CHECK(f.body->completeness > 0.2);
    CHECK(f.body->confidence > 0.3);
    CHECK(f.body->mass == Approx(980.0 * f.body->volume));
    const double r = test::kThreeFruit[0].radius;  // all are within 2 mm of it
    CHECK(f.body->volume == Approx(4.0 / 3.0 * kPi * r * r * r).epsilon(0.25));
    CHECK(f.body->volume_error > 0.0);
    CHECK(f.body->volume_error < 0.1 * f.body->volume);
    // The picking, planned after all else: poses that the arm takes at its joints.
    REQUIRE(f.picking);
    REQUIRE(f.picking->reachable);
    CHECK((arm::forward(*f.picking->joints) * cell().tool0_T_optical).isApprox(f.picking->world_T_pre_grasp, 1e-9));
    const Eigen::Vector3d to_center = f.body->center - f.picking->world_T_pre_grasp.translation();
    CHECK(to_center.normalized().dot(f.picking->direction) == Approx(1.0));
    CHECK(to_center.norm() == Approx(0.12 + r).margin(0.004));
  }
  std::vector<int> orders;
  for (const Fruit& f : result.fruits) orders.push_back(f.picking->order);
  std::sort(orders.begin(), orders.end());
  CHECK(orders == std::vector<int>{1, 2, 3});
}

TEST_CASE("a gripper that is not on the camera's axis is planned for where it is") {
  Workcell w = cell();
  w.tool0_T_tool = pose_from_xyz_rpy({0.03, 0.0, 0.14}, {0.0, 0.0, 0.0});
  Pipeline pipeline(w);
  Joints joints = w.start;
  while (const auto next = pipeline.next_view(joints)) {
    if (pipeline.views().size() == 4) break;
    joints = *next->joints;
    pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), next->world_T_optical,
                     joints);
  }
  const ScanResult result = pipeline.result();
  int reachable = 0;
  for (const Fruit& f : result.fruits) {
    if (!f.picking || !f.picking->reachable) continue;
    ++reachable;
    const Pose tool = arm::forward(*f.picking->joints) * *w.tool0_T_tool;
    CHECK(tool.isApprox(f.picking->world_T_pre_grasp, 1e-9));
    const Eigen::Vector3d to_center = f.body->center - tool.translation();
    CHECK(tool.linear().col(2).dot(to_center.normalized()) == Approx(1.0));
  }
  CHECK(reachable >= 1);
}

TEST_CASE("what was measured beside the fruit counts for the picking") {
  // Beads on a string, 7 cm before the first fruit.
  auto seen = test::kThreeFruit;
  for (int i = -10; i <= 10; ++i)
    seen.push_back({test::kThreeFruit[0].center + Eigen::Vector3d(0.0, -0.07, 0.006 * i), 0.004});
  const Workcell w = cell();
  double crossed[2] = {0.0, 0.0};
  for (const bool careful : {false, true}) {
    Parameters p;
    if (!careful) p.picking.clear_weight = 0.0;
    Pipeline pipeline(w, p);
    Joints joints = w.start;
    while (const auto next = pipeline.next_view(joints)) {
      if (pipeline.views().size() == 5) break;
      joints = *next->joints;
      pipeline.observe(test::render(seen, w.sensor.intrinsics, next->world_T_optical), next->world_T_optical, joints);
    }
    const ScanResult result = pipeline.result();
    REQUIRE(result.fruits.size() == 3);
    auto pieces = pick::surface_pieces(pick::surroundings_of(result.cloud, result.labels, result.raw));
    CHECK_FALSE(pieces.empty());
    for (const Fruit& f : result.fruits) pieces = pick::pieces_beyond(pick::kRim, pick::occupied(f), pieces);
    for (const Fruit& f : result.fruits) {
      const double here = pick::crossed_surface(pieces, pick::occupied(f), {f.picking->direction}, p.picking).front();
      CHECK(f.picking->crossed == Approx(here));
      CHECK(f.picking->reachable);
      crossed[careful] += here;
    }
  }
  CHECK(crossed[0] > 1e-4);
  CHECK(crossed[1] < 0.3 * crossed[0]);
}

TEST_CASE("a camera without intrinsics is refused") {
  Workcell w = cell();
  w.sensor = {};
  CHECK_THROWS_WITH(Pipeline(w), test::says("sensor.intrinsics.width"));
}

TEST_CASE("the picking can be left out") {
  Parameters p;
  p.max_views = 3;
  p.planner = "fixed";
  p.picking.enabled = false;
  const ScanResult result = run(p, no_fault, never);
  CHECK_FALSE(result.fruits.empty());
  for (const Fruit& f : result.fruits) CHECK_FALSE(f.picking);
}

TEST_CASE("faults of a robot do not end a scan") {
  check_found(run(
      {},
      [](int v, sensor::DepthFrame& f) {
        if (v == 1) std::fill(f.depth.begin(), f.depth.end(), 0.0f);
      },
      never));
  check_found(run(
      {},
      [](int v, sensor::DepthFrame& f) {
        if (v == 0) std::fill(f.depth.begin(), f.depth.end(), std::nanf(""));
      },
      never));
  int refusals = 0;
  check_found(run(
      {}, no_fault, [](int asked) { return asked % 3 == 1; }, &refusals));
  CHECK(refusals > 0);
}

TEST_CASE("frames from other poses than the commanded ones, and a truss that moves, do not end a scan") {
  const Workcell w = cell();
  for (const bool moves : {false, true}) {
    INFO((moves ? "truss moves" : "other poses"));
    Pipeline pipeline(w);
    Joints joints = w.start;
    std::vector<Sphere> fruit = test::kThreeFruit;
    while (const auto next = pipeline.next_view(joints)) {
      joints = *next->joints;
      Pose pose = next->world_T_optical;
      if (!moves) pose = pose * pose_from_xyz_rpy({0.03, -0.02, 0.01}, {deg(4), deg(-3), deg(10)});
      if (moves && pipeline.views().size() == 2)
        for (Sphere& s : fruit) s.center += Eigen::Vector3d(0.0015, 0.001, -0.001);
      pipeline.observe(test::render(fruit, w.sensor.intrinsics, pose, 0.001, pipeline.views().size() + 1), pose,
                       joints);
    }
    const ScanResult result = pipeline.result();
    CHECK(result.stop_reason != StopReason::not_stopped);
    CHECK(result.fruits.size() == fruit.size());
    for (const Sphere& s : fruit) {
      double best = 1.0;
      for (const Fruit& f : result.fruits)
        if (f.body) best = std::min(best, (f.body->center - s.center).norm());
      CHECK(best < 0.003);
    }
  }
}

TEST_CASE("the planner says how complete the scan is") {
  const Workcell w = cell();
  Pipeline pipeline(w);
  CHECK_FALSE(pipeline.completeness());
  Joints joints = w.start;
  std::vector<double> seen;
  while (const auto next = pipeline.next_view(joints)) {
    if (const auto c = pipeline.completeness()) {
      CHECK(c->seen <= c->observable);
      CHECK(c->observable <= 1.0);
      seen.push_back(c->seen);
    }
    joints = *next->joints;
    pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), next->world_T_optical,
                     joints);
  }
  const ScanResult result = pipeline.result();
  REQUIRE(result.completeness);
  REQUIRE(seen.size() >= 2);
  CHECK(result.completeness->seen > seen.front());
  CHECK(result.completeness->fruits.size() == test::kThreeFruit.size());
  // What points cover, counted on the true spheres.
  const KdTree<float> tree(result.raw.points);
  double covered = 0.0, all = 0.0;
  for (const Sphere& s : test::kThreeFruit)
    for (const Eigen::Vector3d& d : plan::spread_directions(2000)) {
      const double area = s.radius * s.radius;
      all += area;
      Neighbors<float> nearest;
      tree.knn((s.center + s.radius * d).cast<float>(), 1, nearest);
      if (double(nearest.front().distance) <= 0.005) covered += area;
    }
  CHECK(std::abs(result.completeness->seen - covered / all) < 0.05);
}

TEST_CASE("how complete each fruit is, is told of where the result puts it, with wrong poses too") {
  const Workcell w = cell();
  Parameters parameters;
  parameters.max_views = 6;
  Pipeline pipeline(w, parameters);
  Joints joints = w.start;
  while (const auto next = pipeline.next_view(joints)) {
    joints = *next->joints;
    const std::size_t number = pipeline.views().size();
    Pose reported = next->world_T_optical;
    if (number > 0) reported.pretranslate(Eigen::Vector3d(0.003, 0.0, 0.0));  // the first view is what others fit to
    pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical, 0.0005, number + 1),
                     reported);
  }
  const ScanResult result = pipeline.result();
  REQUIRE(result.completeness);
  REQUIRE(result.fruits.size() == test::kThreeFruit.size());
  for (const Fruit& fruit : result.fruits) {
    double nearest = 1.0;
    for (const Completeness::Part& part : result.completeness->fruits)
      nearest = std::min(nearest, (part.center - fruit.body->center).norm());
    CHECK(nearest < 0.001);
  }
}

TEST_CASE("every planner terminates within its budget") {
  for (const char* name : {"gain", "see", "fixed", "random"}) {
    for (Parameters p : {Parameters{}, Parameters::paper()}) {
      INFO(name << " " << p.preset);
      p.planner = name;
      p.max_views = 5;
      const ScanResult result = run(p, no_fault, never);
      CHECK(result.views.size() <= 5);
      CHECK(result.views.size() >= 1);
      if (p.planner != "see") CHECK(result.views.size() >= 2);  // SEE++ may find no core point in a coarse cloud
      CHECK(result.stop_reason != StopReason::not_stopped);
    }
  }
}

TEST_CASE("every planner that is asked twice offers the same view until it is taken or refused") {
  for (const char* name : {"gain", "see", "fixed", "random"}) {
    INFO(name);
    Parameters p;
    p.planner = name;
    p.max_views = 4;
    p.see.rho = 5e5;  // else SEE++ finds no core point in so coarse a cloud, and ends after one view
    const Workcell w = cell();
    Pipeline pipeline(w, p);
    Joints joints = w.start;
    int others = 0;  // offered after a refusal
    for (int step = 0; step < 8; ++step) {
      const auto next = pipeline.next_view(joints), again = pipeline.next_view(joints);
      REQUIRE(next.has_value() == again.has_value());
      if (!next) break;
      CHECK(again->world_T_optical.matrix() == next->world_T_optical.matrix());
      CHECK(*again->joints == *next->joints);
      CHECK(again->gain == next->gain);
      if (step % 3 == 1) {
        pipeline.refused();
        const auto other = pipeline.next_view(joints);
        CHECK((!other || other->world_T_optical.matrix() != next->world_T_optical.matrix()));
        others += other.has_value();
        continue;
      }
      joints = *next->joints;
      pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical, 0.001),
                       next->world_T_optical, joints);
    }
    CHECK(pipeline.views().size() >= 2);
    CHECK(others >= 1);
  }
}

TEST_CASE("the paper's stages on the paper's values") {
  Parameters p = Parameters::paper();
  p.max_views = 4;
  const ScanResult result = run(p, no_fault, never);
  CHECK(result.views.size() == 4);
  CHECK(result.cloud.size() > 500);
  CHECK(result.cloud.size() < result.raw.size());
  for (const Fruit& f : result.fruits) {
    CHECK_FALSE(f.body);
    CHECK_FALSE(f.picking);
    CHECK(f.pose().translation() == f.centroid);
  }
}

TEST_CASE("a truss out of reach and one that is not there are said to be so") {
  Workcell far = cell();
  far.world_T_base.translation() = Eigen::Vector3d(3.0, 3.0, 0.0);
  far.keep_out.clear();
  Pipeline pipeline(far);
  CHECK_FALSE(pipeline.next_view(far.start));
  CHECK(pipeline.stop_reason() == StopReason::no_reachable_view);
  CHECK(pipeline.result().fruits.empty());

  const ScanResult nothing = run(
      {}, [](int, sensor::DepthFrame& f) { std::fill(f.depth.begin(), f.depth.end(), 0.0f); }, never);
  CHECK(nothing.stop_reason == StopReason::nothing_seen);
  CHECK_THAT(why_no_fruit(nothing), test::says("the views show no return at all"));
  CHECK(nothing.fruits.empty());
}

TEST_CASE("what cannot be observed is refused and what was seen is kept") {
  const Workcell w = cell();
  Pipeline pipeline(w);
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), next->world_T_optical,
                   next->joints);
  const std::size_t merged = pipeline.merged().size();
  CHECK(merged > 100);
  sensor::DepthFrame broken;
  CHECK_THROWS_AS(pipeline.observe(broken, next->world_T_optical), InputError);
  Pose skewed = next->world_T_optical;
  skewed.translation().x() = std::nan("");
  CHECK_THROWS_AS(pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), skewed),
                  InputError);
  CHECK_THROWS_AS(pipeline.next_view(Joints::Constant(std::nan(""))), InputError);
  CHECK(pipeline.merged().size() == merged);
  CHECK(pipeline.views().size() == 1);
  Workcell empty = w;
  empty.scan_volume = Aabb();
  CHECK_THROWS_AS(Pipeline(empty), InputError);
  Parameters bad;
  bad.planner = "oracle";
  CHECK_THROWS_AS(Pipeline(w, bad), ParameterError);
}

TEST_CASE("poses that a calibration tool has rounded are made rigid, and the result says so") {
  const auto rounded = [](const Pose& pose) {
    Pose out = pose;
    out.matrix() = (pose.matrix() * 1e4).array().round() * 1e-4;
    return out;
  };
  Workcell w = cell();
  w.tool0_T_optical = rounded(pose_from_xyz_rpy({0, 0.02, 0.04}, {0.1, -0.2, 0.3}));
  REQUIRE_FALSE(is_rigid(w.tool0_T_optical));
  Pipeline pipeline(w);
  CHECK(is_rigid(pipeline.workcell().tool0_T_optical));
  REQUIRE(pipeline.warnings().size() == 1);
  CHECK_THAT(pipeline.warnings()[0], test::says("tool0_T_optical: its rotation matrix was off by"));
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  const Pose reported = rounded(next->world_T_optical);
  pipeline.observe(test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical), reported);
  CHECK(is_rigid(pipeline.views()[0].world_T_optical));
  const ScanResult result = pipeline.result();
  REQUIRE(result.warnings.size() == 2);
  CHECK_THAT(result.warnings[1], test::says("world_T_optical of 1 of 1 views"));
  w.tool0_T_optical.linear() *= 1.01;
  CHECK_THROWS_WITH(Pipeline(w), test::says("tool0_T_optical is not a rigid transform"));
  CHECK(Pipeline(cell()).warnings().empty());
}

TEST_CASE("millimetres and degrees are refused, and the likely cause is named") {
  const Workcell w = cell();
  Pipeline pipeline(w);
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  sensor::DepthFrame frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical);
  for (float& z : frame.depth) z *= 1000.0f;
  CHECK_THROWS_WITH(pipeline.observe(frame, next->world_T_optical), test::says("is it in millimetres"));
  for (float& z : frame.depth) z *= 1e-6f;
  CHECK_THROWS_WITH(pipeline.observe(frame, next->world_T_optical), test::says("once more"));
  CHECK_THROWS_AS(pipeline.observe(frame, next->world_T_optical), InputError);
  CHECK(pipeline.views().empty());
  for (float& z : frame.depth) z *= 1000.0f;
  CHECK_NOTHROW(pipeline.observe(frame, next->world_T_optical));
  const Joints degrees = w.start / deg(1);
  CHECK_THROWS_WITH(pipeline.next_view(degrees), test::says("are the angles in degrees?"));
  CHECK_NOTHROW(pipeline.next_view((Joints() << 6.5, -1.57, 1.57, -1.57, -1.57, 0.0).finished()));
  Workcell turned = w;
  turned.start = degrees;
  CHECK_THROWS_WITH(Pipeline(turned), test::says("start: joint 2 is"));
  PipelineOptions own;
  own.reach = [](const plan::ViewRequest&, const Joints&) { return std::optional<plan::ReachableView>(); };
  CHECK_NOTHROW(Pipeline(turned, {}, std::move(own)));  // only this robot knows what its joints mean
  Workcell large = w;
  large.scan_volume.max *= 1000.0;
  CHECK_THROWS_WITH(Pipeline(large), test::says("is it in millimetres?"));
}

TEST_CASE("joints that cannot be are refused, and those of another posture than the pose's are told") {
  const Workcell w = cell();
  Pipeline pipeline(w);
  const auto next = pipeline.next_view(w.start);
  REQUIRE(next);
  const sensor::DepthFrame frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical);
  CHECK_THROWS_WITH(pipeline.observe(frame, next->world_T_optical, Joints(*next->joints / deg(1))),
                    test::says("observe: joint"));
  CHECK_THROWS_WITH(pipeline.observe(frame, next->world_T_optical, Joints(Joints::Constant(std::nan("")))),
                    test::says("observe: the joints are not finite"));
  CHECK(pipeline.views().empty());
  pipeline.observe(frame, next->world_T_optical, next->joints);
  pipeline.observe(frame, next->world_T_optical);  // of joints that are not known there is nothing to say
  CHECK(pipeline.warnings().empty());
  pipeline.observe(frame, next->world_T_optical, Joints(Joints::Zero()));
  REQUIRE(pipeline.result().warnings.size() == 1);
  CHECK_THAT(pipeline.result().warnings[0], test::says("by the joints of 1 of 3 views the sensor was up to"));
  Pipeline turned(w);
  Pose pose = next->world_T_optical;
  pose.rotate(Eigen::AngleAxisd(deg(6.0), Eigen::Vector3d::UnitZ()));
  turned.observe(frame, pose, next->joints);
  REQUIRE(turned.warnings().size() == 1);
  CHECK_THAT(turned.warnings()[0], test::says("and 6 degrees away from the reported pose"));
  PipelineOptions own;
  own.reach = [](const plan::ViewRequest&, const Joints&) { return std::optional<plan::ReachableView>(); };
  Pipeline other(w, {}, std::move(own));  // only this robot knows what its joints mean
  other.observe(frame, next->world_T_optical, Joints(Joints::Constant(90.0)));
  CHECK(other.warnings().empty());
}

TEST_CASE("an external robot's own reach replaces ours") {
  const Workcell w = cell();
  int asked = 0;
  PipelineOptions options;
  options.reach = [&](const plan::ViewRequest& request, const Joints&) -> std::optional<plan::ReachableView> {
    ++asked;
    if (request.direction.y() < 0.5) return std::nullopt;
    plan::ReachableView view;
    view.target = request.target;
    view.world_T_optical = look_along(request.target - request.distance * request.direction, request.direction);
    return view;
  };
  Pipeline pipeline(w, {}, std::move(options));
  std::size_t taken = 0;
  while (const auto next = pipeline.next_view(Joints::Zero())) {
    CHECK(next->world_T_optical.linear().col(2).y() >= 0.5 - 1e-9);
    std::vector<Eigen::Vector3f> points;  // this robot's sensor gives plain points
    const auto frame = test::render(test::kThreeFruit, w.sensor.intrinsics, next->world_T_optical);
    for (int v = 0; v < frame.intrinsics.height; ++v)
      for (int u = 0; u < frame.intrinsics.width; ++u)
        if (frame.at(u, v) > 0) points.push_back(frame.point(u, v));
    pipeline.observe_points(points, next->world_T_optical);
    REQUIRE(++taken <= 15);
  }
  CHECK(asked > 0);
  check_found(pipeline.result());
  for (const Fruit& f : pipeline.result().fruits)  // nothing is known of how this robot picks
    CHECK(f.picking->reason == PickingReason::not_tested);
  CHECK_FALSE(pipeline.views()[0].joints);
}

TEST_CASE("ready clouds: nothing, little and degenerate clouds give no fruit") {
  CHECK(process(Cloud{}).fruits.empty());
  for (const int n : {1, 2, 3, 300}) {
    Cloud same, line;
    for (int i = 0; i < n; ++i) {
      same.points.emplace_back(0.1f, 0.2f, 0.3f);
      line.points.emplace_back(0.001f * static_cast<float>(i), 0.0f, 0.0f);
    }
    CHECK(process(same).fruits.empty());
    CHECK(process(line).fruits.empty());
    same.points.emplace_back(std::nanf(""), 0.0f, 0.0f);
    CHECK(process(same).fruits.empty());
    CHECK(process(line, Parameters::paper()).fruits.empty());
  }
}

}  // namespace pipeline_test
