// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The functions that pipeline_stages.hpp declares.
#pragma once

#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/pipeline_stages.hpp>
#include <agrisee/plan/arm_approach.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/picking.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

namespace agrisee::detail {
inline namespace AGRISEE_ABI {

AGRISEE_INLINE sensor::SurfaceImage surface_of(const sensor::DepthFrame& frame, const Pose& world_T_optical,
                                               const Aabb& volume, const sensor::SurfaceParameters& parameters,
                                               int threads) {
  return sensor::reconstruct_surface(frame, world_T_optical, volume, parameters, threads);
}

AGRISEE_INLINE std::optional<Pose> registered(const Cloud& source, const Cloud& target,
                                              const IcpParameters& parameters) {
  const IcpResult icp = register_cloud(source, source.normals, target, target.normals, parameters);
  return icp.accepted ? std::optional(icp.target_T_source) : std::nullopt;
}

AGRISEE_INLINE Indices without_outliers(const Cloud& cloud, const SorParameters& parameters, int threads) {
  return remove_statistical_outliers(cloud, parameters, threads);
}

AGRISEE_INLINE plan::Reach ur3_reach(const Workcell& workcell) { return plan::reach_of(workcell); }

AGRISEE_INLINE plan::ReachApproach ur3_approach(const Workcell& workcell, const plan::PickingParameters& parameters) {
  const Pose tool0_T_tool = workcell.tool0_T_optical * Eigen::Translation3d(0.0, 0.0, parameters.tool_length);
  return plan::approach_of(plan::mount_of(workcell), tool0_T_tool, parameters);
}

AGRISEE_INLINE std::vector<Picking> picking_of(const ScanResult& result, const std::vector<KeepOut>& keep_out,
                                               const Eigen::Vector3d& eye, const Joints& joints,
                                               const plan::ReachApproach& approach,
                                               const plan::PickingParameters& parameters) {
  return plan::plan_picking(result.fruits,
                            {keep_out, eye, joints, plan::seen_directions(result.cloud, result.labels, result.fruits)},
                            approach, parameters);
}

}  // namespace AGRISEE_ABI
}  // namespace agrisee::detail
