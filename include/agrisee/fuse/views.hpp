// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The interface of a scan's map. A frame is first analyzed (`look`), then added to the map (`take`).
///
/// There are two implementations: FusedViews (surfaces, the default) and MergedViews (raw points, as in SEE++ and [1]).
/// World frame, metres.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/fuse/body_errors.hpp>
#include <agrisee/fuse/calibration_check.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <optional>
#include <vector>

namespace agrisee::fuse {

/// What a frame shows inside the scan volume.
struct Observation {
  sensor::SurfaceImage surface;  ///< its points, and for surfaces their normals and uncertainty (world)
  bool consistent = true;        ///< whether it agrees with the other views
};

/// The change of the map by a view.
struct Change {
  std::vector<Eigen::Vector3f> added;     ///< new points (m)
  std::vector<Eigen::Vector3f> observed;  ///< all points of the view (m), registered if the map registers views
  std::optional<Indices> kept;  ///< if points of the map were dropped: those that stay, as indices into the map
                                ///< before the change followed by `added`
  std::size_t points_in = 0;    ///< number of points of the frame inside the scan volume
};

/// Number of pixels of a frame that returned a point inside a volume (world). Defined in `agrisee::agrisee`.
std::size_t count_inside(const sensor::DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume);

/// The views of a scan, and the map made of them.
class Views {
 public:
  Views() = default;
  Views(const Views&) = delete;
  Views& operator=(const Views&) = delete;
  virtual ~Views() = default;

  /// Analyze a frame without changing the map.
  /// @param frame depth z (m)
  /// @param world_T_optical pose of the camera as reported
  /// @throws InputError for a frame whose size disagrees with its intrinsics, or a pose that is not rigid; Cancelled
  virtual Observation look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const = 0;

  /// Add an observation to the map. Cannot be cancelled.
  /// @param seen the result of `look` for the frame
  /// @param world_T_optical pose of the camera as reported
  virtual Change take(Observation seen, const Pose& world_T_optical) = 0;

  /// Count a view without using its frame: it is discarded, only its pose is kept.
  /// @param frame depth z (m)
  /// @param world_T_optical pose of the camera as reported
  virtual Change skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) = 0;

  /// Remove statistical outliers from the map, if it does so after every view, and record it in `change`.
  virtual void filter(Change& change) = 0;

  /// The map: points, normals where known, and the view that each point came from.
  virtual Cloud cloud() const = 0;

  /// All points that the views of the present map added, with their views, including those removed since; no normals.
  virtual Cloud all() const = 0;

  /// The surface image of each view, as evidence of free space; empty for raw points. Discarded views have only a pose.
  virtual const std::vector<sensor::SurfaceImage>& images() const = 0;

  /// What a view (by number) shows by itself, at its reported pose: points and normals. Empty for raw points.
  virtual Cloud alone(std::size_t view) const = 0;

  /// Whether a view (by number) is discarded; a later view can change that.
  virtual bool discarded(std::size_t view) const = 0;

  /// The shift of the map that makes the views agree, on average, with their reported poses.
  ///
  /// Registration aligns every view with the first, so an error of the first reported pose shifts the whole map. Over
  /// all views the errors of the reported poses average out.
  /// @param center of the map (m)
  /// @return the shift (m)
  virtual Eigen::Vector3d shift_to_reported(const Eigen::Vector3d& center) const = 0;

  /// Errors of bodies fitted to the map due to errors of the views, see fuse::body_errors.
  virtual std::vector<BodyErrors> body_errors(const std::vector<Ellipsoid>& bodies,
                                              const FitParameters& parameters) const = 0;

  /// Whether the views agree on the bodies, see fuse::check_calibration.
  virtual CalibrationCheck check_calibration(const std::vector<Ellipsoid>& bodies) const = 0;
};

}  // namespace agrisee::fuse
