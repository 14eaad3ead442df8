// SPDX-License-Identifier: BSD-3-Clause
#include "version.hpp"

#include <agrisee/version.hpp>

#include <string>
#include <string_view>
#ifdef AGRISEE_HAS_SQLITE
#include <sqlite3.h>
#endif

namespace agrisee::cli {

/// The commit of the sources with "-dirty" behind it if they were changed; empty if they are in no git repository.
/// Written by CMake (cmake/EmbedCommit.cmake).
extern const std::string_view kCommit;

namespace {

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "an unknown compiler";
#endif
}

/// The processor that the program was built for, and the instructions that it needs beyond those that all have.
std::string processor() {
  std::string out = AGRISEE_PROCESSOR;
#ifdef __AVX2__
  out += " with AVX2";
#endif
#ifdef __FMA__
  out += " and FMA";
#endif
  return out;
}

}  // namespace

std::string sqlite_version() {
#ifdef AGRISEE_HAS_SQLITE
  return sqlite3_libversion();
#else
  return "";
#endif
}

std::string version_text() {
  const std::string type = AGRISEE_BUILD_TYPE, commit(kCommit), sqlite = sqlite_version();
  return std::string("agrisee ") + AGRISEE_VERSION + "\nbuilt:     " + compiler() + ", " +
         (type.empty() ? "without a build type: slow" : type) + ", for " + processor() +
         "\nsources:   " + (commit.empty() ? "of the release" : "commit " + commit) +
         "\nlibraries: Eigen " AGRISEE_EIGEN ", nanoflann " AGRISEE_NANOFLANN ", yaml-cpp " AGRISEE_YAML_CPP_VERSION
         ", zlib " AGRISEE_ZLIB_VERSION ", nlohmann_json " AGRISEE_NLOHMANN_JSON ", CLI11 " AGRISEE_CLI11 +
         "\noptional:  " + (sqlite.empty() ? "no SQLite (merge --db and season are left out)" : "SQLite " + sqlite);
}

}  // namespace agrisee::cli
