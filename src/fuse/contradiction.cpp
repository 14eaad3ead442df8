// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/contradiction.hpp>

#include <algorithm>

namespace agrisee::fuse {
namespace {

/// What `view` says of the points of another image.
Evidence compare_one_way(const sensor::SurfaceImage& points, const sensor::SurfaceImage& view,
                         const FreeSpaceParameters& parameters) {
  Evidence out;
  FreeSpaceParameters far = parameters;
  far.margin = std::max(far.margin, far.leaf_depth);
  const std::size_t step = compared_step(points);
  for (std::size_t i = 0; i < points.points.size(); i += step) {
    const Eigen::Vector3d p = points.points[i].cast<double>();
    if (refutes(view, p, points.normals[i].cast<double>(), far))
      ++out.refute;
    else if (sight(view, p, parameters) == Sight::surface)
      ++out.agree;
  }
  return out;
}

}  // namespace

std::size_t compared_step(const sensor::SurfaceImage& image) {
  return std::max<std::size_t>(1, image.points.size() / 1000);
}

Evidence compare(const sensor::SurfaceImage& a, const sensor::SurfaceImage& b, const FreeSpaceParameters& parameters) {
  Evidence out = compare_one_way(a, b, parameters);
  out += compare_one_way(b, a, parameters);
  return out;
}

}  // namespace agrisee::fuse
