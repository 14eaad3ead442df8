// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The version of the library, stated here once; CMake and the packages read it from this line.
#pragma once

/// The version, stated here alone.
#define AGRISEE_VERSION "0.2.0"
