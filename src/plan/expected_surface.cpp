// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/expected_surface.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloud/searches.hpp"
#include "plan/body_surface.hpp"
#include "plan/fruit_occlusion.hpp"
#include "plan/obstacle_image.hpp"

namespace agrisee::plan {

namespace {

constexpr double kObstacle = 0.003;  // points that may hide fruit are thinned to one in a voxel of this edge (m)
constexpr double kGrowth = 1.25;     // segment the cloud from scratch when it has grown by this factor
constexpr double kSmaller = 0.97;    // a fruit hides and contains what an ellipsoid smaller by this factor does
constexpr double kPatience = 0.5;    // what is not surely a fruit counts so much after each view that looked at it

/// The merged cloud with estimated normals, each turned towards the view that saw its point: for views that are merged
/// as raw points.
Cloud with_normals(const Progress& progress) {
  Cloud cloud = progress.cloud;
  NormalParameters normals;
  if (const double spacing = estimate_spacing(cloud); spacing > 0.0) normals.radius = 3.0 * spacing;
  std::vector<Eigen::Vector3d> sensors;
  for (const View& v : progress.views) sensors.push_back(v.world_T_optical.translation());
  cloud.normals = orient_normals_to_views(estimate_normals(cloud, normals), cloud, cloud.views, sensors);
  return cloud;
}

/// For each point whether it was first seen in a view from this number on; empty where that is not known.
std::vector<char> points_since(const Cloud& cloud, std::size_t view) {
  std::vector<char> since;
  for (const int v : cloud.views) since.push_back(v >= static_cast<int>(view));
  return since;
}

/// How much a view counts that did not show what was expected of it, 0..1: the share of the surface in front of it that
/// it measured, but at least a quarter, so that no view is tried for ever. A view of which nothing was taken counts in
/// full.
double measured_share(const sensor::SurfaceImage& image, const fuse::FreeSpaceParameters& free_space) {
  constexpr double kLeast = 0.25;
  return image.depth.empty() || image.fill >= free_space.min_fill ? 1.0 : std::max(kLeast, image.fill);
}

/// Whether an image tells where surface can be seen: not that of a view of which nothing was taken, nor one without
/// returns.
bool has_returns(const sensor::SurfaceImage& image) {
  return std::any_of(image.depth.begin(), image.depth.end(), [](float z) { return z > 0.0f; });
}

/// Whether the last view has become part of the map with at least some points. A view that was discarded, or a frame
/// without returns, says nothing of what its pose can show.
bool shows_anything(const Progress& progress) {
  return !progress.views.empty() && !progress.views.back().discarded && progress.views.back().points_in > 0 &&
         (progress.images.empty() || !progress.images.back().depth.empty());
}

/// @throws ParameterError for a field out of its range
const ExpectedSurfaceParameters& checked(const ExpectedSurfaceParameters& parameters) {
  parameters.check();
  return parameters;
}

}  // namespace

ExpectedSurface::ExpectedSurface(const sensor::DepthCamera& sensor, const Aabb& volume,
                                 const ExpectedSurfaceParameters& parameters, int threads)
    : sensor_(sensor),
      volume_(volume),
      parameters_(checked(parameters)),
      threads_(threads),
      known_(volume, parameters.voxel) {}

void ExpectedSurface::update(const Progress& progress, const SplitParameters& split_parameters,
                             const fuse::FreeSpaceParameters& free_space) {
  const std::vector<Promise> promised = promises(progress);
  if (shows_anything(progress)) count_looks(promised);
  read_sight_lines(progress.images, free_space);
  const Labels labels = find_fruit(progress, split_parameters, free_space);
  const Grid<float> grid(progress.cloud, static_cast<float>(parameters_.cover_radius), threads_);
  collect_samples(progress, grid, free_space);
  record_outcome(progress, promised, grid, free_space);
  collect_obstacles(progress.cloud, labels);
  lower_missed(progress.images, free_space);
}

std::vector<ExpectedSurface::Promise> ExpectedSurface::promises(const Progress& progress) const {
  std::vector<Promise> out;
  if (progress.views.empty()) return out;
  for_each_shown(progress.views.back().world_T_optical, [&](std::size_t i) {
    out.push_back({samples_[i].point, samples_[i].body, areas_[i]});
  });
  return out;
}

void ExpectedSurface::count_looks(const std::vector<Promise>& promised) {
  constexpr double kLook = 0.02;  // of a body's surface
  std::vector<int> shown(bodies_.size(), 0);
  for (const Promise& p : promised)
    if (p.body >= 0) ++shown[static_cast<std::size_t>(p.body)];
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (!is_sure(bodies_[b]) && shown[b] >= kLook * parameters_.samples) vain_looks_.add(bodies_[b].fit.body);
}

void ExpectedSurface::read_sight_lines(const std::vector<sensor::SurfaceImage>& images,
                                       const fuse::FreeSpaceParameters& free_space) {
  std::vector<char> show;
  for (const sensor::SurfaceImage& image : images) show.push_back(!image.depth.empty());
  if (!std::equal(images_read_.begin(), images_read_.end(), show.begin(),
                  show.begin() + static_cast<std::ptrdiff_t>(std::min(images_read_.size(), show.size())))) {
    known_ = KnownSpace(volume_, parameters_.voxel);
    images_read_.clear();
    bodies_.clear();
    vain_looks_.clear();
    tracked_views_ = segmented_at_ = 0;
  }
  for (std::size_t v = images_read_.size(); v < images.size(); ++v) known_.add(images[v], free_space);
  images_read_ = std::move(show);
}

Labels ExpectedSurface::find_fruit(const Progress& progress, const SplitParameters& split_parameters,
                                   const fuse::FreeSpaceParameters& free_space) {
  // The model needs bodies, whatever stages the final segmentation uses.
  SplitParameters with_bodies = split_parameters;
  with_bodies.adaptive = with_bodies.fit_bodies = true;
  with_bodies.bodies.ridge = 0.0;  // what few views have seen looks less round than it is
  with_bodies.bodies.normal_noise = std::max(with_bodies.bodies.normal_noise, sensor::normal_noise(progress.images));
  min_confidence_ = split_parameters.bodies.min_confidence;
  with_bodies.bodies.min_confidence = std::min(min_confidence_, parameters_.least_confidence);
  BodyEvidence evidence;
  evidence.seen_through = [&](const Ellipsoid& b) { return fuse::seen_through(progress.images, b, free_space); };
  if (progress.masks) evidence.masks = *progress.masks;
  const bool fused = progress.cloud.normals.size() == progress.cloud.size();
  const Cloud estimated = fused ? Cloud() : with_normals(progress);
  const Cloud& cloud = fused ? progress.cloud : estimated;
  // Segment from scratch while the cloud grows fast; later only bring the known fruit up to date.
  const bool anew = bodies_.empty() || static_cast<double>(cloud.size()) > kGrowth * static_cast<double>(segmented_at_);
  Split found = anew ? split(cloud, with_bodies, evidence, threads_)
                     : track(cloud, bodies_, with_bodies, evidence, points_since(cloud, tracked_views_));
  tracked_views_ = progress.views.size();
  if (anew) segmented_at_ = cloud.size();
  bodies_ = std::move(found.found);
  return std::move(found.labels);
}

void ExpectedSurface::collect_samples(const Progress& progress, const Grid<float>& grid,
                                      const fuse::FreeSpaceParameters& free_space) {
  samples_.clear();
  areas_.clear();
  occluders_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Ellipsoid& body = bodies_[b].fit.body;
    if (believed(bodies_[b]))
      occluders_.push_back({body.center.cast<float>(), (body.A / kSmaller).cast<float>(),
                            static_cast<float>(kSmaller * semi_axes(body).first[0]), static_cast<int>(b)});
  }
  area_ = covered_ = 0.0;
  surface_of_.clear();
  const Aabb cloud_extent = bounding_box(progress.cloud.points);
  extent_ = cloud_extent.empty() ? volume_ : cloud_extent;
  center_ = extent_.center();
  if (!bodies_.empty()) extent_ = {}, center_.setZero();
  sample_bodies(progress, grid, free_space);
  sample_unknown_space(cloud_extent);
}

void ExpectedSurface::sample_bodies(const Progress& progress, const Grid<float>& grid,
                                    const fuse::FreeSpaceParameters& free_space) {
  // Any point near a fruit's surface covers it, also points of calyx and stem: no more will be seen behind them.
  const auto cover = static_cast<float>(parameters_.cover_radius);
  const auto is_covered = [&](const Eigen::Vector3d& p) { return grid.count(p.cast<float>(), cover, 1) > 0; };
  const std::vector<Eigen::Vector3d> directions = spread_directions(parameters_.samples);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Ellipsoid& body = bodies_[b].fit.body;
    center_ += body.center / static_cast<double>(bodies_.size());
    for (int side : {-1, 1}) extent_.extend(body.center + Eigen::Vector3d::Constant(side * body.mean_radius()));
    const double r = body.mean_radius();
    const double weight = weight_of(bodies_[b]), share = 4.0 * kPi * r * r / parameters_.samples;
    double covered = 0.0;
    for (const Eigen::Vector3d& d : directions) {
      const Eigen::Vector3d p = body.surface(d);
      if (is_covered(p) || is_below_lobe(progress.cloud, grid, p, d, r, cover)) {
        covered += share;
        continue;
      }
      const Eigen::Vector3d normal = body.normal(p);
      const auto at = carved(p, normal, body.center, progress.images, free_space);
      if (at && is_covered(*at))
        covered += share;
      else if (at && !inside_other(*at, static_cast<int>(b)))
        add_sample(*at, normal, weight * share, static_cast<int>(b));
    }
    surface_of_.push_back({share * parameters_.samples, covered, weight});
    area_ += weight * surface_of_.back().area;
    covered_ += weight * covered;
  }
}

void ExpectedSurface::sample_unknown_space(const Aabb& cloud) {
  constexpr std::size_t kEvery = 8;  // far from fruit one voxel stands for so many
  const double area = parameters_.unknown_weight * known_.edge() * known_.edge();
  std::size_t far = 0;
  known_.for_each_unknown([&](const Eigen::Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const FoundBody& b : bodies_)
      if (believed(b)) nearest = std::min(nearest, (p - b.fit.body.center).norm() - b.fit.body.mean_radius());
    if (bodies_.empty() && cloud.distance(p) < parameters_.neighborhood) nearest = 0.0;
    if (nearest >= 0.0 && nearest <= parameters_.neighborhood)
      add_sample(p, Eigen::Vector3d::Zero(), area, -1);
    else if (nearest > 0.0 && parameters_.elsewhere > 0.0 && far++ % kEvery == 0)
      add_sample(p, Eigen::Vector3d::Zero(), double(kEvery) * parameters_.elsewhere * area, -1);
  });
}

void ExpectedSurface::add_sample(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double area, int body) {
  samples_.push_back({point.cast<float>(), normal.cast<float>(), body});
  areas_.push_back(static_cast<float>(area));
}

double ExpectedSurface::weight_of(const FoundBody& body) const {
  const double weight = std::min(1.0, 2.0 * body.confidence);  // a fruit, if it is more likely one than not
  return is_sure(body) ? weight : weight * std::pow(kPatience, vain_looks_.count(body.fit.body));
}

bool ExpectedSurface::inside_other(const Eigen::Vector3d& point, int own) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (static_cast<int>(b) != own && believed(bodies_[b]) &&
        (bodies_[b].fit.body.A * (point - bodies_[b].fit.body.center)).squaredNorm() < kSmaller * kSmaller)
      return true;
  return false;
}

PromiseRecord::Outcome ExpectedSurface::outcome_of(const std::vector<Promise>& promised,
                                                   const Grid<float>& grid) const {
  const auto cover = static_cast<float>(parameters_.cover_radius);
  PromiseRecord::Outcome out;
  for (const Promise& p : promised) {
    out.promised += double(p.area);
    if (p.body < 0 ? known_.has(p.point.cast<double>()) : grid.count(p.point, cover, 1) > 0) out.kept += double(p.area);
  }
  return out;
}

void ExpectedSurface::record_outcome(const Progress& progress, const std::vector<Promise>& promised,
                                     const Grid<float>& grid, const fuse::FreeSpaceParameters& free_space) {
  if (promised.empty()) return;
  const PromiseRecord::Outcome outcome = outcome_of(promised, grid);
  if (shows_anything(progress))
    record_.weigh(outcome, progress.images.empty() ? 1.0 : measured_share(progress.images.back(), free_space));
  // A view without returns is blind, too: something stands nearer than the camera measures.
  const View& view = progress.views.back();
  if (!view.discarded && outcome.blind()) record_.add_blind(view.world_T_optical);
}

void ExpectedSurface::collect_obstacles(const Cloud& cloud, const Labels& labels) {
  PointCloud<float> rest;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (labels[i] == 0) rest.points.push_back(cloud.points[i]);
  const std::vector<Eigen::Vector3f> thinned = average_in_voxels(rest, kObstacle).points;
  obstacles_.clear();
  for (const int axis : {0, 1, 2})
    for (const Eigen::Vector3f& p : thinned) obstacles_.push_back(p[axis]);
}

void ExpectedSurface::lower_missed(const std::vector<sensor::SurfaceImage>& images,
                                   const fuse::FreeSpaceParameters& free_space) {
  observable_ = areas_;
  std::vector<std::vector<std::uint32_t>> shown_in(images.size());
  parallel_for(
      shown_in.size(), threads_, [&](std::size_t v) { shown_in[v] = shown(images[v].world_T_optical); }, 1);
  for (std::size_t v = 0; v < shown_in.size(); ++v) {
    const auto factor =
        static_cast<float>(1.0 - (1.0 - parameters_.missed_factor) * measured_share(images[v], free_space));
    const bool tells = has_returns(images[v]);
    for (const std::uint32_t i : shown_in[v]) {
      areas_[i] *= factor;
      if (tells) observable_[i] *= factor;
    }
  }
}

template <typename F>
void ExpectedSurface::for_each_shown(const Pose& world_T_optical, F&& f) const {
  const Eigen::Isometry3f optical_T_world = world_T_optical.inverse(Eigen::Isometry).cast<float>();
  const Eigen::Vector3f camera = world_T_optical.translation().cast<float>();
  const auto cos_max = static_cast<float>(std::cos(parameters_.max_incidence));
  const auto near_sq = static_cast<float>(sensor_.range_min * sensor_.range_min);
  const auto far_sq = static_cast<float>(sensor_.range_max * sensor_.range_max);
  const Coordinates obstacles(obstacles_.data(), static_cast<Eigen::Index>(obstacles_.size() / 3), 3);
  const ObstacleImage image(sensor_.intrinsics, optical_T_world, obstacles);
  const FruitOcclusion fruit(occluders_, camera);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    const Eigen::Vector3f d = s.point - camera;
    const float distance_sq = d.squaredNorm();
    if (distance_sq < near_sq || distance_sq > far_sq) continue;
    const float distance = std::sqrt(distance_sq);
    if (s.body >= 0 && -d.dot(s.normal) < cos_max * distance) continue;
    if (!image.shows(optical_T_world * s.point)) continue;
    if (!fruit.hides(d / distance, distance, s.body)) f(i);
  }
}

std::vector<std::uint32_t> ExpectedSurface::shown(const Pose& world_T_optical) const {
  std::vector<std::uint32_t> out;
  for_each_shown(world_T_optical, [&](std::size_t i) { out.push_back(static_cast<std::uint32_t>(i)); });
  return out;
}

double ExpectedSurface::gain(const std::vector<std::uint32_t>& shown) const {
  double area = 0.0;
  for (const std::uint32_t i : shown) area += double(areas_[i]);
  return area;
}

Completeness ExpectedSurface::completeness(const std::vector<char>& can_be_seen) const {
  Completeness out;
  std::vector<double> open(bodies_.size(), 0.0);  // unseen surface of each fruit that can be seen (m2), weighted
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (samples_[i].body >= 0 && can_be_seen[i])
      open[static_cast<std::size_t>(samples_[i].body)] += double(observable_[i]);
  double all = 0.0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!believed(bodies_[b])) continue;
    const auto& [area, seen, weight] = surface_of_[b];
    const double observable = seen + open[b] / weight;
    out.fruits.push_back({bodies_[b].fit.body.center, seen / area, observable / area});
    out.seen += seen;
    out.observable += observable;
    all += area;
  }
  if (all > 0.0) out.seen /= all, out.observable /= all;
  return out;
}

}  // namespace agrisee::plan
