// SPDX-License-Identifier: BSD-3-Clause
// job.json: what a result in a list of scans was made from. By it a list knows what is done, and what has changed.
#pragma once

#include <agrisee/io/fingerprint.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace agrisee::cli {

/// The contents of job.json.
struct JobRecord {
  std::string command;             ///< "scan" or "process"
  std::string input;               ///< as in the list
  std::string key;                 ///< fingerprint of inputs, parameters and version: of all that changes the result
  std::string version;             ///< of AgriSEE
  std::string status = "started";  ///< then `ok` or `failed`
  std::string message;             ///< why it failed
};

/// Read FOLDER/job.json; none if it is missing or damaged.
std::optional<JobRecord> read_job(const std::filesystem::path& folder);

/// Write FOLDER/job.json. @throws FileError when it cannot be written
void write_job(const std::filesystem::path& folder, const JobRecord& record);

/// Remove FOLDER/job.json, if it is there.
void remove_job(const std::filesystem::path& folder);

/// Append the bytes of a file to a fingerprint. @throws FileError when it cannot be read
void add_file(io::Fingerprint& print, const std::filesystem::path& path);

}  // namespace agrisee::cli
