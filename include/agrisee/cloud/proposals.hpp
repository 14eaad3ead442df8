// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Proposes spheres as first guesses of the bodies in a cloud: from segments and from votes for centers. How many
/// points make a fruit follows from the spacing of the cloud. Metres.
#pragma once

#include <agrisee/cloud/body_size.hpp>
#include <agrisee/cloud/found_body.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/sphere_voting.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace agrisee {

/// Parameters of the two stages for a certain cloud.
struct StageParameters {
  RegionGrowingParameters growing;  ///< first stage
  DbscanParameters clustering;      ///< second stage
  std::size_t min_residual = 0;     ///< DBSCAN runs if the residual holds more points than this
  int min_cluster = 1;              ///< smaller clusters are noise
  double spacing = 0.0;             ///< of the cloud (m); 0 where the parameters are not adaptive
};

/// The fewest points that may be a fruit of a given radius: `min_region` of its surface, and at least 12.
/// @param radius of the fruit (m)
/// @param spacing of the cloud (m)
inline int least_points(double radius, double spacing, const SplitParameters& parameters) {
  const double points = parameters.min_region * 4.0 * kPi * radius * radius / (spacing * spacing);
  return std::max(12, static_cast<int>(std::min(points, 1e9)));
}

/// Parameters of the two stages for a cloud of a given spacing. If `parameters` are adaptive, lengths and sizes are
/// derived from the spacing.
/// @param spacing of the cloud (m), see estimate_spacing; used only if `parameters` are adaptive
/// @param parameters see their struct
/// @return empty if `parameters` are adaptive and the spacing is not positive (a cloud without two different points)
inline std::optional<StageParameters> stages_for(double spacing, const SplitParameters& parameters) {
  StageParameters stages{parameters.growing, parameters.clustering, static_cast<std::size_t>(parameters.min_residual),
                         1};
  if (!parameters.adaptive) return stages;
  if (!(spacing > 0.0)) return std::nullopt;
  stages.spacing = spacing;
  stages.growing.radius = parameters.growing_reach * spacing;
  stages.growing.min_size = least_points(parameters.bodies.radius_min, spacing, parameters);
  stages.clustering.eps = parameters.clustering_reach * spacing;
  stages.clustering.min_points = 8;
  stages.min_residual = static_cast<std::size_t>(stages.growing.min_size);
  stages.min_cluster = stages.growing.min_size;
  return stages;
}

namespace detail {

/// The distance from a voted center at which most points face away from it (m); 0 if there are none.
/// @param radius_min, radius_max the range of radii that voted (m)
template <typename S>
double likely_radius(const PointCloud<S>& cloud, const Grid<S>& grid, const Eigen::Vector3d& center, double radius_min,
                     double radius_max) {
  constexpr int kBins = 24;
  const double low = 0.8 * radius_min, width = (1.2 * radius_max - low) / kBins;
  std::array<double, kBins + 2> count{};
  grid.visit(center.template cast<S>(), static_cast<S>(1.2 * radius_max), [&](Index index, S d_sq) {
    const auto i = static_cast<std::size_t>(index);
    const double d = std::sqrt(double(d_sq));
    const Eigen::Vector3d u = cloud.points[i].template cast<double>() - center;
    if (d < low || u.dot(cloud.normals[i].template cast<double>()) < 0.9 * d) return;
    count[static_cast<std::size_t>(std::min((d - low) / width, kBins - 1.0)) + 1] += 1.0 / (d * d);  // by solid angle
  });
  int best = 0;
  double most = 0.0;
  for (int b = 1; b <= kBins; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const double sum = count[i - 1] + 2.0 * count[i] + count[i + 1];
    if (sum > most) most = sum, best = b;
  }
  return best == 0 ? 0.0 : low + (best - 0.5) * width;
}

/// Propose a sphere, unless its radius is far from what is expected.
/// @return the count of the reason for which it was not proposed; null if it was
inline std::size_t BodyCounts::*propose(Sphere sphere, const char* by, const BodyParameters& parameters,
                                        std::vector<BodyCandidate>& candidates) {
  if (!(sphere.radius > 0.0)) return &BodyCounts::inside_out;
  if (!(sphere.radius > 0.5 * parameters.radius_min)) return &BodyCounts::too_small;
  if (!(sphere.radius < 2.0 * parameters.radius_max)) return &BodyCounts::too_large;
  std::size_t BodyCounts::*const doubt =
      parameters.plausible(sphere.radius) ? nullptr : wrong_size(sphere.radius, parameters);
  sphere.radius = std::clamp(sphere.radius, parameters.radius_min, parameters.radius_max);
  candidates.push_back({Ellipsoid(sphere), by, doubt});
  return nullptr;
}

/// Propose bodies about the centers for which the points of `voters`, a part of `cloud`, vote. Centers that coincide
/// with one of the `candidates` given are left out: they would only be fitted twice.
///
/// A wide range of radii is divided, so that the cells that are voted for, and the votes that are needed, suit the
/// size.
/// @param fresh one per voter, as vote_for_centers takes it
/// @param single_view whether one camera saw all points: then as many centers as vote_for_centers gives by default are
///   enough, and weaker ones are leaves more often than fruit
template <typename S>
void propose_voted(const PointCloud<S>& cloud, const PointCloud<S>& voters, const std::vector<char>& fresh,
                   const Grid<S>& grid, const StageParameters& stages, const SplitParameters& parameters,
                   std::vector<BodyCandidate>& candidates, bool single_view = false) {
  constexpr double kWidest = 2.5;      // largest over smallest radius that vote together
  constexpr double kMost = 60;         // proposals of each part of the range; weaker maxima are noise
  constexpr double kMostOnDisc = 2.8;  // and of each disc of the largest radius, so that a whole tree has enough
  constexpr double kVotes = 1.5;       // votes that a center needs, for each of the fewest points that may be a fruit
  const double area = static_cast<double>(cloud.size()) * stages.spacing * stages.spacing;
  const BodyParameters& bodies = parameters.bodies;
  const double discs = area / (kPi * bodies.radius_max * bodies.radius_max);
  const auto most = static_cast<std::size_t>(std::max(kMost, kMostOnDisc * discs));
  const std::size_t voted = single_view ? kMostVotedCenters : std::max(kMostVotedCenters, most);
  const std::size_t known = candidates.size();
  const double range = bodies.radius_max / bodies.radius_min;
  const int parts = std::max(1, static_cast<int>(std::ceil(std::log(range) / std::log(kWidest) - 1e-9)));
  for (int part = 0; part < parts; ++part) {
    const double low = bodies.radius_min * std::pow(range, double(part) / parts);
    const double high = bodies.radius_min * std::pow(range, (part + 1.0) / parts);
    const int least = stages.spacing > 0.0 ? least_points(low, stages.spacing, parameters) : stages.growing.min_size;
    const std::size_t proposed = candidates.size();
    for (const VotedCenter& v : vote_for_centers(voters, low, high, kVotes * least, fresh, voted)) {
      throw_if_cancelled();
      const double radius = likely_radius(cloud, grid, v.center, low, high);
      const auto same = [&](const BodyCandidate& c) {
        const double r = c.body.mean_radius();
        return (c.body.center - v.center).norm() < 0.15 * r && (parts == 1 || std::abs(r - radius) < 0.3 * r);
      };
      if (std::none_of(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(known), same))
        propose({v.center, radius}, "sphere_voting", bodies, candidates);
      if (candidates.size() >= proposed + most) break;
    }
  }
}

}  // namespace detail

}  // namespace agrisee
