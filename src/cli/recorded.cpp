// SPDX-License-Identifier: BSD-3-Clause
// Recorded views: `agrisee process views.yaml`.
#include "recorded.hpp"

#include <agrisee/fuse/pose_check.hpp>
#include <agrisee/io/depth_picture.hpp>
#include <agrisee/io/recorded_views.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/sensor/in_range.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>

#include "inputs.hpp"
#include "summary.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

/// A planner that proposes nothing, for views that have already been taken.
class NoPlanner final : public plan::Planner {
 public:
  void observe(const plan::Progress&) override {}
  std::optional<plan::ReachableView> next(const plan::Progress&, const Joints&, const plan::Reach&) override {
    return std::nullopt;
  }
  void refused() override {}
  StopReason stop_reason() const override { return StopReason::not_stopped; }
};

/// Farther from its sensor a point tells nothing of the scan volume (m): no depth camera measures fruit from there, but
/// single wrong pixels reach 65 m in images of whole millimetres.
constexpr double kFarthest = 10.0;

/// What a first pass over the images finds.
struct Survey {
  Aabb seen;                              ///< all points within kFarthest of the views that were looked at
  std::size_t farther = 0;                ///< number of points beyond
  std::vector<fuse::ViewSample> samples;  ///< some of their points
  std::size_t changed = 0;                ///< views that show something else than the first
};

/// Views from any kind of recording.
struct ViewSource {
  Workcell workcell;        ///< an empty scan volume if none is stated
  std::vector<Pose> poses;  ///< world_T_optical of each view
  std::function<sensor::DepthFrame(std::size_t view)> frame;
  std::vector<std::string> warnings;
};

/// The views of views.yaml.
ViewSource source_of_yaml(const std::string& path) {
  const auto recorded = std::make_shared<io::RecordedViews>(io::read_recorded_views(path));
  ViewSource out{recorded->workcell, {}, {}, recorded->warnings};
  for (const io::RecordedView& view : recorded->views) out.poses.push_back(view.world_T_optical);
  out.frame = [recorded](std::size_t view) { return io::read_frame(*recorded, view); };
  return out;
}

/// The views of an MCAP file.
ViewSource source_of_mcap(const std::string& path, const RecordingChoice& choice) {
  const auto recorded = std::make_shared<io::McapRecording>(path, choice.mcap);
  ViewSource out{recorded->workcell(), recorded->world_T_optical(), {}, recorded->warnings()};
  if (!choice.range) {
    out.frame = [recorded](std::size_t view) { return recorded->frame(view); };
    return out;
  }
  out.workcell.sensor.range_min = choice.range->x();
  out.workcell.sensor.range_max = choice.range->y();
  out.frame = [recorded, range = *choice.range](std::size_t view) {
    return sensor::in_range(recorded->frame(view), range[0], range[1]);
  };
  return out;
}

/// Whether two frames of a camera show different things: not only noise. At least 30 % of what one of them shows, the
/// other does not show, or 3 % nearer or farther.
bool differ(const sensor::DepthFrame& a, const sensor::DepthFrame& b) {
  constexpr std::size_t kSamples = 2000;
  constexpr double kOff = 0.03, kShare = 0.3;
  std::size_t shown = 0, off = 0;
  for (std::size_t i = 0; i < a.depth.size(); i += a.depth.size() / kSamples + 1) {
    const double za = double(a.depth[i]), zb = double(b.depth[i]);
    const bool in_a = sensor::DepthFrame::valid(a.depth[i]), in_b = sensor::DepthFrame::valid(b.depth[i]);
    shown += in_a || in_b;
    off += in_a != in_b || (in_a && std::abs(za - zb) > kOff * za);
  }
  return static_cast<double>(off) > kShare * static_cast<double>(shown);
}

/// Number of pixels of a frame that returned.
std::size_t returns(const sensor::DepthFrame& frame) {
  return static_cast<std::size_t>(std::count_if(frame.depth.begin(), frame.depth.end(), sensor::DepthFrame::valid));
}

/// Extend what is seen by what a frame shows within kFarthest.
void extend_by(const sensor::DepthFrame& frame, const Pose& world_T_optical, Survey& out) {
  const sensor::DepthFrame near = sensor::in_range({frame.intrinsics, frame.depth}, 0.0, kFarthest);
  out.farther += returns(frame) - returns(near);
  const Aabb seen = io::extent_of(near, world_T_optical);
  if (!seen.empty()) out.seen.extend(seen.min), out.seen.extend(seen.max);
}

/// Look at all views; where the scan volume is known, at some are enough.
Survey survey(const ViewSource& source) {
  constexpr std::size_t kEnough = 16;
  const std::size_t step = source.workcell.scan_volume.empty() ? 1 : source.poses.size() / kEnough + 1;
  Survey out;
  sensor::DepthFrame first;
  for (std::size_t i = 0; i < source.poses.size(); i += step) {
    sensor::DepthFrame frame = source.frame(i);
    if (!first.depth.empty()) out.changed += frame.depth.size() == first.depth.size() && differ(first, frame);
    out.samples.push_back(fuse::sample_of(frame, source.poses[i]));
    extend_by(frame, source.poses[i], out);
    if (first.depth.empty() && returns(frame) > 0) first = std::move(frame);
  }
  return out;
}

/// What shortens the range of a recording.
std::string remedy_of_range(const std::string& path) {
  return is_mcap(path) ? "shorten the range (--range)" : "state a scan_volume, or shorten camera.range";
}

/// Everything that the views show within kFarthest, and a millimetre around it.
/// @throws FileError if they show nothing there, or things too far apart
Aabb all_that_is_seen(const std::string& path, const Survey& first) {
  if (first.seen.empty())
    throw FileError(path + ": no depth image has a single return " +
                    (first.farther > 0 ? "within " + metres(kFarthest) + " of the camera: are the depths in metres?"
                                       : "in the camera's range"));
  Aabb seen = first.seen;
  seen.min.array() -= 1e-3;
  seen.max.array() += 1e-3;
  constexpr double kLargest = 50.0;  // m; a Pipeline takes no larger scan volume
  const double size = seen.size().maxCoeff();
  if (size > kLargest)
    throw FileError(path + ": what its views show is " + metres(size) +
                    " long: are the positions of the poses in metres? If they are, " + remedy_of_range(path));
  return seen;
}

/// A warning that points were left out of the scan volume.
std::string doubt_of_far_points(const std::string& path, std::size_t farther) {
  return std::to_string(farther) + (farther == 1 ? " pixel lies" : " pixels lie") + " more than " + metres(kFarthest) +
         " from the camera and " + (farther == 1 ? "does" : "do") + " not count for the scan volume, as none is " +
         "stated: " + (is_mcap(path) ? "shorten the range (--range) to be rid of them" : remedy_of_range(path));
}

/// @throws FileError if the poses are all alike, but not the images
void check_poses_differ(const std::string& path, const ViewSource& source, const Survey& first) {
  const auto same = [&](const Pose& pose) { return pose.matrix() == source.poses.front().matrix(); };
  if (2 * first.changed >= first.samples.size() && std::all_of(source.poses.begin(), source.poses.end(), same))
    throw FileError(path + ": all " + std::to_string(source.poses.size()) +
                    " views have the same pose, but different images. Each view needs the pose that the camera had "
                    "when its image was taken");
}

/// Test the poses. @return a warning if the views hardly agree
/// @throws FileError if the poses are not world_T_optical
std::optional<std::string> doubt_of_poses(const std::string& path, const Survey& first, const Aabb& volume) {
  constexpr double kHardly = 0.1;
  const fuse::PoseCheck check = fuse::check_poses(first.samples, volume);
  const std::string rule = fuse::kRuleOfPoses;
  if (!check.mistake.empty())
    throw FileError(path + ": it seems that the poses " + check.mistake +
                    (check.mended > 0.0
                         ? ". Taken so, " + percentage(check.mended) + " of what a view shows is shown by another, " +
                               "too; as they stand, " + percentage(check.as_reported) + ". "
                         : ". Only so does the view see the scan volume. ") +
                    rule);
  const auto shows = [](const fuse::ViewSample& sample) { return !sample.points.empty(); };
  if (check.as_reported >= kHardly || std::count_if(first.samples.begin(), first.samples.end(), shows) < 2)
    return std::nullopt;
  return "only " + percentage(check.as_reported) +
         " of what a view shows is shown by another, too: are the poses right? " + rule;
}

/// The first of many warnings, and how many more there are.
std::vector<std::string> shortened(std::vector<std::string> warnings) {
  constexpr std::size_t kMost = 3;
  if (warnings.size() <= kMost) return warnings;
  const std::size_t more = warnings.size() - kMost;
  warnings.resize(kMost);
  warnings.back() += "; so were " + std::to_string(more) + " more poses";
  return warnings;
}

/// @throws InputError if most views contradict one another: then no map of them can be trusted
void check_contradictions(const std::string& path, const std::vector<View>& views) {
  std::size_t contradict = 0, others = 0;
  for (const View& v : views) {
    contradict += v.discard_reason == DiscardReason::contradicts_others;
    others += v.discard_reason == DiscardReason::none;
  }
  if (contradict > others)
    throw InputError(path + ": " + std::to_string(contradict) + " of " + std::to_string(views.size()) +
                     " views contradict the others. Are the poses those of their images, in metres, from the optical "
                     "frame to world? Are the intrinsics right? Did the plant move between views?");
}

}  // namespace

Processed process_recording(const std::string& path, const CommonOptions& options, const Parameters& parameters,
                            const RecordingChoice& choice) {
  const ViewSource source = is_mcap(path) ? source_of_mcap(path, choice) : source_of_yaml(path);
  Processed out;
  out.workcell = source.workcell;
  const Survey first = survey(source);
  check_poses_differ(path, source, first);
  const std::optional<std::string> doubt = doubt_of_poses(path, first, source.workcell.scan_volume);
  const bool volume_is_stated = !out.workcell.scan_volume.empty();
  if (!volume_is_stated) out.workcell.scan_volume = all_that_is_seen(path, first);
  PipelineOptions pipeline_options;
  pipeline_options.planner = std::make_unique<NoPlanner>();
  pipeline_options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };  // there is no arm
  pipeline_options.seed = options.seed;
  pipeline_options.threads = threads_of(options.threads);
  Pipeline pipeline = [&] {
    try {
      return Pipeline(out.workcell, parameters, std::move(pipeline_options));
    } catch (const InputError& error) {
      throw InputError(path + ": " + error.what());
    }
  }();
  for (std::size_t i = 0; i < source.poses.size(); ++i) {
    sensor::DepthFrame frame = source.frame(i);
    out.history.depth.push_back(io::depth_picture(frame));
    try {
      pipeline.observe(std::move(frame), source.poses[i]);
    } catch (const InputError& error) {
      throw InputError(path + ": " + error.what());
    }
    if (!options.quiet) show_progress(pipeline.views(), source.poses.size());
  }
  if (!options.quiet) end_progress();
  out.result = pipeline.result();
  check_contradictions(path, out.result.views);
  const std::vector<std::string> notes = shortened(source.warnings);
  out.result.warnings.insert(out.result.warnings.begin(), notes.begin(), notes.end());
  if (doubt) out.result.warnings.push_back(*doubt);
  if (!volume_is_stated && first.farther > 0) out.result.warnings.push_back(doubt_of_far_points(path, first.farther));
  return out;
}

}  // namespace agrisee::cli
