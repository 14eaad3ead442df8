// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tables of numbers as text, one row a line: XYZ, CSV.
#pragma once

#include <string_view>

namespace agrisee::io {

/// Whether a file that begins with these bytes looks like a table of numbers that read_table_cloud can read: a line of
/// numbers, or of names among which are x, y and z.
bool is_table(std::string_view first_bytes);

}  // namespace agrisee::io
