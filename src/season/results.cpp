// SPDX-License-Identifier: BSD-3-Clause
#include "season/results.hpp"

#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>

#include <algorithm>
#include <system_error>

#include "io/formats/json_value.hpp"

namespace agrisee::season {
namespace {

namespace fs = std::filesystem;

/// Add the results in and below a folder. @param inner whether it is itself below the first: then a result holds no
/// other
void find_results(const fs::path& folder, bool inner, std::vector<fs::path>& out) {
  std::error_code error;
  if (fs::exists(folder / "run.json", error)) {
    out.push_back(folder);
    if (inner) return;
  }
  if (inner && fs::is_symlink(folder, error)) return;
  fs::directory_iterator i(folder, error);
  for (; !error && i != fs::directory_iterator(); i.increment(error))
    if (std::error_code ignored; i->is_directory(ignored)) find_results(i->path(), true, out);
  if (error) io::fail(folder, error.message());
}

}  // namespace

std::vector<fs::path> result_folders(const fs::path& folder) {
  std::vector<fs::path> out;
  find_results(folder, false, out);
  std::sort(out.begin(), out.end());
  return out;
}

Scan open_result(const fs::path& folder) {
  Scan scan;
  scan.folder = folder;
  io::Fingerprint print;
  for (const char* name : {"run.json", "fruits.json", "views.csv"}) print.add(io::read_bytes(folder / name).view());
  const io::Json job = io::load_json_or_null(folder / "job.json");
  const auto text = [&](const char* key) {
    return job.is_object() && job.contains(key) && job[key].is_string() ? job[key].get<std::string>() : std::string();
  };
  scan.input = text("input");
  if (text("status") == "failed") {  // such as a scan that could take no view, whose empty result is written
    scan.status = "failed";
    scan.message = text("message");
  }
  for (const std::string* part : {&scan.input, &scan.status, &scan.message}) print.add(*part + "\n");
  scan.content = print.text();
  return scan;
}

ResultFiles read_result(const fs::path& folder) {
  return {io::read_run(folder / "run.json"), io::read_fruits(folder / "fruits.json"),
          io::read_views(folder / "views.csv")};
}

}  // namespace agrisee::season
