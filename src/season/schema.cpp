// SPDX-License-Identifier: BSD-3-Clause
#include "season/schema.hpp"

#include <agrisee/core/error.hpp>

#include "season/sqlite.hpp"

namespace agrisee::season {

void check_schema(const Connection& connection) {
  if (connection.integer("PRAGMA application_id") != kApplicationId)
    throw FileError(connection.path() +
                    ": is a database of something else; `agrisee merge --db` writes that of a season");
  if (connection.integer("PRAGMA user_version") != kSchemaVersion)
    throw FileError(connection.path() + ": was written by another version of AgriSEE; make it again from the results");
}

}  // namespace agrisee::season
