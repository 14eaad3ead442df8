// SPDX-License-Identifier: BSD-3-Clause
// agrisee export-views: writes the frames of a simulated scan as recorded views.
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/detections.hpp>
#include <agrisee/io/recorded_views.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "inputs.hpp"
#include "io/formats/json_value.hpp"
#include "io/formats/text.hpp"
#include "summary.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string result, output, scene;
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

constexpr const char* kImageFolders[] = {"depth", "color", "masks"};

/// The images in a folder that are named as those of views: 0000.png, 0001.npy and so on.
std::vector<fs::path> images_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> images;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    const std::string number = i->path().stem().string(), extension = i->path().extension().string();
    if (number.size() >= 4 && io::to_integer(number) &&
        (extension == ".png" || extension == ".npy" || extension == ".json"))
      images.push_back(i->path());
  }
  std::sort(images.begin(), images.end());
  return images;
}

/// Make room for views in a folder. The images of an earlier call are removed, as fewer may follow.
/// @throws UsageError if it holds recorded views, or images that could be overwritten, and `force` is off
void make_room(const fs::path& to, bool force) {
  const bool has_views = fs::exists(to / "views.yaml");
  if (has_views && !force)
    throw UsageError(to.string() + ": already holds recorded views; use --force to overwrite them");
  for (const char* folder : kImageFolders)
    for (const fs::path& image : images_in(to / folder)) {
      if (!force) throw UsageError(image.string() + ": exists; use --force to overwrite it");
      std::error_code error;
      if (has_views) fs::remove(image, error);
    }
}

/// Reads the frames of a scan with the colors and masks that it simulated, which the records leave out.
class ScanFrames {
 public:
  /// @param scene where the scene is now; empty: where it was
  ScanFrames(const fs::path& folder, const std::string& scene)
      : folder_(folder), task_(io::read_scan_task(folder / "scan.json")) {
    const std::string path = scene.empty() ? task_.scene : scene_file(scene);
    if (scene.empty() && !fs::exists(path))
      throw FileError(path + ": no such file; name the scene of the scan with --scene");
    scene_ = io::read_scene(path);
    images_ = images_of(task_);
    if (!images_.any() && scene.empty()) return;
    if (content_of(path, scene_) != task_.content)
      throw FileError(path + ": is not the scene of the scan" +
                      (images_.any() ? ", so its colors and masks cannot be made again" : ""));
    if (!images_.any()) return;
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
  const ScanFrames frames(from, options.scene);
  const RecordNumbers numbers = record_numbers(from);
  if (numbers.present.empty()) throw FileError(options.result + ": holds no recorded view");
  for (const std::size_t i : numbers.present) frames.record(i);  // nothing is written if one is damaged
  io::RecordedViews recorded;
  recorded.workcell = frames.workcell();
  recorded.workcell.sensor.range_min = 0.0;
  recorded.workcell.sensor.range_max = 1e6;  // the images hold only what was in range
  recorded.depth_scale = options.npy ? 1.0 : kScale;
  make_room(to, options.force);
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

}  // namespace

void add_export_views(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand(
      "export-views", "write the frames of a simulated scan as recorded views, with the simulated colors and masks");
  auto options = std::make_shared<ExportOptions>();
  command->add_option("result", options->result, "result folder of a scan")->required();
  command->add_option("-o,--output", options->output, "folder for views.yaml and the images")->required();
  command->add_option("--scene", options->scene, "scene of the scan (file or folder), if it was moved");
  command->add_flag("--npy", options->npy, "write depth as NPY with floats (exact), not as PNG in steps of 0.1 mm");
  command->add_flag("--force", options->force, "overwrite recorded views and images");
  command->footer(
      "Example:\n"
      "  agrisee export-views result -o recorded\n"
      "  agrisee process recorded -o again");
  command->callback([options, &run] { run = [options] { return run_export(*options); }; });
}

}  // namespace agrisee::cli
