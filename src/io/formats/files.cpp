// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/missing_file.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "io/formats/text.hpp"

namespace agrisee::io {

namespace fs = std::filesystem;

namespace {

/// Whether a file is a temporary one of AtomicFile: `.<name>.tmp<process>-<count>`.
bool is_temporary(std::string_view name) {
  const std::size_t mark = name.rfind(".tmp"), dash = name.rfind('-');
  if (mark == name.npos || mark < 2 || dash == name.npos || dash < mark + 4) return false;
  return name[0] == '.' && is_digits(name.substr(mark + 4, dash - mark - 4)) && is_digits(name.substr(dash + 1));
}

/// Flush a file, or the list of names of a folder, to the disk. @return false if that fails
bool sync(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done =
      ::fsync(file) == 0 || errno == EINVAL || errno == EROFS;  // EINVAL, EROFS: the file system has no fsync
  ::close(file);
  return done;
}

/// Whether two names are alike but for their digits: those of numbered files, of which none stands for another.
bool differ_in_digits_only(const std::string& a, const std::string& b) {
  const auto without = [](std::string name) {
    name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }), name.end());
    return name;
  };
  return without(a) == without(b);
}

/// "; did you mean 'season/scene.yaml'?" for a path that does not exist: the first of its names that is missing,
/// replaced by the nearest name in its folder. Empty if no name is near.
std::string nearest_path(const fs::path& path) {
  fs::path known;
  std::error_code error;
  for (auto at = path.begin(); at != path.end(); ++at) {
    const fs::path& part = *at;
    if (fs::exists(known / part, error)) {
      known /= part;
      continue;
    }
    std::vector<std::string> names;
    for (fs::directory_iterator i(known.empty() ? "." : known, error), end; !error && i != end; i.increment(error)) {
      const std::string name = i->path().filename().string();
      if (name[0] != '.' && !differ_in_digits_only(name, part.string())) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    const auto nearest = nearest_word(part.string(), names);
    if (!nearest) return "";
    known /= *nearest;
    fs::path whole = known;
    for (auto rest = std::next(at); rest != path.end(); ++rest) whole /= *rest;
    return "; did you mean '" + (fs::exists(whole, error) ? whole : known).string() + "'?";
  }
  return "";
}

}  // namespace

void fail(const fs::path& path, const std::string& message) { throw FileError(path.string() + ": " + message); }

void fail(const fs::path& path, std::size_t line, const std::string& message) {
  throw FileError(path.string() + ":" + std::to_string(line) + ": " + message);
}

InputFile::InputFile(const fs::path& path) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) fail(path, "cannot be opened: " + error.message());
  if (!fs::exists(status)) throw MissingFile(path, "no such file" + nearest_path(path));
  if (fs::is_directory(status)) fail(path, "is a directory, not a file");
  if (!fs::is_regular_file(status) && !fs::is_fifo(status)) fail(path, "is not a regular file");
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) fail(path, std::string("cannot be opened: ") + std::strerror(errno));
  struct stat now;  // of the file that was opened; the name may belong to another file by now
  if (::fstat(::fileno(file_.get()), &now) == 0 && S_ISREG(now.st_mode) && now.st_size > 0)
    size_ = static_cast<std::size_t>(now.st_size);
}

void InputFile::Closer::operator()(std::FILE* file) const { std::fclose(file); }

std::size_t InputFile::read(char* to, std::size_t size) {
  const std::size_t got = std::fread(to, 1, size, file_.get());
  if (got < size && std::ferror(file_.get())) fail(path_, "cannot be read");
  return got;
}

Bytes InputFile::rest(Bytes before) {
  // One byte more than the size of the file, so that the first read meets the end of the file.
  std::size_t capacity = std::max(size_ ? *size_ + 1 : 1 << 16, before.size + 1);
  Bytes bytes{std::unique_ptr<char[]>(new char[capacity]), before.size};
  if (before.size > 0) std::memcpy(bytes.data.get(), before.data.get(), before.size);
  while (true) {
    bytes.size += read(bytes.data.get() + bytes.size, capacity - bytes.size);
    if (bytes.size < capacity) return bytes;
    std::unique_ptr<char[]> larger(new char[2 * capacity]);
    std::memcpy(larger.get(), bytes.data.get(), bytes.size);
    bytes.data = std::move(larger);
    capacity *= 2;
  }
}

Bytes read_bytes(const fs::path& path) { return InputFile(path).rest(); }

void AtomicFile::Closer::operator()(std::FILE* file) const { std::fclose(file); }

AtomicFile::AtomicFile(const fs::path& path) : path_(path) {
  static std::atomic<unsigned> counter{0};  // distinguishes the temporary files of this process
  std::error_code error;
  if (fs::is_directory(path, error)) fail(path, "is a directory, cannot be written as a file");
  temporary_ = path;
  temporary_.replace_filename("." + path.filename().string() + ".tmp" + std::to_string(::getpid()) + "-" +
                              std::to_string(counter++));
  file_.reset(std::fopen(temporary_.c_str(), "wb"));
  if (!file_) fail(path, std::string("cannot be written: ") + std::strerror(errno));
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  file_.reset();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::write(const void* data, std::size_t size) {
  if (size > 0 && std::fwrite(data, 1, size, file_.get()) != size)
    fail(path_, std::string("cannot be written: ") + std::strerror(errno));
}

void AtomicFile::commit(Durability durability) {
  const bool now = durability == Durability::now;
  if (now && (std::fflush(file_.get()) != 0 || !sync(temporary_)))
    fail(path_, std::string("cannot be written: ") + std::strerror(errno));
  if (std::fclose(file_.release()) != 0) fail(path_, std::string("cannot be written: ") + std::strerror(errno));
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) fail(path_, "cannot be written: " + error.message());
  temporary_.clear();
  if (now && !sync(path_.has_parent_path() ? path_.parent_path() : fs::path(".")))
    fail(path_, std::string("cannot be written: ") + std::strerror(errno));
}

void write_file(const fs::path& path, std::string_view bytes, Durability durability) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit(durability);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail(folder, "cannot be created: " + error.message());
}

void make_durable(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && !sync(entry.path()))
      fail(entry.path(), std::string("cannot be written: ") + std::strerror(errno));
  if (!sync(folder)) fail(folder, std::string("cannot be written: ") + std::strerror(errno));
}

void remove_leftovers(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (is_temporary(entry.path().filename().string())) fs::remove(entry.path(), ignored);
}

}  // namespace agrisee::io
