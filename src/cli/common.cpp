// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/pipeline.hpp>

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <thread>

#include "commands.hpp"

namespace agrisee::cli {

namespace fs = std::filesystem;

std::vector<std::string> preset_choices() { return {kPresetNames.begin(), kPresetNames.end()}; }

std::vector<std::string> planner_choices() {
  std::vector<std::string> choices(kPlannerNames.begin(), kPlannerNames.end());
  choices.push_back("greedy");
  return choices;
}

CLI::Option* add_common_options(CLI::App& command, CommonOptions& options) {
  CLI::Option* output = command.add_option("-o,--output", options.output, "folder for the result");
  command.add_option("--preset", options.preset, "initial parameter values: default, or paper")
      ->check(CLI::IsMember(preset_choices()))
      ->capture_default_str();
  command.add_option("--params", options.parameter_file, "YAML file with parameters to change");
  command
      .add_option("--radius", options.radius,
                  "smallest,largest expected radius of a fruit (m; default 0.02,0.05); also sets the parameters that "
                  "depend on it")
      ->delimiter(',')
      ->expected(2);
  command.add_option("--seed", options.seed, "seed of all random draws")->capture_default_str();
  command.add_option("--threads", options.threads, "number of threads (0: one per core); does not change the result")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("--force", options.force, "overwrite an existing result");
  command.add_flag("--json", options.json, "print the summary as JSON");
  return output;
}

Parameters parameters_of(const CommonOptions& options) {
  const Parameters base = Parameters::named(options.preset);
  Parameters parameters = options.parameter_file.empty() ? base : io::read_parameters(options.parameter_file, base);
  if (options.radius.empty()) return parameters;
  try {
    parameters.expect_radii(options.radius[0], options.radius[1]);
  } catch (const ParameterError& e) {  // the numbers came from the command line
    throw UsageError(std::string("--radius: ") + e.what());
  }
  return parameters;
}

int threads_of(int requested) {
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

study::NoiseModel noise_of(const std::string& text) {
  try {
    return study::parse_noise(text);
  } catch (const ParameterError& e) {
    throw UsageError(e.what());
  }
}

void check_scan(const Workcell& workcell, const Parameters& parameters) {
  workcell.sensor.check();
  Pipeline(workcell, parameters);  // its constructor checks the rest
}

void make_folder(const std::string& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw UsageError(folder + ": exists and is not a folder");
  fs::create_directories(folder, error);
  if (error) throw FileError(folder + ": cannot be created: " + error.message());
}

void prepare_output(const std::string& folder, bool force) {
  std::error_code error;
  for (const char* name : kResultFiles)
    if (!force && fs::exists(fs::path(folder) / name, error))
      throw UsageError(folder + ": already holds a result (" + name + "); use --force to overwrite it");
  if (!force && fs::exists(fs::path(folder) / "scan.json", error))
    throw UsageError(folder + ": holds a scan that was not finished; continue it with `agrisee scan --resume " +
                     folder + "`, or use --force to overwrite it");
  make_folder(folder);
  io::remove_leftovers(folder);
  if (!force) return;
  for (const char* name : kResultFiles) {  // no file of an older result may be mistaken for one of the new result
    const fs::path path = fs::path(folder) / name;
    fs::remove(path, error);
    if (error) throw FileError(path.string() + ": cannot be removed: " + error.message());
  }
  io::remove_scan_records(folder);
}

namespace {

std::string summary_json(const ScanResult& result, const std::string& folder, std::size_t labelled) {
  nlohmann::ordered_json out;
  out["folder"] = folder;
  out["fruits"] = result.fruits.size();
  out["views"] = result.views.size();
  out["stop_reason"] = to_string(result.stop_reason);
  out["points"] = {{"merged", result.raw.size()}, {"filtered", result.cloud.size()}, {"labelled", labelled}};
  out["seconds"] = result.seconds.total;
  return out.dump(2) + "\n";
}

std::string summary_text(const ScanResult& result, const std::string& folder) {
  std::ostringstream text;
  text << std::fixed;
  text << result.fruits.size() << " fruit from " << result.views.size() << " views (" << to_string(result.stop_reason)
       << "), " << result.cloud.size() << " points, " << std::setprecision(2) << result.seconds.total
       << " s of computing\n";
  if (!result.fruits.empty())
    text << "  id   points  found by              centre x, y, z (m)          radius  seen  axis z (world)\n";
  for (const Fruit& f : result.fruits) {
    const Eigen::Vector3d c = f.body ? f.body->center : f.centroid;
    const Eigen::Vector3d z = f.orientation.col(2);
    text << std::setw(4) << f.id << std::setw(9) << f.points << "  " << std::left << std::setw(16) << f.found_by
         << std::right << std::setprecision(4) << std::setw(10) << c.x() << std::setw(9) << c.y() << std::setw(9)
         << c.z();
    if (f.body)
      text << std::setprecision(1) << std::setw(9) << 1e3 * f.body->radii.mean() << " mm" << std::setprecision(0)
           << std::setw(4) << 100.0 * f.body->completeness << " %";
    text << std::setprecision(2) << std::setw(8) << z.x() << std::setw(6) << z.y() << std::setw(6) << z.z() << "\n";
  }
  text << "Result: " << folder << "\n";
  return text.str();
}

}  // namespace

void print_summary(const ScanResult& result, const std::string& folder, bool json) {
  std::size_t labelled = 0;
  for (int l : result.labels) labelled += l > 0;
  std::cout << (json ? summary_json(result, folder, labelled) : summary_text(result, folder));
}

}  // namespace agrisee::cli
