// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/parameters.hpp>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "catch.hpp"

using namespace agrisee;

namespace {

std::string write(const std::string& text) {
  // Test cases run side by side, each in a process of its own.
  const std::string path =
      (std::filesystem::temp_directory_path() / ("parameters_test_" + std::to_string(::getpid()) + ".yaml")).string();
  std::ofstream(path) << text;
  return path;
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

TEST_CASE("absent keys keep their values; a preset sets them") {
  CHECK(io::read_parameters(write("")).sor.mean_k == 20);
  const Parameters p = io::read_parameters(write("preset: paper\nsor: {mean_k: 5}\n"));
  CHECK(p.sor.mean_k == 5);
  CHECK(p.planner == "see");
  CHECK(p.see.k() == 537);
}

TEST_CASE("mistakes are named with file, line and key") {
  CHECK(error_of("sor:\n  mean_q: 3\n").find(".yaml:2: unknown key 'sor.mean_q'") != std::string::npos);
  CHECK(error_of("max_views: lots\n").find(".yaml:1: 'max_views'") != std::string::npos);
  CHECK(error_of("sor: 3\n").find("'sor' must be a map") != std::string::npos);
  CHECK(error_of("normals: {radius: -1}\n").find("radius must be positive") != std::string::npos);
  CHECK(error_of("icp: {kernel: soft}\n").find("kernel") != std::string::npos);
  CHECK(error_of("preset: other\n").find("preset") != std::string::npos);
  CHECK(error_of("a: [1, 2\n").find("not YAML") != std::string::npos);
  CHECK_THROWS_AS(io::read_parameters("no_such_file.yaml"), FileError);
}

TEST_CASE("parameter files that hold more, or other things, than parameters are refused") {
  CHECK(error_of("normals: {radius: .inf}\n").find(".yaml:1: 'normals.radius': has to be finite, got .inf") !=
        std::string::npos);
  CHECK(error_of("split:\n  bodies:\n    min_roundness: .nan\n").find(".yaml:3: 'split.bodies.min_roundness'") !=
        std::string::npos);
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
  p.expect_radii(0.03, 0.06);  // lengths of the surface stay as they are for fruit larger than the defaults' 20 mm
  CHECK(p.split.bodies.radius_min == 0.03);
  CHECK(p.split.bodies.radius_max == 0.06);
  CHECK(p.surface.spacing == sensor::SurfaceParameters().spacing);
  CHECK(p.surfels.separation == SurfelParameters().separation);
  p.expect_radii(0.01, 0.02);
  CHECK(p.surface.spacing == Approx(0.5 * sensor::SurfaceParameters().spacing));
  CHECK(p.surface.smallest_radius == Approx(0.006));
  CHECK(p.surfels.separation == Approx(0.5 * SurfelParameters().separation));
  CHECK(p.surfels.agreement == Approx(0.5 * SurfelParameters().agreement));
  CHECK(p.split.bodies.fit.noise == Approx(0.5 * FitParameters().noise));
  p.expect_radii(0.02, 0.05);  // it is not cumulative
  CHECK(io::parameters_to_yaml(p) == io::parameters_to_yaml(Parameters{}));
  CHECK_THROWS_AS(p.expect_radii(0.0, 0.05), ParameterError);
  CHECK_THROWS_AS(p.expect_radii(0.03, 0.02), ParameterError);
  CHECK_THROWS_AS(p.expect_radii(0.01, 0.3), ParameterError);
}
