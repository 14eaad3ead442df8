// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/share_seen_through.hpp>
#include <agrisee/fuse/contradiction.hpp>
#include <agrisee/fuse/free_space.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace agrisee::fuse {
namespace {

constexpr double kSlanted = deg(70);  // a surface seen at a larger angle of incidence may return nothing

}  // namespace

bool refutes(const sensor::SurfaceImage& view, const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
             const FreeSpaceParameters& parameters) {
  double z = 0.0;
  const std::ptrdiff_t c = view.cell(p, &z);
  if (c < 0) return false;
  const auto width = static_cast<std::ptrdiff_t>(view.intrinsics.width);
  const std::ptrdiff_t u = c % width, v = c / width;
  if (u < 1 || v < 1 || u + 1 >= width || v + 1 >= view.intrinsics.height) return false;
  const double margin = std::max(parameters.margin, 3.0 * view.noise);
  const Eigen::Vector3d to_sensor = view.world_T_optical.translation() - p;
  const bool slanted = std::abs(normal.dot(to_sensor)) < std::cos(kSlanted) * to_sensor.norm();
  const bool empty_is_unknown = slanted || view.fill < parameters.min_fill;
  for (std::ptrdiff_t dv = -1; dv <= 1; ++dv)
    for (std::ptrdiff_t du = -1; du <= 1; ++du) {
      const double measured = double(view.depth[static_cast<std::size_t>((v + dv) * width + u + du)]);
      if (measured > 0.0 ? measured <= z + margin : empty_is_unknown) return false;
    }
  return true;
}

Returned returned(const sensor::SurfaceImage& view, const sensor::SurfaceImage& known,
                  const FreeSpaceParameters& parameters) {
  Returned out;
  const double margin = std::max(parameters.margin, 3.0 * view.noise), steepest = std::cos(parameters.max_incidence);
  const std::size_t step = compared_step(known);
  for (std::size_t i = 0; i < known.points.size(); i += step) {
    const Eigen::Vector3d p = known.points[i].cast<double>();
    const Eigen::Vector3d to_sensor = view.world_T_optical.translation() - p;
    if (known.normals[i].cast<double>().dot(to_sensor) < steepest * to_sensor.norm()) continue;
    double z = 0.0;
    const std::ptrdiff_t c = view.cell(p, &z);
    if (c < 0) continue;
    const double measured = double(view.depth[static_cast<std::size_t>(c)]);
    if (!(measured > 0.0))
      ++out.lost;
    else if (std::abs(measured - z) <= margin)
      ++out.seen;
  }
  return out;
}

bool is_free(const std::vector<sensor::SurfaceImage>& views, const Eigen::Vector3d& p,
             const FreeSpaceParameters& parameters) {
  FreeSpaceParameters measured = parameters;
  measured.min_fill = std::numeric_limits<double>::infinity();  // no return is no evidence
  int through = 0, surface = 0;
  for (const sensor::SurfaceImage& view : views) {
    const Sight seen = sight(view, p, measured);
    through += seen == Sight::through;
    surface += seen == Sight::surface;
  }
  return through > surface;
}

double seen_through(const std::vector<sensor::SurfaceImage>& views, const Ellipsoid& body,
                    const FreeSpaceParameters& parameters) {
  return share_seen_through(
      views, body, parameters.max_incidence,
      [](const sensor::SurfaceImage& view) -> Eigen::Vector3d { return view.world_T_optical.translation(); },
      [&](const sensor::SurfaceImage& view, const Eigen::Vector3d& p) { return sight(view, p, parameters); });
}

}  // namespace agrisee::fuse
