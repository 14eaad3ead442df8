// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The whole method in one include: the pipeline, and its stages to be called one by one. Not included: files (io/),
/// simulation and evaluation (study/), other libraries' types (interop/).
#pragma once

#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/fuse/fused_views.hpp>
#include <agrisee/fuse/merged_views.hpp>
#include <agrisee/locate.hpp>
#include <agrisee/pick/arm_approach.hpp>
#include <agrisee/pick/picking.hpp>
#include <agrisee/pick/surroundings.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/planners.hpp>
#include <agrisee/process.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>
#include <agrisee/trusses.hpp>
#include <agrisee/version.hpp>
