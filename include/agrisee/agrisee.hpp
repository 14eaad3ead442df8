// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All of the library but files (io/), studies (study/) and other libraries' types (interop/): the pipeline, and the
/// stages to be called one by one.
#pragma once

#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/plan/arm_approach.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/picking.hpp>
#include <agrisee/planner_by_name.hpp>
#include <agrisee/process_stages.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>
#include <agrisee/version.hpp>
