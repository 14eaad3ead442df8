// SPDX-License-Identifier: BSD-3-Clause
#include "fuse/mask_depths.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace agrisee::fuse {
namespace {

/// A pixel of a mask: where it is beside the middle of the body (m), how deep the body's front is there, and how far
/// behind that the depth is (m).
struct Depth {
  double x, y, front, behind;
};

/// The pixels of a mask that have a depth, those at the rim left out, by how far they are behind the body's front.
/// @param missing receives the number of those without depth
std::vector<Depth> depths_under(const MaskImage& image, std::uint16_t instance, const Ellipsoid& body,
                                std::size_t& missing) {
  constexpr double kRim = 0.87;  // of the radius
  const auto width = static_cast<std::size_t>(image.frame->intrinsics.width);
  const Eigen::Vector3d sensor = image.world_T_optical.translation(), to_center = body.center - sensor;
  const Eigen::Vector3d ex = to_center.unitOrthogonal(), ey = to_center.cross(ex).normalized();
  const Eigen::Vector3d a = body.times(-to_center);
  std::vector<Depth> out;
  for (const std::uint32_t p : image.pixels.at(instance)) {
    const Eigen::Vector3d ray = image.direction(double(p % width), double(p / width)), b = body.times(ray);
    const double middle = -a.dot(b) / b.squaredNorm();  // nearest to the center in the body's metric
    const double inside = 1.0 - (a + middle * b).squaredNorm();
    if (!(inside > 1.0 - kRim * kRim)) continue;
    const double d = image.distance(p), front = middle - std::sqrt(inside / b.squaredNorm());
    if (d > 0.0)
      out.push_back({middle * ray.dot(ex), middle * ray.dot(ey), front - middle, d - front});
    else
      ++missing;
  }
  std::sort(out.begin(), out.end(), [](const Depth& l, const Depth& r) { return l.behind < r.behind; });
  return out;
}

/// A number and its standard error.
struct Slope {
  double value = 0.0, error = 1.0;
};

/// How much the depths bulge as the body does, by least squares beside a common offset and tilt: 1 for its own front, 0
/// for a plane. Errors of neighbors are alike, so the depths count as 20 independent ones.
/// @param from, to the depths that count by how far they are behind the front (m)
Slope bulge_of(const std::vector<Depth>& depths, double from, double to) {
  constexpr double kIndependent = 20.0;
  Eigen::Matrix4d normal = 1e-12 * Eigen::Matrix4d::Identity();
  Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
  double mean = 0.0, count = 0.0, squares = 0.0;
  const auto counts = [&](const Depth& d) { return d.behind >= from && d.behind <= to; };
  for (const Depth& d : depths)
    if (counts(d)) mean += d.front, count += 1.0;
  mean /= std::max(1.0, count);
  for (const Depth& d : depths) {
    if (!counts(d)) continue;
    const Eigen::Vector4d row(1.0, d.x, d.y, d.front - mean);
    const double depth = d.front - mean + d.behind;
    normal += row * row.transpose();
    rhs += row * depth;
    squares += depth * depth;
  }
  const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
  const Eigen::Vector4d fit = solver.solve(rhs);
  if (!fit.allFinite() || count < 5.0) return {};
  const double variance = std::max(0.0, squares - fit.dot(rhs)) / count;
  const double spread = solver.solve(Eigen::Vector4d::Unit(3))[3] * count / std::min(count, kIndependent);
  return {fit[3], std::sqrt(variance * std::max(0.0, spread))};
}

}  // namespace

DepthsUnder judge_depths(const MaskImage& image, std::uint16_t instance, const Ellipsoid& body) {
  constexpr double kNear = 0.2, kAlike = 0.45;  // of the radius
  constexpr double kLeastBulge = -1.0, kMostBulge = 3.0, kFlat = 0.4;
  const bool boxed = image.boxed.count(instance) > 0;
  const double near = kNear * body.mean_radius(), alike = kAlike * body.mean_radius();
  std::size_t missing = 0;
  std::vector<Depth> depths = depths_under(image, instance, body, missing);
  if (boxed)  // a box holds what hides the fruit, too
    depths.erase(depths.begin(),
                 std::find_if(depths.begin(), depths.end(), [&](const Depth& d) { return d.behind > -2.0 * near; }));
  const auto [best, end] = densest(depths, 2.0 * near, [](const Depth& d) { return d.behind; });
  const std::size_t most = end - best;
  DepthsUnder out;
  out.boxed = boxed ? 1.0 : 0.0;
  if (most == 0) return out;
  out.agreement = static_cast<double>(most) / (static_cast<double>(depths.size()) + 0.5 * static_cast<double>(missing));
  const double middle = depths[best].behind + near;
  const Slope bulge = bulge_of(depths, middle - alike, middle + alike);
  out.bulge = std::clamp(bulge.value, kLeastBulge, kMostBulge);
  out.flatness = std::max(0.0, kFlat - (bulge.value + 2.0 * bulge.error));
  return out;
}

}  // namespace agrisee::fuse
