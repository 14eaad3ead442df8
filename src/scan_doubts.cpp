// SPDX-License-Identifier: BSD-3-Clause
#include "scan_doubts.hpp"

#include <agrisee/geometry/angle.hpp>
#include <agrisee/sensor/detection_check.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee {
namespace {

/// That a frame comes from another camera than the workcell's, if it does.
std::optional<std::string> doubt_of_camera(const sensor::Intrinsics& frame, const sensor::Intrinsics& camera) {
  constexpr double kOff = 0.01;  // share of the focal length; calibrations of one camera differ by less
  const auto off = [](double a, double b) { return std::abs(a - b) > kOff * b; };
  const auto text = [](const sensor::Intrinsics& k) {
    return std::to_string(k.width) + " x " + std::to_string(k.height) + " pixels with a focal length of " +
           number_text(k.fx, 4) + " and " + number_text(k.fy, 4);
  };
  if (frame.width == camera.width && frame.height == camera.height && !off(frame.fx, camera.fx) &&
      !off(frame.fy, camera.fy))
    return std::nullopt;
  return "the frame has " + text(frame) + ", but the camera of the workcell has " + text(camera) +
         ": which are right? Places and sizes follow from the frame's";
}

/// A sentence if our model of the arm puts the sensor elsewhere than the reported poses do.
std::optional<std::string> doubt_of_joints(const std::vector<View>& views, const Workcell& workcell) {
  constexpr double kFar = 0.02, kTurned = deg(5.0);  // m, rad; more than arms and hand-eye transforms are off
  std::size_t far = 0;
  double farthest = 0.0, most_turned = 0.0;
  for (const View& v : views) {
    if (!v.joints) continue;
    const Pose by_joints = optical_pose(workcell, *v.joints);
    const double off = (by_joints.translation() - v.world_T_optical.translation()).norm();
    const double turned = turn_between(by_joints, v.world_T_optical);
    far += off > kFar || turned > kTurned;
    farthest = std::max(farthest, off);
    most_turned = std::max(most_turned, turned);
  }
  if (far == 0) return std::nullopt;
  return "by the joints of " + std::to_string(far) + " of " + std::to_string(views.size()) +
         " views the sensor was up to " + metres(farthest) + " and " +
         number_text(0.1 * std::round(most_turned / deg(0.1)), 2) +
         " degrees away from the reported pose: are the joints those of the moment, in radians? Are the arm, its base "
         "and the hand-eye transform right?";
}

/// A sentence if a third or more of the views that have points show none in the scan volume, but not all.
std::optional<std::string> doubt_of_aim(const std::vector<View>& views) {
  std::size_t with_points = 0, beside = 0;
  std::string numbers;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!(views[i].median_depth > 0.0)) continue;
    ++with_points;
    if (views[i].points_in > 0) continue;
    numbers += (beside++ ? "," : "") + std::to_string(i);
  }
  if (beside == 0 || 3 * beside < with_points || beside == with_points) return std::nullopt;
  return std::to_string(beside) + " of " + std::to_string(views.size()) + " views show nothing of the scan volume (" +
         numbers + "): are their poses right? " + fuse::kRuleOfPoses + ". Or does something stand in the way?";
}

/// A sentence if many views contradict the others, or none shows the volume: with the mistake, if changed poses agree.
std::optional<std::string> doubt_of_poses(const std::vector<View>& views, const std::vector<fuse::ViewSample>& samples,
                                          const Aabb& volume) {
  constexpr std::size_t kFew = 2, kMany = 4;  // fewer views show no mistake; one of so many contradicts by chance
  const auto contradict = static_cast<std::size_t>(std::count_if(
      views.begin(), views.end(), [](const View& v) { return v.discard_reason == DiscardReason::contradicts_others; }));
  const bool many = kMany * contradict > views.size();
  const bool empty = std::none_of(views.begin(), views.end(), [](const View& v) { return v.points_in > 0; });
  if (views.size() < kFew || (!many && !empty)) return std::nullopt;
  std::string text = fuse::check_poses(samples, volume).mistake;
  if (!text.empty()) text = "it seems that the poses " + text;
  if (many)
    text = std::to_string(contradict) + " of " + std::to_string(views.size()) +
           " views contradict the others, so the places of the fruit may be wrong, too" +
           (text.empty() ? "" : "; " + text);
  return text.empty() ? std::nullopt : std::optional(text);
}

}  // namespace

void ScanDoubts::Doubt::add(const std::optional<std::string>& text, std::size_t view) {
  if (!text) return;
  if (views++ == 0) first = "view " + std::to_string(view) + ": " + *text;
}

void ScanDoubts::look_at(const sensor::DepthFrame& frame, const Pose& world_T_optical, const Pose& reported,
                         const sensor::Intrinsics& camera) {
  const std::size_t view = samples_.size();
  masks_.add(sensor::doubt_of_masks(frame), view);
  intrinsics_.add(sensor::doubt_of(frame.intrinsics), view);
  other_camera_.add(doubt_of_camera(frame.intrinsics, camera), view);
  samples_.push_back(fuse::sample_of(frame, world_T_optical));
  if (is_rigid(reported)) return;
  ++rounded_poses_;
  worst_rounding_ = std::max(worst_rounding_, rigid_error(reported));
}

std::vector<std::string> ScanDoubts::sentences(const std::vector<View>& views, const Workcell& workcell,
                                               bool own_arm) const {
  std::vector<std::string> all;
  const auto add = [&](std::optional<std::string> text) {
    if (text) all.push_back(std::move(*text));
  };
  add(doubt_of_poses(views, samples_, workcell.scan_volume));
  add(doubt_of_aim(views));
  if (own_arm) add(doubt_of_joints(views, workcell));
  for (const Doubt* d : {&masks_, &intrinsics_, &other_camera_})
    if (d->views > 0) all.push_back(d->first + (d->views > 1 ? " (so in " + std::to_string(d->views) + " views)" : ""));
  if (rounded_poses_ > 0)
    all.push_back("world_T_optical of " + std::to_string(rounded_poses_) + " of " + std::to_string(views.size()) +
                  " views: the rotation matrix was off by up to " + number_text(worst_rounding_, 2) +
                  " and has been made orthonormal");
  return all;
}

void check_instances(const sensor::DepthFrame& frame, std::size_t view) {
  if (frame.instances.empty()) return;
  try {
    sensor::check_masks(frame);
  } catch (const InputError& e) {
    throw InputError("observe: the array `instances` of view " + std::to_string(view) + " " + e.what());
  }
}

std::optional<std::string> doubt_of(const fuse::CalibrationCheck& check) {
  constexpr double kFar = 0.0025;  // m; noise of 20 mm a pixel makes 1.3 mm
  if (check.mistake.empty() && check.apart < kFar) return std::nullopt;
  const auto millimetres = [](double length) { return number_text(1e3 * length, 2) + " mm"; };
  return "the views show the surface of the fruit " + millimetres(check.apart) +
         " apart, so places and sizes are wrong. " +
         (check.mistake.empty() ? "Are the poses those of the moments of the images? Did the plant move?"
                                : "They would agree to " + millimetres(check.mended) + " if " + check.mistake);
}

std::vector<std::string> doubts_of(const Workcell& workcell, double distance_min, double distance_max) {
  std::vector<std::string> all;
  const sensor::DepthCamera& camera = workcell.sensor;
  if (auto doubt = sensor::doubt_of(camera.intrinsics)) all.push_back(std::move(*doubt));
  if (camera.range_min > distance_max || camera.range_max < distance_min)
    all.push_back("the camera measures from " + metres(camera.range_min) + " to " + metres(camera.range_max) +
                  ", but views are taken from " + metres(distance_min) + " to " + metres(distance_max) +
                  " (gain.distance_min, gain.distance_max)");
  return all;
}

std::optional<std::string> doubt_of_volume(const std::vector<Fruit>& fruits, const Aabb& volume) {
  constexpr double kCut = 0.2;  // of the mean radius; bodies of fruit with a little room are not off by as much
  std::string cut;
  std::size_t n = 0;
  for (const Fruit& fruit : fruits) {
    if (!fruit.body) continue;
    const Eigen::Vector3d half = (fruit.body->axes * fruit.body->radii.asDiagonal()).rowwise().norm();
    const Eigen::Vector3d low = fruit.body->center - half, high = fruit.body->center + half;
    if ((volume.min - low).cwiseMax(high - volume.max).maxCoeff() < kCut * fruit.body->radii.mean()) continue;
    cut += (n++ ? ", " : "") + std::to_string(fruit.id);
  }
  if (n == 0) return std::nullopt;
  return "fruit " + cut + (n == 1 ? " reaches" : " reach") +
         " out of the scan volume, where nothing is measured: place and size may be wrong. Is the volume large enough?";
}

}  // namespace agrisee
