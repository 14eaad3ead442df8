// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Searches for a truss whose fruit are visible or hidden as requested.
#pragma once

#include <functional>

#include "truss_layout.hpp"

namespace agrisee::study {

/// Draws a random layout. `spread` (0 to 1) scales how much it varies.
using LayoutDraw = std::function<TrussLayout(double spread, Rng& rng)>;

/// Draws layouts until one of them gives a truss as requested. Each attempt varies the layout less than the one before,
/// and has a random stream of its own.
/// @throws ParameterError if no attempt succeeds
Truss find_truss(const TrussParameters& parameters, const LayoutDraw& draw_layout);

}  // namespace agrisee::study
