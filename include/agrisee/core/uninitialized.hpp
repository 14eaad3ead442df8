// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Vectors whose new elements are left as they are, for what all threads write at once: the system hands out a page of
/// memory when it is first written to, and that takes longer than writing it.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// std::allocator but for elements that are made without a value: numbers are not set.
template <typename T>
struct LeavingAllocator : std::allocator<T> {
  LeavingAllocator() = default;
  /// Of another type.
  template <typename U>
  LeavingAllocator(const LeavingAllocator<U>&) noexcept {}
  /// Of another type.
  template <typename U>
  struct rebind {
    using other = LeavingAllocator<U>;  ///< the type
  };

  /// Makes an element without a value.
  template <typename U>
  void construct(U* p) {
    ::new (static_cast<void*>(p)) U;
  }
  /// Makes one of values.
  template <typename U, typename... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

/// A vector of numbers, or structs of them, whose resize() leaves new ones for whoever writes them first.
template <typename T>
using Uninitialized = std::vector<T, LeavingAllocator<T>>;

}  // namespace agrisee::detail
