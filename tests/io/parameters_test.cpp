// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/parameters.hpp>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "io/io_support.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

std::string write(const std::string& text) {
  static const test::TempFolder folder;
  return folder.file("parameters.yaml", text).string();
}

std::string error_of(const std::string& text) {
  try {
    io::read_parameters(write(text));
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("parameters read back as they were written") {
  for (Parameters p : {Parameters{}, Parameters::paper()}) {
    p.sor.mean_k = 33;
    p.surface.spacing = 0.1 + 0.2;
    p.icp.kernel = RobustKernel::huber;
    p.split.bodies.fit.noise = 1e-4;
    const std::string yaml = io::parameters_to_yaml(p);
    const Parameters q = io::read_parameters(write(yaml));
    CHECK(io::parameters_to_yaml(q) == yaml);
    CHECK(q.surface.spacing == p.surface.spacing);
    CHECK(nlohmann::json::parse(io::parameters_to_json(q))["sor"]["mean_k"] == 33);
  }
}

TEST_CASE("absent keys keep their values, a preset sets them") {
  CHECK(io::read_parameters(write("")).sor.mean_k == 20);
  const Parameters p = io::read_parameters(write("preset: paper\nsor: {mean_k: 5}\n"));
  CHECK(p.sor.mean_k == 5);
  CHECK(p.planner == "see");
  CHECK(p.see.k() == 537);
}

TEST_CASE("mistakes are named with file, line and key") {
  CHECK(error_of("sor:\n  mean_q: 3\n").find(".yaml:2: unknown key 'sor.mean_q'") != std::string::npos);
  CHECK(error_of("max_views: 5\nmax_views: 9\n").find(".yaml:2: 'max_views' is given twice") != std::string::npos);
  CHECK(error_of("max_views: lots\n").find(".yaml:1: 'max_views'") != std::string::npos);
  CHECK(error_of("sor: 3\n").find("'sor' must be a map") != std::string::npos);
  CHECK(error_of("icp: {kernel: soft}\n").find("kernel") != std::string::npos);
  CHECK(error_of("preset: other\n").find("preset") != std::string::npos);
  CHECK(error_of("a: [1, 2\n").find("not YAML") != std::string::npos);
  CHECK_THROWS_AS(io::read_parameters("no_such_file.yaml"), FileError);
}

TEST_CASE("whole numbers are decimal, also with zeros before them") {
  CHECK(io::parameters_from_yaml("max_views: 010", "job").max_views == 10);
  CHECK(io::parameters_from_yaml("max_views: 08", "job").max_views == 8);
  CHECK(io::parameters_from_yaml("gain: {candidates: +0100}", "job").gain.candidates == 100);
  CHECK(io::parameters_from_yaml("mass: {density: 0980}", "job").mass.density == 980.0);
  for (const char* text : {"0x10", "1e1", "3.0", "2147483648x", "''", "~"})
    CHECK_THAT(error_of(std::string("max_views: ") + text + "\n"), test::says(".yaml:1: 'max_views'"));
  CHECK_THAT(error_of("max_views: 1e1\n"), test::says(".yaml:1: 'max_views': '1e1' is not a whole number"));
  CHECK_THAT(error_of("max_views: 4294967297\n"), test::says(".yaml:1: 'max_views': 4294967297 is too large"));
}

TEST_CASE("a key with dots is answered with how to write it") {
  CHECK_THAT(error_of("gain.min_gain: 0.003\n"),
             test::says(".yaml:1: unknown key 'gain.min_gain'; write gain: {min_gain: ...}"));
  CHECK_THAT(error_of("split:\n  bodies.fit.noise: 1\n"),
             test::says(".yaml:2: unknown key 'split.bodies.fit.noise'; write bodies: {fit: {noise: ...}}"));
  for (const std::string name : {"foo.bar", "gain.", ".gain", "."})
    CHECK_THAT(error_of("'" + name + "': 1\n"), !test::says("write"));
}

TEST_CASE("parameters from texts") {
  Parameters p;
  p.max_views = 7;
  CHECK(io::parameters_from_json(io::parameters_to_json(p), "job").max_views == 7);
  CHECK(io::parameters_from_yaml(io::parameters_to_yaml(p), "job").max_views == 7);
  CHECK(io::parameters_from_yaml("", "job").max_views == Parameters().max_views);
  CHECK_THROWS_WITH(io::parameters_from_json("{", "job"), test::says("job: not JSON, at byte "));
  CHECK_THROWS_WITH(io::parameters_from_json("max_views: 7", "job"), test::says("job: not JSON"));
  CHECK_THROWS_WITH(io::parameters_from_json("", "job"), test::says("job: is empty"));
  CHECK_THROWS_WITH(io::parameters_from_json("{\"max_views\": 0}", "job"),
                    test::says("job:1: 'max_views' must be at least 1, got 0"));
  CHECK_THROWS_WITH(io::parameters_from_yaml("a: [", "job"), test::says("not YAML"));
}

TEST_CASE("values out of their range are named with file, line and the whole key") {
  const auto refused = [](const std::string& text, const std::string& message) {
    CHECK_THAT(error_of(text), test::says(".yaml" + message));
  };
  refused("max_views: 0\n", ":1: 'max_views' must be at least 1, got 0");
  refused("planner: best\n", ":1: 'planner' must be gain, see, fixed or random, got best");
  refused("max_views: 3\npreset: other\n", ":2: 'preset' must be default, paper or see, got other");
  refused("max_views: 3\n\ngain:\n  dwell: 2\n  min_gain: -0.5\n",
          ":5: 'gain.min_gain' must be zero or more, got -0.5");
  refused("gain:\n  expected: {voxel: 0}\n", ":2: 'gain.expected.voxel' must be positive, got 0");
  refused("split:\n  bodies:\n    fit: {noise: 0}\n", ":3: 'split.bodies.fit.noise' must be positive, got 0");
  refused("split:\n  growing:\n    radius: 0\n", ":3: 'split.growing.radius' must be positive");
  refused("see: {radius: -1}\n", ":1: 'see.radius' must be ");
  refused("normals:\n  radius: -1\n", ":2: 'normals.radius' must be positive, got -1");
  refused("free_space: {margin: 0}\n", ":1: 'free_space.margin' must be positive, got 0");
  refused("icp: {degeneracy: 1}\n", ":1: 'icp.degeneracy' must be at least 0 and below 1, got 1");
  refused("picking:\n  contact: 0.2\n", ":2: 'picking.contact' must be from -1 to stand_off (0.12), got 0.2");
  refused("picking: {gripper_radius: 20}\n",
          ":1: 'picking.gripper_radius' must be from 0 to 1, got 20: lengths are in metres; 20 mm are 0.02");
  refused("normals: {radius: .inf}\n", ":1: 'normals.radius' must be a finite number, got inf");
  refused("split:\n  bodies:\n    min_roundness: .nan\n",
          ":3: 'split.bodies.min_roundness' must be a finite number, got nan");
}

TEST_CASE("where the key at fault is not in the file, the line is that of what encloses it") {
  CHECK_THAT(error_of("max_views: 9\nsplit:\n  bodies:\n    radius_min: 0.07\n"),
             test::says(".yaml:4: 'split.bodies.radius_max' must be from radius_min (0.07) to "));
  CHECK_THAT(error_of("gain:\n  distance_min: 0.5\n"),
             test::says(".yaml:2: 'gain.distance' must be from distance_min (0.5) to distance_max (0.55), got 0.38"));
  Parameters bad;
  bad.max_views = 0;
  CHECK_THROWS_WITH(io::read_parameters(write("planner: see\n"), bad), test::says(".yaml: 'max_views' must be "));
}

TEST_CASE("a whole struct is checked by whole keys") {
  const auto refused = [](auto&& change, const std::string& message) {
    Parameters p;
    change(p);
    CHECK_THROWS_WITH(p.check(), message);
  };
  refused([](Parameters& p) { p.gain.min_gain = -1; }, "gain.min_gain must be zero or more, got -1");
  refused([](Parameters& p) { p.split.bodies.fit.noise = 0; }, "split.bodies.fit.noise must be positive, got 0");
  refused([](Parameters& p) { p.normals.radius = 0; }, "normals.radius must be positive, got 0");
  refused([](Parameters& p) { p.split.growing.radius = 0; }, "split.growing.radius must be positive, got 0");
  refused([](Parameters& p) { p.planner = ""; }, "planner must be gain, see, fixed or random, got ");
  refused([](Parameters& p) { p.see.psi = 1000; }, "see.upsilon must be at least psi / 100000 (0.01), got 0.005");
  refused([](Parameters& p) { p.see.radius = 10; },
          "see.radius must be above 0 and below (1e8 / rho)^(1/3) (3.6840315), got 10");
  refused([](Parameters& p) { p.split.growing.smoothness = 12.0; },
          "split.growing.smoothness must be from 0 to pi (3.14159265), got 12: angles are in radians; 12 degrees are "
          "0.20943951");
  refused(
      [](Parameters& p) { p.surfels.separation = 2.4; },
      "surfels.separation must be below 20 times split.bodies.radius_max (1.2), got 2.4: lengths are in metres; 2.4 "
      "mm are 0.0024");
  Parameters p;
  CHECK_THROWS_WITH(p.expect_radii(20, 50),
                    "split.bodies.radius_min must be above 0 and at most 1, got 20: lengths are in metres; 20 mm are "
                    "0.02");
  CHECK_THROWS_WITH(p.expect_radii(0.03, 0.02),
                    "split.bodies.radius_max must be from radius_min (0.03) to 20 times radius_min (0.6), got 0.02");
  CHECK_THROWS_WITH(NormalParameters({0.0, 25}).check(), "radius must be positive, got 0");
  CHECK_NOTHROW(Parameters().check());
  CHECK_NOTHROW(Parameters::paper().check());
}

TEST_CASE("what fusion needs is gathered from its stages") {
  Parameters p;
  p.surface.spacing = 0.5;
  p.surfels.separation = 0.25;
  p.icp.min_matches = 7;
  p.free_space.margin = 0.125;
  p.register_views = false;
  const fuse::FusionParameters f = p.fusion();
  CHECK(f.surface.spacing == 0.5);
  CHECK(f.surfels.separation == 0.25);
  CHECK(f.icp.min_matches == 7);
  CHECK(f.free_space.margin == 0.125);
  CHECK_FALSE(f.register_views);
}

TEST_CASE("a radius in millimetres is refused with line and key") {
  const std::string error = error_of("split:\n  bodies:\n    radius_min: 25\n    radius_max: 45\n");
  CHECK(error.find(":3: 'split.bodies.radius_min' must be") != std::string::npos);
  CHECK(error.find("25 mm are 0.025") != std::string::npos);
}

TEST_CASE("parameter files that hold more, or other things, than parameters are refused") {
  CHECK(error_of("max_views: 3\n---\nmax_views: 4\n").find("more than one YAML document") != std::string::npos);
  CHECK(error_of("--- {max_views: 3}\n...\n").empty());
  CHECK_FALSE(error_of(",").empty());
  try {
    io::read_parameters(std::filesystem::temp_directory_path().string());
    FAIL("a folder was read as parameters");
  } catch (const FileError& e) {
    CHECK(std::string(e.what()).find("is a directory") != std::string::npos);
  }
}

TEST_CASE("expected radii set what follows from them, and only that") {
  Parameters p;
  p.expect_radii(0.03, 0.06);  // lengths of the surface stay as they are for fruit of 20 mm and more
  CHECK(p.split.bodies.radius_min == 0.03);
  CHECK(p.split.bodies.radius_max == 0.06);
  CHECK(p.surface.spacing == sensor::SurfaceParameters().spacing);
  CHECK(p.surfels.separation == fuse::SurfelParameters().separation);
  p.expect_radii(0.01, 0.02);
  CHECK(p.surface.spacing == Approx(0.5 * sensor::SurfaceParameters().spacing));
  CHECK(p.surface.smallest_radius == Approx(0.006));
  CHECK(p.surfels.separation == Approx(0.5 * fuse::SurfelParameters().separation));
  CHECK(p.surfels.agreement == Approx(0.5 * fuse::SurfelParameters().agreement));
  CHECK(p.split.bodies.min_tolerance == Approx(0.5 * BodyParameters().min_tolerance));
  p.expect_radii(0.008, 0.06);  // it is not cumulative
  CHECK(io::parameters_to_yaml(p) == io::parameters_to_yaml(Parameters{}));
  CHECK_THROWS_AS(p.expect_radii(0.0, 0.05), ParameterError);
  CHECK_THROWS_AS(p.expect_radii(0.03, 0.02), ParameterError);
  CHECK_THROWS_AS(p.expect_radii(0.01, 0.3), ParameterError);
}
