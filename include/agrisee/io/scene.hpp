// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scene files: the robot's cell and what stands in it, as YAML beside meshes (docs: scene format). Metres and radians,
/// the sensor's opening angles in degrees; `world` is the frame of everything.
#pragma once

#include <agrisee/geometry/scene.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>

namespace agrisee::io {

/// A scene file in memory.
struct SceneFile {
  Workcell workcell;  ///< all but the objects
  Scene scene;        ///< meshes in world coordinates; object i is the i-th of the file
};

/// Read a scene and its meshes (relative to the scene file; a mesh named several times is read once).
///
/// A mesh's relative path must not leave the scene's folder by `..`; an absolute one may name any file.
/// Optional keys have the defaults of Workcell. Sizes, ids and classes are checked as the scene format asks.
/// @throws FileError "<path>:<line>: <key>: ..." for a missing or unknown key, a value out of range, two fruits with
/// one id,
///   or a mesh that cannot be read or is named by a relative path out of the folder
SceneFile read_scene(const std::filesystem::path& path);

/// Write a scene; its meshes go beside it, `fruit_<id>.stl` for fruit and `<class>_<number>.stl` for the rest. Meshes
/// are written before the scene file, each file atomically. Reading it back gives the same scene (mesh vertices in the
/// order of their first use).
/// @throws InputError for what the format cannot express or would be refused by read_scene (a fruit's id, an empty
/// volume,
///   intrinsics that do not follow from opening angles...)
/// @throws FileError when a file cannot be written
void write_scene(const std::filesystem::path& path, const SceneFile& file);

}  // namespace agrisee::io
