// SPDX-License-Identifier: BSD-3-Clause
#include <sys/mman.h>
#include <unistd.h>

#include "targets.hpp"

namespace agrisee::fuzz {

namespace fs = std::filesystem;

fs::path as_file(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("fuzz", 0);
  require(file >= 0 && ::ftruncate(file, 0) == 0, "the system has room for the input");
  for (std::size_t at = 0; at < size;) {
    const ssize_t written = ::pwrite(file, data + at, size - at, static_cast<off_t>(at));
    require(written > 0, "the system has room for the input");
    at += static_cast<std::size_t>(written);
  }
  return "/proc/self/fd/" + std::to_string(file);
}

const fs::path& scratch() {
  struct Folder {
    fs::path path;
    Folder() {
      std::string name = (fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) / "agrisee_XXXXXX";
      require(::mkdtemp(name.data()) != nullptr, "the system has room for a folder");
      path = name;
    }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

}  // namespace agrisee::fuzz
