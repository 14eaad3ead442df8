// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All of the library but files (io/), studies (study/) and other libraries' types (interop/).
#pragma once

#include <agrisee/pipeline.hpp>
#include <agrisee/version.hpp>
