// SPDX-License-Identifier: BSD-3-Clause
#include "inputs.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include "commands.hpp"
#include "io/formats/text.hpp"
#include "io/formats/yaml_map.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

bool is_folder(const std::string& input) {
  std::error_code error;
  return fs::is_directory(input, error);
}

bool holds(const std::string& folder, const char* name) {
  std::error_code error;
  return fs::exists(fs::path(folder) / name, error);
}

/// Whether a name ends as one of those.
bool ends(const std::string& input, std::initializer_list<const char*> extensions) {
  const std::string own = io::lower(fs::path(input).extension().string());
  return std::any_of(extensions.begin(), extensions.end(), [&](const char* extension) { return own == extension; });
}

/// The kind of a YAML file, by its keys.
Kind kind_of_yaml(const std::string& input) {
  try {
    const io::YamlValue top(input, io::load_yaml(input), "");
    if (top.has("objects") || top.has("robot")) return Kind::scene;
    if (top.has("camera") && top.has("views")) return Kind::recording;
  } catch (const FileError&) {  // who reads it says what is wrong
  }
  return Kind::unknown;
}

Kind input_kind_of(const std::string& input) {
  if (is_folder(input)) {
    if (holds(input, "scene.yaml")) return Kind::scene;
    if (holds(input, "views.yaml")) return Kind::recording;
    if (holds(input, "scan.json")) return Kind::scan;
    return holds(input, "run.json") ? Kind::processed : Kind::unknown;
  }
  std::error_code error;
  if (!fs::is_regular_file(input, error)) return Kind::unknown;
  if (ends(input, {".yaml", ".yml"})) return kind_of_yaml(input);
  if (is_mcap(input)) return Kind::recording;
  return ends(input, {".ply", ".pcd", ".npy", ".xyz", ".csv"}) ? Kind::cloud : Kind::unknown;
}

/// What a kind is called, and which command takes it.
const char* text_of(Kind kind) {
  switch (kind) {
    case Kind::scene:
      return "a scene, which `agrisee scan` takes";
    case Kind::recording:
      return "a list of recorded views (views.yaml or MCAP), which `agrisee process` takes";
    case Kind::cloud:
      return "a point cloud, which `agrisee process` takes";
    case Kind::scan:
      return "the result of a scan, which `agrisee export-views` and, after the scene, `agrisee evaluate` take; its "
             "cloud is cloud.ply";
    case Kind::processed:
      return "a result that holds a cloud (cloud.ply) but no frames, as `agrisee process` and Python write it";
    case Kind::unknown:
      break;
  }
  return "something else";
}

/// The file that an input of a certain kind names. @throws FileError
std::string file_of(const std::string& input, Kind wanted, const char* name) {
  if (!is_folder(input)) {
    check_kind(input, wanted);
    return input;
  }
  if (holds(input, name)) return (fs::path(input) / name).string();
  check_kind(input, wanted);
  throw FileError(input + ": is a folder without " + name);
}

/// A temporary file with all that comes out of a pipe: readers look at the beginning of a file first, and then read it.
class Spooled {
 public:
  Spooled(std::FILE* pipe, const std::string& name) : path_((fs::temp_directory_path() / "agrisee-XXXXXX").string()) {
    const int descriptor = ::mkstemp(path_.data());
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(descriptor < 0 ? nullptr : ::fdopen(descriptor, "wb"),
                                                         &std::fclose);
    if (!file) throw FileError(path_ + ": cannot be written: " + std::strerror(errno));
    std::vector<char> block(1 << 16);
    std::size_t got = 0;
    bool good = true;
    while (good && (got = std::fread(block.data(), 1, block.size(), pipe)) > 0)
      good = std::fwrite(block.data(), 1, got, file.get()) == got;
    if (std::ferror(pipe)) throw FileError(name + ": cannot be read");
    if (!good || std::fflush(file.get()) != 0) throw FileError(path_ + ": cannot be written: " + std::strerror(errno));
  }
  Spooled(const Spooled&) = delete;
  Spooled& operator=(const Spooled&) = delete;
  ~Spooled() { ::unlink(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

io::CloudFile read_pipe(std::FILE* pipe, const std::string& name) {
  const Spooled file(pipe, name);
  try {
    return io::read_cloud(file.path());
  } catch (const FileError& e) {  // nobody knows the temporary file
    std::string message = e.what();
    if (message.rfind(file.path(), 0) == 0) message.replace(0, file.path().size(), name);
    throw FileError(message);
  }
}

}  // namespace

void check_kind(const std::string& input, Kind wanted) {
  const Kind kind = input_kind_of(input);
  if (kind == wanted || kind == Kind::unknown) return;
  const char* const missing = wanted == Kind::scene  ? "not a scene"
                              : wanted == Kind::scan ? "not the result of a scan"
                                                     : "neither a cloud nor recorded views";
  throw FileError(input + ": is " + missing + ", but " + text_of(kind));
}

std::string scene_file(const std::string& input) { return file_of(input, Kind::scene, "scene.yaml"); }

std::string recording_file(const std::string& input) { return file_of(input, Kind::recording, "views.yaml"); }

bool is_mcap(const std::string& input) { return ends(input, {".mcap"}); }

bool is_recording(const std::string& input) { return is_folder(input) || ends(input, {".yaml", ".yml", ".mcap"}); }

std::string name_of(const std::string& input) {
  return input == "-" ? "standard input" : fs::path(input).filename().string();
}

io::CloudFile read_cloud_input(const std::string& input) {
  if (input == "-") {
    if (::isatty(STDIN_FILENO)) throw UsageError("-: standard input is a terminal; pipe a cloud into the command");
    return read_pipe(stdin, name_of(input));
  }
  std::error_code error;
  if (!fs::is_fifo(input, error)) return io::read_cloud(input);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(std::fopen(input.c_str(), "rb"), &std::fclose);
  if (!pipe) throw FileError(input + ": cannot be opened: " + std::strerror(errno));
  return read_pipe(pipe.get(), input);
}

}  // namespace agrisee::cli
