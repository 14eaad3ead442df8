// SPDX-License-Identifier: BSD-3-Clause
// What this program was built from, and how.
#pragma once

#include <string>

namespace agrisee::cli {

/// What `agrisee --version` prints: "agrisee 0.2.0", then a line each for compiler, sources, libraries and the parts
/// that are optional. Without a line break at the end.
std::string version_text();

/// The version of SQLite, which `merge --db` and `season` need; empty if AgriSEE was built without it.
std::string sqlite_version();

}  // namespace agrisee::cli
