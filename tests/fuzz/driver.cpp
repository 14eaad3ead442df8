// SPDX-License-Identifier: BSD-3-Clause
// One target as libFuzzer wants it; AGRISEE_FUZZ_TARGET names it.
#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  agrisee::fuzz::AGRISEE_FUZZ_TARGET(data, size);
  return 0;
}
