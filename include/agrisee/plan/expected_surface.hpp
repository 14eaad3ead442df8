// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Predicts how much new fruit surface a view will show: the unseen parts of the fruit found so far, and unknown space
/// near them in which more fruit may be hidden.
///
/// The merged cloud is segmented into fruit, each modeled by an ellipsoid (cloud/split.hpp). Samples are spread over
/// each ellipsoid; those with no point nearby, nor on a lobe above them, are unseen surface, and each stands for an
/// area. Where sight lines pass through a sample it is moved inwards, because the surface must lie deeper, or dropped.
/// In addition, voxels near the ellipsoids that no sight line has reached stand for fruit that may be hidden there. A
/// view shows a sample when the sample lies in the image and within the sensor's range, faces the sensor, and no
/// ellipsoid or other point of the cloud hides it. The area of a sample shrinks with each view that should have shown
/// it but did not, because the prediction seems to be wrong there. A body with a fruit probability p below one half
/// counts with the weight 2 p instead of not at all, so that doubtful bodies are looked at. What stays doubtful, or
/// little seen, counts half as much with every view that looked at it: such bodies are leaves more often than fruit.
/// The share of the expected surface that the last views really showed is the reliability of further expectations.
/// World frame, metres; gains in m2 of fruit surface.
#pragma once

#include <agrisee/cloud/found_body.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/plan/known_space.hpp>
#include <agrisee/plan/occluder.hpp>
#include <agrisee/plan/parameters.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/plan/promise_record.hpp>
#include <agrisee/plan/vain_looks.hpp>
#include <agrisee/sensor/depth_camera.hpp>

namespace agrisee::plan {

/// The fruit surface that is known, and the surface that is expected but has not been seen.
class ExpectedSurface {
 public:
  /// @param sensor intrinsics and range of the camera
  /// @param volume to be scanned (world)
  /// @param parameters see their struct
  /// @param threads the model does not depend on it
  /// @throws ParameterError
  ExpectedSurface(const sensor::DepthCamera& sensor, const Aabb& volume, const ExpectedSurfaceParameters& parameters,
                  int threads = 1);

  /// Update the model after a view. Bodies are fitted whatever stages `split_parameters` selects.
  /// @throws ParameterError
  void update(const Progress& progress, const SplitParameters& split_parameters,
              const fuse::FreeSpaceParameters& free_space);

  /// Indices of the unseen samples that a view is expected to show, ascending.
  std::vector<std::uint32_t> shown(const Pose& world_T_optical) const;
  /// Fruit surface (m2) that each sample stands for.
  const std::vector<float>& areas() const { return areas_; }
  /// The fruit surface (m2) of some samples: the gain of the view that shows them.
  double gain(const std::vector<std::uint32_t>& shown) const;

  /// Share (0..1) of the surface expected of the last views that they did show; older views count less.
  double reliability() const { return record_.reliability(area_); }

  /// How much a view can be expected to show (above 0, up to 1) of what the model promises: less close to views that
  /// showed hardly any of it, as something stands in the way that the model does not know. It may be outside the scan
  /// volume, as pots and posts are, or nearer than the camera measures.
  double clearness(const Pose& world_T_optical) const { return record_.clearness(world_T_optical); }

  /// How complete the scan is. A view without returns, or of which nothing was taken, lowers areas() and gain(), so
  /// that others are tried, but not what can be observed.
  /// @param can_be_seen one per sample: not zero when some reachable view shows it
  Completeness completeness(const std::vector<char>& can_be_seen) const;

  /// The fruit found so far, and the bodies that may be fruit.
  const std::vector<FoundBody>& bodies() const { return bodies_; }
  /// Surface (m2) of all fruit found so far, seen or not.
  double area() const { return area_; }
  /// The part of that surface which points cover (m2).
  double covered_area() const { return covered_; }
  /// The point to look at (m, world): the mean of the fruit's centers; the center of the cloud's bounding box when no
  /// fruit has been found; the center of the volume when there is no cloud.
  const Eigen::Vector3d& center() const { return center_; }
  /// Bounding box of the fruit, else of the cloud, else the volume (world).
  const Aabb& extent() const { return extent_; }

 private:
  static constexpr double kWellSeen = 0.25;  // coverage from which a believed body is surely a fruit

  struct Sample {
    Eigen::Vector3f point, normal;  // m, world; a zero normal marks a voxel, which can be seen from any side
    int body;                       // index of its fruit; -1 for a voxel
  };

  /// The surface of a body.
  struct BodySurface {
    double area;     // (m2)
    double covered;  // the part that points cover (m2)
    double weight;   // how much it counts (0..1)
  };

  /// A sample that a view was expected to show.
  struct Promise {
    Eigen::Vector3f point;  // m, world
    int body;               // index of its fruit when it was promised; -1 for a voxel
    float area;             // m2
  };

  /// What the last view was expected to show, before it is used.
  std::vector<Promise> promises(const Progress& progress) const;
  /// Note which bodies that are not surely fruit the last view looked at, before the fruit are found anew.
  void count_looks(const std::vector<Promise>& promised);
  /// Mark what the sight lines of new views have reached. Where earlier ones are others than before, as the map has
  /// started again, everything but the record of promises is forgotten.
  void read_sight_lines(const std::vector<sensor::SurfaceImage>& images, const fuse::FreeSpaceParameters& free_space);
  /// Find the fruit in the merged cloud and set `bodies_`; returns one label per point, 0 = no fruit.
  Labels find_fruit(const Progress& progress, const SplitParameters& split_parameters,
                    const fuse::FreeSpaceParameters& free_space);
  /// Replace all samples, and the areas and boxes that go with them.
  /// @param grid of the cloud's points
  void collect_samples(const Progress& progress, const Grid<float>& grid, const fuse::FreeSpaceParameters& free_space);
  /// Add samples of each fruit's unseen surface; counts the covered surface.
  void sample_bodies(const Progress& progress, const Grid<float>& grid, const fuse::FreeSpaceParameters& free_space);
  /// Add a sample for each unknown voxel near the fruit, or near the cloud when no fruit has been found, and for some
  /// of the others.
  void sample_unknown_space(const Aabb& cloud);
  void add_sample(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double area, int body);
  /// How much the surface of a body counts (0..1): less if it is doubtful, and after views looked at it in vain.
  double weight_of(const FoundBody& body) const;
  /// Whether a point (m) lies inside another fruit than `own`.
  bool inside_other(const Eigen::Vector3d& point, int own) const;
  /// Compare what was expected of a view with the cloud and the space that are known since.
  /// @param grid of the cloud's points
  PromiseRecord::Outcome outcome_of(const std::vector<Promise>& promised, const Grid<float>& grid) const;
  /// Let what the last view showed of its promises count for further expectations.
  /// @param grid of the cloud's points
  void record_outcome(const Progress& progress, const std::vector<Promise>& promised, const Grid<float>& grid,
                      const fuse::FreeSpaceParameters& free_space);
  /// Keep the points of no fruit that may hide samples.
  /// @param labels one per point of the cloud, 0 = no fruit
  void collect_obstacles(const Cloud& cloud, const Labels& labels);
  /// Let samples that earlier views should have shown count less.
  void lower_missed(const std::vector<sensor::SurfaceImage>& images, const fuse::FreeSpaceParameters& free_space);
  /// Whether a body counts as a fruit, and not only as a possible one.
  bool believed(const FoundBody& body) const { return body.confidence >= min_confidence_; }
  /// Whether a body counts as a fruit, and so much of it was seen that it will stay one.
  bool is_sure(const FoundBody& body) const { return believed(body) && body.coverage >= kWellSeen; }

  /// Calls f(i) for every sample that a view shows, in ascending order.
  template <typename F>
  void for_each_shown(const Pose& world_T_optical, F&& f) const;

  sensor::DepthCamera sensor_;
  Aabb volume_;
  ExpectedSurfaceParameters parameters_;
  int threads_;
  KnownSpace known_;               // what sight lines have reached
  std::vector<char> images_read_;  // views whose sight lines are marked in `known_`: whether they have some
  std::vector<FoundBody> bodies_;
  VainLooks vain_looks_;
  double min_confidence_ = 0.0;    // a body is believed from this probability on
  std::size_t segmented_at_ = 0;   // size of the cloud when it was last segmented from scratch
  std::size_t tracked_views_ = 0;  // views of the cloud in which `bodies_` were found
  std::vector<Sample> samples_;
  std::vector<float> areas_;         // one per sample (m2)
  std::vector<float> observable_;    // the same, lowered only by views that tell what can be seen (m2)
  std::vector<Occluder> occluders_;  // ellipsoids a little smaller than the fruit
  std::vector<float> obstacles_;     // points that belong to no fruit, thinned: all x, then all y, then all z (m)
  double area_ = 0.0, covered_ = 0.0;
  PromiseRecord record_;
  std::vector<BodySurface> surface_of_;  // one per body
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  Aabb extent_;
};

}  // namespace agrisee::plan
