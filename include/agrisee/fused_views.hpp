// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The views of a scan laid on one another and fused into one surface; what contradicts the rest is not believed.
///
/// A view is discarded when its frame does not belong to its pose: where it puts surface others looked through, and
/// through what others saw it looked (plan/contradiction.hpp). Of views that contradict one another the more are
/// believed, so that a wrong first view is found out too. World frame, metres.
#pragma once

#include <agrisee/cloud/surfels.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/pipeline_stages.hpp>
#include <agrisee/plan/contradiction.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee {

/// The fused surface of a scan, and what each of its views saw.
class FusedViews {
 public:
  /// What a frame shows, laid on what is fused so far.
  struct Look {
    sensor::SurfaceImage image;  ///< its surface
    bool believed = false;       ///< if not, the image is as reported
  };

  /// What a view changed.
  struct Change {
    std::vector<Eigen::Vector3f> added;  ///< points that are new (m)
    std::optional<Indices> kept;  ///< where what was fused before is not believed any more: the points that are kept,
                                  ///< those from before counted
  };

  /// @param scan_volume what lies outside is left out (world)
  /// @param parameters of surface, surfels, registration and free space
  /// @param threads the result does not depend on it
  /// @throws ParameterError for those of surfels; for the others when they are first used
  FusedViews(const Aabb& scan_volume, const Parameters& parameters, int threads)
      : scan_volume_(scan_volume), parameters_(parameters), threads_(threads), surfels_(parameters.surfels) {}

  /// What a frame shows; changes nothing.
  /// @param frame depth z (m)
  /// @param world_T_optical pose of the sensor as reported
  /// @throws InputError as reconstruct_surface does; Cancelled
  Look look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const {
    Look out;
    out.image = detail::surface_of(frame, world_T_optical, scan_volume_, parameters_.surface, threads_);
    if (parameters_.register_views) {
      if (contradicted(out.image)) {
        // A pose that errs by millimetres contradicts at borders and thin parts, until the view is laid on the others.
        sensor::SurfaceImage laid = out.image;
        lay_on_fused(laid);
        if (contradicted(laid)) return out;
        out.image = std::move(laid);
      }
      lay_on_fused(out.image);
    }
    out.believed = true;
    return out;
  }

  /// A view that shows nothing to be believed: it counts as discarded, its pose alone is kept.
  /// @param world_T_optical pose of the sensor as reported
  void skip(const Pose& world_T_optical) { begin(world_T_optical, 0, true); }

  /// What a frame shows becomes part of what is fused, unless it is not believed. Not to be cancelled.
  /// @param look as the frame was seen
  /// @param world_T_optical its pose as reported
  /// @return what is new, and what is left of the old
  Change take(Look look, const Pose& world_T_optical) {
    const detail::CancellationSwap to_the_end(nullptr);  // half of it would be neither the old nor the new
    const std::size_t id = begin(world_T_optical, look.image.points_in, false);
    Change out;
    if (look.believed) {
      add(std::move(look.image), id, out.added);
      return out;
    }
    // Those of the views that were not believed which tell the same as this one; more of them than of the others?
    std::vector<std::size_t> group;
    for (const auto& [other, held] : held_)
      if (tell_the_same(plan::compare(held, look.image, parameters_.free_space))) group.push_back(other);
    held_.emplace(id, std::move(look.image));
    group.push_back(id);
    std::size_t believed = 0;
    for (std::size_t v = 0; v < id; ++v) believed += !views_[v].discarded && views_[v].points_in > 0;
    if (group.size() <= believed) {
      views_[id].discarded = true;
      return out;
    }
    const std::size_t before = surfels_.size();
    surfels_ = SurfelMap(parameters_.surfels);
    for (std::size_t v = 0; v <= id; ++v) {
      views_[v].discarded |= views_[v].points_in > 0;
      images_[v] = {};
      images_[v].world_T_optical = views_[v].reported;
    }
    for (const std::size_t v : group) {
      views_[v].discarded = false;
      lay_on_fused(held_.at(v));
      add(std::move(held_.at(v)), v, out.added);
      held_.erase(v);
    }
    out.kept.emplace(out.added.size());
    std::iota(out.kept->begin(), out.kept->end(), static_cast<Index>(before));
    return out;
  }

  /// Number of views.
  std::size_t size() const { return views_.size(); }
  /// Whether a view (its number, below size()) is not believed; it may come to be, or cease to be, with a later one.
  bool discarded(std::size_t view) const { return views_[view].discarded; }
  /// What each view saw; of discarded ones the pose alone.
  const std::vector<sensor::SurfaceImage>& images() const { return images_; }
  /// All surfels: points, normals, founding views.
  Cloud all() const { return surfels_.cloud(); }

  /// The fused surface; surfels that later sight lines went through are left out.
  Cloud cloud() const {
    Cloud out;
    for (const Surfel& s : surfels_.surfels()) {
      int through = 0;
      for (const auto& image : images_)
        through += plan::refutes(image, s.position.cast<double>(), parameters_.free_space);
      if (through >= parameters_.free_space.min_refuting && through >= s.seen_by) continue;
      out.points.push_back(s.position);
      out.normals.push_back(s.normal);
      out.views.push_back(s.view);
    }
    return out;
  }

  /// Registration lays every view on the first; the errors of that one view's pose would be the whole scan's. Over all
  /// views they average out.
  /// @param center of the cloud (m)
  /// @return how far the mean of where each view, as reported, would have put the centre lies from it (m)
  Eigen::Vector3d shift_to_reported(const Eigen::Vector3d& center) const {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    std::size_t believed = 0;
    for (std::size_t v = 0; v < images_.size(); ++v) {
      if (views_[v].discarded) continue;
      const Pose reported_T_registered = views_[v].reported * images_[v].world_T_optical.inverse(Eigen::Isometry);
      shift += reported_T_registered * center - center;
      ++believed;
    }
    return shift / static_cast<double>(std::max<std::size_t>(believed, 1));
  }

 private:
  struct Taken {
    Pose reported;
    std::size_t points_in;  // the scan volume
    bool discarded;
  };

  std::size_t begin(const Pose& world_T_optical, std::size_t points_in, bool discarded) {
    views_.push_back({world_T_optical, points_in, discarded});
    images_.emplace_back();  // nothing that counts as evidence
    images_.back().world_T_optical = world_T_optical;
    return images_.size() - 1;
  }

  bool tell_the_same(const plan::Evidence& evidence) const {
    constexpr std::size_t kEnough = 50;
    return evidence.count() >= kEnough && evidence.contradiction() <= parameters_.free_space.max_contradiction;
  }

  /// True when the views that are fused looked through what the image shows, or the other way round.
  bool contradicted(const sensor::SurfaceImage& image) const {
    plan::Evidence all;
    for (const auto& other : images_) all += plan::compare(image, other, parameters_.free_space);
    return all.contradiction() > parameters_.free_space.max_contradiction;
  }

  /// Add an image that is laid on what is fused so far.
  void add(sensor::SurfaceImage image, std::size_t id, std::vector<Eigen::Vector3f>& added) {
    for (std::size_t c = 0; c < image.points.size(); ++c)
      if (surfels_.add(image.points[c], image.normals[c], image.sigma[c], static_cast<int>(id)))
        added.push_back(image.points[c]);
    // The depths are needed from now on, as evidence of free space, and some points, to compare later views with.
    std::vector<Eigen::Vector3f> some;
    const std::size_t step = plan::compared_step(image);
    for (std::size_t c = 0; c < image.points.size(); c += step) some.push_back(image.points[c]);
    image.points = std::move(some);
    image.normals = {};
    image.sigma = {};
    images_[id] = std::move(image);
  }

  void lay_on_fused(sensor::SurfaceImage& image) const {
    if (surfels_.size() == 0) return;
    Cloud source;
    const std::size_t step = std::max<std::size_t>(1, image.points.size() / 2500);
    for (std::size_t c = 0; c < image.points.size(); c += step) {
      source.points.push_back(image.points[c]);
      source.normals.push_back(image.normals[c]);
    }
    const auto target_T_source = detail::registered(source, surfels_.cloud(), parameters_.icp);
    if (!target_T_source) return;
    const Eigen::Isometry3f correction = target_T_source->cast<float>();
    for (std::size_t c = 0; c < image.points.size(); ++c) {
      image.points[c] = correction * image.points[c];
      image.normals[c] = correction.linear() * image.normals[c];
    }
    image.world_T_optical = *target_T_source * image.world_T_optical;
  }

  Aabb scan_volume_;
  Parameters parameters_;
  int threads_;
  SurfelMap surfels_;
  std::vector<Taken> views_;
  std::vector<sensor::SurfaceImage> images_;          // what each view saw; of discarded ones the pose alone
  std::map<std::size_t, sensor::SurfaceImage> held_;  // what views saw that are not believed
};

}  // namespace agrisee
