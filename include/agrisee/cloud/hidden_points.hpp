// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The share of a cloud's points that are hidden behind others and so cannot have been seen from a given viewpoint.
/// Metres. Cost: linear in the points, to build a grid of their directions.
#pragma once

#include <agrisee/cloud/spacing.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <bitset>
#include <vector>

namespace agrisee {

/// Share (0..1) of the points of a cloud that a closed surface of other points hides from `viewpoint`.
///
/// A point is hidden if nearer points surround its direction: in each of six sectors about it one is nearer by
/// `margin`, within three spacings of the directions. A cloud of one view has hardly any such points, except in small
/// holes: points that it shows behind a surface have nearer points on one side only.
/// @param cloud points (m), any cloud type
/// @param viewpoint where a sensor may have stood (m)
/// @param margin by how much the points of the hiding surface are nearer (m), > 0; larger than the noise of the points
/// @param samples about this many points are looked at (at most twice as many), evenly spread in index order
/// @throws Cancelled
template <typename C>
double hidden_share(const C& cloud, const Eigen::Vector3d& viewpoint, double margin, std::size_t samples = 2000) {
  constexpr int kSectors = 6;
  PointCloud<float> directions;
  std::vector<double> ranges;
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
    const Eigen::Vector3d sight = point(cloud, i).template cast<double>() - viewpoint;
    const double range = sight.norm();
    if (!std::isfinite(range) || !(range > margin)) continue;
    directions.points.push_back((sight / range).cast<float>());
    ranges.push_back(range);
  }
  if (ranges.empty()) return 0.0;
  const float reach = static_cast<float>(3.0 * estimate_spacing(directions));
  if (!(reach > 0.0f)) return 0.0;
  const Grid<float> grid(directions, reach);
  std::size_t hidden = 0, looked_at = 0;
  const std::size_t step = std::max<std::size_t>(1, ranges.size() / samples);
  for (std::size_t i = 0; i < ranges.size(); i += step, ++looked_at) {
    throw_if_cancelled();
    const Eigen::Vector3f ahead = directions.points[i], right = any_orthogonal<float>(ahead), up = ahead.cross(right);
    std::bitset<kSectors> sectors;
    grid.visit(ahead, reach, [&](Index other, float) {
      const auto j = static_cast<std::size_t>(other);
      if (ranges[j] > ranges[i] - margin) return;
      const Eigen::Vector3f aside = directions.points[j] - ahead;
      const double angle = std::atan2(double(up.dot(aside)), double(right.dot(aside)));
      sectors.set(static_cast<std::size_t>((angle + kPi) / kTwoPi * kSectors) % kSectors);
    });
    hidden += sectors.all();
  }
  return static_cast<double>(hidden) / static_cast<double>(looked_at);
}

}  // namespace agrisee
