// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A 64-bit hash (FNV-1a; Fowler, Noll, Vo) that shows whether data has changed. It detects damage and mix-ups, not
/// forgery.
#pragma once

#include <agrisee/study/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace agrisee::io {

/// Computes the hash of a sequence of bytes. Only the sequence counts, not how it is divided among the calls of add().
class Fingerprint {
 public:
  /// Append `size` bytes.
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ULL;
  }
  /// Append the bytes of a text.
  void add(std::string_view text) { add(text.data(), text.size()); }
  /// Append the vertices and triangles of all meshes of a scene.
  void add(const study::Scene& scene) {
    for (const study::Object& object : scene.objects) {
      add(object.mesh.vertices.data(), object.mesh.vertices.size() * sizeof(object.mesh.vertices[0]));
      add(object.mesh.triangles.data(), object.mesh.triangles.size() * sizeof(object.mesh.triangles[0]));
    }
  }
  /// The hash of all bytes added so far.
  std::uint64_t value() const { return hash_; }
  /// The hash as 16 hexadecimal digits.
  std::string text() const {
    std::string out(16, '0');
    for (int i = 0; i < 16; ++i) out[static_cast<std::size_t>(i)] = "0123456789abcdef"[hash_ >> (60 - 4 * i) & 15u];
    return out;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

}  // namespace agrisee::io
