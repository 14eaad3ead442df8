// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/fuse/paint.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee::fuse {
namespace {

/// The pixel of a view in which a point is seen; empty if it is not.
std::optional<std::size_t> pixel_of(const sensor::DepthFrame& frame, const Eigen::Vector3d& point) {
  constexpr double kShare = 0.01, kLeast = 0.004;  // of the depth; m
  const auto pixel = frame.intrinsics.pixel_of(point);
  if (!pixel) return std::nullopt;
  const float z = frame.depth[*pixel];
  if (!sensor::DepthFrame::valid(z) || std::abs(double(z) - point.z()) > std::max(kLeast, kShare * point.z()))
    return std::nullopt;
  return pixel;
}

}  // namespace

std::vector<Rgb> colors_of(const Cloud& cloud, const std::vector<DetectedView>& views) {
  constexpr double kSlant = 0.1;  // least weight of a view that sees a point at a slant
  const auto colored = [](const DetectedView& v) { return !v.frame->color.empty(); };
  check_lengths(cloud);
  for (const DetectedView& view : views) check_input(view.frame != nullptr, "colors_of: a view has no frame");
  if (std::none_of(views.begin(), views.end(), colored)) return {};
  std::vector<Eigen::Vector3d> sums(cloud.size(), Eigen::Vector3d::Zero());
  std::vector<double> weights(cloud.size(), 0.0);
  for (const DetectedView& view : views) {
    if (!colored(view)) continue;
    check(*view.frame);
    const Pose optical_T_world = view.world_T_optical.inverse();
    const Eigen::Vector3d sensor = view.world_T_optical.translation();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if ((i & 0xFFF) == 0) throw_if_cancelled();
      const Eigen::Vector3d p = cloud.points[i].cast<double>();
      const auto pixel = pixel_of(*view.frame, optical_T_world * p);
      if (!pixel) continue;
      const double facing =
          cloud.normals.empty() ? 1.0 : cloud.normals[i].cast<double>().dot((sensor - p).normalized());
      const double weight = std::max(kSlant, facing);
      const Rgb& c = view.frame->color[*pixel];
      sums[i] += weight * Eigen::Vector3d(c[0], c[1], c[2]);
      weights[i] += weight;
    }
  }
  std::vector<Rgb> out(cloud.size(), Rgb{0, 0, 0});
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (weights[i] > 0.0)
      for (std::size_t c = 0; c < 3; ++c)
        out[i][c] = static_cast<std::uint8_t>(std::lround(sums[i][static_cast<Eigen::Index>(c)] / weights[i]));
  return out;
}

}  // namespace agrisee::fuse
