// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/pipeline_stage_bodies.hpp>
