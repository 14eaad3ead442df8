// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fuses the surfaces of a scan's views into one and, if they are registered (`register_views`), discards views that
/// contradict the rest.
///
/// A view whose frame does not belong to its pose puts surface where other views looked through, and looks through
/// surface that other views saw (fuse/contradiction.hpp). When more of the discarded views agree with a new one, itself
/// counted, than there are views in the map, the map starts again with them: of views that contradict one another the
/// larger group is kept, so that even a wrong first view is detected. World frame, metres. Defined in
/// `agrisee::agrisee`.
#pragma once

#include <agrisee/fuse/contradiction.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/fuse/surfels.hpp>
#include <agrisee/fuse/views.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <map>

namespace agrisee::fuse {

/// The fused surface of a scan, and what each of its views saw.
class FusedViews : public Views {
 public:
  /// @param scan_volume points outside are ignored (world)
  /// @param parameters of surface, surfels, registration and free space
  /// @param threads number of threads; the result does not depend on it
  /// @throws ParameterError for those of surfels; for the others when they are first used
  FusedViews(const Aabb& scan_volume, const FusionParameters& parameters, int threads);

  Observation look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const override;
  Change take(Observation seen, const Pose& world_T_optical) override;
  Change skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) override;
  void filter(Change&) override {}
  Cloud cloud() const override;  ///< without the surfels that later sight lines went through
  Cloud all() const override;
  const std::vector<sensor::SurfaceImage>& images() const override { return images_; }
  Cloud alone(std::size_t view) const override;
  bool discarded(std::size_t view) const override { return views_[view].discarded; }
  Eigen::Vector3d shift_to_reported(const Eigen::Vector3d& center) const override;
  std::vector<BodyErrors> body_errors(const std::vector<Ellipsoid>& bodies,
                                      const FitParameters& parameters) const override;
  CalibrationCheck check_calibration(const std::vector<Ellipsoid>& bodies) const override;

 private:
  struct Taken {
    Pose reported;
    std::size_t points_in;  // inside the scan volume
    bool discarded;
    bool in_map() const { return !discarded && points_in > 0; }
  };

  struct Refuting {                                      // the views that looked through a surfel
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  // of the surfel when it was compared with the first (m, world)
    std::size_t compared = 0;                            // views that it has been compared with
    int views = 0;                                       // of these, those that looked through it
  };

  std::size_t begin(const Pose& world_T_optical, std::size_t points_in, bool discarded);
  bool agree(const Evidence& evidence) const;
  sensor::SurfaceImage near_bodies(std::size_t view, std::vector<Sphere> balls) const;
  std::vector<RegisteredView> registered_views(const std::vector<Ellipsoid>& bodies,
                                               std::vector<sensor::SurfaceImage>& parts) const;
  bool contradicted(const sensor::SurfaceImage& image) const;
  std::vector<std::size_t> views_that_agree(const sensor::SurfaceImage& image) const;
  std::size_t views_in_map() const;
  void start_again(const std::vector<std::size_t>& views, Change& change);
  void add(sensor::SurfaceImage image, std::size_t id, std::vector<Eigen::Vector3f>& added);
  void count_refuting();
  void lay_on_map(sensor::SurfaceImage& image) const;
  Returned measured_again(const sensor::SurfaceImage& image) const;
  void learn_returns(const sensor::SurfaceImage& image);

  Aabb scan_volume_;
  FusionParameters parameters_;
  int threads_;
  SurfelMap surfels_;
  std::vector<Refuting> refuting_;  // one a surfel
  std::vector<Taken> views_;
  std::vector<Returned> measured_;                    // one a view: what it measures of what later ones show
  std::vector<sensor::SurfaceImage> images_;          // what each view saw; of discarded ones only the pose
  std::map<std::size_t, sensor::SurfaceImage> seen_;  // all of it, by number, at the reported poses; the depths of
                                                      // views in the map are in images_; of skipped views nothing
};

}  // namespace agrisee::fuse
