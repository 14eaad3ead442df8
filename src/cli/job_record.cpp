// SPDX-License-Identifier: BSD-3-Clause
#include "job_record.hpp"

#include <agrisee/io/files.hpp>

#include "io/formats/json_value.hpp"

namespace agrisee::cli {
namespace {

constexpr const char* kJobFile = "job.json";

/// Calls f(key, text) for every text of a record.
template <typename Record, typename F>
void each_text(Record& record, F&& f) {
  f("command", record.command);
  f("input", record.input);
  f("key", record.key);
  f("version", record.version);
  f("status", record.status);
  f("message", record.message);
}

}  // namespace

std::optional<JobRecord> read_job(const std::filesystem::path& folder) {
  const io::Json json = io::load_json_or_null(folder / kJobFile);
  if (!json.is_object()) return std::nullopt;
  JobRecord record;
  bool whole = true;
  each_text(record, [&](const char* key, std::string& text) {
    const auto found = json.find(key);
    if (found != json.end() && found->is_string())
      text = found->get<std::string>();
    else
      whole = false;
  });
  return whole ? std::optional(record) : std::nullopt;
}

void write_job(const std::filesystem::path& folder, const JobRecord& record) {
  io::Json json;
  each_text(record, [&](const char* key, const std::string& text) { json[key] = text; });
  io::write_file(folder / kJobFile, json.dump(2, ' ', false, io::Json::error_handler_t::replace) + "\n");
}

void remove_job(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kJobFile, ignored);
}

void add_file(io::Fingerprint& print, const std::filesystem::path& path) {
  const io::Bytes bytes = io::read_bytes(path);
  print.add(std::to_string(bytes.size) + ":");  // so that bytes of one file cannot pass for those of the next
  print.add(bytes.view());
}

}  // namespace agrisee::cli
