// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The map that the views of a scan make together: what a frame shows is looked at first, then taken in.
///
/// Two kinds share these verbs: FusedViews (surfaces, the default) and MergedViews (raw points, as in SEE++ and [1]).
/// World frame, metres.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <optional>
#include <vector>

namespace agrisee::fuse {

/// What a frame shows inside the scan volume.
struct Observation {
  sensor::SurfaceImage surface;  ///< its points, and for surfaces their normals and uncertainty (world)
  bool consistent = true;        ///< whether it agrees with what other views saw
};

/// What a view changed in the map.
struct Change {
  std::vector<Eigen::Vector3f> added;     ///< points that are new (m)
  std::vector<Eigen::Vector3f> observed;  ///< all points that the view showed, registered where that is done (m)
  std::optional<Indices> kept;  ///< if points of the map were dropped: those that stay, as indices into the map
                                ///< before the change followed by `added`
  std::size_t points_in = 0;    ///< points that the frame returned inside the scan volume
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

  /// What a frame shows; changes nothing.
  /// @param frame depth z (m)
  /// @param world_T_optical pose of the camera as reported
  /// @throws InputError for a frame whose size disagrees with its intrinsics, or a pose that is not rigid; Cancelled
  virtual Observation look(const sensor::DepthFrame& frame, const Pose& world_T_optical) const = 0;

  /// Make an observation part of the map. Cannot be cancelled.
  /// @param seen what `look` returned for the frame
  /// @param world_T_optical pose of the camera as reported
  virtual Change take(Observation seen, const Pose& world_T_optical) = 0;

  /// Count a view whose frame is not used: it is discarded, only its pose is kept.
  /// @param frame depth z (m)
  /// @param world_T_optical pose of the camera as reported
  virtual Change skip(const sensor::DepthFrame& frame, const Pose& world_T_optical) = 0;

  /// Remove statistical outliers from the map, where this kind does so after every view, and note it in `change`.
  virtual void filter(Change& change) = 0;

  /// The map: points, normals where known, and the view that each point came from.
  virtual Cloud cloud() const = 0;

  /// All points ever taken in, removed since or not, and their views; no normals.
  virtual Cloud all() const = 0;

  /// What each view saw, as evidence of free space; empty for raw points. Of discarded views only the pose.
  virtual const std::vector<sensor::SurfaceImage>& images() const = 0;

  /// Whether a view (by number) is discarded; a later view can change that.
  virtual bool discarded(std::size_t view) const = 0;

  /// How far the map has to move so that the views lie, on average, where their reported poses put them.
  ///
  /// Registration lays every view on the first, so an error of the first reported pose shifts the whole map. Averaged
  /// over all views the errors of the reported poses cancel.
  /// @param center of the map (m)
  /// @return the shift (m)
  virtual Eigen::Vector3d shift_to_reported(const Eigen::Vector3d& center) const = 0;

  /// Covariances of the centers of bodies fitted to the map by what the views err, see fuse::center_errors; zero for a
  /// body where that cannot be told.
  virtual std::vector<Eigen::Matrix3d> center_errors(const std::vector<Ellipsoid>& bodies,
                                                     const FitParameters& parameters) const = 0;
};

}  // namespace agrisee::fuse
