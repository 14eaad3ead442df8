// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How many of the bodies proposed in a cloud were taken as fruit, and why the others were rejected.
#pragma once

#include <cstddef>

namespace agrisee {

/// Numbers of proposed bodies by outcome. Each distinct body is counted once, by the first test that it fails; a body
/// whose points went to a better one is not counted.
struct BodyCounts {
  std::size_t taken = 0;         ///< reported as fruit
  std::size_t too_small = 0;     ///< below the expected radii
  std::size_t too_large = 0;     ///< above the expected radii; this includes flat parts
  std::size_t inside_out = 0;    ///< the normals of its points face inwards
  std::size_t little_seen = 0;   ///< points cover too little of its surface (`split.bodies.min_coverage`)
  std::size_t contradicted = 0;  ///< points lie inside it, or sight lines pass through it
  std::size_t too_flat = 0;      ///< flat, ridge-like (`split.bodies.min_roundness`), or a part of something larger
  std::size_t doubtful = 0;      ///< probability of a fruit too low (`split.bodies.min_confidence`)
  std::size_t overlapping = 0;   ///< it penetrates a better body too deeply (`split.bodies.max_overlap`)
  std::size_t not_fitted = 0;    ///< no ellipsoid fits its points

  /// Number of bodies that were not taken.
  std::size_t rejected() const {
    return too_small + too_large + inside_out + little_seen + contradicted + too_flat + doubtful + overlapping +
           not_fitted;
  }

  /// f(name, field) for every count.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("taken", p.taken);
    f("too_small", p.too_small);
    f("too_large", p.too_large);
    f("inside_out", p.inside_out);
    f("little_seen", p.little_seen);
    f("contradicted", p.contradicted);
    f("too_flat", p.too_flat);
    f("doubtful", p.doubtful);
    f("overlapping", p.overlapping);
    f("not_fitted", p.not_fitted);
  }
};

}  // namespace agrisee
