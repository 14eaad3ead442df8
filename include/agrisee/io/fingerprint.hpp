// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A number that tells whether bytes are what they were: FNV-1a of 64 bits (Fowler, Noll, Vo). It finds damage and
/// mix-ups, not forgery.
#pragma once

#include <agrisee/geometry/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace agrisee::io {

/// Bytes are added one after the other; their order counts, how they are divided among calls does not.
class Fingerprint {
 public:
  /// `size` bytes.
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ULL;
  }
  /// The bytes of a text.
  void add(std::string_view text) { add(text.data(), text.size()); }
  /// The meshes of a scene.
  void add(const Scene& scene) {
    for (const Object& object : scene.objects) {
      add(object.mesh.vertices.data(), object.mesh.vertices.size() * sizeof(object.mesh.vertices[0]));
      add(object.mesh.triangles.data(), object.mesh.triangles.size() * sizeof(object.mesh.triangles[0]));
    }
  }
  /// Of all that was added.
  std::uint64_t value() const { return hash_; }
  /// As 16 hexadecimal digits.
  std::string text() const {
    std::string out(16, '0');
    for (int i = 0; i < 16; ++i) out[static_cast<std::size_t>(i)] = "0123456789abcdef"[hash_ >> (60 - 4 * i) & 15u];
    return out;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

}  // namespace agrisee::io
