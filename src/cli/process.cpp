// SPDX-License-Identifier: BSD-3-Clause
// agrisee process: locates the fruit in a cloud, or in the views of a camera, from another source.
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/recorded_views.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/process.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "depth_image.hpp"
#include "folder_lock.hpp"
#include "inputs.hpp"
#include "job_record.hpp"
#include "many.hpp"
#include "recorded.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

struct ProcessOptions : CommonOptions {
  std::vector<std::string> clouds;
  std::string cloud, views, shard;
  std::vector<double> viewpoint, range;
  bool turn_normals = false;
  DepthImageOptions image;
  io::McapChoice mcap;

  RecordingChoice choice() const {
    RecordingChoice out;
    out.mcap = mcap;
    if (!range.empty()) out.range = Eigen::Vector2d(range[0], range[1]);
    return out;
  }
};

/// What is known about where the points of a cloud were seen from. @throws FileError if views are missing
CloudOrigin origin_of(const ProcessOptions& options, const Cloud& cloud) {
  CloudOrigin origin;
  origin.check_normals = true;
  origin.trust_viewpoint = options.turn_normals;
  if (!options.viewpoint.empty())
    origin.viewpoint = Eigen::Vector3d(options.viewpoint[0], options.viewpoint[1], options.viewpoint[2]);
  if (options.views.empty()) return origin;
  if (cloud.views.size() != cloud.size())
    throw FileError(options.cloud + ": has no property 'view', which --views needs (cloud_raw.ply of a scan has it)");
  for (const View& v : io::read_views(options.views)) origin.sensors.push_back(v.world_T_optical.translation());
  for (int v : cloud.views)
    if (v >= static_cast<int>(origin.sensors.size()))
      throw FileError(options.views + ": has no view " + std::to_string(v) + ", which " + options.cloud + " refers to");
  return origin;
}

/// Refuse a cloud that cannot be what the options say: in metres, and seen from one viewpoint.
/// @throws FileError
void check_cloud(const ProcessOptions& options, const Cloud& cloud, const Parameters& parameters,
                 const CloudOrigin& origin) {
  std::size_t away = 0;
  try {
    check_units(cloud, parameters);
    check_origin(cloud, origin);
    if (origin.viewpoint && !options.turn_normals) away = normals_facing_away(cloud, origin);
  } catch (const InputError& e) {
    throw FileError(options.cloud + ": " + e.what() + (origin.viewpoint && cloud.views.size() ? " (--views)" : ""));
  }
  if (100 * away > cloud.size())
    throw FileError(options.cloud + ": " + std::to_string(away) + " of its " + std::to_string(cloud.size()) +
                    " normals face away from --viewpoint. If the cloud was seen from several sides, leave --viewpoint "
                    "out, which keeps the normals; if the normals are wrong, add --turn-normals");
}

/// The files that options name.
std::vector<std::string> files_of(const ProcessOptions& options) {
  const DepthImageOptions& image = options.image;
  return {options.parameter_file, options.views, image.depth, image.color, image.masks, image.boxes};
}

io::RunInfo run_info(const ProcessOptions& options, const Parameters& parameters, const std::string& scene) {
  io::RunInfo info;
  info.scene = scene;
  info.version = AGRISEE_VERSION;
  info.time = io::utc_now();
  info.seed = options.seed;
  info.threads = threads_of(options.threads);
  info.noise = "none";
  info.preset = parameters.preset;
  info.planner = "none";
  info.parameters_json = io::parameters_to_json(parameters);
  return info;
}

Processed process_cloud(const ProcessOptions& options, const Parameters& parameters) {
  const io::CloudFile file = read_cloud_input(options.cloud);
  if (file.dropped > 0)
    std::cerr << options.cloud << ": " << file.dropped << " points that are not finite were dropped\n";
  if (file.skipped > 0)
    std::cerr << options.cloud << ": of its " << file.skipped + 3
              << " columns only the first three, x, y and z, are read; PLY and CSV can hold more\n";
  const CloudOrigin origin = origin_of(options, file.cloud);
  check_cloud(options, file.cloud, parameters, origin);
  const Cloud cloud = parameters.fuse_surfaces ? thinned(file.cloud, parameters) : file.cloud;
  Processed out;
  out.workcell.name = name_of(options.cloud);
  out.workcell.scan_volume = bounding_box(cloud.points);
  try {
    out.result = process(cloud, parameters, origin, {}, threads_of(options.threads));
  } catch (const InputError& e) {  // the rest was checked before
    const char* advice =
        ". If several views saw the cloud, leave --viewpoint out, or give their positions (--views); if --viewpoint is "
        "right, add --turn-normals";
    throw FileError(options.cloud + ": " + e.what() + (origin.viewpoint ? advice : ""));
  }
  return out;
}

/// Refuse options that do not go together. @throws UsageError
void check_input_options(const ProcessOptions& options) {
  const bool image = !options.image.depth.empty();
  if (!image && options.cloud.empty()) throw UsageError("an input is needed: a cloud, views.yaml, or --depth");
  if (image && !options.cloud.empty()) throw UsageError("give either an input or --depth, not both");
  const bool of_mcap = !options.mcap.topic.empty() || !options.mcap.world_frame.empty() || !options.range.empty();
  if (of_mcap && (image || !is_mcap(options.cloud)))
    throw UsageError((image ? options.image.depth : options.cloud) +
                     ": is no MCAP file, so leave out --topic, --world-frame and --range");
  if (!options.range.empty() && !(options.range[0] >= 0.0 && options.range[0] < options.range[1]))
    throw UsageError("--range: expected 0 <= minimum < maximum");
  if (!options.range.empty() && options.range[0] > 50.0)
    throw UsageError("--range: begins at " + metres(options.range[0]) + ": is it in millimetres?");
  if (!image) return;
  if (!(options.views.empty() && options.viewpoint.empty()))
    throw UsageError("--depth: the image was seen from its own origin, so leave out --views and --viewpoint");
  if (options.image.intrinsics.empty()) throw UsageError("--depth needs --intrinsics fx,fy,cx,cy");
}

/// Append all files of recorded views to a fingerprint.
void add_recording(io::Fingerprint& print, const std::string& path) {
  add_file(print, path);
  if (is_mcap(path)) return;
  const io::RecordedViews recorded = io::read_recorded_views(path);
  for (const io::RecordedView& view : recorded.views)
    for (const std::filesystem::path& image :
         {view.depth, view.channels.color, view.channels.masks, view.channels.boxes}) {
      if (image.empty()) continue;
      add_file(print, recorded.folder / image);
      if (image != view.channels.masks) continue;
      for (const char* extension : {".json", ".csv"}) {  // classes and scores beside a label image
        const auto beside = (recorded.folder / image).replace_extension(extension);
        if (std::filesystem::exists(beside)) add_file(print, beside);
      }
    }
}

/// Fingerprint of all that changes the result of an input: version, files, parameters, where it was seen from. Empty
/// for what can be read only once, such as a pipe.
std::string key_of(const ProcessOptions& options, const std::string& input) {
  const bool recording = is_recording(input);
  if (!recording && std::filesystem::exists(input) && !std::filesystem::is_regular_file(input)) return "";
  if (input == "-") return "";
  io::Fingerprint print;
  print.add("process\n" AGRISEE_VERSION "\n" + io::parameters_to_json(parameters_of(options)) + "\n" +
            std::to_string(options.seed) + (options.turn_normals ? " turned" : "") + "\n" + options.mcap.topic + "\n" +
            options.mcap.world_frame + "\n");
  for (const double x : options.viewpoint) print.add(&x, sizeof x);
  for (const double x : options.range) print.add(&x, sizeof x);
  if (!options.views.empty()) add_file(print, options.views);
  if (recording)
    add_recording(print, recording_file(input));
  else
    add_file(print, input);
  return print.text();
}

void run_process(const ProcessOptions& options) {
  check_input_options(options);
  const Parameters parameters = parameters_of(options);
  parameters.check();
  if (!options.prepared) check_output(options.output, options.force);
  const bool recording = options.image.depth.empty() && is_recording(options.cloud);
  if (recording && !(options.views.empty() && options.viewpoint.empty()))
    throw FileError(options.cloud + ": states where its views were seen from, so leave out --views and --viewpoint");
  const Processed done = !options.image.depth.empty() ? process_depth_image(options.image, parameters, options.threads)
                         : recording
                             ? process_recording(recording_file(options.cloud), options, parameters, options.choice())
                             : process_cloud(options, parameters);
  FolderLock lock;  // a list has its own
  if (!options.prepared) {
    lock.take(options.output);
    prepare_output(options.output, options.force);
    lock.take(options.output);
  }
  write_files(options.output, done.result, done.workcell, run_info(options, parameters, done.workcell.name), options,
              done.history);
  print_summary(done.result, options.output, options);
}

}  // namespace

void add_process(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("process", "locate the fruit in a cloud, or in recorded depth images");
  auto options = std::make_shared<ProcessOptions>();
  command->add_option(
      "input", options->clouds,
      "cloud (PLY, PCD, NPY, XYZ, CSV; metres; - for standard input); or views.yaml (or its folder), which lists "
      "depth images and camera poses; or a recording of ROS 2 (MCAP); of several inputs, or a pattern, each gets its "
      "own folder in the output folder");
  add_common_options(*command, *options)->required();
  command
      ->add_option("--viewpoint", options->viewpoint,
                   "position x,y,z of the sensor (m) from which all points were seen; for a cloud of a single view")
      ->delimiter(',')
      ->expected(3);
  command->add_flag(
      "--turn-normals", options->turn_normals,
      "accept --viewpoint even if points or normals contradict it, and turn normals that face away from it");
  command
      ->add_option("--views", options->views,
                   "views.csv with the sensor pose of each view, for points with a property 'view'")
      ->excludes("--viewpoint");
  add_depth_image_options(*command, options->image);
  command->add_option("--topic", options->mcap.topic,
                      "topic of the depth images in an MCAP file (default: the only one)");
  command->add_option("--world-frame", options->mcap.world_frame,
                      "frame of the result, for an MCAP file (default: world, base_link, or the root of tf)");
  command
      ->add_option("--range", options->range,
                   "least and largest distance min,max along the rays (m) in an MCAP file; what is nearer or farther "
                   "is no return (default: all counts)")
      ->delimiter(',')
      ->expected(2);
  add_shard_option(*command, options->shard);
  command->footer(
      "Normals in the file are kept; those that face away from their sensor are turned. Missing normals are\n"
      "estimated; without --viewpoint or --views they are turned so that neighbors agree. --viewpoint is refused if\n"
      "the points come from several views, if more than 1 % of the normals face away from it, if more than 3 % of the\n"
      "points are hidden behind others, or if it lies on the hollow side of curved surfaces.\n"
      "Examples:\n"
      "  agrisee process cloud.ply -o result\n"
      "  agrisee process recorded/views.yaml -o result\n"
      "  agrisee process recorded.mcap -o result --topic /camera/depth/image_rect_raw\n"
      "  zcat cloud.ply.gz | agrisee process - -o result\n"
      "  agrisee process frame.pcd -o result --viewpoint 0,0,0 --radius 0.025,0.06\n"
      "  agrisee process --depth depth.png --color color.png --masks masks.png --intrinsics 911,911,640,360 -o result\n"
      "  agrisee process 'season/*.ply' -o results --shard 2/8");
  command->callback([options, &run] {
    run = [options] {
      ListedCommand list{"process", options->force, options->json, files_of(*options), {}, {}, {}};
      list.run = [&](const std::string& input, const std::string& folder, Begin begin) {
        ProcessOptions one = *options;
        one.cloud = input;
        one.output = folder;
        one.prepared = begin != Begin::as_asked;
        run_process(one);
      };
      list.key = [&](const std::string& input) { return key_of(*options, input); };
      list.is_complete = [&](const std::string& folder) { return is_finished(folder, *options); };
      return run_inputs(options->clouds, options->shard, options->output, list);
    };
  });
}

}  // namespace agrisee::cli
