// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Vectors that do not zero new elements. Large arrays are then first written by the threads that fill them in
/// parallel. The operating system maps a page of memory when it is first written to, which takes longer than the write
/// itself, so zeroing them on one thread first would cost more than the rest of the work.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// std::allocator, except that elements made without arguments are default-initialized: numbers keep whatever value the
/// memory holds.
template <typename T>
struct DefaultInitAllocator : std::allocator<T> {
  DefaultInitAllocator() = default;
  template <typename U>
  DefaultInitAllocator(const DefaultInitAllocator<U>&) noexcept {}
  template <typename U>
  struct rebind {
    using other = DefaultInitAllocator<U>;
  };

  /// Default-initializes an element.
  template <typename U>
  void construct(U* p) {
    ::new (static_cast<void*>(p)) U;
  }
  /// Constructs an element from arguments.
  template <typename U, typename... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

/// A vector whose resize() leaves new numbers, or structs of numbers, without a value.
template <typename T>
using Uninitialized = std::vector<T, DefaultInitAllocator<T>>;

}  // namespace agrisee::detail
