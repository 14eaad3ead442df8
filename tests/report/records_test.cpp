// SPDX-License-Identifier: BSD-3-Clause
#include "report/records.hpp"

#include <agrisee/io/files.hpp>

#include <filesystem>

#include "catch.hpp"

using namespace agrisee;

namespace {

std::filesystem::path file(const char* name) { return std::filesystem::temp_directory_path() / name; }

study::CellRecord a_record() {
  study::CellRecord r;
  r.cell = {"truss|7", "default", "gain", "gaussian:0.01", 3};
  r.fingerprint = "abc";
  r.total = 2;
  r.hidden = 1;
  r.stop_reason = "low_gain";
  r.views = 2;
  r.merged = 12345;
  r.seconds.plan = 0.1;
  r.path = 1.0 / 3.0;
  r.metrics.recall = 0.7;
  r.metrics.n_real = 2;
  r.metrics.fruits.resize(2);
  r.metrics.fruits[0].id = 4;
  r.metrics.fruits[0].detected = true;
  r.metrics.fruits[0].center_error = 1e-3;
  r.growing.n_det = 5;
  r.clustering.miou = 0.25;
  r.fruits.resize(2);
  r.fruits[1].found_by = "dbscan";
  r.fruits[1].centroid = {0.1, -0.2, 1e-17};
  r.scanned_after = {0.5, 0.75};
  r.recall_after = {0.25, 0.125};
  r.true_after = {1, 2};
  return r;
}

}  // namespace

TEST_CASE("a record is read back exactly as it was written") {
  const auto path = file("agrisee_cell.json");
  const study::CellRecord r = a_record();
  report::write_record(path, r);
  const study::CellRecord b = report::read_cell_record(path);
  CHECK(b.cell.name() == r.cell.name());
  CHECK(b.cell.noise == "gaussian:0.01");
  CHECK(b.fingerprint == "abc");
  CHECK(b.merged == 12345);
  CHECK(b.seconds.plan == 0.1);
  CHECK(b.path == r.path);
  REQUIRE(b.metrics.fruits.size() == 2);
  CHECK(b.metrics.fruits[0].detected);
  CHECK(b.metrics.fruits[0].center_error == r.metrics.fruits[0].center_error);
  CHECK_FALSE(b.metrics.fruits[1].center_error);
  CHECK(b.growing.n_det == 5);
  CHECK(b.clustering.miou == 0.25);
  CHECK(b.fruits[1].centroid == r.fruits[1].centroid);
  CHECK(b.scanned_after == r.scanned_after);
  CHECK(b.recall_after == r.recall_after);
  CHECK(b.true_after == r.true_after);
  std::filesystem::remove(path);
}

TEST_CASE("different cells have different names, which are valid file names") {
  study::Cell a = a_record().cell, b = a;
  b.trial = 4;
  CHECK(a.name() != b.name());
  CHECK(a.name().find_first_of(":/\\") == std::string::npos);
}

TEST_CASE("the error for a missing or broken record names the file") {
  const auto path = file("agrisee_broken.json");
  for (const char* text : {"", "{", "[]", "{\"cell\": 3}", "{\"cell\": {\"scene\": \"s\"}}"}) {
    io::write_file(path, text);
    std::string message;
    try {
      report::read_cell_record(path);
    } catch (const FileError& e) {
      message = e.what();
    }
    CHECK(message.find("agrisee_broken.json") != std::string::npos);
    CHECK_THROWS_AS(report::read_scene_record(path), FileError);
  }
  std::filesystem::remove(path);
  CHECK_THROWS_AS(report::read_cell_record(path), FileError);
}
