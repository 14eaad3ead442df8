// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// CDR, in which ROS 2 writes messages: values aligned to their size, texts with their length, after four bytes that
/// tell the byte order. Little-endian alone (OMG DDSI-RTPS, plain CDR).
#pragma once

#include <agrisee/core/error.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace agrisee::io {

/// Composes a message.
class CdrWriter {
 public:
  template <typename T>
  CdrWriter& put(T value) {
    bytes_.resize(4 + (bytes_.size() - 4 + sizeof(T) - 1) / sizeof(T) * sizeof(T), '\0');
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  CdrWriter& text(std::string_view value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value);
    bytes_ += '\0';
    return *this;
  }
  /// A list of bytes with its length.
  CdrWriter& data(const void* values, std::size_t size) {
    put(static_cast<std::uint32_t>(size));
    bytes_.append(static_cast<const char*>(values), size);
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

/// Takes a message apart. All functions throw InputError for a message that is too short.
class CdrReader {
 public:
  explicit CdrReader(std::string_view bytes) : bytes_(bytes) {
    check_input(bytes.size() >= 4 && bytes[0] == 0, "is not CDR");
    check_input(bytes[1] == 1, "is big-endian CDR, which is not read");
    bytes_.remove_prefix(4);
  }
  template <typename T>
  T take() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    T value;
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string text() {
    const std::string_view value = next(take<std::uint32_t>());
    return std::string(value.substr(0, value.find('\0')));
  }
  /// A list of bytes; valid as long as those of the message.
  std::string_view data() { return next(take<std::uint32_t>()); }

 private:
  std::string_view next(std::size_t size) {
    check_input(at_ <= bytes_.size() && size <= bytes_.size() - at_, "is shorter than its type says");
    const std::string_view out = bytes_.substr(at_, size);
    at_ += size;
    return out;
  }
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace agrisee::io
