// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/icp.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/fuse/body_errors.hpp>
#include <agrisee/fuse/fused_views.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>

#include <algorithm>
#include <numeric>
#include <utility>

#include "cloud/searches.hpp"

namespace agrisee::fuse {
namespace {

/// A view with as many points near bodies tells as much of them as the comparisons need.
constexpr std::size_t kEnoughOnBodies = 250;

/// Move an image with all it shows.
void move_image(sensor::SurfaceImage& image, const Pose& to_T_from) {
  const Eigen::Isometry3f motion = to_T_from.cast<float>();
  for (std::size_t c = 0; c < image.points.size(); ++c) {
    image.points[c] = motion * image.points[c];
    image.normals[c] = motion.linear() * image.normals[c];
  }
  image.world_T_optical = to_T_from * image.world_T_optical;
}

/// What may belong to bodies: a ball around each (m), wide enough for fuse::body_errors and fuse::check_calibration.
std::vector<Sphere> balls_around(const std::vector<Ellipsoid>& bodies) {
  std::vector<Sphere> out;
  for (const Ellipsoid& body : bodies)
    out.push_back({body.center, semi_axes(body).first.maxCoeff() + 0.5 * body.mean_radius()});
  return out;
}

/// The numbers of the points that lie inside of balls.
std::vector<std::size_t> inside_of(const std::vector<Eigen::Vector3f>& points, const std::vector<Sphere>& balls) {
  Aabb around;
  for (const Sphere& ball : balls) {
    around.extend(ball.center.array() - ball.radius);
    around.extend(ball.center.array() + ball.radius);
  }
  std::vector<std::size_t> inside;
  for (std::size_t c = 0; c < points.size(); ++c) {
    const Eigen::Vector3d p = points[c].cast<double>();
    if (!around.contains(p)) continue;
    const auto holds = [&](const Sphere& ball) { return (p - ball.center).squaredNorm() <= ball.radius * ball.radius; };
    if (std::any_of(balls.begin(), balls.end(), holds)) inside.push_back(c);
  }
  return inside;
}

/// An image where it was before it was registered to a map.
sensor::SurfaceImage as_reported(sensor::SurfaceImage image, const Pose& reported) {
  if (image.world_T_optical.matrix() == reported.matrix()) return image;
  move_image(image, reported * image.world_T_optical.inverse(Eigen::Isometry));
  image.world_T_optical = reported;
  return image;
}

}  // namespace

FusedViews::FusedViews(const Aabb& scan_volume, const FusionParameters& parameters, int threads)
    : scan_volume_(scan_volume), parameters_(parameters), threads_(threads), surfels_(parameters.surfels) {}

Observation FusedViews::look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const {
  Observation out;
  out.surface = sensor::reconstruct_surface(frame, world_T_optical, scan_volume_, parameters_.surface, threads_);
  out.surface.fill = std::min(out.surface.fill, measured_again(out.surface).share());
  if (!parameters_.register_views) return out;
  if (contradicted(out.surface)) {
    // A pose that is wrong by millimetres contradicts at borders and thin parts, until the view is registered.
    sensor::SurfaceImage registered = out.surface;
    lay_on_map(registered);
    if (contradicted(registered)) {
      out.consistent = false;
      return out;
    }
    out.surface = std::move(registered);
  }
  lay_on_map(out.surface);
  return out;
}

Change FusedViews::skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) {
  begin(world_T_optical, 0, true);
  Change change;
  change.points_in = count_inside(frame, world_T_optical, scan_volume_);
  return change;
}

Change FusedViews::take(Observation seen, const Pose& world_T_optical) {
  const detail::CancellationSwap to_the_end(nullptr);  // a map changed by half would be neither the old nor the new
  const std::size_t id = begin(world_T_optical, seen.surface.points_in, false);
  Change change;
  change.points_in = seen.surface.points_in;
  change.observed = seen.surface.points;
  seen_.emplace(id, as_reported(seen.surface, world_T_optical));
  if (seen.consistent) {
    add(std::move(seen.surface), id, change.added);
    count_refuting();
    return change;
  }
  // Do more of the discarded views agree with this one than there are views in the map?
  std::vector<std::size_t> group = views_that_agree(seen.surface);
  group.push_back(id);
  if (group.size() > views_in_map()) {
    start_again(group, change);
    count_refuting();
  } else {
    views_[id].discarded = true;
  }
  return change;
}

Cloud FusedViews::all() const {
  Cloud out = surfels_.cloud();
  out.normals.clear();
  return out;
}

Cloud FusedViews::cloud() const {
  Cloud out;
  for (std::size_t i = 0; i < surfels_.size(); ++i) {
    const Surfel& s = surfels_.surfels()[i];
    const int through = refuting_[i].views;
    if (through >= parameters_.free_space.min_refuting && through >= s.seen_by) continue;
    out.points.push_back(s.position);
    out.normals.push_back(s.normal);
    out.views.push_back(s.view);
  }
  return out;
}

Cloud FusedViews::alone(std::size_t view) const {
  Cloud out;
  if (const auto seen = seen_.find(view); seen != seen_.end()) {
    out.points = seen->second.points;
    out.normals = seen->second.normals;
  }
  return out;
}

Eigen::Vector3d FusedViews::shift_to_reported(const Eigen::Vector3d& center) const {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  std::size_t used = 0;
  for (std::size_t v = 0; v < images_.size(); ++v) {
    if (!views_[v].in_map()) continue;
    const Pose reported_T_registered = views_[v].reported * images_[v].world_T_optical.inverse(Eigen::Isometry);
    shift += reported_T_registered * center - center;
    ++used;
  }
  return shift / static_cast<double>(std::max<std::size_t>(used, 1));
}

std::vector<BodyErrors> FusedViews::body_errors(const std::vector<Ellipsoid>& bodies,
                                                const FitParameters& parameters) const {
  std::vector<sensor::SurfaceImage> parts;
  return fuse::body_errors(bodies, registered_views(bodies, parts), parameters);
}

CalibrationCheck FusedViews::check_calibration(const std::vector<Ellipsoid>& bodies) const {
  std::vector<sensor::SurfaceImage> parts;
  return fuse::check_calibration(registered_views(bodies, parts), bodies);
}

/// What a view of the map shows near bodies, registered: some points, evenly picked.
sensor::SurfaceImage FusedViews::near_bodies(std::size_t view, std::vector<Sphere> balls) const {
  const sensor::SurfaceImage& whole = seen_.at(view);
  const Pose& registered = images_[view].world_T_optical;
  const Pose reported_T_registered = views_[view].reported * registered.inverse(Eigen::Isometry);
  for (Sphere& ball : balls) ball.center = reported_T_registered * ball.center;
  sensor::SurfaceImage out;
  out.noise = whole.noise;
  out.world_T_optical = views_[view].reported;
  const std::vector<std::size_t> inside = inside_of(whole.points, balls);
  const std::size_t step = std::max<std::size_t>(1, inside.size() / kEnoughOnBodies);
  for (std::size_t i = 0; i < inside.size(); i += step) {
    out.points.push_back(whole.points[inside[i]]);
    out.normals.push_back(whole.normals[inside[i]]);
  }
  move_image(out, reported_T_registered.inverse(Eigen::Isometry));
  out.world_T_optical = registered;
  return out;
}

/// The views of the map that show something, with points on bodies: those that are kept to compare views with, or
/// others of the whole image where these hardly touch the bodies, because the view shows much else.
/// @param parts receives what is taken of whole images
std::vector<RegisteredView> FusedViews::registered_views(const std::vector<Ellipsoid>& bodies,
                                                         std::vector<sensor::SurfaceImage>& parts) const {
  const std::vector<Sphere> balls = balls_around(bodies);
  parts.assign(images_.size(), {});
  std::vector<RegisteredView> views;
  for (std::size_t v = 0; v < images_.size(); ++v) {
    if (!views_[v].in_map()) continue;
    throw_if_cancelled();
    const bool all_kept = images_[v].points.size() == seen_.at(v).points.size();
    const bool enough = all_kept || inside_of(images_[v].points, balls).size() >= kEnoughOnBodies;
    if (!enough) parts[v] = near_bodies(v, balls);
    views.push_back({enough ? &images_[v] : &parts[v], views_[v].reported, v});
  }
  return views;
}

/// A new view, of which only the pose is known so far.
/// @return its number
std::size_t FusedViews::begin(const Pose& world_T_optical, std::size_t points_in, bool discarded) {
  views_.push_back({world_T_optical, points_in, discarded});
  images_.emplace_back();  // an image without cells is no evidence of anything
  images_.back().world_T_optical = world_T_optical;
  return images_.size() - 1;
}

/// True when two views share enough surface, and contradict each other in little of it.
bool FusedViews::agree(const Evidence& evidence) const {
  constexpr std::size_t kEnough = 50;
  return evidence.count() >= kEnough && evidence.contradiction() <= parameters_.free_space.max_contradiction;
}

/// True when the views of the map looked through what the image shows, or the image looks through what they show.
bool FusedViews::contradicted(const sensor::SurfaceImage& image) const {
  Evidence all;
  for (const auto& other : images_) all += compare(image, other, parameters_.free_space);
  return all.contradiction() > parameters_.free_space.max_contradiction;
}

/// How much of what the views of the map show an image measures again.
Returned FusedViews::measured_again(const sensor::SurfaceImage& image) const {
  Returned all;
  for (const auto& other : images_) all += returned(image, other, parameters_.free_space);
  return all;
}

/// Learn from a new image how much of what they look at the earlier views measure.
void FusedViews::learn_returns(const sensor::SurfaceImage& image) {
  measured_.resize(images_.size());
  for (std::size_t v = 0; v < images_.size(); ++v) {
    sensor::SurfaceImage& other = images_[v];
    measured_[v] += returned(other, image, parameters_.free_space);
    const bool was_full = other.fill >= parameters_.free_space.min_fill;
    other.fill = std::min(other.fill, measured_[v].share());
    if (was_full && other.fill < parameters_.free_space.min_fill) refuting_.clear();  // to be counted again
  }
}

/// The discarded views that agree with an image, by number.
std::vector<std::size_t> FusedViews::views_that_agree(const sensor::SurfaceImage& image) const {
  std::vector<std::size_t> group;
  for (const auto& [number, other] : seen_)
    if (views_[number].discarded && agree(compare(other, image, parameters_.free_space))) group.push_back(number);
  return group;
}

/// Number of earlier views that the map is made of.
std::size_t FusedViews::views_in_map() const {
  std::size_t count = 0;
  for (std::size_t v = 0; v + 1 < views_.size(); ++v) count += views_[v].in_map();
  return count;
}

/// Make the map anew of some discarded views; all others are discarded, but remembered.
void FusedViews::start_again(const std::vector<std::size_t>& views, Change& change) {
  const std::size_t before = surfels_.size();
  surfels_ = SurfelMap(parameters_.surfels);
  refuting_.clear();
  measured_.clear();
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (!views_[v].discarded && views_[v].points_in == 0) continue;  // of empty space, which contradicts no map
    views_[v].discarded = true;
    if (!images_[v].depth.empty()) seen_.at(v).depth = std::move(images_[v].depth);
    images_[v] = {};
    images_[v].world_T_optical = views_[v].reported;
  }
  for (const std::size_t v : views) {
    views_[v].discarded = false;
    sensor::SurfaceImage image = seen_.at(v);
    lay_on_map(image);
    add(std::move(image), v, change.added);
  }
  change.kept.emplace(change.added.size());
  std::iota(change.kept->begin(), change.kept->end(), static_cast<Index>(before));
}

/// Add an image, registered already, to the map.
void FusedViews::add(sensor::SurfaceImage image, std::size_t id, std::vector<Eigen::Vector3f>& added) {
  for (std::size_t c = 0; c < image.points.size(); ++c)
    if (surfels_.add(image.points[c], image.normals[c], image.sigma[c], static_cast<int>(id)))
      added.push_back(image.points[c]);
  learn_returns(image);
  // From now on only the depths are needed, as evidence of free space, and some points to compare later views with.
  std::vector<Eigen::Vector3f> points, normals;
  const std::size_t step = compared_step(image);
  for (std::size_t c = 0; c < image.points.size(); c += step) {
    points.push_back(image.points[c]);
    normals.push_back(image.normals[c]);
  }
  image.points = std::move(points);
  image.normals = std::move(normals);
  image.sigma = std::vector<float>();  // = {} would keep the memory
  images_[id] = std::move(image);
  seen_.at(id).depth = std::vector<float>();  // images_ has them
}

/// Count the views that looked through each surfel. A surfel that has hardly moved since it was counted is only
/// compared with the views that came after.
void FusedViews::count_refuting() {
  const auto hardly = static_cast<float>(0.1 * parameters_.free_space.margin);
  refuting_.resize(surfels_.size());
  parallel_for(surfels_.size(), threads_, [&](std::size_t i) {
    const Surfel& s = surfels_.surfels()[i];
    Refuting& r = refuting_[i];
    if (r.compared > 0 && (s.position - r.position).norm() > hardly) r = {};
    if (r.compared == 0) r.position = s.position;
    for (; r.compared < images_.size(); ++r.compared)
      r.views +=
          refutes(images_[r.compared], s.position.cast<double>(), s.normal.cast<double>(), parameters_.free_space);
  });
}

/// Register an image to the map (ICP). It stays where it is when the registration is not accepted.
void FusedViews::lay_on_map(sensor::SurfaceImage& image) const {
  if (surfels_.size() == 0) return;
  Cloud source;
  const std::size_t step = std::max<std::size_t>(1, image.points.size() / 2500);
  for (std::size_t c = 0; c < image.points.size(); c += step) {
    source.points.push_back(image.points[c]);
    source.normals.push_back(image.normals[c]);
  }
  const Cloud target = surfels_.cloud();
  const IcpResult icp =
      register_cloud(source, source.normals, target, target.normals, parameters_.icp, Pose::Identity(), threads_);
  if (!icp.accepted) return;
  move_image(image, icp.target_T_source);
}

}  // namespace agrisee::fuse
