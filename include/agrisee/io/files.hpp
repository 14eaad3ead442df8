// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whole files in and out. Every reader and writer of this module goes through here, so that all of them fail alike: a
/// FileError that begins with the path.
#pragma once

#include <agrisee/core/error.hpp>

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace agrisee::io {

/// The bytes of a file.
struct Bytes {
  std::unique_ptr<char[]> data;  ///< the bytes
  std::size_t size = 0;          ///< how many

  /// Them as text.
  std::string_view view() const { return {data.get(), size}; }
};

/// A regular file (or pipe) that is read from its beginning to its end.
class InputFile {
 public:
  /// @throws FileError when it is missing, a directory, a device, or cannot be opened
  explicit InputFile(const std::filesystem::path& path);

  /// Bytes of the whole file; none for a pipe and for files of the system, whose length nobody knows.
  std::optional<std::size_t> size() const { return size_; }
  /// The next bytes, as many as there are. @return how many, less than `size` at the end of the file alone
  /// @throws FileError when it cannot be read
  std::size_t read(char* to, std::size_t size);
  /// All bytes that are left. @param before what comes before them, read already
  /// @throws FileError when it cannot be read
  Bytes rest(Bytes before = {});

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::optional<std::size_t> size_;
};

/// All bytes of a file, read at once.
/// @throws FileError as InputFile does
Bytes read_bytes(const std::filesystem::path& path);

/// What of a file is left after a power cut. Either way it is complete or absent for whoever looks while the machine
/// runs, however the process that writes it ends.
enum class Durability {
  whenever,  ///< the operating system brings it to the disk in its own time
  now        ///< it is on the disk when the call returns (fsync); some 30 ms
};

/// A file that appears under its name only when it is complete: it is written to a temporary beside `path`, then
/// renamed. Without commit() nothing is left behind and an older file stays as it was.
class AtomicFile {
 public:
  /// @throws FileError when the temporary cannot be created
  explicit AtomicFile(const std::filesystem::path& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Append bytes. @throws FileError when they cannot be written
  void write(const void* data, std::size_t size);
  /// Append text. @throws FileError when it cannot be written
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Put the file in its place. @throws FileError when that fails
  void commit(Durability durability = Durability::whenever);

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  std::filesystem::path path_, temporary_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Write a whole file, atomically. @throws FileError
void write_file(const std::filesystem::path& path, std::string_view bytes,
                Durability durability = Durability::whenever);

/// Bring what was written to a folder's own files to the disk. @throws FileError when the disk refuses
void make_durable(const std::filesystem::path& folder);

/// Remove the temporaries that killed writers left in a folder; other files are not touched.
void remove_leftovers(const std::filesystem::path& folder);

/// Throw FileError("<path>: <message>").
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& message);
/// Throw FileError("<path>:<line>: <message>").
[[noreturn]] void fail(const std::filesystem::path& path, std::size_t line, const std::string& message);

}  // namespace agrisee::io
