// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a view is expected to show: the unseen parts of the bodies found so far, and unknown space in which more may
/// hide.
///
/// The merged cloud is split into bodies (split.hpp). Each predicts where the rest of its surface lies; those parts
/// that no point covers are samples, with the area they stand for. Beside them, voxels near the bodies that no sight
/// line has reached stand for what may still hide there. A view shows a sample when it lies in the image and the range,
/// faces the sensor, and no body or obstacle is in between. Samples that earlier views should have shown and did not
/// count less and less: the prediction is wrong there. Metres, world; gains in m2 of fruit surface.
#pragma once

#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/plan/gain_parameters.hpp>
#include <agrisee/sensor/l515.hpp>

#include <array>

namespace agrisee::plan {

/// The model of what has been seen and what has not.
class ExpectedSurface {
 public:
  /// Of a sensor and a volume to scan (world). @throws ParameterError
  ExpectedSurface(const sensor::L515& sensor, const Aabb& volume, const ExpectedSurfaceParameters& parameters)
      : sensor_(sensor), volume_(volume), parameters_(parameters) {
    parameters.check();
    const Eigen::Vector3d size = volume.size();
    // At most about two million voxels, whatever the volume.
    edge_ = parameters.voxel;
    while ((size / edge_).array().ceil().max(1.0).prod() > 2e6) edge_ *= 1.3;
    for (int a = 0; a < 3; ++a) dims_[a] = std::max(1, static_cast<int>(std::ceil(size[a] / edge_)));
    known_.assign(std::size_t(dims_[0]) * std::size_t(dims_[1]) * std::size_t(dims_[2]), 0);
  }

  /// Update the model after a view.
  void update(const Progress& progress, const SplitParameters& split_parameters,
              const FreeSpaceParameters& free_space) {
    for (; images_read_ < progress.images.size(); ++images_read_) carve(progress.images[images_read_], free_space);
    // Bodies are what this planner looks for, whatever the stages of the final split.
    SplitParameters with_bodies = split_parameters;
    with_bodies.adaptive = with_bodies.fit_bodies = true;
    const auto through = [&](const Ellipsoid& body) { return seen_through(progress.images, body, free_space); };
    const bool fused = progress.cloud.normals.size() == progress.cloud.size();
    const Cloud estimated = fused ? Cloud() : with_normals(progress);
    const Cloud& cloud = fused ? progress.cloud : estimated;
    // Anew while the cloud grows fast; later what is known is only brought up to date.
    const bool anew = bodies_.empty() || static_cast<double>(cloud.size()) > kGrowth * static_cast<double>(split_at_);
    const Split found = anew ? split(cloud, with_bodies, through) : track(cloud, bodies_, with_bodies, through);
    if (anew) split_at_ = cloud.size();
    bodies_ = found.found;
    collect_samples(progress);
    PointCloud<float> rest;
    for (std::size_t i = 0; i < progress.cloud.size(); ++i)
      if (found.labels[i] == 0) rest.points.push_back(progress.cloud.points[i]);
    obstacles_ = average_in_voxels(rest, 0.006).points;
    // Expectations that earlier views disappointed.
    for (const auto& image : progress.images)
      look(image.world_T_optical, [&](std::size_t i) { areas_[i] *= static_cast<float>(parameters_.disappointment); });
  }

  /// The samples of unseen surface that a view is expected to show, ascending.
  std::vector<std::uint32_t> shown(const Pose& world_T_optical) const {
    std::vector<std::uint32_t> out;
    look(world_T_optical, [&](std::size_t i) { out.push_back(static_cast<std::uint32_t>(i)); });
    return out;
  }
  /// Fruit surface (m2) that each sample stands for.
  const std::vector<float>& areas() const { return areas_; }
  /// Fruit surface (m2) that a view is expected to show for the first time.
  double gain(const Pose& world_T_optical) const {
    double area = 0.0;
    look(world_T_optical, [&](std::size_t i) { area += double(areas_[i]); });
    return area;
  }

  /// How complete the scan is, given which of the samples some reachable view shows.
  Completeness completeness(const std::vector<char>& can_be_seen) const {
    Completeness out;
    std::vector<double> open(bodies_.size(), 0.0);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (samples_[i].body >= 0 && can_be_seen[i])
        open[static_cast<std::size_t>(samples_[i].body)] += double(areas_[i]);
    double all = 0.0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const double seen = covered_of_[b], observable = seen + open[b];
      out.fruits.push_back({bodies_[b].fit.body.center, seen / area_of_[b], observable / area_of_[b]});
      out.seen += seen;
      out.observable += observable;
      all += area_of_[b];
    }
    if (all > 0.0) out.seen /= all, out.observable /= all;
    return out;
  }

  /// The bodies that are known.
  const std::vector<FoundBody>& bodies() const { return bodies_; }
  /// Surface (m2) of all bodies found so far, and the part of it that points cover.
  double area() const { return area_; }
  /// Their surface that points cover (m2).
  double covered_area() const { return covered_; }
  /// Centre of what is worth looking at: the mean of the bodies, else of the cloud's extent, else of the volume.
  const Eigen::Vector3d& center() const { return center_; }
  /// Box about the bodies, else about the cloud, else the volume (m).
  const Aabb& extent() const { return extent_; }

 private:
  static constexpr double kGrowth = 1.25;  // of the cloud, before it is split anew

  struct Sample {
    Eigen::Vector3f point, normal;  // zero normal: a voxel, seen from any side
    int body;                       // -1: a voxel
  };
  struct Occluder {
    Eigen::Vector3f center;
    float radius;
  };

  /// Raw points have no normals yet: estimated, and turned to the view that saw each.
  static Cloud with_normals(const Progress& progress) {
    Cloud cloud = progress.cloud;
    NormalParameters normals;
    if (const double spacing = estimate_spacing(cloud); spacing > 0.0) normals.radius = 3.0 * spacing;
    std::vector<Eigen::Vector3d> sensors;
    for (const View& v : progress.views) sensors.push_back(v.world_T_optical.translation());
    cloud.normals = orient_normals_to_views(estimate_normals(cloud, normals), cloud, cloud.views, sensors);
    return cloud;
  }

  void carve(const sensor::SurfaceImage& image, const FreeSpaceParameters& free_space) {
    std::size_t i = 0;
    for (int z = 0; z < dims_[2]; ++z)
      for (int y = 0; y < dims_[1]; ++y)
        for (int x = 0; x < dims_[0]; ++x, ++i)
          if (!known_[i] && sight(image, voxel_center(x, y, z), free_space) != Sight::unknown) known_[i] = 1;
  }

  Eigen::Vector3d voxel_center(int x, int y, int z) const {
    return volume_.min + edge_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
  }

  void collect_samples(const Progress& progress) {
    samples_.clear();
    areas_.clear();
    spheres_.clear();
    for (const FoundBody& b : bodies_)
      spheres_.push_back({b.fit.body.center.cast<float>(), static_cast<float>(0.97 * b.fit.body.mean_radius())});
    area_ = covered_ = 0.0;
    area_of_.clear();
    covered_of_.clear();
    extent_ = {};
    for (const auto& p : progress.cloud.points) extent_.extend(p.cast<double>());
    const Aabb cloud = extent_;
    if (extent_.empty()) extent_ = volume_;
    center_ = extent_.center();
    if (!bodies_.empty()) extent_ = {}, center_.setZero();
    // Anything near a body's surface covers it, calyx and stem included: behind them nothing more will show.
    const Grid<float> grid(progress.cloud, static_cast<float>(parameters_.cover_radius));
    const std::vector<Eigen::Vector3d> directions = spread_directions(parameters_.samples);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Ellipsoid& body = bodies_[b].fit.body;
      center_ += body.center / static_cast<double>(bodies_.size());
      for (int side : {-1, 1}) extent_.extend(body.center + Eigen::Vector3d::Constant(side * body.mean_radius()));
      const double r = body.mean_radius(), share = 4.0 * kPi * r * r / parameters_.samples;
      double covered = 0.0;
      for (const Eigen::Vector3d& d : directions) {
        const Eigen::Vector3d p = body.surface(d);
        if (grid.count(p.cast<float>(), static_cast<float>(parameters_.cover_radius), 1) > 0)
          covered += share;
        else if (!inside_other(p, static_cast<int>(b)))
          add_sample(p, body.normal(p), share, static_cast<int>(b));
      }
      area_of_.push_back(share * parameters_.samples);
      covered_of_.push_back(covered);
      area_ += area_of_.back();
      covered_ += covered;
    }
    std::size_t i = 0;
    for (int z = 0; z < dims_[2]; ++z)
      for (int y = 0; y < dims_[1]; ++y)
        for (int x = 0; x < dims_[0]; ++x, ++i) {
          if (known_[i]) continue;
          const Eigen::Vector3d p = voxel_center(x, y, z);
          double nearest = std::numeric_limits<double>::infinity();
          for (const FoundBody& b : bodies_)
            nearest = std::min(nearest, (p - b.fit.body.center).norm() - b.fit.body.mean_radius());
          if (bodies_.empty() && cloud.distance(p) < parameters_.neighborhood) nearest = edge_;
          if (nearest < 0.0 || nearest > parameters_.neighborhood) continue;
          add_sample(p, Eigen::Vector3d::Zero(), parameters_.unknown_weight * edge_ * edge_, -1);
        }
  }

  void add_sample(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double area, int body) {
    samples_.push_back({point.cast<float>(), normal.cast<float>(), body});
    areas_.push_back(static_cast<float>(area));
  }

  bool inside_other(const Eigen::Vector3d& p, int own) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (static_cast<int>(b) != own &&
          (p - bodies_[b].fit.body.center).norm() < 0.98 * bodies_[b].fit.body.mean_radius())
        return true;
    return false;
  }

  /// f(i) for every sample that a view shows.
  template <typename F>
  void look(const Pose& world_T_optical, F&& f) const {
    const sensor::Intrinsics& k = sensor_.intrinsics;
    const Eigen::Isometry3f optical_T_world = world_T_optical.inverse(Eigen::Isometry).cast<float>();
    const Eigen::Vector3f eye = world_T_optical.translation().cast<float>();
    const auto cos_max = static_cast<float>(std::cos(parameters_.max_incidence));
    const auto near_sq = static_cast<float>(sensor_.range_min * sensor_.range_min);
    const auto far_sq = static_cast<float>(sensor_.range_max * sensor_.range_max);
    // Obstacles: a coarse depth image.
    constexpr int kWidth = 96, kHeight = 72;
    const auto fx = static_cast<float>(k.fx / k.width * kWidth), fy = static_cast<float>(k.fy / k.height * kHeight);
    const auto cx = static_cast<float>((k.cx + 0.5) / k.width * kWidth),
               cy = static_cast<float>((k.cy + 0.5) / k.height * kHeight);
    std::array<float, kWidth * kHeight> depth;
    depth.fill(std::numeric_limits<float>::infinity());
    const auto pixel = [&](const Eigen::Vector3f& p) -> int {
      if (!(p.z() > 0.0f)) return -1;
      const float u = fx * p.x() / p.z() + cx, v = fy * p.y() / p.z() + cy;
      if (!(u >= 0.0f && v >= 0.0f && u < float(kWidth) && v < float(kHeight))) return -1;
      return static_cast<int>(v) * kWidth + static_cast<int>(u);
    };
    for (const Eigen::Vector3f& o : obstacles_) {
      const Eigen::Vector3f p = optical_T_world * o;
      const int c = pixel(p);
      if (c >= 0) depth[static_cast<std::size_t>(c)] = std::min(depth[static_cast<std::size_t>(c)], p.z());
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& s = samples_[i];
      const Eigen::Vector3f d = s.point - eye;
      const float distance_sq = d.squaredNorm();
      if (distance_sq < near_sq || distance_sq > far_sq) continue;
      const float distance = std::sqrt(distance_sq);
      if (s.body >= 0 && -d.dot(s.normal) < cos_max * distance) continue;
      const Eigen::Vector3f p = optical_T_world * s.point;
      const int c = pixel(p);
      if (c < 0 || depth[static_cast<std::size_t>(c)] < p.z() - 0.012f) continue;
      if (!hidden(eye, d / distance, distance, s.body)) f(i);
    }
  }

  bool hidden(const Eigen::Vector3f& eye, const Eigen::Vector3f& u, float distance, int own) const {
    for (std::size_t b = 0; b < spheres_.size(); ++b) {
      if (static_cast<int>(b) == own) continue;
      const Eigen::Vector3f c = spheres_[b].center - eye;
      const float r_sq = spheres_[b].radius * spheres_[b].radius, along = c.dot(u);
      const float off_sq = c.squaredNorm() - along * along;
      if (off_sq >= r_sq || along < 0.0f) continue;
      if (along - std::sqrt(r_sq - off_sq) < distance - 1e-3f) return true;
    }
    return false;
  }

  sensor::L515 sensor_;
  Aabb volume_;
  ExpectedSurfaceParameters parameters_;
  double edge_ = 0.0;
  Eigen::Vector3i dims_ = Eigen::Vector3i::Ones();
  std::vector<char> known_;  // one a voxel: some sight line has reached it
  std::size_t images_read_ = 0;
  std::vector<FoundBody> bodies_;
  std::size_t split_at_ = 0;  // points of the cloud when it was last split anew
  std::vector<Sample> samples_;
  std::vector<float> areas_;       // one a sample (m2)
  std::vector<Occluder> spheres_;  // the bodies, a little smaller
  std::vector<Eigen::Vector3f> obstacles_;
  double area_ = 0.0, covered_ = 0.0;
  std::vector<double> area_of_, covered_of_;  // one a body (m2)
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  Aabb extent_;
};

}  // namespace agrisee::plan
