// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sor.hpp>
#include <agrisee/fuse/merged_views.hpp>

#include <utility>

namespace agrisee::fuse {

MergedViews::MergedViews(const Aabb& scan_volume, double separation, const std::optional<SorParameters>& filter,
                         int threads)
    : scan_volume_(scan_volume), filter_(filter), threads_(threads), points_(separation) {}

Observation MergedViews::look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const {
  check(frame);
  check_input(is_rigid(world_T_optical), "look: the pose of the camera is not a rigid transform");
  Observation out;
  out.surface.world_T_optical = world_T_optical;
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      if (!sensor::DepthFrame::valid(frame.at(u, v))) continue;
      const Eigen::Vector3f p = (world_T_optical * frame.point(u, v).cast<double>()).cast<float>();
      if (scan_volume_.contains(p)) out.surface.points.push_back(p);
    }
  out.surface.points_in = out.surface.points.size();
  return out;
}

Change MergedViews::take(Observation seen, const Pose&) {
  const int view = static_cast<int>(discarded_.size());
  discarded_.push_back(false);
  Change change;
  change.points_in = seen.surface.points_in;
  for (const Eigen::Vector3f& p : seen.surface.points) {
    if (!points_.add(p, view)) continue;
    change.added.push_back(p);
    all_.points.push_back(p);
    all_.views.push_back(view);
  }
  change.observed = std::move(seen.surface.points);
  return change;
}

Change MergedViews::skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) {
  discarded_.push_back(true);
  Change change;
  change.points_in = count_inside(frame, world_T_optical, scan_volume_);
  return change;
}

void MergedViews::filter(Change& change) {
  if (!filter_ || points_.cloud().empty()) return;
  change.kept = remove_statistical_outliers(points_.cloud(), *filter_, threads_);
  points_.keep(*change.kept);
}

}  // namespace agrisee::fuse
