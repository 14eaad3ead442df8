// SPDX-License-Identifier: BSD-3-Clause
#include "inputs.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include "commands.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

bool is_folder(const std::string& input) {
  std::error_code error;
  return fs::is_directory(input, error);
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

std::string file_in(const std::string& input, const char* name) {
  if (!is_folder(input)) return input;
  const fs::path file = fs::path(input) / name;
  std::error_code error;
  if (!fs::exists(file, error)) throw FileError(input + ": is a folder without " + name);
  return file.string();
}

bool is_recording(const std::string& input) {
  const std::string extension = fs::path(input).extension().string();
  return is_folder(input) || extension == ".yaml" || extension == ".yml";
}

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
