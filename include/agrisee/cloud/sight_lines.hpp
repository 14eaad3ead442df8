// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence of free space from the points of a cloud alone: the space between the sensor and each point is free. A body
/// that would have stopped such sight lines cannot be there.
///
/// The points of one sensor are sorted into a grid of directions about it; each cell keeps the nearest point. Metres,
/// the frame of the cloud. Cost: linear in the points; a body is tested in constant time for each sensor.
#pragma once

#include <agrisee/cloud/share_seen_through.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/spiral.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace agrisee {

/// The sight lines of one sensor.
class SightLines {
 public:
  /// @param cloud the points that the sensor saw (m)
  /// @param sensor its position (m)
  template <typename S>
  SightLines(const PointCloud<S>& cloud, const Eigen::Vector3d& sensor) : sensor_(sensor) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    std::vector<float> ranges;
    for (const auto& p : cloud.points) {
      const Eigen::Vector3d d = p.template cast<double>() - sensor;
      middle += d.normalized();
      ranges.push_back(static_cast<float>(d.norm()));
    }
    std::vector<float> reordered = ranges;
    const double typical = static_cast<double>(median(reordered)), spacing = estimate_spacing(cloud);
    if (!(middle.norm() > 1e-6) || !(typical > 0.0) || !(spacing > 0.0)) return;
    axes_.col(2) = middle.normalized();
    axes_.col(0) = any_orthogonal<double>(axes_.col(2));
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
    pitch_ = std::max(kCell * spacing / typical, kPi / kMost);
    std::vector<Eigen::Vector2d> angles_of;
    angles_of.reserve(cloud.size());
    Eigen::Vector2d low = Eigen::Vector2d::Constant(kPi), high = -low;
    for (const auto& p : cloud.points) {
      angles_of.push_back(angles(p.template cast<double>() - sensor));
      low = low.cwiseMin(angles_of.back()), high = high.cwiseMax(angles_of.back());
    }
    low_ = low;
    width_ = static_cast<int>((high.x() - low.x()) / pitch_) + 1;
    height_ = static_cast<int>((high.y() - low.y()) / pitch_) + 1;
    nearest_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                    std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      float& range = nearest_[static_cast<std::size_t>(cell(angles_of[i]))];
      range = std::min(range, ranges[i]);
    }
  }

  /// Position of the sensor (m).
  const Eigen::Vector3d& sensor() const { return sensor_; }

  /// The evidence for the point p (m).
  /// @param margin sight lines that end within this distance (m) of it end there
  Sight at(const Eigen::Vector3d& p, double margin) const {
    if (nearest_.empty()) return Sight::unknown;
    const Eigen::Vector3d d = p - sensor_;
    const Eigen::Vector2d a = (angles(d) - low_) / pitch_;
    const int u = static_cast<int>(std::floor(a.x())), v = static_cast<int>(std::floor(a.y()));
    const double range = d.norm();
    int behind = 0;
    bool ends = false;
    for (int y = v - 1; y <= v + 1; ++y)
      for (int x = u - 1; x <= u + 1; ++x) {
        const double seen = range_of(x, y);
        if (std::isinf(seen)) continue;
        if (seen < range - margin) return Sight::unknown;
        ends |= seen <= range + margin;
        ++behind;
      }
    if (ends) return Sight::surface;
    return behind >= kEnough ? Sight::through : Sight::unknown;
  }

  /// Range (m) of the nearest point in the direction of p. In a gap between points, that of the neighbor which is most
  /// like the range of p, if most neighbors have points. Empty where nothing was seen.
  std::optional<double> range_towards(const Eigen::Vector3d& p) const {
    if (nearest_.empty()) return std::nullopt;
    const Eigen::Vector3d d = p - sensor_;
    const Eigen::Vector2d a = (angles(d) - low_) / pitch_;
    const int u = static_cast<int>(std::floor(a.x())), v = static_cast<int>(std::floor(a.y()));
    const double range = d.norm(), own = range_of(u, v);
    if (!std::isinf(own)) return own;
    constexpr int kFilled = 5;
    double best = own;
    int neighbors = 0;
    for (int y = v - 1; y <= v + 1; ++y)
      for (int x = u - 1; x <= u + 1; ++x) {
        const double seen = range_of(x, y);
        if (std::isinf(seen)) continue;
        ++neighbors;
        if (std::abs(seen - range) < std::abs(best - range)) best = seen;
      }
    return neighbors >= kFilled ? std::optional(best) : std::nullopt;
  }

 private:
  static constexpr double kCell = 1.5;  ///< size of a cell in spacings of the points
  static constexpr int kMost = 2000;    ///< cells in half a turn, at most
  static constexpr int kEnough = 3;     ///< of the nine cells about a place, those that must show what is behind

  /// Angles (rad) of a direction, to the side of and above the middle one.
  Eigen::Vector2d angles(const Eigen::Vector3d& d) const {
    const Eigen::Vector3d l = axes_.transpose() * d;
    return {std::atan2(l.x(), l.z()), std::atan2(l.y(), std::hypot(l.x(), l.z()))};
  }

  /// The range in a cell (m); infinite where there is no point, or outside of the grid.
  double range_of(int x, int y) const {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return std::numeric_limits<double>::infinity();
    return double(
        nearest_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)]);
  }

  int cell(const Eigen::Vector2d& a) const {
    const Eigen::Vector2d c = (a - low_) / pitch_;
    return std::clamp(static_cast<int>(c.y()), 0, height_ - 1) * width_ +
           std::clamp(static_cast<int>(c.x()), 0, width_ - 1);
  }

  Eigen::Vector3d sensor_;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  // columns: sideways, up, middle direction
  double pitch_ = 1.0;                                  // rad
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  int width_ = 0, height_ = 0;
  std::vector<float> nearest_;  // distance of the nearest point in each cell (m); infinite: none
};

/// What the sensor of a single view measured where a body should be seen: in directions evenly spread over most of its
/// disc, is a surface where the body's is? A fruit fills its disc, as far as nothing nearer occludes it; the disc about
/// a piece of a leaf is partly empty, or shows what is far behind.
/// @param margin surfaces within this distance (m) of the body's, along the sight line, are the body's
/// @return as of SeenOn; 1 if all of it is occluded
inline double seen_on(const SightLines& lines, const Ellipsoid& body, double margin) {
  constexpr int kDirections = 128;
  constexpr double kDisc = 0.9;     // of the radius; the rim itself is seen at a slant and often gives no return
  constexpr double kUnsure = 0.05;  // share of the directions that counts as seen anyway
  const Eigen::Matrix3d unit = body.A.inverse();  // from the unit sphere to the ellipsoid
  const Eigen::Vector3d front = (body.A * (lines.sensor() - body.center)).normalized();
  const Eigen::Vector3d side = any_orthogonal<double>(front), up = front.cross(side);
  int on = 0, missed = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double rho = kDisc * std::sqrt((i + 0.5) / kDirections), phi = kGoldenAngle * i;
    const Eigen::Vector3d u = rho * (std::cos(phi) * side + std::sin(phi) * up) + std::sqrt(1.0 - rho * rho) * front;
    const Eigen::Vector3d p = body.center + unit * u;
    const double range = (p - lines.sensor()).norm();
    const std::optional<double> measured = lines.range_towards(p);
    if (measured && *measured < range - margin) continue;
    ++(measured && *measured <= range + margin ? on : missed);
  }
  constexpr double kSure = kUnsure * kDirections;
  return (on + kSure) / (on + missed + kSure);
}

/// Share (0..1) of a body's surface that more sensors looked through than saw.
/// @param max_incidence only sight lines that meet the surface at less than this angle to its normal count (rad)
/// @param margin m, see SightLines::at
inline double seen_through(const std::vector<SightLines>& sensors, const Ellipsoid& body, double max_incidence,
                           double margin) {
  return share_seen_through(
      sensors, body, max_incidence, [](const SightLines& lines) -> const Eigen::Vector3d& { return lines.sensor(); },
      [&](const SightLines& lines, const Eigen::Vector3d& p) { return lines.at(p, margin); });
}

}  // namespace agrisee
