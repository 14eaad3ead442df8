// SPDX-License-Identifier: BSD-3-Clause
// Your sensor, your motion planner, our decisions: the loop that a robot runs. Replace `grab_frame` and `move_to`.
#include <agrisee/agrisee.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/truss.hpp>

#include <iostream>

using namespace agrisee;

// Stand-ins: a simulated sensor before a truss of seven fruit, and an arm that fails now and then.
const study::Truss truss = study::make_truss({});
const study::TracedScene world(truss.scene);

sensor::DepthFrame grab_frame(const Pose& world_T_optical) {
  static std::uint64_t view = 0;
  return study::capture(world, truss.workcell.sensor, world_T_optical, study::parse_noise("l515"), 1, view++).frame;
}
bool move_to(const Joints&) {
  static int moves = 0;
  return ++moves % 5 != 0;
}

int main() {
  const Workcell& cell = truss.workcell;  // poses of base and sensor, scan volume, keep-out: see workcell.hpp
  Pipeline pipeline(cell);
  Joints joints = cell.start;
  while (const auto view = pipeline.next_view(joints)) {
    if (!move_to(*view->joints)) {
      pipeline.refused();  // the next best follows
      continue;
    }
    joints = *view->joints;
    pipeline.observe(grab_frame(view->world_T_optical), view->world_T_optical, joints);
  }
  const ScanResult result = pipeline.result();
  std::cout << result.views.size() << " views, " << to_string(result.stop_reason) << "\n";
  for (const Fruit& fruit : result.fruits)
    std::cout << "fruit " << fruit.id << " at " << fruit.pose().translation().transpose() << "\n";
  return result.fruits.size() == 7 ? 0 : 1;
}
