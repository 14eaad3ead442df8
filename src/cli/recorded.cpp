// SPDX-License-Identifier: BSD-3-Clause
// Recorded views: `agrisee process views.yaml`, and `agrisee export-views`, which writes those of a simulated scan.
#include "recorded.hpp"

#include <agrisee/fuse/pose_check.hpp>
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/depth_picture.hpp>
#include <agrisee/io/recorded_views.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/sensor/detection_check.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>

#include "inputs.hpp"
#include "io/formats/json_value.hpp"
#include "io/formats/text.hpp"
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

/// What a first pass over the images finds.
struct Survey {
  Aabb seen;                              ///< all points of the views that were looked at
  std::vector<fuse::ViewSample> samples;  ///< some of their points
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
ViewSource source_of_mcap(const std::string& path, const io::McapChoice& choice) {
  const auto recorded = std::make_shared<io::McapRecording>(path, choice);
  ViewSource out{recorded->workcell(), recorded->world_T_optical(), {}, recorded->warnings()};
  out.frame = [recorded](std::size_t view) { return recorded->frame(view); };
  return out;
}

/// Look at all views; where the scan volume is known, at some are enough.
Survey survey(const ViewSource& source) {
  constexpr std::size_t kEnough = 16;
  const std::size_t step = source.workcell.scan_volume.empty() ? 1 : source.poses.size() / kEnough + 1;
  Survey out;
  for (std::size_t i = 0; i < source.poses.size(); i += step) {
    const sensor::DepthFrame frame = source.frame(i);
    out.samples.push_back(fuse::sample_of(frame, source.poses[i]));
    const Aabb seen = io::extent_of(frame, source.poses[i]);
    if (seen.empty()) continue;
    out.seen.extend(seen.min);
    out.seen.extend(seen.max);
  }
  return out;
}

/// Everything that the views show, and a millimetre around it. @throws FileError if they show nothing
Aabb all_that_is_seen(const std::string& path, Aabb seen) {
  if (seen.empty()) throw FileError(path + ": no depth image has a single return in the camera's range");
  seen.min.array() -= 1e-3;
  seen.max.array() += 1e-3;
  return seen;
}

/// Test the poses. @return a warning if the views hardly agree
/// @throws FileError if the poses are not world_T_optical
std::optional<std::string> doubt_of_poses(const std::string& path, const Survey& first, const Aabb& volume) {
  constexpr double kHardly = 0.1;
  const fuse::PoseCheck check = fuse::check_poses(first.samples, volume);
  const std::string rule = "Poses have to be world_T_optical: z forward, x right, y down";
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

struct ExportOptions {
  std::string result, output;
  bool npy = false, force = false;
};

/// The views that a scan recorded, and those that are missing between them and up to the number that run.json states.
struct RecordNumbers {
  std::vector<std::size_t> present, missing;
};

RecordNumbers record_numbers(const fs::path& folder) {
  constexpr std::size_t kMost = 1000000;  // more are no views of a scan
  const io::Json run = io::load_json_or_null(folder / "run.json");
  std::size_t count = 0;
  if (run.is_object() && run.value("views", io::Json()).is_number_unsigned())
    count = std::min(kMost, run["views"].get<std::size_t>());
  std::error_code error;
  for (fs::directory_iterator i(folder / "views", error), end; !error && i != end; i.increment(error)) {
    const auto number = io::to_integer(i->path().stem().string());
    if (i->path().extension() == ".view" && number && *number >= 0 && *number < static_cast<long long>(kMost))
      count = std::max(count, static_cast<std::size_t>(*number) + 1);
  }
  RecordNumbers out;
  for (std::size_t i = 0; i < count; ++i)
    (fs::exists(io::view_record_path(folder, i), error) ? out.present : out.missing).push_back(i);
  return out;
}

/// The file of an image of view `i`, from the folder of views.yaml.
fs::path image_name(const char* folder, std::size_t i, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%04zu.%s", i, extension);
  return fs::path(folder) / name;
}

/// Reads the frames of a scan with the colors and masks that it simulated, which the records leave out.
class ScanFrames {
 public:
  explicit ScanFrames(const fs::path& folder) : folder_(folder), task_(io::read_scan_task(folder / "scan.json")) {
    scene_ = io::read_scene(task_.scene);
    images_ = images_of(task_);
    if (!images_.any()) return;
    if (content_of(task_.scene, scene_) != task_.content)
      throw FileError(task_.scene + ": is not the scene of the scan, so its colors and masks cannot be made again");
    traced_ = std::make_unique<study::TracedScene>(scene_.scene, threads_of(0));
  }
  const Workcell& workcell() const { return scene_.workcell; }
  const study::ImageOptions& images() const { return images_; }

  /// The record of a view, without colors and masks. @throws FileError if it is damaged
  io::ViewRecord record(std::size_t i) const {
    try {
      return *io::read_view_record(folder_, i, task_.fingerprint(), scene_.workcell.sensor.intrinsics.size());
    } catch (const FileError& e) {
      throw FileError(std::string(e.what()) + "; if only the view is removed, the others are exported");
    }
  }
  io::ViewRecord view(std::size_t i) const {
    io::ViewRecord out = record(i);
    if (traced_)
      study::add_images(out.frame, *traced_, scene_.workcell.sensor, out.world_T_optical_asked, images_, task_.seed, i,
                        threads_of(0));
    return out;
  }

 private:
  fs::path folder_;
  io::ScanTask task_;
  io::SceneFile scene_;
  study::ImageOptions images_;
  std::unique_ptr<study::TracedScene> traced_;
};

int run_export(const ExportOptions& options) {
  constexpr double kScale = 1e-4;  // m; the images then reach up to 6.5 m
  const fs::path from = options.result, to = options.output;
  check_kind(options.result, Kind::scan);
  if (!fs::exists(from / "scan.json"))
    throw FileError(options.result + ": is not the result of a scan: there is no " + (from / "scan.json").string());
  const ScanFrames frames(from);
  const RecordNumbers numbers = record_numbers(from);
  if (numbers.present.empty()) throw FileError(options.result + ": holds no recorded view");
  for (const std::size_t i : numbers.present) frames.record(i);  // nothing is written if one is damaged
  io::RecordedViews recorded;
  recorded.workcell = frames.workcell();
  recorded.workcell.sensor.range_min = 0.0;
  recorded.workcell.sensor.range_max = 1e6;  // the images hold only what was in range
  recorded.depth_scale = options.npy ? 1.0 : kScale;
  if (!options.force && fs::exists(to / "views.yaml"))
    throw UsageError(options.output + ": already holds recorded views; use --force to overwrite them");
  make_folder((to / "depth").string());
  if (frames.images().any()) make_folder((to / "color").string());
  if (frames.images().detector) make_folder((to / "masks").string());
  for (const std::size_t i : numbers.present) {
    const io::ViewRecord view = frames.view(i);
    io::RecordedView out{image_name("depth", i, options.npy ? "npy" : "png"), view.world_T_optical, "", {}};
    if (options.npy)
      io::write_depth_npy(to / out.depth, view.frame);
    else
      io::write_depth_png(to / out.depth, view.frame, kScale);
    if (!view.frame.color.empty()) out.channels.color = image_name("color", i, "png");
    if (!view.frame.instances.empty()) out.channels.masks = image_name("masks", i, "png");
    const auto whole = [&](const fs::path& path) { return path.empty() ? path : to / path; };
    io::write_channels(view.frame, {whole(out.channels.color), whole(out.channels.masks), {}});
    recorded.views.push_back(out);
  }
  io::write_recorded_views(to / "views.yaml", recorded);
  std::cout << recorded.views.size() << " views in " << (to / "views.yaml").string() << "\n";
  if (!numbers.missing.empty())
    std::cerr << "agrisee: " << (from / "views").string() << ": holds no record of view " << comma_list(numbers.missing)
              << ", which is left out\n";
  return kSuccess;
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
                            const io::McapChoice& choice) {
  const ViewSource source = is_mcap(path) ? source_of_mcap(path, choice) : source_of_yaml(path);
  Processed out;
  out.workcell = source.workcell;
  const Survey first = survey(source);
  const std::optional<std::string> doubt = doubt_of_poses(path, first, source.workcell.scan_volume);
  if (out.workcell.scan_volume.empty()) out.workcell.scan_volume = all_that_is_seen(path, first.seen);
  PipelineOptions pipeline_options;
  pipeline_options.planner = std::make_unique<NoPlanner>();
  pipeline_options.reach = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };  // there is no arm
  pipeline_options.seed = options.seed;
  pipeline_options.threads = threads_of(options.threads);
  Pipeline pipeline(out.workcell, parameters, std::move(pipeline_options));
  std::string doubt_of_masks;
  std::size_t doubted = 0;
  for (std::size_t i = 0; i < source.poses.size(); ++i) {
    sensor::DepthFrame frame = source.frame(i);
    out.history.depth.push_back(io::depth_picture(frame));
    if (const auto text = sensor::doubt_of_masks(frame); text && ++doubted == 1)
      doubt_of_masks = "view " + std::to_string(i) + ": " + *text;
    pipeline.observe(std::move(frame), source.poses[i]);
    if (!options.quiet) show_progress(pipeline.views(), source.poses.size());
  }
  if (!options.quiet) end_progress();
  out.result = pipeline.result();
  check_contradictions(path, out.result.views);
  const std::vector<std::string> notes = shortened(source.warnings);
  out.result.warnings.insert(out.result.warnings.begin(), notes.begin(), notes.end());
  if (doubt) out.result.warnings.push_back(*doubt);
  if (doubted > 1) doubt_of_masks += " (so in " + std::to_string(doubted) + " views)";
  if (doubted > 0) out.result.warnings.push_back(doubt_of_masks);
  return out;
}

void add_export_views(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand(
      "export-views",
      "write the frames of a simulated scan as recorded views, with the colors and masks that it simulated");
  auto options = std::make_shared<ExportOptions>();
  command->add_option("result", options->result, "result folder of a scan")->required();
  command->add_option("-o,--output", options->output, "folder for views.yaml and the images")->required();
  command->add_flag("--npy", options->npy, "write depth as NPY with floats (exact), not as PNG in steps of 0.1 mm");
  command->add_flag("--force", options->force, "overwrite recorded views");
  command->footer(
      "Example:\n"
      "  agrisee export-views result -o recorded\n"
      "  agrisee process recorded -o again");
  command->callback([options, &run] { run = [options] { return run_export(*options); }; });
}

}  // namespace agrisee::cli
