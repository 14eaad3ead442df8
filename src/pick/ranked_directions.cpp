// SPDX-License-Identifier: BSD-3-Clause
#include "pick/ranked_directions.hpp"

#include <agrisee/plan/directions.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace agrisee::pick {
namespace {

/// Another fruit, as seen from the one that is being planned.
struct Neighbor {
  Eigen::Vector3d direction;  // unit vector from center to center
  double weight;              // 1 when they touch, less with distance
};

/// What other fruit are as neighbors of one.
std::vector<Neighbor> neighbors_of(const OrientedEllipsoid& fruit, const std::vector<OrientedEllipsoid>& others) {
  std::vector<Neighbor> neighbors;
  const double r = fruit.radii.mean();
  for (const OrientedEllipsoid& other : others) {
    const Eigen::Vector3d d = other.center - fruit.center;
    const double away = d.norm(), gap = std::max(away - r - other.radii.mean(), 0.0);
    if (away > 1e-9) neighbors.push_back({d / away, std::exp(-gap / r)});
  }
  return neighbors;
}

/// `weight` times the share of the surface within 45 degrees about the unit vector `side` that was observed.
double seen_score(const SeenDirections& seen, const Eigen::Vector3d& side, double weight) {
  static const double cos_cap = std::cos(deg(45));
  const auto& bins = DirectionBins::directions();
  double cap = 0.0, covered = 0.0;
  for (std::size_t b = 0; b < bins.size(); ++b) {
    if (bins[b].dot(side) < cos_cap) continue;
    cap += DirectionBins::shares()[b];
    if (seen[b]) covered += DirectionBins::shares()[b];
  }
  return weight * covered / cap;
}

}  // namespace

std::vector<RankedDirection> ranked_directions(const OrientedEllipsoid& fruit,
                                               const std::vector<OrientedEllipsoid>& others, const Preferences& by,
                                               const Eigen::Vector3d& robot, const PickingParameters& parameters) {
  const Eigen::Vector3d front = plan::level_direction(robot, fruit.center);
  const std::vector<Neighbor> neighbors = neighbors_of(fruit, others);
  const std::vector<Eigen::Vector3d> spread = plan::spread_directions(parameters.directions);
  const std::vector<double> crossed = crossed_surface(by.pieces, fruit, spread, parameters);
  const double section = kPi * std::pow(parameters.gripper_radius, 2), cos_pedicel = std::cos(parameters.pedicel_angle);
  std::vector<std::pair<double, std::size_t>> scores;
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const Eigen::Vector3d &d = spread[i], side = -d;
    if (parameters.pedicel_angle > 0.0 && side.dot(by.growth_axis) > cos_pedicel) continue;
    double score =
        parameters.front_weight * d.dot(front) - parameters.across_weight * std::pow(d.dot(by.growth_axis), 2);
    for (const Neighbor& n : neighbors)
      score -= parameters.away_weight * n.weight * std::pow(std::max(side.dot(n.direction), 0.0), 2);
    if (by.seen) score += seen_score(*by.seen, side, parameters.seen_weight);
    if (crossed[i] > 0.0 && section > 0.0) score -= parameters.clear_weight * crossed[i] / section;
    scores.emplace_back(-score, i);
  }
  std::sort(scores.begin(), scores.end());
  std::vector<RankedDirection> out;
  for (const auto& s : scores) out.push_back({spread[s.second], crossed[s.second]});
  return out;
}

}  // namespace agrisee::pick
