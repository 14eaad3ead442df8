// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The results of a season in one SQLite file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "season/place.hpp"
#include "season/results.hpp"

namespace agrisee::season {

/// What add_scans did.
struct Added {
  std::size_t added = 0;           ///< results that were not there
  std::size_t changed = 0;         ///< results that are others than before
  std::size_t unchanged = 0;       ///< results that were there already
  std::size_t failed = 0;          ///< scans without a result that failed
  std::size_t open = 0;            ///< scans without a result that are to be done
  std::size_t moved = 0;           ///< scans that were there with another folder, which is gone
  std::size_t removed = 0;         ///< scans that were there and are left out, or are there twice with a folder gone
  std::size_t twice = 0;           ///< scans that are there more than once, in different folders
  std::string example = {};        ///< two folders with the same scan
  std::vector<Place> places = {};  ///< of all scans, in their order
  std::vector<std::string> unread = {};  ///< why results could not be read; what was there of them stays
};

/// Put scans into a database, which is created if it is missing. A scan is known by its folder, relative to that of the
/// database: one that is there with the same content is skipped, one with another content is replaced. One that is
/// there with the same content and another folder, which is gone, gets the new folder. All of it
/// happens in one transaction: if it fails, or the process is killed, the database stays as it was.
/// @param left_out scans that are removed if they are there
/// @param threads number of threads that read files; the database does not depend on it
/// @throws FileError for a file that is no such database
Added add_scans(const std::string& database, const std::vector<Scan>& scans, const std::vector<Scan>& left_out,
                const PlaceRules& rules, int threads);

}  // namespace agrisee::season
