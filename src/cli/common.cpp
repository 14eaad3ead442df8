// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/render.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/pipeline.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <sys/ioctl.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "commands.hpp"
#include "interrupt.hpp"
#include "io/formats/json_value.hpp"
#include "io/formats/text.hpp"
#include "job_record.hpp"
#include "words.hpp"

namespace agrisee::cli {

namespace fs = std::filesystem;

std::string message_of(const std::exception& e) {
  if (const auto* const of_files = dynamic_cast<const fs::filesystem_error*>(&e))
    return of_files->path1().string() + ": " + of_files->code().message();
  return e.what();
}

std::vector<std::string> preset_choices() { return {kPresetNames.begin(), kPresetNames.end()}; }

std::vector<std::string> planner_choices() {
  std::vector<std::string> choices{"greedy"};
  choices.insert(choices.begin(), kPlannerNames.begin(), kPlannerNames.end());
  return choices;
}

CLI::Option* add_common_options(CLI::App& command, CommonOptions& options) {
  CLI::Option* output = command.add_option("-o,--output", options.output, "folder for the result");
  command.add_option("--preset", options.preset, "initial parameter values")
      ->check(one_of(preset_choices()))
      ->each([&options](const std::string&) { options.preset_asked = true; })
      ->capture_default_str();
  command.add_option("--params", options.parameter_file, "YAML file with parameters to change");
  command
      .add_option("--radius", options.radius,
                  "smallest,largest expected radius of a fruit (m, the largest at most 20 times the smallest; default "
                  "0.008,0.06); also sets the parameters that depend on the radii")
      ->delimiter(',')
      ->expected(2);
  command.add_option("--seed", options.seed, "seed of all random draws")->check(not_negative())->capture_default_str();
  command.add_option("--threads", options.threads, "number of threads (0: one per core); does not change the result")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("--force", options.force, "overwrite an existing result");
  command.add_flag("--json", options.json, "print the summary and the fruit as JSON; of several inputs, one line each");
  command.add_flag("--quiet", options.quiet, "print neither progress nor the table of fruit");
  command.add_flag("--no-picture", options.no_picture,
                   "do not write truss.png, which takes about half of the time of `process`");
  command.add_flag("--no-report", options.no_report, "do not write report.html");
  return output;
}

Parameters changed_by(const std::string& file, const Parameters& preset, const char* option) {
  Parameters parameters = io::read_parameters(file, preset);
  if (parameters.preset != preset.preset)
    throw UsageError(std::string(option) + " " + preset.preset + ": " + file + " starts from the preset " +
                     parameters.preset + "; leave one of them out");
  return parameters;
}

Parameters parameters_of(const CommonOptions& options) {
  Parameters parameters = Parameters::named(options.preset);
  if (!options.parameter_file.empty())
    parameters = options.preset_asked ? changed_by(options.parameter_file, parameters, "--preset")
                                      : io::read_parameters(options.parameter_file, parameters);
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
    const std::vector<std::string> known{"none", "gaussian", "l515", "azure", "d405", "l515-white", "rough"};
    const std::string word = text.substr(0, text.find(':'));
    throw UsageError(e.what() + (word == "gaussian" ? "" : io::did_you_mean(word, known)));
  }
}

std::string content_of(const std::string& scene, const io::SceneFile& file) {
  io::Fingerprint print;
  print.add(io::read_bytes(scene).view());
  print.add(file.scene);
  return print.text();
}

study::ImageOptions images_of(const io::ScanTask& task) {
  study::ImageOptions images;
  images.color = task.color;
  if (!task.detector.empty()) images.detector = study::detector_named(task.detector);
  return images;
}

void check_scan(const Workcell& workcell, const Parameters& parameters) {
  workcell.sensor.check();
  Pipeline(workcell, parameters);  // its constructor checks the rest
}

void make_folder(const std::string& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw UsageError(folder + ": exists and is not a folder");
  io::make_folder(folder);
}

void check_output(const std::string& folder, bool force) {
  std::error_code error;
  if (force) return;
  const bool finished = fs::exists(fs::path(folder) / "run.json", error);
  if (!finished && fs::exists(fs::path(folder) / "scan.json", error))
    throw UsageError(folder + ": holds a scan that was not finished; continue it with `agrisee scan --resume " +
                     shell_word(folder) +
                     "`, or use --force to start again, which deletes the views that it has taken");
  for (const char* name : io::kResultFiles)
    if (fs::exists(fs::path(folder) / name, error))
      throw UsageError(folder + ": already holds a result (" + name + "); use --force to overwrite it");
}

bool is_finished(const std::string& folder, const CommonOptions& options) {
  return std::all_of(std::begin(io::kResultFiles), std::end(io::kResultFiles), [&](const std::string& name) {
    return fs::exists(fs::path(folder) / name) || (options.no_picture && name == io::kPicture) ||
           (options.no_report && name == io::kReport);
  });
}

void prepare_output(const std::string& folder, bool force) {
  check_output(folder, force);
  std::error_code error;
  make_folder(folder);
  io::remove_leftovers(folder);
  remove_job(folder);  // a list must not take the new result for its own
  if (!force) return;
  for (const char* name : io::kResultFiles) {  // no file of an older result may be mistaken for one of the new result
    const fs::path path = fs::path(folder) / name;
    fs::remove(path, error);
    if (error) throw FileError(path.string() + ": cannot be removed: " + error.message());
  }
  io::remove_scan_records(folder);
}

void write_files(const std::string& folder, const ScanResult& result, const Workcell& workcell, const io::RunInfo& info,
                 const CommonOptions& options, const io::ScanHistory& history) {
  io::write_result(folder, result, info);
  // The picture comes last: `scan --live` may have left a page already, which does not say that a result is complete.
  if (!options.no_report) io::write_scan_page(fs::path(folder) / io::kReport, result, workcell, info, history);
  if (!options.no_picture) io::write_picture(fs::path(folder) / io::kPicture, result, workcell);
}

namespace {

/// The width of the terminal that stderr is; 0 if it is none, or one that cannot draw over a line (TERM=dumb).
std::size_t columns_of_terminal() {
  const char* const term = std::getenv("TERM");
  if (!isatty(STDERR_FILENO) || !term || std::string_view(term) == "dumb") return 0;
  winsize size{};
  constexpr std::size_t kUsual = 80;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : kUsual;
}

}  // namespace

void show_progress(const std::vector<View>& views, std::size_t budget) {
  const View& v = views.back();
  const std::size_t n = views.size();
  const std::string line = std::to_string(n) + "/" + std::to_string(budget) + " views: " + std::to_string(v.points_in) +
                           " points in the scan volume, " + std::to_string(v.points_new) + " new";
  const std::size_t columns = columns_of_terminal();
  if (columns == 0) {
    std::cerr << line << "\n";
    return;
  }
  constexpr std::size_t kWidth = 24;
  const std::size_t done = std::min(kWidth, kWidth * n / std::max<std::size_t>(1, budget));
  const std::string drawn = "[" + std::string(done, '#') + std::string(kWidth - done, '.') + "] " + line;
  std::cerr << "\r" << drawn.substr(0, columns - 1) << "\033[K" << std::flush;  // a line that wraps stays behind
}

void end_progress() {
  if (columns_of_terminal() > 0) std::cerr << "\n";
}

namespace {

/// @param one_line as in a list, whose results are a line each
std::string summary_json(const ScanResult& result, const std::string& folder, std::size_t labelled, bool one_line) {
  io::Json out;
  out["folder"] = folder;
  out["fruits"] = io::parse_json(io::fruits_to_json(result.fruits));
  out["views"] = result.views.size();
  if (const std::string discarded = discarded_views(result.views); !discarded.empty()) out["discarded"] = discarded;
  if (!result.warnings.empty()) out["warnings"] = result.warnings;
  out["stop_reason"] = to_string(result.stop_reason);
  if (result.fruits.empty()) out["no_fruit"] = why_no_fruit(result);
  out["points"] = {{"merged", result.raw.size()}, {"filtered", result.cloud.size()}, {"labelled", labelled}};
  out["seconds"] = result.seconds.total;
  return out.dump(one_line ? -1 : 2, ' ', false, io::Json::error_handler_t::replace) + "\n";
}

/// " from 7 views (low_gain)"; nothing for a cloud, of whose views nothing is known.
std::string views_text(const ScanResult& result) {
  if (result.views.empty() && result.stop_reason == StopReason::not_stopped) return "";
  std::string text = " from " + std::to_string(result.views.size()) + (result.views.size() == 1 ? " view" : " views");
  if (result.stop_reason != StopReason::not_stopped) text += std::string(" (") + to_string(result.stop_reason) + ")";
  return text;
}

std::string summary_text(const ScanResult& result, const std::string& folder) {
  std::ostringstream text;
  text << std::fixed;
  text << result.fruits.size() << " fruit, " << result.cloud.size() << " points" << views_text(result) << ", "
       << std::setprecision(2) << result.seconds.total << " s of computing\n";
  const bool colored = !result.cloud.colors.empty();
  if (!result.fruits.empty())
    text << "  id   points  found by              position x, y, z (m)        radius  seen  axis z (world)"
         << (colored ? "      ripeness" : "") << "\n";
  for (const Fruit& f : result.fruits) {
    const Eigen::Vector3d& c = f.position();
    const Eigen::Vector3d z = f.orientation.col(2);
    text << std::setw(4) << f.id << std::setw(9) << f.points << "  " << std::left << std::setw(16) << f.found_by
         << std::right << std::setprecision(4) << std::setw(10) << c.x() << std::setw(9) << c.y() << std::setw(9)
         << c.z();
    if (f.body)
      text << std::setprecision(1) << std::setw(9) << 1e3 * f.body->radii.mean() << " mm" << std::setprecision(0)
           << std::setw(4) << 100.0 * f.body->completeness << " %";
    text << std::setprecision(2) << std::setw(8) << z.x() << std::setw(6) << z.y() << std::setw(6) << z.z();
    if (f.ripeness)
      text << "  " << to_string(f.ripeness->grade) << std::setprecision(0) << " (" << 100.0 * f.ripeness->probability
           << " %)";
    text << "\n";
  }
  if (result.fruits.empty()) text << "No fruit: " << why_no_fruit(result) << "\n";
  const std::string discarded = discarded_views(result.views);
  if (!discarded.empty()) text << "Note: " << discarded << "\n";
  for (const std::string& warning : result.warnings) text << "Note: " << warning << "\n";
  text << "Result: " << folder << "\n";
  return text.str();
}

}  // namespace

void print_summary(const ScanResult& result, const std::string& folder, const CommonOptions& options) {
  if (options.quiet && !options.json) return;
  std::size_t labelled = 0;
  for (int l : result.labels) labelled += l > 0;
  std::cout << (options.json ? summary_json(result, folder, labelled, options.prepared) : summary_text(result, folder));
}

}  // namespace agrisee::cli
