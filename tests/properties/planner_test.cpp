// SPDX-License-Identifier: BSD-3-Clause
// Every view that a planner proposes, and every pick that is said to be reachable, in random cells and from random
// postures, re-checked by a verifier of its own.
#include <agrisee/pipeline.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include "properties/cells.hpp"

using namespace agrisee;

namespace {

/// All that a reachable pick promises: the tool's pose and, at the steps of the approach, joints within the limits, no
/// part in a space that counts for the fruit, in the arm, or in another fruit that may hang there.
void check_pick(const Fruit& fruit, const std::vector<Fruit>& all, const Workcell& w,
                const pick::PickingParameters& p) {
  const Picking& pick = *fruit.picking;
  REQUIRE(pick.joints);
  arm::Mount mount = plan::mount_of(w);
  mount.keep_out.clear();
  for (const KeepOut& space : w.keep_out) {
    const Eigen::Vector3d& c = fruit.body->center;
    if (verify::depth(space, {c.x(), c.y(), c.z()}) < 0.0) mount.keep_out.push_back(space);
  }
  std::vector<OrientedEllipsoid> others;
  for (const Fruit& other : all)
    if (other.id != fruit.id && std::find(pick.after.begin(), pick.after.end(), other.id) == pick.after.end())
      others.push_back({other.body->center, other.body->radii, other.body->axes});
  const Pose tool0_T_tool = w.tool0_T_optical * Eigen::Translation3d(0, 0, p.tool_length);
  const Pose base_T_world = w.world_T_base.inverse(), tool_T_tool0 = tool0_T_tool.inverse();
  Joints q = *pick.joints;
  for (int i = 0; i <= p.steps; ++i) {
    INFO("step " << i << " of " << p.steps);
    Pose tool = pick.world_T_pre_grasp;
    tool.translation() += double(i) / p.steps * (p.stand_off - p.contact) * pick.direction;
    // The posture nearest to the last; that it is one at all, and free, is for the verifier to say.
    std::optional<Joints> next;
    double least = p.max_joint_step;
    for (const Joints& solution : arm::inverse(base_T_world * tool * tool_T_tool0, mount.model.limits, q[5]))
      if (const auto near = arm::nearest(solution, q, mount.model.limits))
        if (const double turn = (*near - q).cwiseAbs().maxCoeff(); turn < least) least = turn, next = near;
    REQUIRE(next);
    if (i == 0) REQUIRE((*next - q).cwiseAbs().maxCoeff() < 1e-6);
    q = *next;
    const auto stands = verify::times(verify::times(verify::matrix_of(w.world_T_base), verify::links(q)[5]),
                                      verify::matrix_of(tool0_T_tool));
    REQUIRE(verify::difference(stands, verify::matrix_of(tool)) < 1e-8);
    REQUIRE(verify::fault_of(q, mount, others) == "");
  }
  // And it ends at the fruit: on the line to the center, `contact` before the surface.
  const Eigen::Vector3d end = pick.world_T_pre_grasp.translation() + (p.stand_off - p.contact) * pick.direction;
  const Eigen::Vector3d from_center = fruit.body->axes.transpose() * (end - fruit.body->center);
  REQUIRE(from_center.cwiseQuotient(fruit.body->radii).norm() == Approx(1.0).margin(1e-6));
}

}  // namespace

TEST_CASE("planners: all that is proposed stands up to an independent check") {
  const std::string planner = GENERATE("gain", "see", "fixed", "random");
  INFO(planner);
  int proposed = 0, picks = 0;
  for (std::uint64_t seed = 0; seed < 14; ++seed) {
    INFO("seed " << seed);
    cells::Cell cell = cells::random_cell(seed);
    if (planner == "see")  // which sees no frontiers in thin clouds
      cell.workcell.sensor.intrinsics = sensor::intrinsics_from_fov(400, 300, deg(70), deg(55));
    const arm::Mount mount = plan::mount_of(cell.workcell);
    Parameters parameters;
    parameters.planner = planner;
    parameters.max_views = 6;
    PipelineOptions options;
    options.seed = seed;
    Pipeline pipeline(cell.workcell, parameters, std::move(options));
    Rng rng(seed, 1);
    Joints joints = cells::random_joints(rng);
    for (int step = 0; step < 8; ++step) {
      const auto view = pipeline.next_view(joints);
      if (!view) break;
      ++proposed;
      cells::check_view(*view, cell.workcell, mount, joints);
      for (const auto& other : pipeline.candidates()) {  // found from where the arm stood at one time or another
        plan::ReachableView same = other;
        same.move_time = arm::move_time(joints, *other.joints);
        cells::check_view(same, cell.workcell, mount, joints);
        ++proposed;
        if (proposed % 7) break;  // the best of them, and now and then all
      }
      if (rng.uniform() < 0.2) {
        pipeline.refused();
        if (rng.uniform() < 0.5) joints = cells::random_joints(rng);
        continue;
      }
      joints = *view->joints;
      pipeline.observe(test::render(cell.fruit, cell.workcell.sensor.intrinsics, view->world_T_optical, 3e-4, seed),
                       view->world_T_optical, joints);
      if (rng.uniform() < 0.3) joints = cells::random_joints(rng);  // moved by someone else
    }
    const ScanResult result = pipeline.result();
    for (const Fruit& fruit : result.fruits) {
      REQUIRE(fruit.picking);
      if (!fruit.picking->reachable) continue;
      ++picks;
      check_pick(fruit, result.fruits, cell.workcell, parameters.picking);
    }
  }
  CHECK(proposed > 30);
  CHECK(picks > 5);
}
