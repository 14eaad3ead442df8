// SPDX-License-Identifier: BSD-3-Clause
// The trusses that the commands make by name.
#pragma once

#include <agrisee/study/truss.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Names of the paper's eleven trusses, in its order: truss_05_1 and so on.
std::vector<std::string> paper_truss_names();

/// The truss of a name: truss_07_1 or 7_1 is the paper's, truss_07_1_s5 or 7_1_s5 any of those counts from seed 5. Its
/// workcell is named in full. None when the text is no such name.
/// @throws UsageError for counts that the paper has no truss of, or that no truss can be made of
std::optional<study::Truss> truss_by_name(const std::string& name);

/// study::make_truss(), which takes the compiler long.
study::Truss make_truss(const study::TrussParameters& parameters);

/// Write scene.yaml, ground_truth.json and the meshes. @throws FileError
void write_truss(const std::filesystem::path& folder, const study::Truss& truss);

}  // namespace agrisee::cli
