// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// MCAP files (mcap.dev/spec, version 0): messages with their time, topic and schema. Chunks are written and read
/// without compression.
#pragma once

#include <agrisee/io/files.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace agrisee::io::mcap {

/// Little-endian bytes of a record.
class Record {
 public:
  Record& u8(std::uint8_t value) { return number(value, 1); }
  Record& u16(std::uint16_t value) { return number(value, 2); }
  Record& u32(std::uint32_t value) { return number(value, 4); }
  Record& u64(std::uint64_t value) { return number(value, 8); }
  Record& bytes(std::string_view value) { return bytes_.append(value), *this; }
  /// A text or bytes with their length before them.
  Record& text(std::string_view value) { return u32(static_cast<std::uint32_t>(value.size())).bytes(value); }
  const std::string& str() const { return bytes_; }

 private:
  Record& number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 255u);
    return *this;
  }
  std::string bytes_;
};

/// Writes an MCAP file. It appears under its name when close() is called.
class Writer {
 public:
  /// @param profile "ros2", or empty  @throws FileError, as all functions, when the file cannot be written
  Writer(const std::filesystem::path& path, std::string_view profile, std::string_view library);

  /// Add a schema. @param encoding "ros2msg" or "jsonschema"  @return its id
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view text);
  /// Add a channel. @param encoding "cdr" or "json"  @return its id
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding);
  /// Add a message. @param time of it (ns)
  void add_message(std::uint16_t channel, std::uint64_t time, std::string_view data);
  /// Add a record of names and values.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);
  /// Write the index, and give the file its name.
  void close();

 private:
  struct Chunk {
    std::uint64_t offset, length, first, last, size, index_length;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };
  struct Metadata {
    std::uint64_t offset, length;
    std::string name;
  };
  void write(std::uint8_t opcode, std::string_view content);
  void put(std::string_view bytes);
  void end_chunk();

  AtomicFile file_;
  std::uint64_t at_ = 0;                                                                 // position in the file
  std::vector<std::string> schemas_, channels_;                                          // whole records
  std::string chunk_;                                                                    // records of the open chunk
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> times_;  // per channel, of that chunk
  std::uint64_t first_ = 0, last_ = 0;                                                   // times in it
  std::vector<Chunk> chunks_;
  std::vector<Metadata> metadata_;
  std::map<std::uint16_t, std::uint64_t> counts_;  // messages per channel
  std::uint32_t sequence_ = 0;
};

/// Where a message lies.
struct Message {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;    ///< when it was logged (ns)
  std::uint64_t offset = 0;  ///< of its data in the file
  std::uint64_t size = 0;    ///< of its data (bytes)
};

struct Channel {
  std::string topic, encoding;  ///< "cdr"
  std::string schema;           ///< name, "sensor_msgs/msg/Image"
};

/// What a file holds.
struct Contents {
  std::map<std::uint16_t, Channel> channels;
  std::vector<Message> messages;                                       ///< in the order of the file
  std::map<std::string, std::map<std::string, std::string>> metadata;  ///< by the name of the record
  bool cut_off = false;                                                ///< the file ends within a record
};

/// What a file is that begins like a recording of another format, and how to convert it; empty for others.
std::string other_recording(std::string_view first_bytes);

/// Read the list of all messages. A file that was cut off counts up to its last whole record.
/// @throws FileError for a file that is not MCAP, is damaged, or has compressed chunks
Contents read_contents(const std::filesystem::path& path);

/// Read the data of a message. @throws FileError
std::string read_message(const std::filesystem::path& path, const Message& message);

}  // namespace agrisee::io::mcap
