// SPDX-License-Identifier: BSD-3-Clause
#include "io/results/transform_tree.hpp"

#include <algorithm>

namespace agrisee::io::ros {

void TransformTree::add(const Transform& transform, bool is_static) {
  Edge& edge = edges_[transform.child];
  if (edge.parent != transform.header.frame) edge = {transform.header.frame, is_static, {}};
  edge.is_static = is_static;
  if (is_static) edge.poses.clear();
  edge.poses.emplace_back(transform.header.time, transform.pose);
}

void TransformTree::finish() {
  for (auto& [child, edge] : edges_)
    std::stable_sort(edge.poses.begin(), edge.poses.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::vector<std::string> TransformTree::chain(const std::string& frame) const {
  std::vector<std::string> out{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end() && out.size() <= edges_.size();
       edge = edges_.find(out.back()))
    out.push_back(edge->second.parent);
  return out;
}

std::optional<Pose> TransformTree::at(const Edge& edge, std::uint64_t time, bool between) {
  constexpr std::uint64_t kFar = 200000000, kGap = 500000000;  // ns
  if (edge.is_static) return edge.poses.back().second;
  const auto after = std::lower_bound(edge.poses.begin(), edge.poses.end(), time,
                                      [](const auto& entry, std::uint64_t t) { return entry.first < t; });
  const bool has_after = after != edge.poses.end(), has_before = after != edge.poses.begin();
  if (has_after && after->first == time) return after->second;
  if (!has_after || !has_before) {
    const auto& only = has_after ? *after : edge.poses.back();
    const std::uint64_t away = has_after ? only.first - time : time - only.first;
    // If the neighbor is far away in time, the frame may have been moving, and still be.
    if (edge.poses.size() > 1) {
      const auto& first = has_after ? edge.poses.front() : edge.poses[edge.poses.size() - 2];
      const auto& second = has_after ? edge.poses[1] : edge.poses.back();
      if (second.first - first.first > kGap) return std::nullopt;
    }
    return away <= kFar && !between ? std::optional(only.second) : std::nullopt;
  }
  const auto& before = *(after - 1);
  if (after->first - before.first > kGap) return std::nullopt;
  const double part = static_cast<double>(time - before.first) / static_cast<double>(after->first - before.first);
  Pose out = Pose::Identity();
  out.translation() = (1.0 - part) * before.second.translation() + part * after->second.translation();
  out.linear() = quaternion(before.second.linear())
                     .slerp(part, quaternion(after->second.linear()))
                     .normalized()
                     .toRotationMatrix();
  return out;
}

std::optional<Pose> TransformTree::pose(const std::string& world, const std::string& frame, std::uint64_t time,
                                        bool between) const {
  Pose out = Pose::Identity();
  std::string at_frame = frame;
  for (std::size_t i = 0; at_frame != world; ++i) {
    const auto edge = edges_.find(at_frame);
    if (edge == edges_.end() || i > edges_.size()) return std::nullopt;
    const auto up = at(edge->second, time, between);
    if (!up) return std::nullopt;
    out = *up * out;
    at_frame = edge->second.parent;
  }
  return out;
}

}  // namespace agrisee::io::ros
