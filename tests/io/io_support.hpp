// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A folder of its own for a test's files, and checks on what a reader says of a bad one.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/io/files.hpp>

#include <filesystem>
#include <string>
#include <unistd.h>

#include "catch.hpp"

namespace agrisee::test {

/// Made anew for each test, removed after it.
class TempFolder {
 public:
  TempFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("agrisee_io_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(const std::string& name, std::string_view bytes) const {
    io::write_file(path_ / name, bytes);
    return path_ / name;
  }
  std::size_t files() const {
    std::size_t n = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) n += entry.is_directory() ? 0 : 1;
    return n;
  }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::filesystem::path& path) { return std::string(io::read_bytes(path).view()); }

/// Reading has to fail with a FileError that begins with the path and says `what`.
template <typename Read>
void require_file_error(const std::filesystem::path& path, const std::string& what, Read&& read) {
  try {
    read(path);
  } catch (const FileError& e) {
    const std::string message = e.what();
    INFO(message);
    CHECK(message.rfind(path.string(), 0) == 0);
    CHECK(message.find(what, path.string().size()) != std::string::npos);
    return;
  }
  FAIL("no FileError, expected: " << what);
}

/// The bytes of a number, little- or big-endian.
template <typename T>
std::string bytes_of(T value, bool big_endian = false) {
  std::string out(reinterpret_cast<const char*>(&value), sizeof(T));
  if (big_endian) out.assign(out.rbegin(), out.rend());
  return out;
}

/// Random damage must never crash, hang or end in anything but a result or a FileError.
template <typename Read>
void survive_damage(const TempFolder& folder, const std::string& name, const std::string& good, Read&& read) {
  Rng rng(11);
  for (int round = 0; round < 100; ++round) {
    std::string bad = good;
    if (round % 3 == 0) bad.resize(rng.below(bad.size()));
    for (int k = 0; k < 1 + round % 4 && !bad.empty(); ++k)
      bad[rng.below(bad.size())] = static_cast<char>(rng.below(256));
    const auto path = folder.file(name, bad);
    try {
      read(path);
    } catch (const FileError&) {
    }
  }
  SUCCEED();
}

}  // namespace agrisee::test
