// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/results.hpp>

#include <cstdlib>
#include <ctime>

#include "io/formats/text.hpp"

namespace agrisee::io {

std::string utc_now() {
  std::time_t seconds = std::time(nullptr);
  if (const char* given = std::getenv("SOURCE_DATE_EPOCH"))
    if (const auto number = to_integer(given); number && *number >= 0) seconds = static_cast<std::time_t>(*number);
  std::tm utc{};
  char text[32];
  if (!gmtime_r(&seconds, &utc) || std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) return "";
  return text;
}

}  // namespace agrisee::io
