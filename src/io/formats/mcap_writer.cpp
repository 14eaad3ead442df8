// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>

#include "io/formats/crc32.hpp"
#include "io/formats/mcap.hpp"
#include "io/formats/mcap_records.hpp"

namespace agrisee::io::mcap {
namespace {

constexpr std::size_t kChunkSize = 4 << 20;  // bytes after which a chunk ends

/// A record with opcode and length.
std::string whole(std::uint8_t opcode, std::string_view content) {
  return Record().u8(opcode).u64(content.size()).bytes(content).str();
}

}  // namespace

Writer::Writer(const std::filesystem::path& path, std::string_view profile, std::string_view library) : file_(path) {
  put(kMagic);
  write(kHeader, Record().text(profile).text(library).str());
}

void Writer::put(std::string_view bytes) {
  file_.write(bytes);
  at_ += bytes.size();
}

void Writer::write(std::uint8_t opcode, std::string_view content) { put(whole(opcode, content)); }

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding, std::string_view text) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);  // 0 means: no schema
  schemas_.push_back(whole(kSchema, Record().u16(id).text(name).text(encoding).text(text).str()));
  chunk_ += schemas_.back();
  return id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back(whole(kChannel, Record().u16(id).u16(schema).text(topic).text(encoding).text("").str()));
  chunk_ += channels_.back();
  counts_[id] = 0;
  return id;
}

void Writer::add_message(std::uint16_t channel, std::uint64_t time, std::string_view data) {
  const bool is_first = times_.empty();
  first_ = is_first ? time : std::min(first_, time);
  last_ = is_first ? time : std::max(last_, time);
  times_[channel].emplace_back(time, chunk_.size());
  chunk_ += whole(kMessage, Record().u16(channel).u32(sequence_++).u64(time).u64(time).bytes(data).str());
  ++counts_[channel];
  if (chunk_.size() > kChunkSize) end_chunk();
}

void Writer::add_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  end_chunk();
  Record map;
  for (const auto& [key, value] : values) map.text(key).text(value);
  const std::uint64_t offset = at_;
  write(kMetadata, Record().text(name).text(map.str()).str());
  metadata_.push_back({offset, at_ - offset, std::string(name)});
}

void Writer::end_chunk() {
  if (chunk_.empty()) return;
  Chunk chunk{at_, 0, first_, last_, chunk_.size(), 0, {}};
  write(kChunk, Record()
                    .u64(first_)
                    .u64(last_)
                    .u64(chunk_.size())
                    .u32(crc32(chunk_))
                    .text("")
                    .u64(chunk_.size())
                    .bytes(chunk_)
                    .str());
  chunk.length = at_ - chunk.offset;
  for (const auto& [channel, entries] : times_) {
    chunk.index_offsets[channel] = at_;
    Record list;
    for (const auto& [time, offset] : entries) list.u64(time).u64(offset);
    write(kMessageIndex, Record().u16(channel).text(list.str()).str());
  }
  chunk.index_length = at_ - chunk.offset - chunk.length;
  chunks_.push_back(chunk);
  chunk_.clear();
  times_.clear();
  first_ = last_ = 0;
}

void Writer::close() {
  end_chunk();
  write(kDataEnd, Record().u32(0).str());
  const std::uint64_t summary = at_;
  std::string offsets;
  const auto group = [&](std::uint8_t opcode, const std::function<void()>& fill) {
    const std::uint64_t start = at_;
    fill();
    if (at_ > start) offsets += whole(kSummaryOffset, Record().u8(opcode).u64(start).u64(at_ - start).str());
  };
  group(kSchema, [&] {
    for (const std::string& schema : schemas_) put(schema);
  });
  group(kChannel, [&] {
    for (const std::string& channel : channels_) put(channel);
  });
  group(kStatistics, [&] {
    std::uint64_t messages = 0, first = 0, last = 0;
    Record counts;
    for (const auto& [channel, count] : counts_) messages += count, counts.u16(channel).u64(count);
    bool any = false;
    for (const Chunk& chunk : chunks_) {
      if (chunk.index_offsets.empty()) continue;
      first = any ? std::min(first, chunk.first) : chunk.first;
      last = std::max(last, chunk.last);
      any = true;
    }
    write(kStatistics, Record()
                           .u64(messages)
                           .u16(static_cast<std::uint16_t>(schemas_.size()))
                           .u32(static_cast<std::uint32_t>(channels_.size()))
                           .u32(0)
                           .u32(static_cast<std::uint32_t>(metadata_.size()))
                           .u32(static_cast<std::uint32_t>(chunks_.size()))
                           .u64(first)
                           .u64(last)
                           .text(counts.str())
                           .str());
  });
  group(kChunkIndex, [&] {
    for (const Chunk& chunk : chunks_) {
      Record map;
      for (const auto& [channel, offset] : chunk.index_offsets) map.u16(channel).u64(offset);
      write(kChunkIndex, Record()
                             .u64(chunk.first)
                             .u64(chunk.last)
                             .u64(chunk.offset)
                             .u64(chunk.length)
                             .text(map.str())
                             .u64(chunk.index_length)
                             .text("")
                             .u64(chunk.size)
                             .u64(chunk.size)
                             .str());
    }
  });
  group(kMetadataIndex, [&] {
    for (const Metadata& entry : metadata_)
      write(kMetadataIndex, Record().u64(entry.offset).u64(entry.length).text(entry.name).str());
  });
  const std::uint64_t summary_offsets = at_;
  put(offsets);
  write(kFooter, Record().u64(summary).u64(summary_offsets).u32(0).str());
  put(kMagic);
  file_.commit();
}

}  // namespace agrisee::io::mcap
