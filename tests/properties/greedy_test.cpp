// SPDX-License-Identifier: BSD-3-Clause
// The views of the planner that knows the truth, in random workcells and from random joints, checked by an independent
// verifier.
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/greedy_planner.hpp>

#include "properties/cells.hpp"
#include "support/shapes.hpp"

using namespace agrisee;

TEST_CASE("the greedy planner: every proposed view passes an independent check") {
  int proposed = 0;
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    INFO("seed " << seed);
    const cells::Cell cell = cells::random_cell(seed);
    const arm::Mount mount = plan::mount_of(cell.workcell);
    study::Scene scene;
    study::Samples samples;
    for (const auto& f : cell.fruit) {
      const int id = static_cast<int>(scene.objects.size()) + 1;
      scene.objects.push_back({id, study::ObjectClass::fruit, shapes::sphere(f.center, f.radius, 16)});
      Rng rng(seed, std::uint64_t(id));
      for (int i = 0; i < 60; ++i) {
        const Eigen::Vector3d d = rng.direction();
        samples.points.push_back((f.center + 1.0005 * f.radius * d).cast<float>());
        samples.normals.push_back(d.cast<float>());
        samples.fruit.push_back(id);
      }
    }
    const study::TracedScene traced(scene);
    study::LimitParameters limits;
    limits.candidates = 150;
    auto planner = study::make_greedy_planner(traced, samples, cell.workcell, limits);
    const auto reach = plan::reach_of(cell.workcell);
    const Cloud cloud;
    const std::vector<sensor::SurfaceImage> images;
    const std::vector<View> views;
    const std::vector<Eigen::Vector3f> added;
    const plan::Progress progress{cloud, images, views, added, added};
    Rng rng(seed, 2);
    Joints joints = cells::random_joints(rng);
    for (int step = 0; step < 12; ++step) {
      const auto view = planner->next(progress, joints, reach);
      if (!view) break;
      ++proposed;
      cells::check_view(*view, cell.workcell, mount, joints);
      if (step % 4 == 3) {
        planner->refused();
        joints = cells::random_joints(rng);
      } else {
        planner->observe(progress);
        joints = *view->joints;
      }
    }
  }
  CHECK(proposed > 15);
}

TEST_CASE("reach: answers to random requests from random joints pass an independent check") {
  int met = 0;
  for (std::uint64_t seed = 40; seed < 70; ++seed) {
    const cells::Cell cell = cells::random_cell(seed);
    const arm::Mount mount = plan::mount_of(cell.workcell);
    const auto reach = plan::reach_of(cell.workcell);
    Rng rng(seed, 3);
    for (int i = 0; i < 40; ++i) {
      INFO("seed " << seed << ", request " << i);
      plan::ViewRequest request;
      request.target = cell.workcell.world_T_base *
                       Eigen::Vector3d(rng.uniform(-0.7, 0.7), rng.uniform(-0.7, 0.7), rng.uniform(-0.3, 0.8));
      request.direction = rng.direction();
      const Joints joints = cells::random_joints(rng);
      const auto view = reach(request, joints);
      if (!view) continue;
      ++met;
      cells::check_view(*view, cell.workcell, mount, joints);
      const double distance = (view->world_T_optical.translation() - request.target).norm();
      REQUIRE(distance >= request.distance_min - 1e-9);
      REQUIRE(distance <= request.distance_max + 1e-9);
      REQUIRE((view->world_T_optical.linear().col(2) - request.direction).norm() < 1e-9);
    }
  }
  CHECK(met > 200);
}
