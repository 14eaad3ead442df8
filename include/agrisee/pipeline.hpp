// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The scan loop of a robot: choose views, fuse their frames, find and locate the fruit, plan the picking.
///
/// Ask `next_view`, move there, pass the frame and its pose to `observe`, and repeat until there is no next view; then
/// take the `result`. For a ready cloud see `process` (process.hpp), for a simulated scan `study::scan`
/// (study/simulated_scan.hpp), which runs the same loop. World frame, metres, radians. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/fuse/masks.hpp>
#include <agrisee/fuse/views.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/pick/approach.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/result.hpp>
#include <agrisee/sensor/points_to_frame.hpp>
#include <agrisee/workcell.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace agrisee {

class ScanDoubts;

/// Replacements for the arm model and the planner, and how to run.
struct PipelineOptions {
  plan::Reach reach;             ///< whether and how the arm can take a view; empty: the built-in arm model decides.
                                 ///< Its answers are checked (plan::checked)
  pick::ReachApproach approach;  ///< whether and how the arm can approach a fruit; empty: the built-in arm model
                                 ///< decides, but not if you supply `reach`, because the arm is then unknown.
                                 ///< Its answers are checked (pick::checked)
  std::unique_ptr<plan::Planner> planner;  ///< where to look next; empty: the planner that `parameters.planner` names
  std::uint64_t seed = 0;                  ///< of the planner's random draws
  int threads = 1;                         ///< number of threads, below 1 as 1; the result does not depend on it
};

/// One scan of one truss. Use a pipeline in one thread at a time; several pipelines are independent of each other.
///
/// Any call can be cancelled from another thread (core/cancellation.hpp). It then throws Cancelled and leaves the
/// pipeline as it was before the call. `observe` can be cancelled while it reconstructs and registers the frame; once
/// it updates the map, which takes some tens of milliseconds, it ends as if it had not been cancelled.
///
/// `reach` and `approach` of the options are called one at a time, on the thread that called next_view() or result().
/// What they throw comes out of that call, and so does InputError for an answer that cannot be. The pipeline is then as
/// it was before the call.
class Pipeline {
 public:
  /// The scan ends after this many refused views in a row.
  static constexpr int kMostRefusals = 50;
  /// The scan ends after this many frames in a row that equal the one before, because the camera hangs.
  static constexpr int kMostRepeats = 3;

  /// @param workcell arm, camera, scan volume and keep-out
  /// @param parameters of all stages
  /// @param options reach, planner, seed, threads
  /// @throws ParameterError, also for keep-out spaces without size; InputError for poses that are not rigid within
  ///   kRigidTolerance, a scan volume that is empty, flat, longer than 50 m or more than 1 km from the origin, a camera
  ///   or gripper more than 3 m from the flange, or a start posture that is not finite or, with the built-in arm model,
  ///   outside its limits
  explicit Pipeline(const Workcell& workcell, const Parameters& parameters = {}, PipelineOptions options = {});
  /// A pipeline can be moved, not copied.
  Pipeline(Pipeline&& other) noexcept;
  /// As the move constructor.
  Pipeline& operator=(Pipeline&& other) noexcept;
  ~Pipeline();

  /// Add a depth frame that was taken at `world_T_optical` (and `joints`, if an arm is known).
  ///
  /// A frame with colors, or that a detector has looked at, is kept for the result: move it in, or share it, to avoid
  /// a copy. The planner uses the detections too. A frame without returns inside the scan volume counts as a view that
  /// showed nothing. A view is marked as discarded if its frame repeats the last one bit for bit (the camera is stuck),
  /// or, with `fuse_surfaces` and `register_views`, if it contradicts the other views (fuse/fused_views.hpp), because
  /// its pose must then be wrong. If the built-in arm model puts the sensor more than 20 mm or 5 degrees away from the
  /// pose, `warnings` say so.
  /// @return the view as recorded; the reference is valid until the next observe()
  /// @throws InputError for a frame whose size disagrees with its intrinsics, whose depths cannot be in metres
  ///   (sensor::check_depth_unit) or whose instances cannot be masks (sensor::check_masks), a pose that is not rigid
  ///   within kRigidTolerance or more than 20 m from the scan volume, or joints as next_view(); Cancelled. The scan so
  ///   far is kept.
  const View& observe(sensor::DepthFrame frame, const Pose& world_T_optical,
                      const std::optional<Joints>& joints = std::nullopt);

  /// Like the other observe(), for a shared frame, which must not be null.
  const View& observe(std::shared_ptr<const sensor::DepthFrame> frame, const Pose& world_T_optical,
                      const std::optional<Joints>& joints = std::nullopt);

  /// Like observe(), for unorganized points (m, optical frame) of any cloud type.
  template <typename C>
  const View& observe_points(const C& points, const Pose& world_T_optical,
                             const std::optional<Joints>& joints = std::nullopt) {
    return observe(sensor::frame_from_points(points, workcell_.sensor.intrinsics), world_T_optical, joints);
  }

  /// Where to look next; empty when the scan is over, for the reason `stop_reason`. Until observe() or refused() is
  /// called, it is asked about the same situation and answers alike.
  /// @param current joints at which the arm is now (rad)
  /// @throws InputError when `current` is not finite or, with the built-in arm model, far outside its limits, or
  ///   for an answer of `reach` (plan::checked); what `reach` throws; Cancelled
  std::optional<plan::ReachableView> next_view(const Joints& current);

  /// Report that the arm could not take the view that `next_view` returned last; then ask `next_view` for another one.
  /// The scan ends after kMostRefusals of these in a row, because arm or camera must have failed.
  void refused();

  /// Why next_view() last returned nothing.
  StopReason stop_reason() const { return stop_reason_; }
  /// The planner's estimate, at the last next_view(), of how much of the fruit's surface has been seen and how much the
  /// arm can see at all; empty for planners that do not estimate surfaces, and until points are seen.
  std::optional<Completeness> completeness() const { return planner_->completeness(); }
  /// The views that the last next_view() chose from, best first; empty for planners that do not compare views.
  std::vector<plan::ReachableView> candidates() const { return planner_->candidates(); }
  /// The views taken so far.
  const std::vector<View>& views() const { return views_; }
  /// The cloud merged so far, before the outlier removal at the end.
  const Cloud& merged() const { return cloud_; }
  /// All points that the views which are not discarded added, with their views, including those removed later.
  Cloud raw() const { return map_->all(); }
  /// Sentences about input that should be checked, with the likely cause: poses with rounded rotation matrices, joints
  /// far from the poses, many views that contradict the others, inverted poses, frames of another camera than the
  /// workcell's, unusual intrinsics, masks that stand for all fruit or for the background, a range of the camera in
  /// which no view is taken. May take 0.1 s.
  std::vector<std::string> warnings() const;
  /// The evidence from the masks of all views so far; empty if no detector has looked.
  const MaskEvidence& masks() const { return masks_; }
  /// The workcell of this scan; its poses are rigid.
  const Workcell& workcell() const { return workcell_; }
  /// The parameters of this scan.
  const Parameters& parameters() const { return parameters_; }
  /// The function that decides whether the arm can take a view.
  const plan::Reach& reach() const { return reach_; }

  /// The result of the views so far: clean, segment, locate, and plan the picking from the arm's last posture.
  /// @throws InputError for an answer of `approach` (pick::checked), or if the points are so far apart that depths or
  ///   poses cannot be in metres (check_units); what `approach` throws; Cancelled
  ScanResult result() const;

 private:
  View begin_view(const sensor::DepthFrame& frame, const Pose& reported, const std::optional<Joints>& joints) const;
  void record(View view, const fuse::Change& change, bool repeated);
  void check_current(const char* name, const Joints& joints) const;
  void remember(std::shared_ptr<const sensor::DepthFrame> frame, const Pose& world_T_optical);
  bool repeats_last_frame(const sensor::DepthFrame& frame) const;
  plan::Progress progress(const fuse::Change& change) const;
  std::vector<fuse::DetectedView> detected_views() const;
  void read_masks();
  void center_on_reported_poses(ScanResult& out) const;
  void plan_picking(ScanResult& out) const;

  Workcell workcell_;
  Parameters parameters_;
  plan::Reach reach_;
  bool own_arm_ = true;  // our model of the arm answers for its reach
  pick::ReachApproach approach_;
  std::unique_ptr<plan::Planner> planner_;
  int threads_;
  std::unique_ptr<fuse::Views> map_;
  std::map<std::size_t, fuse::DetectedView> detected_;  // the views with masks or colors, by number
  MaskEvidence masks_;                                  // what the masks of all views say
  Cloud cloud_;                                         // of the map, as of the last view
  std::vector<float> last_frame_;                       // the last that showed anything
  std::vector<View> views_;
  int refusals_ = 0;  // since the last view
  int repeats_ = 0;   // frames in a row that equal the one before
  StopReason stop_reason_ = StopReason::not_stopped;
  Timing seconds_;
  std::vector<std::string> warnings_;   // about the workcell
  std::unique_ptr<ScanDoubts> doubts_;  // about the views
  double planned_before_ = 0.0;         // planning seconds that earlier views account for
};

}  // namespace agrisee
