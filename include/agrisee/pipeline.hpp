// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The whole of AgriSEE behind one facade: look, clean, split, locate, plan the picking.
///
/// A robot's own loop: `observe` each frame with the pose it was taken from, ask `next_view`, move, repeat until there
/// is none; then `result`. A ready cloud: `process` (process.hpp). A simulated scan: `study::scan`
/// (study/simulated_scan.hpp), which drives the same loop. World frame, metres, radians.
#pragma once

#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/merge.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/cloud/surfels.hpp>
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/plan/arm_approach.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/contradiction.hpp>
#include <agrisee/plan/picking.hpp>
#include <agrisee/planners.hpp>
#include <agrisee/process.hpp>
#include <agrisee/sensor/points_to_frame.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>
#include <agrisee/workcell.hpp>

#include <map>
#include <memory>
#include <numeric>

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
        surfels_(parameters.surfels),
        points_(parameters.see.min_separation()) {
    parameters_.check();
    check_input(!workcell.scan_volume.empty() && workcell.scan_volume.size().allFinite(),
                "the scan volume is empty or infinite");
    check_input(is_rigid(workcell.world_T_base) && is_rigid(workcell.tool0_T_optical),
                "a pose of the workcell is not rigid");
    if (!reach_ && !approach_) approach_ = default_approach();
    if (!reach_) reach_ = plan::reach_of(workcell_);
    if (!planner_) planner_ = make_planner(workcell_, parameters_, seed, threads);
  }

  /// Take in a depth frame that was seen from `world_T_optical` (at `joints`, where an arm is known).
  /// A frame without returns inside the scan volume is a view that brought nothing. A view is discarded, and marked so,
  /// when its frame is the last one bit by bit (a sensor that hangs), or where views are registered, when it
  /// contradicts what other views saw (see FreeSpaceParameters::max_contradiction): its pose is wrong. Of views that
  /// contradict one another the more are believed, so that a wrong first view is found out too.
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
    Surface surface;
    double looked = 0.0;
    if (parameters_.fuse_surfaces) {
      const Stopwatch watch(looked);
      surface = surface_of(frame, frozen, view);
    }
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
      if (parameters_.fuse_surfaces)
        kept = take_surface(std::move(surface), frozen, view, added);
      else if (frozen)
        view.discarded = true;
      else
        merge_points(frame, view, added);
    }
    if (parameters_.filter_each_view && !parameters_.fuse_surfaces && !points_.cloud().empty()) {
      const Stopwatch watch(seconds_.filter);
      kept = remove_statistical_outliers(points_.cloud(), parameters_.sor, threads_);
      points_.keep(*kept);
    }
    view.points_new = added.size();
    views_.push_back(view);
    {
      const Stopwatch watch(seconds_.fuse);
      refresh_cloud();
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
  Cloud raw() const { return raw_cloud(); }
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
    if (!images_.empty())
      seen_through = [this](const Ellipsoid& body) {
        return plan::seen_through(images_, body, parameters_.free_space);
      };
    ScanResult out = process(cloud_, parameters_, origin, seen_through, threads_);
    out.raw = raw_cloud();
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

  /// How the UR3 of the workcell, its gripper ahead of the sensor, approaches fruit.
  plan::ReachApproach default_approach() const {
    const Pose tool0_T_tool =
        workcell_.tool0_T_optical * Eigen::Translation3d(0.0, 0.0, parameters_.picking.tool_length);
    return plan::approach_of(plan::mount_of(workcell_), tool0_T_tool, parameters_.picking);
  }

  /// Counts as locating.
  void plan_the_picking(ScanResult& out) const {
    double spent = 0.0;
    {
      const Stopwatch watch(spent);
      const bool known = !views_.empty() && views_.back().joints;
      const auto plan = plan::plan_picking(
          out.fruits,
          {workcell_.keep_out, workcell_.world_T_base.translation(), known ? *views_.back().joints : workcell_.start,
           plan::seen_directions(out.cloud, out.labels, out.fruits)},
          approach_, parameters_.picking);
      for (std::size_t i = 0; i < plan.size(); ++i) out.fruits[i].picking = plan[i];
    }
    out.seconds.locate += spent;
    out.seconds.total += spent;
  }

  plan::Progress progress(const std::vector<Eigen::Vector3f>& added, const Indices* kept) const {
    return {cloud_, images_, views_, added, kept};
  }

  /// True when a frame that shows something is the last one again; a real sensor's noise never repeats.
  bool is_last_frame(const sensor::DepthFrame& frame) const {
    const auto equal = [](float a, float b) { return a == b || (!(a > 0.0f) && !(b > 0.0f)); };
    return std::equal(frame.depth.begin(), frame.depth.end(), last_frame_.begin(), last_frame_.end(), equal);
  }

  /// What a frame shows, laid on what is fused so far.
  struct Surface {
    sensor::SurfaceImage image;
    bool believed = false;  // if not, the image is as reported
  };

  /// The frame's surface; changes nothing but what is told of the view.
  Surface surface_of(const sensor::DepthFrame& frame, bool frozen, View& view) const {
    Surface out;
    out.image =
        sensor::reconstruct_surface(frame, view.world_T_optical, workcell_.scan_volume, parameters_.surface, threads_);
    view.points_in = out.image.points_in;
    if (frozen) return out;
    if (parameters_.register_views) {
      if (contradicted(out.image)) {
        // A pose that errs by millimetres contradicts at borders and thin parts, until the view is laid on the others.
        sensor::SurfaceImage laid = out.image;
        register_image(laid);
        if (contradicted(laid)) return out;
        out.image = std::move(laid);
      }
      register_image(out.image);
    }
    out.believed = true;
    return out;
  }

  /// The frame's surface becomes part of what is fused so far, unless it is not believed.
  /// @return where what was fused before is not believed any more: the points that are kept, those from before counted
  std::optional<Indices> take_surface(Surface surface, bool frozen, View& view, std::vector<Eigen::Vector3f>& added) {
    images_.emplace_back();  // nothing that counts as evidence
    images_.back().world_T_optical = view.world_T_optical;
    const std::size_t id = views_.size();
    if (frozen) {
      view.discarded = true;
      return std::nullopt;
    }
    sensor::SurfaceImage& image = surface.image;
    if (surface.believed) {
      add(std::move(image), id, added);
      return std::nullopt;
    }
    // Those of the views that were not believed which tell the same as this one; more of them than of the others?
    std::vector<std::size_t> group;
    for (const auto& [other, held] : held_)
      if (tell_the_same(plan::compare(held, image, parameters_.free_space))) group.push_back(other);
    held_.emplace(id, std::move(image));
    group.push_back(id);
    const auto believed = static_cast<std::size_t>(
        std::count_if(views_.begin(), views_.end(), [](const View& v) { return !v.discarded && v.points_in > 0; }));
    if (group.size() <= believed) {
      view.discarded = true;
      return std::nullopt;
    }
    const std::size_t before = surfels_.size();
    surfels_ = SurfelMap(parameters_.surfels);
    for (View& v : views_) v.discarded |= v.points_in > 0;
    for (std::size_t v = 0; v < images_.size(); ++v) {
      images_[v] = {};
      images_[v].world_T_optical = v < id ? views_[v].world_T_optical : view.world_T_optical;
    }
    for (const std::size_t v : group) {
      if (v < id) views_[v].discarded = false;
      register_image(held_.at(v));
      add(std::move(held_.at(v)), v, added);
      held_.erase(v);
    }
    Indices kept(added.size());
    std::iota(kept.begin(), kept.end(), static_cast<Index>(before));
    return kept;
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

  void register_image(sensor::SurfaceImage& image) const {
    if (surfels_.size() == 0) return;
    Cloud source;
    const std::size_t step = std::max<std::size_t>(1, image.points.size() / 2500);
    for (std::size_t c = 0; c < image.points.size(); c += step) {
      source.points.push_back(image.points[c]);
      source.normals.push_back(image.normals[c]);
    }
    const Cloud target = surfels_.cloud();
    const IcpResult icp = register_cloud(source, source.normals, target, target.normals, parameters_.icp);
    if (!icp.accepted) return;
    const Eigen::Isometry3f correction = icp.target_T_source.cast<float>();
    for (std::size_t c = 0; c < image.points.size(); ++c) {
      image.points[c] = correction * image.points[c];
      image.normals[c] = correction.linear() * image.normals[c];
    }
    image.world_T_optical = icp.target_T_source * image.world_T_optical;
  }

  /// Registration lays every view on the first; the errors of that one view's pose would be the whole scan's. Over all
  /// views they average out: the result is moved to the mean of where each view, as reported, would have put it.
  void center_on_all_views(ScanResult& out) const {
    if (images_.empty() || out.cloud.empty()) return;
    Eigen::Vector3d center = Eigen::Vector3d::Zero(), shift = Eigen::Vector3d::Zero();
    for (const auto& p : out.cloud.points) center += p.cast<double>() / static_cast<double>(out.cloud.size());
    std::size_t believed = 0;
    for (std::size_t v = 0; v < images_.size(); ++v) {
      if (views_[v].discarded) continue;
      const Pose reported_T_registered =
          views_[v].world_T_optical * images_[v].world_T_optical.inverse(Eigen::Isometry);
      shift += reported_T_registered * center - center;
      ++believed;
    }
    shift /= static_cast<double>(std::max<std::size_t>(believed, 1));
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

  /// The merged cloud as the planner and the result see it: surfels that later sight lines went through are left out.
  void refresh_cloud() {
    if (!parameters_.fuse_surfaces) {
      cloud_ = points_.cloud();
      return;
    }
    cloud_ = {};
    for (const Surfel& s : surfels_.surfels()) {
      int through = 0;
      for (const auto& image : images_)
        through += plan::refutes(image, s.position.cast<double>(), parameters_.free_space);
      if (through >= parameters_.free_space.min_refuting && through >= s.seen_by) continue;
      cloud_.points.push_back(s.position);
      cloud_.normals.push_back(s.normal);
      cloud_.views.push_back(s.view);
    }
  }

  Cloud raw_cloud() const {
    if (!parameters_.fuse_surfaces) return raw_;
    Cloud raw = surfels_.cloud();
    raw.normals.clear();
    return raw;
  }

  Workcell workcell_;
  Parameters parameters_;
  plan::Reach reach_;
  plan::ReachApproach approach_;
  std::unique_ptr<plan::Planner> planner_;
  int threads_;
  SurfelMap surfels_;                                 // fused surfaces
  std::vector<sensor::SurfaceImage> images_;          // what each view saw; of discarded ones the pose alone
  std::map<std::size_t, sensor::SurfaceImage> held_;  // what views saw that are not believed
  std::vector<float> last_frame_;                     // the last that showed anything
  SeparatedCloud points_;                             // or merged raw points
  Cloud raw_;                                         // all of them, filtered away later or not
  Cloud cloud_;                                       // what is merged so far
  std::vector<View> views_;
  int refusals_ = 0;  // since the last view
  StopReason stop_reason_ = StopReason::not_stopped;
  Timing seconds_;
  double plan_seconds_ = 0.0;
};

}  // namespace agrisee
