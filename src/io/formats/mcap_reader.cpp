// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fstream>

#include "io/formats/crc32.hpp"
#include "io/formats/mcap.hpp"
#include "io/formats/mcap_records.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io::mcap {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestText = 1 << 24;  // bytes of a record that is read as a whole
constexpr std::uint64_t kMessageHead = 22;       // channel, sequence, two times
constexpr std::uint64_t kRecordHead = 9;         // opcode, length

std::uint64_t number(const char* bytes, int size) {
  std::uint64_t value = 0;
  for (int i = 0; i < size; ++i) value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return value;
}

/// Takes values from the front of a record.
class Fields {
 public:
  Fields(const fs::path& path, std::string_view bytes) : path_(path), rest_(bytes) {}
  std::uint64_t take(int size) { return number(next(static_cast<std::uint64_t>(size)).data(), size); }
  std::string_view text() { return next(take(4)); }
  bool is_empty() const { return rest_.empty(); }

 private:
  std::string_view next(std::uint64_t size) {
    if (size > rest_.size()) fail(path_, "is damaged: a record is too short");
    const std::string_view out = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(static_cast<std::size_t>(size));
    return out;
  }
  const fs::path& path_;
  std::string_view rest_;
};

/// An open file of known size.
class Source {
 public:
  explicit Source(const fs::path& path) : path_(path), size_(InputFile(path).size().value_or(0)) {
    file_.open(path, std::ios::binary);
    if (!file_) fail(path, "cannot be opened");
  }
  std::uint64_t size() const { return size_; }
  const fs::path& path() const { return path_; }
  /// The bytes from `offset` on, which must lie within the file.
  void read(std::uint64_t offset, char* to, std::uint64_t size) {
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(to, static_cast<std::streamsize>(size));
    if (!file_) fail(path_, "cannot be read");
  }
  std::string read(std::uint64_t offset, std::uint64_t size) {
    if (offset > size_ || size > size_ - offset) fail(path_, "is damaged: a record ends behind the file");
    std::string out(static_cast<std::size_t>(size), '\0');
    read(offset, out.data(), size);
    return out;
  }

 private:
  fs::path path_;
  std::uint64_t size_;
  std::ifstream file_;
};

/// Reads the list of messages.
class Walk {
 public:
  Walk(Source& source, Contents& contents) : source_(source), out_(contents) {}

  /// Read the records in [from, to). @param in_chunk a record that does not fit is damage, not the end of a file
  /// @return false at the end of the data
  bool records(std::uint64_t from, std::uint64_t to, bool in_chunk) {
    while (from < to) {
      char head[kRecordHead];
      if (to - from < kRecordHead) return cut_off(in_chunk);
      source_.read(from, head, kRecordHead);
      const std::uint64_t length = number(head + 1, 8);
      from += kRecordHead;
      if (length > to - from) return cut_off(in_chunk);
      const auto opcode = static_cast<std::uint8_t>(head[0]);
      if (opcode == kDataEnd || opcode == kFooter) return false;
      record(opcode, from, length, in_chunk);
      from += length;
    }
    return true;
  }

 private:
  bool cut_off(bool in_chunk) {
    if (in_chunk) fail(source_.path(), "is damaged: a record ends behind its chunk");
    out_.cut_off = true;
    return false;
  }

  void record(std::uint8_t opcode, std::uint64_t at, std::uint64_t length, bool in_chunk) {
    if (opcode == kMessage) return message(at, length);
    if (opcode == kChunk && !in_chunk) return chunk(at, length);
    if (opcode != kSchema && opcode != kChannel && opcode != kMetadata) return;  // not needed
    if (length > kLargestText)
      fail(source_.path(), "is damaged: a description has " + std::to_string(length) + " bytes");
    const std::string bytes = source_.read(at, length);
    Fields fields(source_.path(), bytes);
    if (opcode == kSchema) {
      const auto id = static_cast<std::uint16_t>(fields.take(2));
      schemas_[id] = std::string(fields.text());
    } else if (opcode == kChannel) {
      const auto id = static_cast<std::uint16_t>(fields.take(2));
      const auto schema = static_cast<std::uint16_t>(fields.take(2));
      Channel& channel = out_.channels[id];
      channel.topic = std::string(fields.text());
      channel.encoding = std::string(fields.text());
      channel.schema = schemas_[schema];
    } else {
      auto& values = out_.metadata[std::string(fields.text())];
      Fields map(source_.path(), fields.text());
      while (!map.is_empty()) {
        const std::string key(map.text());
        values[key] = std::string(map.text());
      }
    }
  }

  void message(std::uint64_t at, std::uint64_t length) {
    char head[kMessageHead];
    if (length < kMessageHead) fail(source_.path(), "is damaged: a message is too short");
    source_.read(at, head, kMessageHead);
    const auto channel = static_cast<std::uint16_t>(number(head, 2));
    if (!out_.channels.count(channel)) fail(source_.path(), "is damaged: a message belongs to no channel");
    out_.messages.push_back({channel, number(head + 6, 8), at + kMessageHead, length - kMessageHead});
  }

  void chunk(std::uint64_t at, std::uint64_t length) {
    constexpr std::uint64_t kHead = 8 + 8 + 8 + 4;
    const std::string head = source_.read(at, std::min<std::uint64_t>(length, 256));
    Fields fields(source_.path(), head);
    fields.take(8), fields.take(8);
    const std::uint64_t size = fields.take(8);
    const auto crc = static_cast<std::uint32_t>(fields.take(4));
    const std::string compression(fields.text());
    if (!compression.empty())
      fail(source_.path(),
           "its chunks are compressed (" + excerpt(compression) +
               "), which is not read; convert it with `mcap compress --compression none FILE -o OTHER`");
    const std::uint64_t begin = at + kHead + 4 + 8;
    if (fields.take(8) != size || size > at + length - begin)
      fail(source_.path(), "is damaged: the sizes of a chunk disagree");
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION  // a fuzzer would never get past it
    if (crc != 0 && crc != crc_of(begin, size)) fail(source_.path(), "is damaged: the checksum of a chunk is wrong");
#else
    static_cast<void>(crc);
#endif
    records(begin, begin + size, true);
  }

  std::uint32_t crc_of(std::uint64_t from, std::uint64_t size) {
    std::vector<char> block(1 << 20);
    std::uint32_t crc = 0;
    while (size > 0) {
      const std::uint64_t part = std::min<std::uint64_t>(size, block.size());
      source_.read(from, block.data(), part);
      crc = crc32({block.data(), static_cast<std::size_t>(part)}, crc);
      from += part;
      size -= part;
    }
    return crc;
  }

  Source& source_;
  Contents& out_;
  std::map<std::uint16_t, std::string> schemas_;
};

}  // namespace

std::string other_recording(std::string_view first_bytes) {
  constexpr std::string_view kRos1 = "#ROSBAG", kSqlite = "SQLite format 3";
  if (first_bytes.substr(0, kRos1.size()) == kRos1)
    return "is a bag of ROS 1, which is not read; convert it with "
           "`rosbags-convert --src FILE --dst OTHER --dst-storage mcap`";
  if (first_bytes.substr(0, kSqlite.size()) == kSqlite)
    return "is an SQLite file, as ROS 2 records them (.db3), which is not read; convert it with `mcap convert "
           "--compression none FILE OTHER.mcap`, or record with `ros2 bag record -s mcap`";
  return "";
}

Contents read_contents(const fs::path& path) {
  Source source(path);
  const std::string first = source.read(0, std::min<std::uint64_t>(source.size(), 16));
  if (first.compare(0, kMagic.size(), kMagic) != 0) {
    const std::string other = other_recording(first);
    fail(path, other.empty() ? "is not an MCAP file" : other);
  }
  Contents out;
  out.cut_off = Walk(source, out).records(kMagic.size(), source.size(), false) || out.cut_off;  // no end of the data
  return out;
}

std::string read_message(const fs::path& path, const Message& message) {
  return Source(path).read(message.offset, message.size);
}

}  // namespace agrisee::io::mcap
