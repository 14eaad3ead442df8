// SPDX-License-Identifier: BSD-3-Clause
#include "many.hpp"

#include <agrisee/version.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <glob.h>
#include <iostream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <unistd.h>

#include "commands.hpp"
#include "folder_lock.hpp"
#include "interrupt.hpp"
#include "io/formats/json_value.hpp"
#include "job_record.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

bool is_pattern(const std::string& input) {
  std::error_code error;
  return input.find_first_of("*?[") != std::string::npos && !fs::exists(input, error);
}

std::vector<std::string> paths_of(const std::string& pattern) {
  glob_t found{};
  const int failed = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> out;
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i) out.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  return out;
}

/// Tell of the folders on the way of a pattern that cannot be entered: glob passes over them.
void tell_closed_folders(const std::string& pattern) {
  std::error_code error;
  for (std::size_t slash = pattern.find('/', 1); slash != std::string::npos; slash = pattern.find('/', slash + 1)) {
    const std::string next = pattern.substr(slash + 1, pattern.find('/', slash + 1) - slash - 1);
    const int needed = is_pattern(next) ? R_OK | X_OK : X_OK;
    for (const std::string& folder : paths_of(pattern.substr(0, slash)))
      if (fs::is_directory(folder, error) && ::access(folder.c_str(), needed) != 0)
        std::cerr << "agrisee: " << folder << ": " << std::strerror(errno) << "; what is in it is left out\n";
  }
}

std::vector<std::string> matches(const std::string& pattern) {
  tell_closed_folders(pattern);
  std::vector<std::string> out = paths_of(pattern);
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

/// A path by which an input is known, wherever the command is called, and whether it names a scene or its folder.
std::string whole_path(const fs::path& path) {
  std::error_code error;
  fs::path whole = fs::absolute(path, error).lexically_normal();
  if (!whole.has_filename() || whole.filename() == "scene.yaml") whole = whole.parent_path();
  return whole.string();
}

/// The folders in an output folder that hold a result of a list (job.json), by their inputs.
std::map<std::string, std::set<std::string>> folders_in(const fs::path& output) {
  std::map<std::string, std::set<std::string>> out;
  std::error_code error;
  for (fs::directory_iterator i(output, error), end; !error && i != end; i.increment(error))
    if (const auto job = read_job(i->path())) out[whole_path(job->input)].insert(i->path().filename().string());
  return out;
}

/// For each path a name that distinguishes it from the others, see jobs_of; those of a.ply and a.pcd are alike.
std::vector<std::string> distinct_names(const std::vector<std::string>& paths) {
  std::vector<std::vector<std::string>> parts;
  std::vector<std::size_t> used(paths.size(), 1);
  for (const std::string& path : paths) parts.push_back(names_of(path));
  const auto name = [&](std::size_t i) {
    std::string out = parts[i][0];
    for (std::size_t k = 1; k < std::min(used[i], parts[i].size()); ++k) out = parts[i][k] + "_" + out;
    return out;
  };
  for (bool clash = true; clash;) {  // while two names are equal, add one more folder to each of them
    clash = false;
    std::map<std::string, std::vector<std::size_t>> same;
    for (std::size_t i = 0; i < paths.size(); ++i) same[name(i)].push_back(i);
    for (const auto& [text, group] : same)
      for (const std::size_t i : group)
        if (group.size() > 1 && used[i] < parts[i].size()) ++used[i], clash = true;
  }
  std::vector<std::string> out;
  for (std::size_t i = 0; i < paths.size(); ++i) out.push_back(name(i));
  return out;
}

/// Fill in a summary's columns from the files of a finished result; columns whose values are missing stay empty.
void add_result(const fs::path& folder, SummaryRow& row) {
  const io::Json run = io::load_json_or_null(folder / "run.json");
  if (!run.is_object()) return;
  const auto at = [&](const char* pointer) {
    const io::Json value = run.value(io::Json::json_pointer(pointer), io::Json());
    return value.is_string() ? value.get<std::string>() : value.is_null() ? std::string() : value.dump();
  };
  const io::Json fruits = io::load_json_or_null(folder / "fruits.json");
  if (fruits.is_array()) row.fruits = std::to_string(fruits.size());
  row.views = at("/views");
  row.stop_reason = at("/stop_reason");
  row.seconds = at("/seconds/total");
}

/// Check that no file of a result in a folder is an input, or a file that all inputs use; empty names are none.
/// @throws UsageError, which names the input
void check_inputs_stay(const std::string& input, const ListedCommand& command, const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> used = command.files;
  used.push_back(input);
  for (const std::string& file : used)
    for (const char* name : io::kResultFiles)
      if (fs::equivalent(file, folder / name, error))
        throw UsageError(file + ": is an input and would be overwritten; name another output folder");
}

/// Does a job unless it is done; where another process works in its folder, it stays open.
/// @return whether there was anything to do
bool do_job(const Job& job, const fs::path& folder, const ListedCommand& command, SummaryRow& row) {
  JobRecord record{command.name, job.input, "", AGRISEE_VERSION, "started", ""};
  bool recorded = false, worked = true;
  FolderLock lock;
  row.message.clear();
  try {
    lock.take(folder.string());
    check_inputs_stay(job.input, command, folder);
    record.key = command.key(job.input);
    make_folder(folder.string());
    lock.take(folder.string());
    const auto before = read_job(folder);
    const bool same = before && before->key == record.key && !record.key.empty() && !command.force;
    if (same && before->status == "ok" && command.is_complete(folder.string())) {
      worked = false;
      recorded = before->input != job.input;  // it has another path now
    } else {
      const bool interrupted = same && before->status == "started";
      // A result is deleted before a new key is noted: it must never pass for what it is not.
      if (!interrupted) prepare_output(folder.string(), before.has_value() || command.force);
      recorded = true;
      write_job(folder, record);
      command.run(job.input, folder.string(), interrupted ? Begin::resume : Begin::again);
    }
  } catch (const FolderBusy& e) {
    row.message = e.what();
    return false;
  } catch (const std::exception& e) {
    row.message = message_of(e);
  }
  row.status = row.message.empty() ? "ok" : "failed";
  if (row.message.empty()) add_result(folder, row);
  record.status = row.status;
  record.message = row.message;
  if (recorded) write_job(folder, record);
  return worked;
}

/// Results of a list are in folders of their own, beside its summary; that of a single input is in the output folder.
/// @throws UsageError if a folder holds one of both, and is to hold the other
void check_list_folder(const fs::path& output, bool list) {
  constexpr const char* kQuotes = " (a pattern is a list also where it matches one file, if it is in quotes)";
  std::error_code error;
  if (list) {
    for (const char* name : {"run.json", "scan.json"})
      if (io::load_json_or_null(output / name).contains("format_version"))
        throw UsageError(output.string() + ": is a result itself (" + name +
                         "), so it cannot hold those of a list; name another folder" + kQuotes);
    return;
  }
  for (fs::directory_iterator i(output, error), end; !error && i != end; i.increment(error))
    if (is_summary(i->path()))
      throw UsageError(output.string() + ": holds the results of a list (" + i->path().filename().string() +
                       "), so it cannot be a result itself; name another folder" + kQuotes);
}

}  // namespace

Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  Shard shard{0, 0};
  char slash = 0;
  std::istringstream in(text);
  in >> shard.index >> slash >> shard.count;
  if (in.fail() || !in.eof() || slash != '/' || text.find('-') != std::string::npos || shard.index < 1 ||
      shard.index > shard.count || shard.count > kMostShards)
    throw UsageError("--shard: expected I/N with 1 <= I <= N <= " + std::to_string(kMostShards) + ", got '" + text +
                     "'");
  return shard;
}

std::vector<Job> jobs_of(const std::vector<std::string>& inputs, const std::string& output) {
  std::vector<std::string> paths;
  std::set<std::string> known;
  for (const std::string& input : inputs)
    for (const std::string& path : is_pattern(input) ? matches(input) : std::vector<std::string>{input})
      if (known.insert(fs::path(path).lexically_normal().string()).second) paths.push_back(path);
  const std::size_t count = paths.size();
  const std::map<std::string, std::set<std::string>> before = folders_in(output);
  std::set<std::string> listed;
  for (const std::string& path : paths) listed.insert(whole_path(path));
  std::error_code error;
  for (const auto& [path, folders] : before)  // inputs of older lists distinguish names, too
    if (!listed.count(path) && fs::exists(path, error)) paths.push_back(path);
  std::vector<std::string> folders = distinct_names(paths);
  std::vector<Job> jobs;
  std::set<std::string> taken;
  std::vector<bool> kept(paths.size(), false);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto found = before.find(whole_path(paths[i]));
    if (found == before.end()) continue;
    if (!found->second.count(folders[i])) folders[i] = *found->second.begin();
    kept[i] = taken.insert(folders[i]).second;
  }
  for (std::size_t i = 0; i < count; ++i) {
    while (!kept[i] && !taken.insert(folders[i]).second) folders[i] += "_";  // such as a.ply and a.pcd in one folder
    jobs.push_back({paths[i], folders[i]});
  }
  return jobs;
}

int run_jobs(const std::vector<Job>& jobs, const Shard& shard, const std::string& output,
             const ListedCommand& command) {
  make_folder(output);
  const StopMessage message("agrisee: stopped; the same command goes on, what is done is skipped");
  const fs::path summary = fs::path(output) / summary_name(shard);
  Summary list;
  std::vector<SummaryRow>& rows = list.rows;
  for (std::size_t i = shard.index - 1; i < jobs.size(); i += shard.count) {
    rows.emplace_back();
    rows.back().input = jobs[i].input;
    rows.back().folder = jobs[i].folder;
  }
  std::vector<std::string> inputs;
  for (const Job& job : jobs) inputs.push_back(job.input);
  if (shard.count > 1)
    list.list = list_mark(inputs);
  else
    remove_replaced_shards(output, inputs);
  write_summary(summary, list);  // if this process is killed, it tells what is open
  std::vector<std::size_t> left(rows.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::size_t done_before = 0;
  for (int round = 0; round < 2 && !left.empty(); ++round) {  // what another process did meanwhile is done, too
    std::vector<std::size_t> busy;
    for (const std::size_t k : left) {
      SummaryRow& row = rows[k];
      const bool worked = do_job({row.input, row.folder}, fs::path(output) / row.folder, command, row);
      if (row.status == "open")
        busy.push_back(k);
      else if (worked)
        write_summary(summary, list);
      else
        ++done_before;
    }
    left = busy;
  }
  write_summary(summary, list);
  const std::size_t failed = count_status(rows, "failed");
  (command.json ? std::cerr : std::cout) << rows.size() << " inputs, "
                                         << (done_before > 0 ? std::to_string(done_before) + " done before, " : "")
                                         << failed << " failed"
                                         << (left.empty() ? "" : ", " + std::to_string(left.size()) + " open") << ": "
                                         << summary.string() << "\n";
  for (const SummaryRow& row : rows)
    if (row.status != "ok") std::cerr << "agrisee: " << row.status << ": " << row.input << ": " << row.message << "\n";
  return failed == 0 && left.empty() ? kSuccess : kBadInput;
}

bool is_list(const std::vector<std::string>& inputs, const std::string& shard) {
  return inputs.size() > 1 || !shard.empty() || (inputs.size() == 1 && is_pattern(inputs[0]));
}

int run_inputs(const std::vector<std::string>& inputs, const std::string& shard, const std::string& output,
               const ListedCommand& command) {
  const bool list = is_list(inputs, shard);
  if (!inputs.empty()) check_list_folder(output, list);
  if (list) return run_jobs(jobs_of(inputs, output), parse_shard(shard), output, command);
  const std::string input = inputs.empty() ? std::string() : inputs[0];
  check_inputs_stay(input, command, output);
  command.run(input, output, Begin::as_asked);
  return kSuccess;
}

void add_shard_option(CLI::App& command, std::string& shard) {
  command.add_option("--shard", shard,
                     "I/N: process only every N-th input, starting with the I-th; `agrisee merge` joins the summaries");
}

}  // namespace agrisee::cli
