// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Poses of frames over time, from the transforms of a recording.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/results/ros_messages.hpp"

namespace agrisee::io::ros {

/// All transforms of a recording.
class TransformTree {
 public:
  /// Add a transform. @param is_static it holds at all times
  void add(const Transform& transform, bool is_static);
  /// Sort what was added; call it before the functions below.
  void finish();
  /// The frames from `frame` up to its root, with both.
  std::vector<std::string> chain(const std::string& frame) const;
  /// world_T_frame at a time (ns), between two transforms by interpolation. None between transforms that are more than
  /// half a second apart, more than 0.2 s before the first or behind the last, before the first or behind the last if
  /// the next one is more than half a second away, or if `world` is not above `frame`.
  /// @param between none at all before the first and behind the last
  std::optional<Pose> pose(const std::string& world, const std::string& frame, std::uint64_t time,
                           bool between = false) const;

 private:
  struct Edge {
    std::string parent;
    bool is_static = false;
    std::vector<std::pair<std::uint64_t, Pose>> poses;  // parent_T_child, by time
  };
  static std::optional<Pose> at(const Edge& edge, std::uint64_t time, bool between);
  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace agrisee::io::ros
