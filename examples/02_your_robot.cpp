// SPDX-License-Identifier: BSD-3-Clause
// Your sensor, your motion planner, our decisions: the loop that a robot runs. Replace the two functions at the end.
#include <agrisee/agrisee.hpp>

#include <iostream>

agrisee::sensor::DepthFrame grab_frame(const agrisee::Pose& world_T_optical);
bool move_to(const agrisee::Joints& joints);

int main() {
  agrisee::Workcell cell;  // poses of base and sensor, scan volume, keep-out: see workcell.hpp
  cell.scan_volume.extend({-0.17, 0.40, -0.02});
  cell.scan_volume.extend({0.17, 0.72, 0.42});
  cell.keep_out.push_back({"truss", agrisee::Cylinder{{0.015, 0.545, 0.21}, 0.30, 0.9}});

  agrisee::Pipeline pipeline(cell);
  agrisee::Joints joints = cell.start;
  while (const auto view = pipeline.next_view(joints)) {
    if (!move_to(*view->joints)) {
      pipeline.refused();  // the next best follows
      continue;
    }
    joints = *view->joints;
    pipeline.observe(grab_frame(view->world_T_optical), view->world_T_optical, joints);
  }
  const agrisee::ScanResult result = pipeline.result();
  std::cout << result.views.size() << " views, " << agrisee::to_string(result.stop_reason) << "\n";
  for (const agrisee::Fruit& fruit : result.fruits)
    std::cout << "fruit " << fruit.id << " at " << fruit.pose().translation().transpose() << "\n";
  return result.fruits.size() == 2 ? 0 : 1;
}

// Stand-ins: two spheres in front of an ideal sensor, and an arm that never fails.
agrisee::sensor::DepthFrame grab_frame(const agrisee::Pose& world_T_optical) {
  agrisee::sensor::DepthFrame frame;
  frame.intrinsics = agrisee::sensor::intrinsics_from_fov(320, 240, agrisee::deg(70), agrisee::deg(55));
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      const Eigen::Vector3d ray = frame.intrinsics.ray(u, v), d = world_T_optical.linear() * ray.normalized();
      double nearest = 0.0;
      for (const Eigen::Vector3d& center : {Eigen::Vector3d(-0.03, 0.54, 0.2), Eigen::Vector3d(0.06, 0.56, 0.22)}) {
        const Eigen::Vector3d c = center - world_T_optical.translation();
        const double along = c.dot(d), inside = 0.035 * 0.035 - (c.squaredNorm() - along * along);
        if (inside > 0.0 && (nearest == 0.0 || along - std::sqrt(inside) < nearest)) nearest = along - std::sqrt(inside);
      }
      frame.depth.push_back(static_cast<float>(nearest / ray.norm()));
    }
  return frame;
}

bool move_to(const agrisee::Joints&) { return true; }
