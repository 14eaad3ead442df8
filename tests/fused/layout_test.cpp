// SPDX-License-Identifier: BSD-3-Clause
// A program that is compiled for more vector instructions than the library links to it, so types must agree.
#include "layout.hpp"

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("types have the same layout whatever vector instructions a program is compiled for") {
  CHECK(test::kLayout == test::plain_layout());
}
