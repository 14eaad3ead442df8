// SPDX-License-Identifier: BSD-3-Clause
// agrisee process: from a ready cloud to located fruit.
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/render.hpp>
#include <agrisee/io/report_html.hpp>
#include <agrisee/process.hpp>
#include <agrisee/process_stages.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "many.hpp"

namespace agrisee::cli {
namespace {

struct ProcessOptions : PipelineOptions {
  std::vector<std::string> clouds;
  std::string cloud, views, shard;
  std::vector<double> viewpoint;
};

int run_process(const ProcessOptions& options) {
  const Parameters parameters = parameters_of(options);
  parameters.check();
  const io::CloudFile file = io::read_cloud(options.cloud);
  if (file.dropped > 0)
    std::cerr << options.cloud << ": " << file.dropped << " points that are not finite were dropped\n";
  CloudOrigin origin;
  origin.check_normals = true;
  if (!options.viewpoint.empty())
    origin.viewpoint = Eigen::Vector3d(options.viewpoint[0], options.viewpoint[1], options.viewpoint[2]);
  if (!options.views.empty()) {
    if (file.cloud.views.size() != file.cloud.size())
      throw FileError(options.cloud + ": has no property 'view', which --views needs");
    for (const View& v : io::read_views(options.views)) origin.sensors.push_back(v.world_T_optical.translation());
    for (int v : file.cloud.views)
      if (v >= static_cast<int>(origin.sensors.size()))
        throw FileError(options.views + ": has no view " + std::to_string(v) + ", which " + options.cloud +
                        " refers to");
  }
  std::error_code error;
  for (const char* name : {"cloud.ply", "cloud_raw.ply"})
    if (std::filesystem::equivalent(options.cloud, std::filesystem::path(options.output) / name, error))
      throw UsageError(options.cloud + ": is the input and would be overwritten");
  prepare_output(options.output, options.force);
  const Cloud cloud = parameters.fuse_surfaces ? thinned(file.cloud, parameters) : file.cloud;
  Workcell workcell;
  workcell.name = std::filesystem::path(options.cloud).filename().string();
  for (const auto& p : cloud.points) workcell.scan_volume.extend(p.cast<double>());
  if (!workcell.scan_volume.empty())
    origin.cluster_origin = cluster_origin(workcell.scan_volume, Eigen::Vector3d::Zero());
  const ScanResult result = process(cloud, parameters, origin, {}, threads_of(options.threads));
  io::RunInfo info;
  info.scene = workcell.name;
  info.version = AGRISEE_VERSION;
  info.seed = options.seed;
  info.threads = threads_of(options.threads);
  info.noise = "none";
  info.preset = parameters.preset;
  info.planner = "none";
  info.parameters_json = io::parameters_to_json(parameters);
  io::write_result(options.output, result, workcell, info);
  io::write_picture(std::filesystem::path(options.output) / "truss.png", result, workcell);
  io::write_report_html(std::filesystem::path(options.output) / "report.html", result, workcell, info);
  print_summary(result, options.output, options.json);
  return kSuccess;
}

}  // namespace

void add_process(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("process", "locate the fruit in a cloud from elsewhere (PLY or PCD)");
  auto options = std::make_shared<ProcessOptions>();
  command
      ->add_option("cloud", options->clouds,
                   "cloud file (PLY or PCD; metres); several, or a pattern, each get a folder of their own in DIR")
      ->required();
  add_pipeline_options(*command, *options)->required();
  command->add_option("--viewpoint", options->viewpoint, "position x,y,z (m) from which all points were seen")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--views", options->views, "views.csv with the sensor of each point's property 'view'")
      ->excludes("--viewpoint");
  add_shard_option(*command, options->shard);
  command->footer(
      "Normals that the file has are kept, but turned where they face away from the viewpoint or view; missing ones\n"
      "are estimated and, without viewpoint or views, made to agree with one another.\n"
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
