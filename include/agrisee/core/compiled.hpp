// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the headers alone are not wanted to be compiled: with AGRISEE_COMPILED defined, as the CMake target
/// `agrisee::compiled` does, the costly stages are declared only, and come from that library. Same results; a program
/// compiles in seconds instead of a minute.
///
/// Their names carry the alignment that Eigen gives its types: a program that is compiled for wider vectors than the
/// library (-march=native) would lay out poses otherwise, and does not link.
#pragma once

#include <Eigen/Core>

/// Two tokens as one.
#define AGRISEE_JOIN_TOKENS(a, b) a##b
/// The same, macros among them replaced first.
#define AGRISEE_JOIN(a, b) AGRISEE_JOIN_TOKENS(a, b)
/// The inline namespace of what may be compiled apart.
#define AGRISEE_ABI AGRISEE_JOIN(aligned_, EIGEN_MAX_STATIC_ALIGN_BYTES)
/// What a function is that may be compiled apart: `inline`, where it is not.
#ifdef AGRISEE_COMPILED
#define AGRISEE_INLINE
#else
#define AGRISEE_INLINE inline
#endif
