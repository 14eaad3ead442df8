// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grows the other parts of a truss around its fruit: rachis, pedicels, calyces and leaflets. Of several random
/// candidates for a part, the one that interpenetrates the fruit least is taken. World frame, metres.
#pragma once

#include "truss_layout.hpp"

namespace agrisee::study {

/// Makes one mesh of the rachis, the peduncle that it hangs from, and all pedicels and calyces.
Mesh stem_mesh(const TrussLayout& layout, Rng& rng);

/// Appends the pedicel of every fruit, from its calyx to the rachis, and its calyx.
/// @param stem receives them
/// @param layout of the truss
/// @param radius the pedicels have 0.75 of it at the fruit and 0.6 at the rachis (m)
/// @param calyces whether the fruit have sepals
/// @param rng random numbers
void append_pedicels(Mesh& stem, const TrussLayout& layout, double radius, bool calyces, Rng& rng);

/// Makes a leaflet with its stalk. It grows from the upper part of the rachis, in a direction that is free of fruit.
/// @param layout of the truss
/// @param size radius of a fruit, which scales the leaflet (m)
/// @param rng random numbers
Mesh leaflet_mesh(const TrussLayout& layout, double size, Rng& rng);

}  // namespace agrisee::study
