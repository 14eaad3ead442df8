// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the fuzzers begin with: small files of every kind, most of them made by our own writers.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <string>
#include <vector>

namespace agrisee::fuzz {

struct Seed {
  std::string target, name, bytes;
};

std::vector<Seed> make_seeds();

/// A tetrahedron.
Mesh seed_mesh();

}  // namespace agrisee::fuzz
