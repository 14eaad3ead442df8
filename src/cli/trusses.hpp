// SPDX-License-Identifier: BSD-3-Clause
// The trusses that the commands know by name.
#pragma once

#include <agrisee/study/truss.hpp>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Names of the eleven trusses of study::kPaperTrusses, in their order: truss_05_1 and so on.
std::vector<std::string> paper_truss_names();

/// The truss of a name. truss_07_1 and 7_1 are the truss of study::kPaperTrusses with 7 fruit, 1 of them hidden;
/// truss_07_1_s5 and 7_1_s5 are a generated truss with the same numbers, from seed 5. The workcell of the truss gets
/// the long name. None if the text is not such a name.
/// @throws UsageError if there is no paper truss with these numbers, or no truss can be generated with them
std::optional<study::Truss> truss_by_name(const std::string& name);

/// Note the name of a scene. @param text what named the scene  @throws UsageError if another one has the name
void take_scene_name(std::set<std::string>& names, const std::string& name, const std::string& text);

/// Write scene.yaml, ground_truth.json and the meshes. @throws FileError
void write_truss(const std::filesystem::path& folder, const study::Truss& truss);

}  // namespace agrisee::cli
