// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is fuzzed: each target takes any bytes as the content of a file. Refusing them with an agrisee::Error is fine;
/// any other exception, a crash, a sanitizer's report, a hang or a broken promise is a bug.
#pragma once

#include <agrisee/core/error.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace agrisee::fuzz {

void ply(const std::uint8_t* data, std::size_t size);
void pcd(const std::uint8_t* data, std::size_t size);
void table(const std::uint8_t* data, std::size_t size);     ///< XYZ, CSV and NPY clouds
void depth(const std::uint8_t* data, std::size_t size);     ///< depth images, PNG and NPY
void recorded(const std::uint8_t* data, std::size_t size);  ///< views.yaml
void mcap(const std::uint8_t* data, std::size_t size);      ///< recordings of ROS 2
void stl(const std::uint8_t* data, std::size_t size);
void obj(const std::uint8_t* data, std::size_t size);
void scene(const std::uint8_t* data, std::size_t size);
void parameters(const std::uint8_t* data, std::size_t size);
void records(const std::uint8_t* data, std::size_t size);   ///< result files; the first byte chooses which
void messages(const std::uint8_t* data, std::size_t size);  ///< ROS messages; the first byte chooses cloud or image

struct Target {
  const char* name;
  void (*run)(const std::uint8_t*, std::size_t);
};
constexpr Target kTargets[] = {
    {"ply", ply},         {"pcd", pcd},          {"table", table}, {"depth", depth}, {"recorded", recorded},
    {"mcap", mcap},       {"stl", stl},          {"obj", obj},     {"scene", scene}, {"parameters", parameters},
    {"records", records}, {"messages", messages}};

/// The bytes as a file; without a disk. There is one at a time.
std::filesystem::path as_file(const std::uint8_t* data, std::size_t size);
/// A folder of this process, removed at its end.
const std::filesystem::path& scratch();

/// Stop where a promise is broken, assert or not.
inline void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

/// Run `read`; what it refuses is fine.
template <typename Read>
void attempt(Read&& read) {
  try {
    read();
  } catch (const Error& e) {
    require(e.what()[0] != '\0', "an error has a message");
  }
}

}  // namespace agrisee::fuzz
