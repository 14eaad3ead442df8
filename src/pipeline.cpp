// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/rigid_pose.hpp>
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/fuse/color_prior.hpp>
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/fuse/fused_views.hpp>
#include <agrisee/fuse/merged_views.hpp>
#include <agrisee/locate.hpp>
#include <agrisee/pick/arm_approach.hpp>
#include <agrisee/pick/picking.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/planners.hpp>
#include <agrisee/process.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "cloud_origin.hpp"
#include "input_checks.hpp"
#include "lone_views.hpp"
#include "scan_doubts.hpp"
#include "stated_errors.hpp"

namespace agrisee {
namespace {

/// The map of a scan: fused surfaces or merged raw points.
std::unique_ptr<fuse::Views> make_map(const Workcell& workcell, const Parameters& parameters, int threads) {
  if (parameters.fuse_surfaces)
    return std::make_unique<fuse::FusedViews>(workcell.scan_volume, parameters.fusion(), threads);
  const auto filter = parameters.filter_each_view ? std::optional(parameters.sor) : std::nullopt;
  return std::make_unique<fuse::MergedViews>(workcell.scan_volume, parameters.see.min_separation(), filter, threads);
}

/// Whether any pixel of a frame returned.
bool shows_something(const sensor::DepthFrame& frame) {
  return std::any_of(frame.depth.begin(), frame.depth.end(), sensor::DepthFrame::valid);
}

}  // namespace

Pipeline::Pipeline(const Workcell& workcell, const Parameters& parameters, PipelineOptions options)
    : workcell_(workcell),
      parameters_(parameters),
      reach_(std::move(options.reach)),
      approach_(pick::checked(std::move(options.approach))),
      planner_(std::move(options.planner)),
      threads_(options.threads),
      doubts_(std::make_unique<ScanDoubts>()) {
  parameters_.check();
  own_arm_ = !reach_;
  check_workcell(workcell_, own_arm_, warnings_);
  for (std::string& doubt : doubts_of(workcell_, parameters_.gain.distance_min, parameters_.gain.distance_max))
    warnings_.push_back(std::move(doubt));
  map_ = make_map(workcell_, parameters_, threads_);
  if (!reach_ && !approach_) approach_ = pick::approach_of(workcell_, parameters_.picking);
  reach_ = own_arm_ ? plan::reach_of(workcell_) : plan::checked(std::move(reach_), workcell_.sensor);
  if (!planner_) planner_ = make_planner(workcell_, parameters_, options.seed, threads_);
}

Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

const View& Pipeline::observe(sensor::DepthFrame frame, const Pose& world_T_optical,
                              const std::optional<Joints>& joints) {
  return observe(std::make_shared<const sensor::DepthFrame>(std::move(frame)), world_T_optical, joints);
}

const View& Pipeline::observe(std::shared_ptr<const sensor::DepthFrame> frame, const Pose& reported,
                              const std::optional<Joints>& joints) {
  check_input(frame != nullptr, "observe: there is no frame");
  const View view = begin_view(*frame, reported, joints);
  const bool frozen = repeats_last_frame(*frame);

  // Look: what the frame shows, registered to the map. Nothing changes until this is known.
  fuse::Observation seen;
  if (!frozen) seen = timed(seconds_.fuse, [&] { return map_->look(*frame, view.world_T_optical); });
  throw_if_cancelled();
  const detail::CancellationSwap to_the_end(nullptr);

  // Fuse: the view becomes part of the map.
  fuse::Change change = timed(seconds_.fuse, [&] {
    return frozen ? map_->skip(*frame, view.world_T_optical) : map_->take(std::move(seen), view.world_T_optical);
  });

  // Clean, where that is done after every view.
  timed(seconds_.filter, [&] { map_->filter(change); });
  cloud_ = timed(seconds_.fuse, [&] { return map_->cloud(); });

  // Record the view, and tell the planner.
  doubts_->look_at(*frame, view.world_T_optical, reported, workcell_.sensor.intrinsics);
  record(view, change, frozen);
  if (!frozen) remember(std::move(frame), view.world_T_optical);
  timed(seconds_.segment, [&] { read_masks(); });
  timed(seconds_.plan, [&] { planner_->observe(progress(change)); });
  return views_.back();
}

std::optional<plan::ReachableView> Pipeline::next_view(const Joints& current) {
  check_current("next_view", current);
  if (static_cast<int>(views_.size()) >= parameters_.max_views) {
    stop_reason_ = StopReason::max_views;
    return std::nullopt;
  }
  if (refusals_ >= kMostRefusals) {
    stop_reason_ = StopReason::no_reachable_view;
    return std::nullopt;
  }
  if (repeats_ >= kMostRepeats) {
    stop_reason_ = StopReason::camera_hangs;
    return std::nullopt;
  }
  auto next = timed(seconds_.plan, [&] { return planner_->next(progress({}), current, reach_); });
  stop_reason_ = next ? StopReason::not_stopped : planner_->stop_reason();
  return next;
}

/// @throws InputError for joint angles that the arm cannot have now
void Pipeline::check_current(const char* name, const Joints& joints) const {
  check_input(joints.allFinite(), (std::string(name) + ": the joints are not finite").c_str());
  if (own_arm_) check_joints(name, workcell_, joints, 1.0);  // a real arm may stand a little outside
}

std::vector<std::string> Pipeline::warnings() const {
  std::vector<std::string> all = warnings_;
  for (std::string& doubt : doubts_->sentences(views_, workcell_, own_arm_)) all.push_back(std::move(doubt));
  return all;
}

void Pipeline::refused() {
  planner_->refused();
  ++refusals_;
}

ScanResult Pipeline::result() const {
  CloudOrigin origin;
  for (const View& v : views_) origin.sensors.push_back(v.world_T_optical.translation());
  origin.cluster_origin = cluster_origin(workcell_.scan_volume, workcell_.world_T_base.translation());
  origin.volume = workcell_.scan_volume;
  origin.detected = detected_views();
  SeenThrough seen_through;
  if (!map_->images().empty()) {
    seen_through = [this](const Ellipsoid& body) {
      return fuse::seen_through(map_->images(), body, parameters_.free_space);
    };
    origin.is_free = [this](const Eigen::Vector3d& p) {
      return fuse::is_free(map_->images(), p, parameters_.free_space);
    };
  }
  const auto kept = std::count_if(views_.begin(), views_.end(), [](const View& v) { return !v.discarded; });
  Parameters parameters = parameters_;
  if (static_cast<std::size_t>(kept) >= kSeveralViews)
    parameters.split = parameters_.scan_split(), origin.mask_order = fuse::MaskOrder::points_first;
  double& normal_noise = parameters.split.bodies.normal_noise;
  normal_noise = std::max(normal_noise, sensor::normal_noise(map_->images()));
  ScanResult out = process(cloud_, parameters, origin, seen_through, threads_);
  out.raw = raw();
  const double located = out.seconds.locate;
  timed(out.seconds.locate, [&] {
    state_errors(*map_, parameters_, out.fruits);
    if (auto doubt = doubt_calibration(*map_, parameters_, out.fruits)) out.warnings.push_back(std::move(*doubt));
    if (auto doubt = doubt_of_agreement(*map_, views_, parameters_, workcell_.scan_volume, out.fruits.size(), threads_))
      out.warnings.push_back(std::move(*doubt));
    if (auto doubt = doubt_of_volume(out.fruits, workcell_.scan_volume)) out.warnings.push_back(std::move(*doubt));
  });
  out.completeness = completeness();
  center_on_reported_poses(out);
  if (parameters_.picking.enabled) timed(out.seconds.locate, [&] { plan_picking(out); });
  out.views = views_;
  out.stop_reason = stop_reason_;
  const std::vector<std::string> of_views = warnings();
  out.warnings.insert(out.warnings.begin(), of_views.begin(), of_views.end());
  out.seconds.plan = seconds_.plan;
  out.seconds.fuse = seconds_.fuse;
  out.seconds.filter += seconds_.filter;
  out.seconds.segment += seconds_.segment;
  out.seconds.total +=
      seconds_.plan + seconds_.fuse + seconds_.filter + seconds_.segment + (out.seconds.locate - located);
  return out;
}

/// What is known of a view before its frame is looked at.
View Pipeline::begin_view(const sensor::DepthFrame& frame, const Pose& reported,
                          const std::optional<Joints>& joints) const {
  const std::string number = std::to_string(views_.size());
  const Pose world_T_optical = made_rigid(reported, "observe: world_T_optical of view " + number);
  check_distance("observe: the sensor of view " + number, world_T_optical.translation(), workcell_.scan_volume,
                 "the scan volume");
  check(frame);
  sensor::check_depth_unit(frame);
  if (joints) check_current("observe", *joints);
  if (frame.detected) fuse::instances_of(frame);  // detections that cannot be are refused before anything changes
  check_instances(frame, views_.size());
  View view;
  view.world_T_optical = world_T_optical;
  // The observed point: as far ahead along the optical axis as the middle of the scan volume.
  const Eigen::Vector3d to_middle = workcell_.scan_volume.center() - world_T_optical.translation();
  const double ahead = std::max(to_middle.dot(world_T_optical.linear().col(2)), 0.0);
  view.target = world_T_optical * Eigen::Vector3d(0.0, 0.0, ahead);
  view.median_depth = sensor::median_depth(frame).value_or(0.0);
  view.volume_distance = to_middle.norm();
  view.joints = joints;
  view.plan_seconds = seconds_.plan - planned_before_;
  return view;
}

/// Add a view to the record. Planning time counts for the next view from here on.
/// @param repeated its frame is the one before
void Pipeline::record(View view, const fuse::Change& change, bool repeated) {
  view.points_in = change.points_in;
  view.points_new = change.added.size();
  if (repeated) view.discard_reason = DiscardReason::repeated_frame;
  repeats_ = repeated ? repeats_ + 1 : 0;
  views_.push_back(std::move(view));
  for (std::size_t v = 0; v < views_.size(); ++v) {  // a view can also make others part of the map, or discard them
    View& each = views_[v];
    each.discarded = map_->discarded(v);
    if (!each.discarded)
      each.discard_reason = DiscardReason::none;
    else if (each.discard_reason == DiscardReason::none)
      each.discard_reason = DiscardReason::contradicts_others;
  }
  refusals_ = 0;
  planned_before_ = seconds_.plan;
}

/// Keep what is needed of the last view's frame: its depths, if it shows something, to recognize it if the camera
/// repeats it; all of it, if it has masks or colors.
void Pipeline::remember(std::shared_ptr<const sensor::DepthFrame> frame, const Pose& world_T_optical) {
  if (shows_something(*frame)) last_frame_ = frame->depth;
  if (!frame->detected && frame->color.empty()) return;
  if (parameters_.color_prior.enabled && !frame->detected)
    frame = std::make_shared<const sensor::DepthFrame>(
        fuse::detected_by_color(*frame, parameters_.split.bodies, parameters_.color_prior));
  detected_[views_.size() - 1] = {std::move(frame), world_T_optical};
}

/// True when a frame equals the last one that showed something; the noise of a camera that works never repeats.
bool Pipeline::repeats_last_frame(const sensor::DepthFrame& frame) const {
  const auto equal = [](float a, float b) { return a == b || (!(a > 0.0f) && !(b > 0.0f)); };
  return shows_something(frame) &&
         std::equal(frame.depth.begin(), frame.depth.end(), last_frame_.begin(), last_frame_.end(), equal);
}

plan::Progress Pipeline::progress(const fuse::Change& change) const {
  return {cloud_,
          map_->images(),
          views_,
          change.added,
          change.observed,
          change.kept ? &*change.kept : nullptr,
          masks_.log_odds ? &masks_ : nullptr};
}

/// The views with masks or colors that are not discarded.
std::vector<fuse::DetectedView> Pipeline::detected_views() const {
  std::vector<fuse::DetectedView> out;
  for (const auto& [number, view] : detected_)
    if (!views_[number].discarded) out.push_back(view);
  return out;
}

/// Bring up to date what masks say: those of a view are read when it is new, or when the map has moved it.
void Pipeline::read_masks() {
  if (detected_.empty()) return;
  const BodyParameters& bodies = parameters_.split.bodies;
  for (auto& [number, view] : detected_) {
    if (views_[number].discarded) continue;
    const Pose pose = map_->images().empty() ? view.world_T_optical : map_->images()[number].world_T_optical;
    if (view.masks && pose.matrix() == view.world_T_optical.matrix()) continue;
    view.world_T_optical = pose;
    if (view.frame->detected) view.masks = fuse::read_masks(view, bodies, parameters_.masks);
  }
  masks_ = fuse::mask_evidence(detected_views(), bodies, parameters_.masks, fuse::MaskOrder::points_first);
}

/// Move the result to where all views together, by their reported poses, put it. What compares bodies with the images
/// of the map, which stay, comes before.
void Pipeline::center_on_reported_poses(ScanResult& out) const {
  if (map_->images().empty() || out.cloud.empty()) return;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& p : out.cloud.points) center += p.cast<double>() / static_cast<double>(out.cloud.size());
  const Eigen::Vector3d shift = map_->shift_to_reported(center);
  for (Cloud* cloud : {&out.cloud, &out.raw})
    for (auto& p : cloud->points) p += shift.cast<float>();
  for (Fruit& f : out.fruits) {
    f.centroid += shift;
    f.centroid_cluster += shift;
    if (f.body) f.body->center += shift;
  }
  for (FoundTruss& truss : out.trusses) truss.world_T_truss.translation() += shift;
  if (out.completeness)
    for (Completeness::Part& part : out.completeness->fruits) part.center += shift;
}

/// How to pick each fruit, from where the arm stood last.
void Pipeline::plan_picking(ScanResult& out) const {
  const bool known = !views_.empty() && views_.back().joints;
  pick::PickingScene scene;
  scene.keep_out = workcell_.keep_out;
  scene.robot = workcell_.world_T_base.translation();
  scene.joints = known ? *views_.back().joints : workcell_.start;
  scene.seen = pick::seen_directions(out.cloud, out.labels, out.fruits);
  scene.surroundings = pick::surroundings_of(out.cloud, out.labels, out.raw);
  const std::vector<Picking> plan = pick::plan_picking(out.fruits, scene, approach_, parameters_.picking);
  for (std::size_t i = 0; i < plan.size(); ++i) out.fruits[i].picking = plan[i];
}

}  // namespace agrisee
