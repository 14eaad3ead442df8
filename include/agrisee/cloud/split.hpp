// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a cloud with normals to fruit: region growing, DBSCAN on the residual and, unless only the paper's two stages
/// are wanted, bodies that compete for the points (paper, "Segmentation"; bodies.hpp).
///
/// The paper's stages alone give a label a region or cluster. With bodies, regions, clusters and voted centres propose,
/// the bodies that best explain the cloud win, and points are labelled by the body on which they lie. Metres, any
/// frame.
#pragma once

#include <agrisee/cloud/bodies.hpp>
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/sphere_voting.hpp>

#include <array>
#include <numeric>

namespace agrisee {

/// What the split found. `labels` count from 1 in the order of `found`.
struct Split {
  Labels labels;                 ///< one per point: the fruit, 0 = none
  std::vector<FoundBody> found;  ///< one per fruit; without bodies only `found_by` is set
  Labels regions;                ///< what region growing alone found
  std::size_t residual = 0;      ///< points that region growing left to DBSCAN
  int regions_found = 0;         ///< instances from region growing
  int clusters_found = 0;        ///< and from DBSCAN on its residual
};

/// What the paper's two stages run with on a certain cloud.
struct StageParameters {
  RegionGrowingParameters growing;  ///< first stage
  DbscanParameters clustering;      ///< second stage
  std::size_t min_residual = 0;     ///< DBSCAN runs when the residual holds more points than this
  int min_cluster = 1;              ///< smaller clusters are noise
};

/// The stages' parameters for a cloud of such spacing (m, see estimate_spacing): as given, or derived from it where
/// they are adaptive; none then for a cloud that has no spacing (no two different points).
inline std::optional<StageParameters> stages_for(double spacing, const SplitParameters& parameters) {
  StageParameters stages{parameters.growing, parameters.clustering, static_cast<std::size_t>(parameters.min_residual),
                         1};
  if (!parameters.adaptive) return stages;
  if (!(spacing > 0.0)) return std::nullopt;
  const double smallest = 4.0 * kPi * parameters.bodies.radius_min * parameters.bodies.radius_min;
  const double least = parameters.min_region * smallest / (spacing * spacing);
  stages.growing.radius = parameters.growing_reach * spacing;
  stages.growing.min_size = std::max(12, static_cast<int>(std::min(least, 1e9)));
  stages.clustering.eps = parameters.clustering_reach * spacing;
  stages.clustering.min_points = 8;
  stages.min_residual = static_cast<std::size_t>(stages.growing.min_size);
  stages.min_cluster = stages.growing.min_size;
  return stages;
}

/// Drop labels of fewer than `least` points and number the others anew from 1 in their old order.
/// @return the largest label left
inline int drop_small(Labels& labels, int least) {
  std::vector<int> sizes(1, 0);
  for (int c : labels) {
    if (static_cast<std::size_t>(c) >= sizes.size()) sizes.resize(static_cast<std::size_t>(c) + 1, 0);
    ++sizes[static_cast<std::size_t>(c)];
  }
  std::vector<int> renumbered(sizes.size(), 0);
  int largest = 0;
  for (std::size_t c = 1; c < sizes.size(); ++c)
    if (sizes[c] >= least) renumbered[c] = ++largest;
  for (int& c : labels) c = renumbered[static_cast<std::size_t>(c)];
  return largest;
}

namespace detail {

/// Who found a body: the stage one of whose segments is mostly this body, and makes up most of it.
inline std::string found_by(const Indices& points, const Labels& segments, const std::vector<std::size_t>& sizes,
                            int first_cluster) {
  std::vector<std::size_t> votes(sizes.size(), 0);
  for (Index i : points) ++votes[static_cast<std::size_t>(segments[static_cast<std::size_t>(i)])];
  std::size_t best = 0;
  for (std::size_t s = 1; s < votes.size(); ++s)
    if (best == 0 || votes[s] > votes[best]) best = s;
  if (best == 0 || 2 * votes[best] < points.size() || 2 * votes[best] < sizes[best]) return "sphere_voting";
  return static_cast<int>(best) < first_cluster ? "region_growing" : "dbscan";
}

/// The distance from a voted centre at which most points face away from it (m), 0 when there are none.
template <typename S>
double likely_radius(const PointCloud<S>& cloud, const Grid<S>& grid, const Eigen::Vector3d& center,
                     const BodyParameters& parameters) {
  constexpr int kBins = 24;
  const double low = 0.8 * parameters.radius_min, width = (1.2 * parameters.radius_max - low) / kBins;
  std::array<double, kBins + 2> count{};
  grid.visit(center.template cast<S>(), static_cast<S>(1.2 * parameters.radius_max), [&](Index index, S d_sq) {
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

/// Votes that a centre needs to be proposed.
inline double least_votes(const RegionGrowingParameters& growing) { return 1.5 * growing.min_size; }

/// Propose a sphere of roughly an expected radius.
inline void propose(Sphere sphere, const char* by, const BodyParameters& parameters,
                    std::vector<BodyCandidate>& candidates) {
  if (!(sphere.radius > 0.5 * parameters.radius_min && sphere.radius < 2.0 * parameters.radius_max)) return;
  sphere.radius = std::clamp(sphere.radius, parameters.radius_min, parameters.radius_max);
  candidates.push_back({Ellipsoid(sphere), by});
}

/// Propose bodies about the centres for which the points of `voters`, a part of `cloud`, vote; but for those that one
/// of `candidates` already stands for: they would only be fitted twice.
template <typename S>
void propose_voted(const PointCloud<S>& cloud, const PointCloud<S>& voters, const Grid<S>& grid, double min_votes,
                   const BodyParameters& parameters, std::vector<BodyCandidate>& candidates) {
  const std::size_t proposed = candidates.size();
  for (const VotedCenter& v : vote_for_centers(voters, parameters.radius_min, parameters.radius_max, min_votes)) {
    throw_if_cancelled();
    const bool known = std::any_of(
        candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(proposed),
        [&](const BodyCandidate& c) { return (c.body.center - v.center).norm() < 0.15 * c.body.mean_radius(); });
    if (!known)
      propose({v.center, likely_radius(cloud, grid, v.center, parameters)}, "sphere_voting", parameters, candidates);
    if (candidates.size() >= proposed + 60) break;  // weaker maxima are noise
  }
}

/// Give a body what an ellipsoid cannot follow: points in its dimples (inside an opaque body there is nothing else),
/// and points of a smooth region that is mostly this body's (shoulders, lobes).
template <typename S>
void extend_labels(Labels& labels, const PointCloud<S>& cloud, const std::vector<FoundBody>& found,
                   const Labels& regions, int region_count, const BodyParameters& parameters) {
  const std::size_t columns = found.size() + 1;
  std::vector<std::size_t> votes(static_cast<std::size_t>(region_count + 1) * columns, 0);
  for (std::size_t i = 0; i < labels.size(); ++i)
    ++votes[static_cast<std::size_t>(regions[i]) * columns + static_cast<std::size_t>(labels[i])];
  std::vector<std::size_t> owner(static_cast<std::size_t>(region_count) + 1, 0);
  for (std::size_t r = 1; r < owner.size(); ++r) {
    const auto row = votes.begin() + static_cast<std::ptrdiff_t>(r * columns);
    const auto most = std::max_element(row + 1, row + static_cast<std::ptrdiff_t>(columns));
    if (most != row + static_cast<std::ptrdiff_t>(columns) &&
        10 * *most >= 6 * std::accumulate(row, row + static_cast<std::ptrdiff_t>(columns), std::size_t{0}))
      owner[r] = static_cast<std::size_t>(most - row);
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if ((i & 0xFFF) == 0) throw_if_cancelled();
    if (labels[i] != 0) continue;
    const Eigen::Vector3d p = cloud.points[i].template cast<double>(), n = cloud.normals[i].template cast<double>();
    if (const std::size_t b = owner[static_cast<std::size_t>(regions[i])]) {
      const Ellipsoid& body = found[b - 1].fit.body;
      if (std::abs(body.distance(p)) < 0.25 * body.mean_radius() && body.normal(p).dot(n) > 0.0)
        labels[i] = static_cast<int>(b);
    }
    for (std::size_t b = 0; b < found.size() && labels[i] == 0; ++b) {
      const Ellipsoid& body = found[b].fit.body;
      const double r = body.mean_radius();
      if ((p - body.center).squaredNorm() > 1.5 * r * r) continue;
      const double d = body.distance(p);
      if (d < 0.5 * parameters.tolerance * r && d > -0.4 * r && body.normal(p).dot(n) > 0.3)
        labels[i] = static_cast<int>(b) + 1;
    }
  }
}

}  // namespace detail

/// Split a cloud with normals (facing outwards) into fruit.
/// @param cloud points (m) with normals
/// @param parameters see their struct
/// @param seen_through evidence of free space for the competition, or empty
/// @throws ParameterError; InputError when the cloud has no normals
template <typename S>
Split split(const PointCloud<S>& cloud, const SplitParameters& parameters = {}, const SeenThrough& seen_through = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "split: the cloud has no normals");
  Split out;
  out.labels.assign(cloud.size(), 0);
  out.regions.assign(cloud.size(), 0);
  if (cloud.empty()) return out;

  const auto stages = stages_for(parameters.adaptive ? estimate_spacing(cloud) : 0.0, parameters);
  if (!stages) return out;
  const RegionGrowingParameters& growing = stages->growing;

  // Region growing, then DBSCAN on what it leaves.
  const Grid<S> grid(cloud, static_cast<S>(growing.radius));
  out.regions = grow_regions(cloud, cloud.normals, growing, grid);
  out.regions_found = *std::max_element(out.regions.begin(), out.regions.end());
  const Indices rest = residual(out.regions);
  out.residual = rest.size();
  Labels segments = out.regions;
  if (rest.size() > stages->min_residual) {
    Labels clusters = dbscan(select(cloud, rest), stages->clustering);
    out.clusters_found = drop_small(clusters, stages->min_cluster);
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (clusters[i] > 0) segments[static_cast<std::size_t>(rest[i])] = out.regions_found + clusters[i];
  }
  const int first_cluster = out.regions_found + 1;
  const auto members = indices_by_label(segments);
  if (!parameters.fit_bodies) {
    out.labels = segments;
    for (std::size_t s = 0; s < members.size(); ++s) {
      FoundBody found;
      found.found_by = static_cast<int>(s) + 1 < first_cluster ? "region_growing" : "dbscan";
      out.found.push_back(std::move(found));
    }
    return out;
  }

  // Segments and voted centres propose bodies; the best explanation wins.
  const BodyParameters& bodies = parameters.bodies;
  std::vector<BodyCandidate> candidates;
  for (std::size_t s = 0; s < members.size(); ++s)
    if (const auto sphere = sphere_from_normals(cloud, members[s]))
      detail::propose(*sphere, static_cast<int>(s) + 1 < first_cluster ? "region_growing" : "dbscan", bodies,
                      candidates);
  detail::propose_voted(cloud, cloud, grid, detail::least_votes(growing), bodies, candidates);
  out.found = find_bodies(cloud, candidates, bodies, seen_through);
  out.labels = assign_to_bodies(cloud, out.found, bodies);

  // Each body is fitted once more to all the points that are its own, and the points are assigned anew.
  FitParameters last_fit = bodies.fit;
  last_fit.max_points = std::max(last_fit.max_points, static_cast<int>(cloud.size()));
  for (int round = 0; round < 2; ++round) {
    auto own = indices_by_label(out.labels);
    own.resize(out.found.size());
    for (std::size_t b = 0; b < out.found.size(); ++b)
      if (const auto fit = fit_ellipsoid(cloud, own[b], out.found[b].fit.body, last_fit))
        if (bodies.plausible(fit->body.mean_radius())) out.found[b].fit = *fit;
    out.labels = assign_to_bodies(cloud, out.found, bodies);
  }
  detail::extend_labels(out.labels, cloud, out.found, out.regions, out.regions_found, bodies);

  std::vector<std::size_t> sizes(members.size() + 1, 0);
  for (int s : segments) ++sizes[static_cast<std::size_t>(s)];
  auto own = indices_by_label(out.labels);
  own.resize(out.found.size());
  for (std::size_t b = 0; b < out.found.size(); ++b)
    out.found[b].found_by = detail::found_by(own[b], segments, sizes, first_cluster);
  return out;
}

/// The bodies of a cloud that has grown, or changed a little, since `known` were found: those and what the points off
/// them vote for compete anew. Far quicker than `split`, and as good while the cloud grows view by view; who found a
/// body is kept. Points are labelled by the body on which they lie; regions are not grown.
/// @param cloud points (m) with normals
/// @param known bodies found before
/// @param parameters see their struct
/// @param seen_through evidence of free space for the competition, or empty
/// @throws ParameterError; InputError when the cloud has no normals
template <typename S>
Split track(const PointCloud<S>& cloud, const std::vector<FoundBody>& known, const SplitParameters& parameters = {},
            const SeenThrough& seen_through = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "track: the cloud has no normals");
  Split out;
  out.labels.assign(cloud.size(), 0);
  if (cloud.empty()) return out;
  const BodyParameters& bodies = parameters.bodies;
  const Grid<S> grid(cloud, static_cast<S>(0.5 * bodies.radius_min));
  const auto stages = stages_for(estimate_spacing(cloud, grid), parameters);
  if (!stages) return out;
  std::vector<BodyCandidate> candidates;
  for (const FoundBody& k : known) candidates.push_back({k.fit.body, k.found_by});
  const PointCloud<S> off_them = select(cloud, residual(assign_to_bodies(cloud, known, bodies)));
  detail::propose_voted(cloud, off_them, grid, detail::least_votes(stages->growing), bodies, candidates);
  out.found = find_bodies(cloud, candidates, bodies, seen_through);
  out.labels = assign_to_bodies(cloud, out.found, bodies);
  return out;
}

}  // namespace agrisee
