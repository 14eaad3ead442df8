// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/geometry/spiral.hpp>
#include <agrisee/plan/directions.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::plan {

std::vector<Eigen::Vector3d> spread_directions(int n) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(static_cast<std::size_t>(std::max(n, 0)));
  for (int i = 0; i < n; ++i) out.push_back(spiral_direction(i, n));
  return out;
}

void spread_aim(ViewRequest& request, double i, const Eigen::Vector3d& size, double spread) {
  const auto part = [](double x) { return x - std::floor(x); };
  const Eigen::Vector3d where(part(i * 0.8566748838545029), part(i * 0.7338918566271260), part(i * 0.6287067210378087));
  request.target += spread * (where.array() - 0.5).matrix().cwiseProduct(size);
  request.distance =
      request.distance_min + part(i * 0.5385972572236101) * (request.distance_max - request.distance_min);
}

Eigen::Vector3d level_direction(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Vector3d d = to - from;
  d.z() = 0.0;
  return d.norm() > 1e-9 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitY());
}

Eigen::Vector3d frontal_direction(const Aabb& volume, const Eigen::Vector3d& robot) {
  return level_direction(robot, volume.center());
}

std::vector<Aabb> parts_to_look_at(const Aabb& volume, double width) {
  constexpr double kMost = 27.0;
  const Eigen::Vector3d size = volume.size();
  Eigen::Array3d counts;
  do {
    counts = (size.array() / width).ceil().max(1.0);
    width *= 1.1;
  } while (counts.prod() > kMost);
  std::vector<Aabb> parts;
  const Eigen::Vector3d each = size.array() / counts;
  for (int z = 0; z < counts.z(); ++z)
    for (int y = 0; y < counts.y(); ++y)
      for (int x = 0; x < counts.x(); ++x) {
        const Eigen::Vector3d low = volume.min + each.cwiseProduct(Eigen::Vector3d(x, y, z));
        parts.push_back({low, low + each});
      }
  if (parts.size() == 1) return {volume};
  // In micrometres, so that rounding does not order parts that are equally near.
  const auto off = [middle = volume.center()](const Aabb& part) {
    return std::round(1e6 * (part.center() - middle).norm());
  };
  std::stable_sort(parts.begin(), parts.end(), [&](const Aabb& a, const Aabb& b) { return off(a) < off(b); });
  parts.insert(parts.begin(), volume);
  return parts;
}

std::optional<ReachableView> first_view(const Aabb& volume, const Eigen::Vector3d& robot, const Joints& current,
                                        const Reach& reach, ViewRequest band, int skip) {
  const Eigen::Vector3d frontal = frontal_direction(volume, robot);
  std::vector<Eigen::Vector3d> directions = spread_directions(600);
  directions.push_back(frontal);
  std::stable_sort(directions.begin(), directions.end(),
                   [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.dot(frontal) > b.dot(frontal); });
  band.target = volume.center();
  for (const Eigen::Vector3d& d : directions) {
    throw_if_cancelled();
    band.direction = d;
    auto view = reach(band, current);
    if (view && skip-- == 0) return view;
  }
  return std::nullopt;
}

}  // namespace agrisee::plan
