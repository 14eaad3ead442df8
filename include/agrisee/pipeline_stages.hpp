// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a Pipeline asks of the costly stages, a function each, so that they can be compiled apart (core/compiled.hpp).
#pragma once

#include <agrisee/cloud/icp_parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/compiled.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/plan/approach.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/result.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/surface_image.hpp>
#include <agrisee/workcell.hpp>

#include <optional>
#include <vector>

namespace agrisee::detail {
inline namespace AGRISEE_ABI {

/// sensor::reconstruct_surface.
AGRISEE_INLINE sensor::SurfaceImage surface_of(const sensor::DepthFrame& frame, const Pose& world_T_optical,
                                               const Aabb& volume, const sensor::SurfaceParameters& parameters,
                                               int threads);
/// What register_cloud finds, where it is accepted.
AGRISEE_INLINE std::optional<Pose> registered(const Cloud& source, const Cloud& target,
                                              const IcpParameters& parameters);
/// remove_statistical_outliers.
AGRISEE_INLINE Indices without_outliers(const Cloud& cloud, const SorParameters& parameters, int threads);
/// plan::reach_of.
AGRISEE_INLINE plan::Reach ur3_reach(const Workcell& workcell);
/// plan::approach_of a gripper ahead of the sensor.
AGRISEE_INLINE plan::ReachApproach ur3_approach(const Workcell& workcell, const plan::PickingParameters& parameters);
/// plan::plan_picking of a result's fruit, the robot standing at `eye` and its arm at `joints`.
AGRISEE_INLINE std::vector<Picking> picking_of(const ScanResult& result, const std::vector<KeepOut>& keep_out,
                                               const Eigen::Vector3d& eye, const Joints& joints,
                                               const plan::ReachApproach& approach,
                                               const plan::PickingParameters& parameters);

}  // namespace AGRISEE_ABI
}  // namespace agrisee::detail

#ifndef AGRISEE_COMPILED
#include <agrisee/pipeline_stage_bodies.hpp>
#endif
