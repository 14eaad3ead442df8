// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Instance segmentation of a cloud with normals into fruit: region growing, DBSCAN on the residual and, unless only
/// these two stages of [1] (3.2.3, alg. 2) are wanted, bodies that compete for the points (bodies.hpp).
///
/// With the two stages alone, each region or cluster becomes a label. With bodies, the regions, the clusters and the
/// centers found by voting are proposals; the bodies that explain the cloud best win, and each point gets the label of
/// the body on which it lies. In a single view without masks doubtful bodies may win, too; what they are is settled
/// after their last fit. Metres, any frame.
#pragma once

#include <agrisee/cloud/bodies.hpp>
#include <agrisee/cloud/body_size.hpp>
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/free_points.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/last_fits.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/proposals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/spacing.hpp>

#include <numeric>

namespace agrisee {

/// The segmentation of a cloud. `labels` count from 1 in the order of `found`.
struct Split {
  Labels labels;                 ///< one per point: the fruit, 0 = none
  std::vector<FoundBody> found;  ///< one per fruit; without bodies only `found_by` is set
  Labels regions;                ///< one per point: the region that region growing found, 0 = none
  std::size_t residual = 0;      ///< points that region growing left to DBSCAN
  int regions_found = 0;         ///< number of regions
  int clusters_found = 0;        ///< number of clusters that DBSCAN found in the residual
  BodyCounts bodies;             ///< numbers of proposed bodies by outcome
};

namespace detail {

/// The segments that the two stages find: regions first, then clusters.
struct Segments {
  Labels labels;                 ///< one per point, from 1, 0 = none
  std::vector<Indices> members;  ///< points of each segment
  int first_cluster = 1;         ///< segments from this label on are clusters

  /// The stage that found the segment with this label.
  const char* found_by(std::size_t label) const {
    return static_cast<int>(label) < first_cluster ? "region_growing" : "dbscan";
  }
};

/// The surface variation of each point, from at most 25 neighbors within the radius of region growing. Empty unless
/// region growing needs it.
template <typename S>
std::vector<S> curvatures_for(const PointCloud<S>& cloud, const RegionGrowingParameters& growing, int threads) {
  std::vector<S> curvatures;
  if (!growing.needs_curvature()) return curvatures;
  NormalParameters within;
  within.radius = growing.radius;
  estimate_normals(cloud, within, threads, &curvatures);
  return curvatures;
}

/// Run region growing, then DBSCAN on what it leaves.
/// @param out receives the regions and the counts
template <typename S>
Segments find_segments(const PointCloud<S>& cloud, const StageParameters& stages, int threads, Split& out) {
  out.regions =
      grow_regions(cloud, cloud.normals, stages.growing, curvatures_for(cloud, stages.growing, threads), threads);
  out.regions_found = *std::max_element(out.regions.begin(), out.regions.end());
  const Indices rest = residual(out.regions);
  out.residual = rest.size();
  Segments segments;
  segments.labels = out.regions;
  if (rest.size() > stages.min_residual) {
    Labels clusters = dbscan(select(cloud, rest), stages.clustering, threads);
    out.clusters_found = drop_small(clusters, stages.min_cluster);
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (clusters[i] > 0) segments.labels[static_cast<std::size_t>(rest[i])] = out.regions_found + clusters[i];
  }
  segments.first_cluster = out.regions_found + 1;
  segments.members = indices_by_label(segments.labels);
  return segments;
}

/// Which stage found a body: that of the segment to which most of its points belong, if that is at least half of its
/// points and at least half of the segment's; otherwise the vote for centers.
/// @param points of the body
/// @param sizes number of points of each segment, by label; element 0 is not used
inline std::string found_by(const Indices& points, const Segments& segments, const std::vector<std::size_t>& sizes) {
  std::vector<std::size_t> votes(sizes.size(), 0);
  for (Index i : points) ++votes[static_cast<std::size_t>(segments.labels[static_cast<std::size_t>(i)])];
  std::size_t best = 0;
  for (std::size_t s = 1; s < votes.size(); ++s)
    if (best == 0 || votes[s] > votes[best]) best = s;
  if (best == 0 || 2 * votes[best] < points.size() || 2 * votes[best] < sizes[best]) return "sphere_voting";
  return segments.found_by(best);
}

/// Whether at least a twentieth of the points near a body are fresh.
/// @param fresh one a point, nonzero for those that are
template <typename S>
bool has_changed(const Grid<S>& grid, const Ellipsoid& body, const std::vector<char>& fresh) {
  constexpr std::size_t kFewest = 20;  // points, for each that is fresh
  std::size_t near = 0, news = 0;
  visit_near(grid, body, [&](Index i) { ++near, news += fresh[static_cast<std::size_t>(i)] != 0; });
  return news * kFewest >= near;
}

/// In a single view, bodies with this share of the required confidence may win points; what they are is settled after
/// their last fit.
constexpr double kShareToWin = 0.06;

/// Whether bodies are judged again after their last fit: in single views, unless masks know better.
inline bool settled(const BodyEvidence& evidence) { return evidence.single_view() && !evidence.masks.log_odds; }

/// The radii among which the bodies of a single view are sought: at least the usual range below the largest, but not
/// below the usual smallest. Patches of fruit often look smaller than the fruit, and what is smaller than fruit has to
/// compete for its points.
inline BodyParameters sought_in_single_view(BodyParameters bodies) {
  const BodyParameters usual;
  const double range = usual.radius_max / usual.radius_min;
  bodies.radius_min = std::min(bodies.radius_min, std::max(usual.radius_min, bodies.radius_max / range));
  return bodies;
}

/// Judge the bodies of a single view once more, by their last fits. Those with too little confidence, and those of
/// another size than expected, lose their points; those of masks stay.
/// @param grid of the cloud's points, with cells of `sought.cell()`
/// @param sought parameters with which the bodies were found  @param expected those with the radii of fruit
template <typename S>
void settle(const PointCloud<S>& cloud, const Grid<S>& grid, const BodyParameters& sought,
            const BodyParameters& expected, const BodyEvidence& evidence, Split& out) {
  const FreePoints<S> points(cloud, grid, sought);
  const auto falls = [&](FoundBody& f) {
    if (f.by_mask) return false;
    if (!plausible(f.fit.body, expected)) {
      ++(out.bodies.*wrong_size(f.fit.body.mean_radius(), expected));
      return true;
    }
    const Verdict v = points.judge(f.fit.body, evidence);
    f.confidence = settled_probability(f.confidence, v, f.fit, sought, f.prior);
    const bool doubtful = f.confidence < sought.min_confidence;
    out.bodies.doubtful += doubtful;
    return doubtful;
  };
  const auto end = std::remove_if(out.found.begin(), out.found.end(), falls);
  out.bodies.taken -= static_cast<std::size_t>(out.found.end() - end);
  out.found.erase(end, out.found.end());
  out.labels = assign_to_bodies_near(cloud, grid, out.found, sought);
}

/// The body to which at least 60 % of the points of each region belong, by the region's label; 0 if there is none.
inline std::vector<std::size_t> owners_of_regions(const Labels& labels, std::size_t bodies, const Labels& regions,
                                                  int region_count) {
  const std::size_t columns = bodies + 1;
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
  return owner;
}

/// Give a body the points that an ellipsoid cannot follow: points in its dimples (there is nothing else inside an
/// opaque body), and points of a smooth region that mostly belongs to it (shoulders, lobes).
template <typename S>
void extend_labels(Labels& labels, const PointCloud<S>& cloud, const std::vector<FoundBody>& found,
                   const Labels& regions, int region_count, const BodyParameters& parameters) {
  const std::vector<std::size_t> owner = owners_of_regions(labels, found.size(), regions, region_count);
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
      if (d < 0.5 * parameters.near(r) && d > -0.4 * r && body.normal(p).dot(n) > 0.3)
        labels[i] = static_cast<int>(b) + 1;
    }
  }
}

/// Let segments, masks and voted centers propose bodies, and give the points to the bodies that win.
/// @param parameters with the radii that are sought  @param expected those with the radii of fruit
template <typename S>
void split_by_bodies(const PointCloud<S>& cloud, const Segments& segments, const StageParameters& stages,
                     const SplitParameters& parameters, const BodyParameters& expected, const BodyEvidence& evidence,
                     int threads, Split& out) {
  const BodyParameters& bodies = parameters.bodies;
  std::vector<BodyCandidate> candidates;
  BodyCounts not_proposed;
  for (std::size_t s = 0; s < segments.members.size(); ++s)
    if (const auto sphere = sphere_from_normals(cloud, segments.members[s]))
      if (std::size_t BodyCounts::*const fault = propose(*sphere, segments.found_by(s + 1), bodies, candidates))
        ++(not_proposed.*fault);
  const Grid<S> grid(cloud, static_cast<S>(bodies.cell()), threads);
  propose_voted(cloud, cloud, {}, grid, stages, parameters, candidates, evidence.single_view());
  for (const MaskBody& m : evidence.masks.bodies)
    candidates.push_back({m.fit.body, "mask", nullptr, m.fit, m.log_odds});
  const bool settles = settled(evidence);
  BodyParameters winners = bodies;
  if (settles) winners.min_confidence *= kShareToWin;
  out.found = find_bodies_near(cloud, grid, candidates, winners, evidence, &out.bodies);
  out.bodies.too_small += not_proposed.too_small;
  out.bodies.too_large += not_proposed.too_large;
  out.bodies.inside_out += not_proposed.inside_out;
  out.labels = assign_to_bodies_near(cloud, grid, out.found, bodies);
  refit(cloud, grid, bodies, out.found, out.labels);
  if (settles) settle(cloud, grid, bodies, expected, evidence, out);
  extend_labels(out.labels, cloud, out.found, out.regions, out.regions_found, bodies);

  std::vector<std::size_t> sizes(segments.members.size() + 1, 0);
  for (std::size_t s = 0; s < segments.members.size(); ++s) sizes[s + 1] = segments.members[s].size();
  auto own = indices_by_label(out.labels);
  own.resize(out.found.size());
  for (std::size_t b = 0; b < out.found.size(); ++b)
    if (!out.found[b].by_mask) out.found[b].found_by = found_by(own[b], segments, sizes);
}

}  // namespace detail

/// Segment a cloud with outward normals into fruit.
/// @param cloud points (m) with normals
/// @param parameters see their struct
/// @param evidence of sight lines and masks; only bodies use it
/// @param threads the result does not depend on it
/// @throws ParameterError; InputError if the cloud has no normals; Cancelled
template <typename S>
Split split(const PointCloud<S>& cloud, const SplitParameters& parameters = {}, const BodyEvidence& evidence = {},
            int threads = 1) {
  parameters.check();
  check_lengths(cloud);
  check_input(cloud.normals.size() == cloud.points.size(), "split: the cloud has no normals");
  Split out;
  out.labels.assign(cloud.size(), 0);
  out.regions.assign(cloud.size(), 0);
  if (cloud.empty()) return out;
  SplitParameters sought = parameters;
  if (detail::settled(evidence)) sought.bodies = detail::sought_in_single_view(parameters.bodies);
  const auto stages = stages_for(parameters.adaptive ? estimate_spacing(cloud) : 0.0, sought);
  if (!stages) return out;

  const detail::Segments segments = detail::find_segments(cloud, *stages, threads, out);
  if (parameters.fit_bodies) {
    detail::split_by_bodies(cloud, segments, *stages, sought, parameters.bodies, evidence, threads, out);
    return out;
  }
  out.labels = segments.labels;
  for (std::size_t s = 0; s < segments.members.size(); ++s) {
    FoundBody found;
    found.found_by = segments.found_by(s + 1);
    out.found.push_back(std::move(found));
  }
  return out;
}

/// Update the bodies of a cloud that has grown, or changed a little, since the bodies `known` were found. These compete
/// again with bodies for which the other points vote. Much faster than `split`, and as good while the cloud grows view
/// by view. Bodies keep their `found_by`. Points are labeled by the body on which they lie; no regions are grown.
/// @param cloud points (m) with normals
/// @param known bodies found before
/// @param parameters see their struct
/// @param evidence of sight lines and masks, of several views
/// @param fresh one per point, nonzero for new ones; empty: all are new
/// @throws ParameterError; InputError if the cloud has no normals; Cancelled
template <typename S>
Split track(const PointCloud<S>& cloud, const std::vector<FoundBody>& known, const SplitParameters& parameters = {},
            const BodyEvidence& evidence = {}, const std::vector<char>& fresh = {}) {
  parameters.check();
  check_lengths(cloud);
  check_input(cloud.normals.size() == cloud.points.size(), "track: the cloud has no normals");
  check_input(fresh.empty() || fresh.size() == cloud.size(), "track: fresh needs one value a point");
  Split out;
  out.labels.assign(cloud.size(), 0);
  if (cloud.empty()) return out;
  const BodyParameters& bodies = parameters.bodies;
  const Grid<S> grid(cloud, static_cast<S>(bodies.cell()));
  const auto stages = stages_for(estimate_spacing(cloud, grid), parameters);
  if (!stages) return out;
  std::vector<BodyCandidate> candidates;
  for (const FoundBody& k : known) {
    if (k.by_mask) continue;  // its masks propose it again
    candidates.push_back({k.fit.body, k.found_by});
    if (!fresh.empty() && !detail::has_changed(grid, k.fit.body, fresh)) candidates.back().fit = k.fit;
  }
  const Indices off_them = residual(detail::assign_to_bodies_near(cloud, grid, known, bodies));
  std::vector<char> fresh_off_them;
  if (!fresh.empty())
    for (const Index i : off_them) fresh_off_them.push_back(fresh[static_cast<std::size_t>(i)]);
  detail::propose_voted(cloud, select(cloud, off_them), fresh_off_them, grid, *stages, parameters, candidates);
  for (const MaskBody& m : evidence.masks.bodies)
    candidates.push_back({m.fit.body, "mask", nullptr, m.fit, m.log_odds});
  out.found = detail::find_bodies_near(cloud, grid, candidates, bodies, evidence, nullptr);
  out.labels = detail::assign_to_bodies_near(cloud, grid, out.found, bodies);
  return out;
}

}  // namespace agrisee
