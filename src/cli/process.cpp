// SPDX-License-Identifier: BSD-3-Clause
// agrisee process: locates the fruit in a cloud from another source.
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/render.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scan_page.hpp>
#include <agrisee/locate.hpp>
#include <agrisee/process.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "many.hpp"

namespace agrisee::cli {
namespace {

struct ProcessOptions : CommonOptions {
  std::vector<std::string> clouds;
  std::string cloud, views, shard;
  std::vector<double> viewpoint;
};

/// What is known about where the points of a cloud were seen from. @throws FileError if views are missing
CloudOrigin origin_of(const ProcessOptions& options, const Cloud& cloud) {
  CloudOrigin origin;
  origin.check_normals = true;
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
  info.seed = options.seed;
  info.threads = threads_of(options.threads);
  info.noise = "none";
  info.preset = parameters.preset;
  info.planner = "none";
  info.parameters_json = io::parameters_to_json(parameters);
  return info;
}

int run_process(const ProcessOptions& options) {
  const Parameters parameters = parameters_of(options);
  parameters.check();
  const io::CloudFile file = io::read_cloud(options.cloud);
  if (file.dropped > 0)
    std::cerr << options.cloud << ": " << file.dropped << " points that are not finite were dropped\n";
  CloudOrigin origin = origin_of(options, file.cloud);
  check_input_is_kept(options);
  prepare_output(options.output, options.force);
  const Cloud cloud = parameters.fuse_surfaces ? thinned(file.cloud, parameters) : file.cloud;
  Workcell workcell;
  workcell.name = std::filesystem::path(options.cloud).filename().string();
  for (const auto& p : cloud.points) workcell.scan_volume.extend(p.cast<double>());
  if (!workcell.scan_volume.empty())
    origin.cluster_origin = cluster_origin(workcell.scan_volume, Eigen::Vector3d::Zero());
  const ScanResult result = process(cloud, parameters, origin, {}, threads_of(options.threads));
  const io::RunInfo info = run_info(options, parameters, workcell.name);
  io::write_result(options.output, result, workcell, info);
  io::write_picture(std::filesystem::path(options.output) / "truss.png", result, workcell);
  io::write_scan_page(std::filesystem::path(options.output) / "report.html", result, workcell, info);
  print_summary(result, options.output, options.json);
  return kSuccess;
}

}  // namespace

void add_process(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("process", "locate the fruit in a cloud from another source (PLY or PCD)");
  auto options = std::make_shared<ProcessOptions>();
  command
      ->add_option(
          "cloud", options->clouds,
          "cloud file (PLY or PCD; metres); with several, or a pattern, each gets its own folder in the output folder")
      ->required();
  add_common_options(*command, *options)->required();
  command
      ->add_option("--viewpoint", options->viewpoint,
                   "position x,y,z of the sensor (m) from which all points were seen")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--views", options->views,
                   "views.csv with the sensor poses that the property 'view' of the points refers to")
      ->excludes("--viewpoint");
  add_shard_option(*command, options->shard);
  command->footer(
      "Normals in the file are kept, but turned if they face away from the viewpoint or view. Missing normals are\n"
      "estimated; without viewpoint or views they are turned so that neighbors agree.\n"
      "Examples:\n"
      "  agrisee process cloud.ply -o result\n"
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
