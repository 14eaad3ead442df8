// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes scene files: the workcell of the robot and the objects in it, as a YAML file beside mesh files
/// (docs/formats.md describes them). World frame, metres and radians, except the fields of view of the sensor, which
/// are in degrees.
#pragma once

#include <agrisee/study/scene.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::io {

/// The contents of a scene file.
struct SceneFile {
  Workcell workcell;                  ///< robot, sensor, scan volume and keep-out solids
  study::Scene scene;                 ///< meshes in world coordinates (m), in the order of the file
  std::vector<std::string> warnings;  ///< input that was corrected and should be checked: "<key>: ..."
};

/// Read a scene and its meshes. A mesh that is named several times is read once.
///
/// Relative paths of meshes are relative to the folder of the scene file and must not leave it by `..`; absolute paths
/// may name any file. Optional keys that are absent have the defaults of Workcell. Sizes, ids and classes are checked.
/// @throws FileError "<path>:<line>: <key>: ..." for a missing or unknown key, a value out of range, two fruits with
///   the same id, or a mesh that cannot be read or whose relative path leaves the folder
SceneFile read_scene(const std::filesystem::path& path);

/// Read a scene from the text of a scene file.
/// @param text YAML
/// @param path the file that the text stands for; messages name it, and paths of meshes are relative to its folder
/// @throws FileError as read_scene
SceneFile scene_from_yaml(const std::string& text, const std::filesystem::path& path);

/// Write a scene. Its meshes are written into the same folder, as `fruit_<id>.stl` for fruit and
/// `<class>_<number>.stl` for other objects; the scene file is written last, and each file atomically. Reading the file
/// gives the same scene, except that mesh vertices are in the order of their first use.
/// @throws InputError for a scene that the format cannot express or that read_scene would reject (such as a fruit
///   without a positive id, an empty scan volume, or a camera without intrinsics)
/// @throws FileError when a file cannot be written
void write_scene(const std::filesystem::path& path, const SceneFile& file);

}  // namespace agrisee::io
