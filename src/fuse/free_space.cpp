// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/fit.hpp>
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <cmath>

namespace agrisee::fuse {

bool refutes(const sensor::SurfaceImage& view, const Eigen::Vector3d& p, const FreeSpaceParameters& parameters) {
  double z = 0.0;
  const std::ptrdiff_t c = view.cell(p, &z);
  if (c < 0) return false;
  const auto width = static_cast<std::ptrdiff_t>(view.intrinsics.width);
  const std::ptrdiff_t u = c % width, v = c / width;
  if (u < 1 || v < 1 || u + 1 >= width || v + 1 >= view.intrinsics.height) return false;
  const double margin = std::max(parameters.margin, 3.0 * view.noise);
  for (std::ptrdiff_t dv = -1; dv <= 1; ++dv)
    for (std::ptrdiff_t du = -1; du <= 1; ++du) {
      const double measured = double(view.depth[static_cast<std::size_t>((v + dv) * width + u + du)]);
      if (measured > 0.0 ? measured <= z + margin : view.fill < parameters.min_fill) return false;
    }
  return true;
}

double seen_through(const std::vector<sensor::SurfaceImage>& views, const Ellipsoid& body,
                    const FreeSpaceParameters& parameters) {
  const auto& directions = DirectionBins::directions();
  const auto& shares = DirectionBins::shares();
  const double cos_max = std::cos(parameters.max_incidence);
  double share = 0.0;
  for (std::size_t b = 0; b < directions.size(); ++b) {
    const Eigen::Vector3d p = body.surface(directions[b]);
    const Eigen::Vector3d n = body.normal(p);
    int through = 0, surface = 0;
    for (const auto& view : views) {
      const Eigen::Vector3d ray = (p - view.world_T_optical.translation()).normalized();
      if (-ray.dot(n) < cos_max) continue;
      const Sight s = sight(view, p, parameters);
      through += s == Sight::through;
      surface += s == Sight::surface;
    }
    if (through > surface) share += shares[b];
  }
  return share;
}

}  // namespace agrisee::fuse
