// SPDX-License-Identifier: BSD-3-Clause
// Matches messages that contain a text, in Catch2 2 and 3.
#pragma once

#include "catch.hpp"

namespace agrisee::test {

inline auto says(const std::string& text) {
#if __has_include(<catch2/catch_all.hpp>)
  return Catch::Matchers::ContainsSubstring(text);
#else
  return Catch::Matchers::Contains(text);
#endif
}

}  // namespace agrisee::test
