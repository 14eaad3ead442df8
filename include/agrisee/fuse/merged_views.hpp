// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Merges the raw points of a scan's views by minimum separation, as SEE++ does; [1] filters the map after every view.
/// World frame, metres. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/fuse/separated_cloud.hpp>
#include <agrisee/fuse/views.hpp>
#include <agrisee/geometry/aabb.hpp>

namespace agrisee::fuse {

/// The raw points of a scan at a minimum separation: the first point at a place is kept, nothing is averaged.
class MergedViews : public Views {
 public:
  /// @param scan_volume points outside are ignored (world)
  /// @param separation least distance between points of the map (m), > 0
  /// @param filter outlier removal after every view; empty for none
  /// @param threads number of threads; the result does not depend on it
  /// @throws ParameterError
  MergedViews(const Aabb& scan_volume, double separation, const std::optional<SorParameters>& filter, int threads);

  Observation look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const override;
  Change take(Observation seen, const Pose& world_T_optical) override;
  Change skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) override;
  void filter(Change& change) override;
  Cloud cloud() const override { return points_.cloud(); }
  Cloud all() const override { return all_; }
  const std::vector<sensor::SurfaceImage>& images() const override { return images_; }
  Cloud alone(std::size_t) const override { return {}; }
  bool discarded(std::size_t view) const override { return discarded_[view]; }
  Eigen::Vector3d shift_to_reported(const Eigen::Vector3d&) const override { return Eigen::Vector3d::Zero(); }
  std::vector<BodyErrors> body_errors(const std::vector<Ellipsoid>& bodies, const FitParameters&) const override {
    return std::vector<BodyErrors>(bodies.size());
  }
  CalibrationCheck check_calibration(const std::vector<Ellipsoid>&) const override { return {}; }

 private:
  Aabb scan_volume_;
  std::optional<SorParameters> filter_;
  int threads_;
  SeparatedCloud points_;
  Cloud all_;
  std::vector<bool> discarded_;               // one a view
  std::vector<sensor::SurfaceImage> images_;  // none: raw points are no evidence of free space
};

}  // namespace agrisee::fuse
