// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/pose.hpp>
#include <agrisee/study/free_flight.hpp>

namespace agrisee::study {

plan::Reach free_flight() {
  return [](const plan::ViewRequest& request, const Joints&) -> std::optional<plan::ReachableView> {
    const Eigen::Vector3d z = request.direction.normalized();
    Eigen::Vector3d down = -Eigen::Vector3d::UnitZ() + z.z() * z;
    if (!(down.norm() > 1e-6)) down = any_orthogonal<double>(z);
    const Eigen::Vector3d y = down.normalized();
    plan::ReachableView view;
    view.world_T_optical.linear() << y.cross(z), y, z;
    view.world_T_optical.translation() = request.target - request.distance * z;
    view.target = request.target;
    return view;
  };
}

}  // namespace agrisee::study
