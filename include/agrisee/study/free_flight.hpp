// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A camera that flies: it takes every view, as the sensor of SEE++'s own experiments does. World frame, metres.
#pragma once

#include <agrisee/plan/planner.hpp>

namespace agrisee::study {

/// Grants every request at its preferred distance, with the image upright. The joints are left empty, and moves
/// take no time.
plan::Reach free_flight();

}  // namespace agrisee::study
