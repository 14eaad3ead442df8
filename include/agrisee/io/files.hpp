// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes whole files. Every reader and writer of agrisee::io uses these functions, so that all of them
/// report errors in the same way: a FileError whose message begins with the path.
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
  std::unique_ptr<char[]> data;  ///< `size` bytes
  std::size_t size = 0;          ///< number of bytes

  /// The bytes as text; valid as long as this object.
  std::string_view view() const { return {data.get(), size}; }
};

/// A regular file or a pipe, open for reading from its beginning to its end.
class InputFile {
 public:
  /// @throws FileError when it is missing, a directory, a device, or cannot be opened
  explicit InputFile(const std::filesystem::path& path);

  /// Size of the file (bytes); none for a pipe and for system files (as in /proc), whose size is not known beforehand.
  std::optional<std::size_t> size() const { return size_; }
  /// Read the next `size` bytes into `to`. @return the number of bytes read; less than `size` only at the end of the
  /// file
  /// @throws FileError when the file cannot be read
  std::size_t read(char* to, std::size_t size);
  /// Read the rest of the file. @param before bytes that were read already; the result begins with them
  /// @throws FileError when the file cannot be read
  Bytes rest(Bytes before = {});

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::optional<std::size_t> size_;
};

/// Read a whole file.
/// @throws FileError when it is missing, a directory, a device, or cannot be read
Bytes read_bytes(const std::filesystem::path& path);

/// Whether a file that was written survives a power cut. In both cases other processes see either the complete file or
/// no file at all, even when the process that writes it is killed.
enum class Durability {
  whenever,  ///< the operating system writes the file to the disk when it suits
  now        ///< the file is on the disk when the call returns (fsync); takes some 30 ms
};

/// A file that appears under its name only when it is complete: it is written to a temporary file beside `path`, which
/// commit() renames. Without commit() the temporary file is removed and an older file of that name stays as it was.
class AtomicFile {
 public:
  /// @throws FileError when the temporary file cannot be created
  explicit AtomicFile(const std::filesystem::path& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Append bytes. @throws FileError when they cannot be written
  void write(const void* data, std::size_t size);
  /// Append text. @throws FileError when it cannot be written
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Give the file its name. @throws FileError when that fails
  void commit(Durability durability = Durability::whenever);

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  std::filesystem::path path_, temporary_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Write a whole file atomically (see AtomicFile). @throws FileError when it cannot be written
void write_file(const std::filesystem::path& path, std::string_view bytes,
                Durability durability = Durability::whenever);

/// Create a folder and those above it, if they are missing. @throws FileError when that fails
void make_folder(const std::filesystem::path& folder);

/// Flush all files of a folder (not of its subfolders) to the disk with fsync. @throws FileError when that fails
void make_durable(const std::filesystem::path& folder);

/// Remove the temporary files that killed processes left in a folder (see AtomicFile). Other files are not touched.
void remove_leftovers(const std::filesystem::path& folder);

/// Throw FileError("<path>: <message>").
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& message);
/// Throw FileError("<path>:<line>: <message>").
[[noreturn]] void fail(const std::filesystem::path& path, std::size_t line, const std::string& message);

}  // namespace agrisee::io
