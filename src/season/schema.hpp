// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The tables of a season's database. docs/many-scans.md describes them.
#pragma once

namespace agrisee::season {

class Connection;

/// `PRAGMA user_version` of a database, and `PRAGMA application_id`, by which files of others are told apart ("AgSE").
constexpr int kSchemaVersion = 1, kApplicationId = 0x41675345;

/// Check that a database holds these tables. @throws FileError if it belongs to something else, or to another version
void check_schema(const Connection& connection);

/// Creates tables and indices that are missing.
constexpr const char* kSchema = R"(
CREATE TABLE IF NOT EXISTS versions (id INTEGER PRIMARY KEY, version TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS parameters (id INTEGER PRIMARY KEY, preset TEXT NOT NULL, json TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS scans (
  id INTEGER PRIMARY KEY,
  folder TEXT NOT NULL UNIQUE,
  content TEXT NOT NULL,
  status TEXT NOT NULL,
  message TEXT NOT NULL,
  input TEXT NOT NULL,
  "row" TEXT NOT NULL,
  date TEXT NOT NULL,
  time TEXT,
  version INTEGER REFERENCES versions(id),
  parameters INTEGER REFERENCES parameters(id),
  scene TEXT, planner TEXT, noise TEXT, seed TEXT,
  fruit INTEGER, views INTEGER, stop_reason TEXT,
  points_merged INTEGER, points_filtered INTEGER, points_labelled INTEGER,
  seconds REAL
);
CREATE TABLE IF NOT EXISTS fruit (
  scan INTEGER NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  id INTEGER NOT NULL,
  truss INTEGER NOT NULL,
  points INTEGER NOT NULL,
  found_by TEXT NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  diameter REAL, radius_a REAL, radius_b REAL, radius_c REAL,
  volume REAL, volume_error REAL, mass REAL, mass_error REAL,
  completeness REAL, confidence REAL,
  ripeness TEXT, ripeness_probability REAL, ripe_share REAL,
  picking_order INTEGER, reachable INTEGER, picking_reason TEXT,
  PRIMARY KEY (scan, id)
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS views (
  scan INTEGER NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  view INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  dx REAL NOT NULL, dy REAL NOT NULL, dz REAL NOT NULL,
  points_in INTEGER NOT NULL, points_new INTEGER NOT NULL, plan_s REAL NOT NULL,
  PRIMARY KEY (scan, view)
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS scans_by_date ON scans(date, "row");
CREATE INDEX IF NOT EXISTS scans_by_row ON scans("row", date);
CREATE INDEX IF NOT EXISTS scans_by_status ON scans(status);
CREATE INDEX IF NOT EXISTS scans_by_content ON scans(content, input);
CREATE INDEX IF NOT EXISTS fruit_by_diameter ON fruit(diameter);
)";

}  // namespace agrisee::season
