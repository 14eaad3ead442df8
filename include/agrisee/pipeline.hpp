// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The whole of AgriSEE behind one facade: look, clean, split, locate, plan the picking.
///
/// A robot's own loop: `observe` each frame with the pose it was taken from, ask `next_view`, move, repeat until there
/// is none; then `result`. A ready cloud: `process` (process.hpp). A simulated scan: `study::scan`
/// (study/simulated_scan.hpp), which drives the same loop. World frame, metres, radians.
#pragma once

#include <agrisee/cloud/merge.hpp>
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/fused_views.hpp>
#include <agrisee/pipeline_stages.hpp>
#include <agrisee/planners.hpp>
#include <agrisee/process.hpp>
#include <agrisee/sensor/points_to_frame.hpp>
#include <agrisee/workcell.hpp>

#include <algorithm>
#include <memory>

namespace agrisee {

/// One scan of one truss. Not to be used by two threads at once; two pipelines in two threads are independent.
///
/// All calls can be stopped from another thread (core/cancellation.hpp), which throws Cancelled and leaves the pipeline
/// as it was before the call. `observe` stops while it works out what the frame shows and where it lies; what it then
/// does to the scan so far, some tens of ms, is done to the end.
class Pipeline {
 public:
  /// So many refused views on end are the end of a scan.
  static constexpr int kMostRefusals = 50;

  /// @param workcell arm, sensor, scan volume and keep-out; see workcell.hpp
  /// @param parameters of all stages
  /// @param reach answers whether and how the arm can take a view; the default asks our UR3 model
  /// @param planner decides where to look next; the default is the one that `parameters.planner` names
  /// @param seed of whatever the planner draws
  /// @param threads the result does not depend on it
  /// @param approach answers whether and how the arm can approach a fruit to pick it; the default asks our UR3 model,
  /// or
  ///   nobody where `reach` is the caller's own (an arm that we do not know)
  /// @throws ParameterError; InputError for an empty scan volume or poses that are not rigid
  explicit Pipeline(const Workcell& workcell, const Parameters& parameters = {}, plan::Reach reach = {},
                    std::unique_ptr<plan::Planner> planner = nullptr, std::uint64_t seed = 0, int threads = 1,
                    plan::ReachApproach approach = {})
      : workcell_(workcell),
        parameters_(parameters),
        reach_(std::move(reach)),
        approach_(std::move(approach)),
        planner_(std::move(planner)),
        threads_(threads),
        fused_(workcell.scan_volume, parameters, threads),
        points_(parameters.see.min_separation()) {
    parameters_.check();
    check_input(!workcell.scan_volume.empty() && workcell.scan_volume.size().allFinite(),
                "the scan volume is empty or infinite");
    check_input(is_rigid(workcell.world_T_base) && is_rigid(workcell.tool0_T_optical),
                "a pose of the workcell is not rigid");
    if (!reach_ && !approach_) approach_ = detail::ur3_approach(workcell_, parameters_.picking);
    if (!reach_) reach_ = detail::ur3_reach(workcell_);
    if (!planner_) planner_ = make_planner(workcell_, parameters_, seed, threads);
  }

  /// Take in a depth frame that was seen from `world_T_optical` (at `joints`, where an arm is known).
  /// A frame without returns inside the scan volume is a view that brought nothing. A view is discarded, and marked so,
  /// when its frame is the last one bit by bit (a sensor that hangs), or where views are registered, when it
  /// contradicts what other views saw (fused_views.hpp): its pose is wrong.
  /// @return the view as recorded
  /// @throws InputError for a frame whose size disagrees with its intrinsics or a pose that is not rigid; Cancelled;
  /// the scan so far is kept
  const View& observe(const sensor::DepthFrame& frame, const Pose& world_T_optical,
                      const std::optional<Joints>& joints = std::nullopt) {
    check(frame);
    check_input(is_rigid(world_T_optical), "observe: the sensor pose is not a rigid transform");
    View view;
    view.world_T_optical = world_T_optical;
    view.target = world_T_optical * Eigen::Vector3d(0.0, 0.0, target_distance(world_T_optical));
    view.joints = joints;
    view.plan_seconds = plan_seconds_;
    const bool shows = std::any_of(frame.depth.begin(), frame.depth.end(), sensor::DepthFrame::valid);
    const bool frozen = shows && is_last_frame(frame);
    FusedViews::Look look;
    double looked = 0.0;
    if (parameters_.fuse_surfaces && !frozen) {
      const Stopwatch watch(looked);
      look = fused_.look(frame, world_T_optical);
    }
    throw_if_cancelled();
    // From here on the scan so far changes: to be done to the end.
    const detail::CancellationSwap to_the_end(nullptr);
    seconds_.fuse += looked;
    plan_seconds_ = 0.0;
    refusals_ = 0;
    if (shows && !frozen) last_frame_ = frame.depth;
    std::vector<Eigen::Vector3f> added;
    std::optional<Indices> kept;
    {
      const Stopwatch watch(seconds_.fuse);
      if (frozen) {
        view.points_in = count_inside(frame, world_T_optical);
        view.discarded = true;
        if (parameters_.fuse_surfaces) fused_.skip(world_T_optical);
      } else if (parameters_.fuse_surfaces) {
        view.points_in = look.image.points_in;
        FusedViews::Change change = fused_.take(std::move(look), world_T_optical);
        added = std::move(change.added);
        kept = std::move(change.kept);
        for (std::size_t v = 0; v < views_.size(); ++v) views_[v].discarded = fused_.discarded(v);
        view.discarded = fused_.discarded(views_.size());
      } else {
        merge_points(frame, view, added);
      }
    }
    if (parameters_.filter_each_view && !parameters_.fuse_surfaces && !points_.cloud().empty()) {
      const Stopwatch watch(seconds_.filter);
      kept = detail::without_outliers(points_.cloud(), parameters_.sor, threads_);
      points_.keep(*kept);
    }
    view.points_new = added.size();
    views_.push_back(view);
    {
      const Stopwatch watch(seconds_.fuse);
      cloud_ = parameters_.fuse_surfaces ? fused_.cloud() : points_.cloud();
    }
    double spent = 0.0;
    {
      const Stopwatch watch(spent);
      planner_->observe(progress(added, kept ? &*kept : nullptr));
    }
    seconds_.plan += spent;
    plan_seconds_ += spent;  // it belongs to the next view
    return views_.back();
  }

  /// The same for unorganised points (m, optical frame), any cloud type.
  template <typename C>
  const View& observe_points(const C& points, const Pose& world_T_optical,
                             const std::optional<Joints>& joints = std::nullopt) {
    return observe(sensor::frame_from_points(points, workcell_.sensor.intrinsics), world_T_optical, joints);
  }

  /// Where to look next, from where the arm stands now; empty when the scan is over, `stop_reason` says why.
  /// @throws InputError when `current` is not finite; Cancelled
  std::optional<plan::ReachableView> next_view(const Joints& current) {
    check_input(current.allFinite(), "next_view: the joints are not finite");
    double spent = 0.0;
    std::optional<plan::ReachableView> next;
    {
      const Stopwatch watch(spent);
      if (static_cast<int>(views_.size()) >= parameters_.max_views) {
        stop_reason_ = StopReason::max_views;
      } else if (refusals_ >= kMostRefusals) {
        stop_reason_ = StopReason::no_reachable_view;
      } else {
        next = planner_->next(progress({}, nullptr), current, reach_);
        stop_reason_ = next ? StopReason::not_stopped : planner_->stop_reason();
      }
    }
    plan_seconds_ += spent;
    seconds_.plan += spent;
    return next;
  }

  /// The arm could not take the view that `next_view` returned last: ask again for another.
  /// After kMostRefusals of them on end the scan is over: the arm does not move, or the sensor is silent.
  void refused() {
    planner_->refused();
    ++refusals_;
  }

  /// Why next_view() returned nothing last.
  StopReason stop_reason() const { return stop_reason_; }
  /// How much of the fruit's surface the planner believes to have been seen, and that the arm can see at all, as of the
  /// last next_view(); nothing where the planner does not reckon with surfaces.
  std::optional<Completeness> completeness() const { return planner_->completeness(); }
  /// The views that the last next_view() chose from, best first; nothing where the planner does not compare views.
  std::vector<plan::ReachableView> candidates() const { return planner_->candidates(); }
  /// The views taken so far.
  const std::vector<View>& views() const { return views_; }
  /// The cloud merged so far, before any filter at the end.
  const Cloud& merged() const { return cloud_; }
  /// All points merged so far, filtered away later or not, each with its view.
  Cloud raw() const {
    if (!parameters_.fuse_surfaces) return raw_;
    Cloud raw = fused_.all();
    raw.normals.clear();
    return raw;
  }
  /// As given.
  const Workcell& workcell() const { return workcell_; }
  /// As given.
  const Parameters& parameters() const { return parameters_; }
  /// What answers for the arm.
  const plan::Reach& reach() const { return reach_; }

  /// Clean, split and locate what has been seen so far, and plan the picking from where the arm stood last.
  /// @throws Cancelled
  ScanResult result() const {
    CloudOrigin origin;
    for (const View& v : views_) origin.sensors.push_back(v.world_T_optical.translation());
    origin.cluster_origin = cluster_origin(workcell_.scan_volume, workcell_.world_T_base.translation());
    SeenThrough seen_through;
    if (fused_.size() > 0)
      seen_through = [this](const Ellipsoid& body) {
        return plan::seen_through(fused_.images(), body, parameters_.free_space);
      };
    ScanResult out = process(cloud_, parameters_, origin, seen_through, threads_);
    out.raw = raw();
    center_on_all_views(out);
    if (parameters_.picking.enabled) plan_the_picking(out);
    out.views = views_;
    out.stop_reason = stop_reason_;
    out.completeness = completeness();
    out.seconds.plan = seconds_.plan;
    out.seconds.fuse = seconds_.fuse;
    out.seconds.filter += seconds_.filter;
    out.seconds.capture = seconds_.capture;
    out.seconds.total += seconds_.plan + seconds_.fuse + seconds_.filter;
    return out;
  }

  /// Counts the time of a simulated sensor apart from our own.
  double& capture_seconds() { return seconds_.capture; }

 private:
  /// How far ahead a view looks: to the middle of the scan volume, as seen along its axis.
  double target_distance(const Pose& world_T_optical) const {
    return std::max(
        (workcell_.scan_volume.center() - world_T_optical.translation()).dot(world_T_optical.linear().col(2)), 0.0);
  }

  /// Counts as locating.
  void plan_the_picking(ScanResult& out) const {
    double spent = 0.0;
    {
      const Stopwatch watch(spent);
      const bool known = !views_.empty() && views_.back().joints;
      const auto plan =
          detail::picking_of(out, workcell_.keep_out, workcell_.world_T_base.translation(),
                             known ? *views_.back().joints : workcell_.start, approach_, parameters_.picking);
      for (std::size_t i = 0; i < plan.size(); ++i) out.fruits[i].picking = plan[i];
    }
    out.seconds.locate += spent;
    out.seconds.total += spent;
  }

  plan::Progress progress(const std::vector<Eigen::Vector3f>& added, const Indices* kept) const {
    return {cloud_, fused_.images(), views_, added, kept};
  }

  /// True when a frame that shows something is the last one again; a real sensor's noise never repeats.
  bool is_last_frame(const sensor::DepthFrame& frame) const {
    const auto equal = [](float a, float b) { return a == b || (!(a > 0.0f) && !(b > 0.0f)); };
    return std::equal(frame.depth.begin(), frame.depth.end(), last_frame_.begin(), last_frame_.end(), equal);
  }

  /// Pixels of a frame that returned a point inside the scan volume.
  std::size_t count_inside(const sensor::DepthFrame& frame, const Pose& world_T_optical) const {
    std::size_t count = 0;
    for (int v = 0; v < frame.intrinsics.height; ++v)
      for (int u = 0; u < frame.intrinsics.width; ++u) {
        const Eigen::Vector3d p = frame.intrinsics.ray(u, v) * double(frame.at(u, v));
        count += sensor::DepthFrame::valid(frame.at(u, v)) && workcell_.scan_volume.contains(world_T_optical * p);
      }
    return count;
  }

  /// Move the result to where all views together, as reported, put it.
  void center_on_all_views(ScanResult& out) const {
    if (fused_.size() == 0 || out.cloud.empty()) return;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const auto& p : out.cloud.points) center += p.cast<double>() / static_cast<double>(out.cloud.size());
    const Eigen::Vector3d shift = fused_.shift_to_reported(center);
    for (Cloud* cloud : {&out.cloud, &out.raw})
      for (auto& p : cloud->points) p += shift.cast<float>();
    for (Fruit& f : out.fruits) {
      f.centroid += shift;
      f.centroid_cluster += shift;
      if (f.body) f.body->center += shift;
    }
  }

  /// The frame's raw points join the merged cloud where nothing is nearer than the minimum separation.
  void merge_points(const sensor::DepthFrame& frame, View& view, std::vector<Eigen::Vector3f>& added) {
    const int id = static_cast<int>(views_.size());
    for (int v = 0; v < frame.intrinsics.height; ++v)
      for (int u = 0; u < frame.intrinsics.width; ++u) {
        if (!sensor::DepthFrame::valid(frame.at(u, v))) continue;
        const Eigen::Vector3f p = (view.world_T_optical * frame.point(u, v).cast<double>()).cast<float>();
        if (!workcell_.scan_volume.contains(p)) continue;
        ++view.points_in;
        if (!points_.add(p, id)) continue;
        added.push_back(p);
        raw_.points.push_back(p);
        raw_.views.push_back(id);
      }
  }

  Workcell workcell_;
  Parameters parameters_;
  plan::Reach reach_;
  plan::ReachApproach approach_;
  std::unique_ptr<plan::Planner> planner_;
  int threads_;
  FusedViews fused_;               // fused surfaces
  std::vector<float> last_frame_;  // the last that showed anything
  SeparatedCloud points_;          // or merged raw points
  Cloud raw_;                      // all of them, filtered away later or not
  Cloud cloud_;                    // what is merged so far
  std::vector<View> views_;
  int refusals_ = 0;  // since the last view
  StopReason stop_reason_ = StopReason::not_stopped;
  Timing seconds_;
  double plan_seconds_ = 0.0;
};

}  // namespace agrisee
