// SPDX-License-Identifier: BSD-3-Clause
#include "many.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <glob.h>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "commands.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeader = "input,folder,status,fruits,views,stop_reason,seconds,message";

bool is_pattern(const std::string& input) {
  std::error_code error;
  return input.find_first_of("*?[") != std::string::npos && !fs::exists(input, error);
}

std::vector<std::string> matches(const std::string& pattern) {
  glob_t found{};
  const int failed = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> out;
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i) out.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (out.empty()) throw FileError(pattern + ": matches no file");
  return out;
}

/// The parts of a path that distinguish it from others, the most specific first: the name without extension, unless it
/// is `scene`, which most scene files are called; then the folders above.
std::vector<std::string> names_of(fs::path path) {
  std::vector<std::string> out;
  if (!path.has_filename()) path = path.parent_path();  // a folder that is named with a slash behind it
  if (path.stem() != "scene") out.push_back(path.stem().string());
  std::error_code error;
  for (fs::path p = fs::absolute(path, error).lexically_normal().parent_path(); p.has_filename(); p = p.parent_path())
    out.push_back(p.filename().string());
  if (out.empty()) out.push_back("scene");
  return out;
}

/// A cell of a CSV file: on one line, and quoted if necessary.
std::string cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// The cells fruits, views, stop_reason and seconds of a finished result, read from its files; empty if they are
/// missing there.
std::string result_cells(const fs::path& folder) {
  std::ifstream file(folder / "run.json");
  const nlohmann::json run = nlohmann::json::parse(file, nullptr, false);
  if (!run.is_object()) return ",,,";
  const auto text = [](const nlohmann::json& value) {
    return value.is_string() ? value.get<std::string>() : value.is_null() ? std::string() : value.dump();
  };
  const auto at = [&](const char* pointer) {
    return text(run.value(nlohmann::json::json_pointer(pointer), nlohmann::json()));
  };
  std::ifstream fruits_file(folder / "fruits.json");
  const nlohmann::json fruits = nlohmann::json::parse(fruits_file, nullptr, false);
  return (fruits.is_array() ? std::to_string(fruits.size()) : std::string()) + "," + at("/views") + "," +
         cell(at("/stop_reason")) + "," + at("/seconds/total");
}

std::string summary_name(const Shard& shard) {
  if (shard.count == 1) return "summary.csv";
  return "summary-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".csv";
}

void write_summary(const fs::path& path, const std::vector<std::string>& rows) {
  std::string text = std::string(kHeader) + "\n";
  for (const std::string& row : rows) text += row + "\n";
  io::write_file(path, text);
}

/// The rows of a summary. @throws FileError
std::vector<std::string> read_summary(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != kHeader) throw FileError(path.string() + ": is not a summary of many scans");
  std::vector<std::string> rows;
  while (std::getline(file, line))
    if (!line.empty()) rows.push_back(line);
  return rows;
}

struct MergeOptions {
  std::string folder;
};

/// Join DIR/summary-I-of-N.csv of all shards to DIR/summary.csv. @throws FileError if one is missing
int merge_summaries(const MergeOptions& options) {
  const fs::path folder = options.folder;
  std::map<std::size_t, std::set<std::size_t>> found;  // for each N, the I that exist
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::size_t index = 0, count = 0;
    char end = 0;
    if (std::sscanf(entry.path().filename().string().c_str(), "summary-%zu-of-%zu.cs%c", &index, &count, &end) == 3 &&
        end == 'v')
      found[count].insert(index);
  }
  if (error) throw FileError(folder.string() + ": " + error.message());
  if (found.empty()) throw FileError(folder.string() + ": holds no summary of a shard (summary-I-of-N.csv)");
  if (found.size() > 1) throw FileError(folder.string() + ": holds summaries of different numbers of shards");
  const std::size_t count = found.begin()->first;
  // Shard i holds the inputs i, i + N, and so on. Taking one from each in turn restores the order of the list.
  std::vector<std::vector<std::string>> parts;
  for (std::size_t i = 1; i <= count; ++i) {
    const fs::path path = folder / summary_name({i, count});
    if (!found.begin()->second.count(i)) throw FileError(path.string() + ": is missing");
    parts.push_back(read_summary(path));
  }
  std::vector<std::string> rows;
  std::size_t failed = 0;
  for (std::size_t k = 0, more = 1; more > 0; ++k) {
    more = 0;
    for (const auto& part : parts)
      if (k < part.size()) rows.push_back(part[k]), ++more;
  }
  for (const std::string& row : rows) failed += row.find(",failed,") != std::string::npos ? 1 : 0;
  write_summary(folder / "summary.csv", rows);
  std::cout << rows.size() << " results of " << count << " shards, " << failed
            << " failed: " << (folder / "summary.csv").string() << "\n";
  return kSuccess;
}

}  // namespace

Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  Shard shard{0, 0};
  char slash = 0;
  std::istringstream in(text);
  in >> shard.index >> slash >> shard.count;
  if (in.fail() || !in.eof() || slash != '/' || text[0] == '-' || shard.index < 1 || shard.index > shard.count)
    throw UsageError("--shard: expected I/N with 1 <= I <= N, got '" + text + "'");
  return shard;
}

std::vector<Job> jobs_of(const std::vector<std::string>& inputs) {
  std::vector<std::string> paths;
  std::set<std::string> known;
  for (const std::string& input : inputs)
    for (const std::string& path : is_pattern(input) ? matches(input) : std::vector<std::string>{input})
      if (known.insert(fs::path(path).lexically_normal().string()).second) paths.push_back(path);
  std::vector<std::vector<std::string>> names;
  std::vector<std::size_t> used(paths.size(), 1);
  for (const std::string& path : paths) names.push_back(names_of(path));
  const auto folder = [&](std::size_t i) {
    std::string out = names[i][0];
    for (std::size_t k = 1; k < std::min(used[i], names[i].size()); ++k) out = names[i][k] + "_" + out;
    return out;
  };
  for (bool clash = true; clash;) {  // while two names are equal, add one more folder to each of them
    clash = false;
    std::map<std::string, std::vector<std::size_t>> same;
    for (std::size_t i = 0; i < paths.size(); ++i) same[folder(i)].push_back(i);
    for (const auto& [name, group] : same)
      for (const std::size_t i : group)
        if (group.size() > 1 && used[i] < names[i].size()) ++used[i], clash = true;
  }
  std::vector<Job> jobs;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    std::string name = folder(i);
    while (!taken.insert(name).second) name += "_";  // such as a.ply and a.pcd in one folder
    jobs.push_back({paths[i], name});
  }
  return jobs;
}

int run_jobs(const std::vector<Job>& jobs, const Shard& shard, const std::string& output, const RunOne& run) {
  make_folder(output);
  const fs::path summary = fs::path(output) / summary_name(shard);
  std::vector<std::string> rows, failures;
  write_summary(summary, rows);
  for (std::size_t i = shard.index - 1; i < jobs.size(); i += shard.count) {
    const Job& job = jobs[i];
    const fs::path folder = fs::path(output) / job.folder;
    std::string message;
    try {
      const int code = run(job.input, folder.string());
      if (code != kSuccess) message = "ended with exit code " + std::to_string(code);
    } catch (const std::exception& e) {
      message = e.what();
    }
    rows.push_back(cell(job.input) + "," + cell(job.folder) + "," + (message.empty() ? "ok" : "failed") + "," +
                   (message.empty() ? result_cells(folder) : ",,,") + "," + cell(message));
    if (!message.empty()) failures.push_back(job.input + ": " + message);
    write_summary(summary, rows);
  }
  std::cout << rows.size() << " inputs, " << failures.size() << " failed: " << summary.string() << "\n";
  for (const std::string& failure : failures) std::cerr << "agrisee: failed: " << failure << "\n";
  return failures.empty() ? kSuccess : kBadInput;
}

int run_inputs(const std::vector<std::string>& inputs, const std::string& shard, const std::string& output,
               const RunOne& run) {
  const bool list = inputs.size() > 1 || !shard.empty() || (inputs.size() == 1 && is_pattern(inputs[0]));
  if (!list) return run(inputs.empty() ? std::string() : inputs[0], output);
  return run_jobs(jobs_of(inputs), parse_shard(shard), output, run);
}

void add_shard_option(CLI::App& command, std::string& shard) {
  command.add_option("--shard", shard,
                     "I/N: process only every N-th input, starting with the I-th; `agrisee merge` joins the summaries");
}

void add_merge(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("merge", "join the summaries of all shards of a list of inputs");
  auto options = std::make_shared<MergeOptions>();
  command->add_option("folder", options->folder, "output folder of the shards, which holds summary-I-of-N.csv")
      ->required();
  command->callback([options, &run] { run = [options] { return merge_summaries(*options); }; });
}

}  // namespace agrisee::cli
