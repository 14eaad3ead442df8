// SPDX-License-Identifier: BSD-3-Clause
// agrisee process: locates the fruit in a cloud, or in the views of a camera, from another source.
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/process.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "inputs.hpp"
#include "many.hpp"
#include "recorded.hpp"

namespace agrisee::cli {
namespace {

struct ProcessOptions : CommonOptions {
  std::vector<std::string> clouds;
  std::string cloud, views, shard;
  std::vector<double> viewpoint;
  bool turn_normals = false;
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
    throw FileError(options.cloud + ": has no property 'view', which --views needs");
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

/// @throws UsageError if a file of the result would overwrite the cloud
void check_input_is_kept(const ProcessOptions& options) {
  std::error_code error;
  for (const char* name : {"cloud.ply", "cloud_raw.ply"})
    if (std::filesystem::equivalent(options.cloud, std::filesystem::path(options.output) / name, error))
      throw UsageError(options.cloud + ": is the input and would be overwritten");
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
  const CloudOrigin origin = origin_of(options, file.cloud);
  check_cloud(options, file.cloud, parameters, origin);
  const Cloud cloud = parameters.fuse_surfaces ? thinned(file.cloud, parameters) : file.cloud;
  Processed out;
  out.workcell.name = name_of(options.cloud);
  out.workcell.scan_volume = bounding_box(cloud.points);
  try {
    out.result = process(cloud, parameters, origin, {}, threads_of(options.threads));
  } catch (const InputError& e) {  // the rest was checked before
    throw FileError(options.cloud + ": " + e.what() +
                    ". If several views saw the cloud, leave --viewpoint out, or give their positions (--views); if "
                    "--viewpoint is right, add --turn-normals");
  }
  return out;
}

int run_process(const ProcessOptions& options) {
  const Parameters parameters = parameters_of(options);
  parameters.check();
  check_input_is_kept(options);
  check_output(options.output, options.force);
  const bool recording = is_recording(options.cloud);
  if (recording && !(options.views.empty() && options.viewpoint.empty()))
    throw FileError(options.cloud + ": states where its views were seen from, so leave out --views and --viewpoint");
  const Processed done = recording ? process_recording(recording_file(options.cloud), options, parameters)
                                   : process_cloud(options, parameters);
  prepare_output(options.output, options.force);
  write_files(options.output, done.result, done.workcell, run_info(options, parameters, done.workcell.name), options,
              done.history);
  print_summary(done.result, options.output, options);
  return kSuccess;
}

}  // namespace

void add_process(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("process", "locate the fruit in a cloud, or in recorded depth images");
  auto options = std::make_shared<ProcessOptions>();
  command
      ->add_option("input", options->clouds,
                   "cloud (PLY, PCD, NPY, XYZ, CSV; metres; - for standard input), or views.yaml, or a folder with it, "
                   "which names depth images and camera poses; with several, or a pattern, each gets its own folder in "
                   "the output folder")
      ->required();
  add_common_options(*command, *options)->required();
  command
      ->add_option("--viewpoint", options->viewpoint,
                   "position x,y,z of the sensor (m) from which all points were seen; for a cloud of a single view")
      ->delimiter(',')
      ->expected(3);
  command->add_flag("--turn-normals", options->turn_normals,
                    "believe --viewpoint: turn normals of the file that face away from it, however many they are, "
                    "and do not refuse it");
  command
      ->add_option("--views", options->views,
                   "views.csv with the sensor poses that the property 'view' of the points refers to")
      ->excludes("--viewpoint");
  add_shard_option(*command, options->shard);
  command->footer(
      "Normals in the file are kept; those that face away from the view of their point are turned. Missing normals\n"
      "are estimated; without viewpoint or views they are turned so that neighbors agree. --viewpoint is refused for\n"
      "points of several views, where more than 1 % of the normals face away from it, where more than 3 % of the\n"
      "points lie hidden behind others, and where it lies on the hollow side of what is curved.\n"
      "Examples:\n"
      "  agrisee process cloud.ply -o result\n"
      "  agrisee process recorded/views.yaml -o result\n"
      "  zcat cloud.ply.gz | agrisee process - -o result\n"
      "  agrisee process frame.pcd -o result --viewpoint 0,0,0 --radius 0.025,0.06\n"
      "  agrisee process 'season/*.ply' -o results --shard 2/8");
  command->callback([options, &run] {
    run = [options] {
      return run_inputs(options->clouds, options->shard, options->output,
                        [&](const std::string& input, const std::string& folder) {
                          ProcessOptions one = *options;
                          one.cloud = input;
                          one.output = folder;
                          return run_process(one);
                        });
    };
  });
}

}  // namespace agrisee::cli
