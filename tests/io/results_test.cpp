// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/ply.hpp>
#include <agrisee/io/results.hpp>

#include <limits>
#include <nlohmann/json.hpp>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace results_test {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix3d rotation(double a, double b) {
  return (Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(b, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

ScanResult some_result() {
  ScanResult r;
  for (int i = 0; i < 3; ++i) {
    View v;
    v.world_T_optical = look_along({0.1 * i, 0.1, 1.0 / 3.0}, {0.1 * i, 0.9, -0.2});
    v.target = {0.015, 0.545, 0.21};
    if (i != 1) v.joints = Joints::Constant(0.1 * i - 1.0 / 7.0);
    v.points_in = static_cast<std::size_t>(1000 + i);
    v.points_new = static_cast<std::size_t>(500 - i);
    v.plan_seconds = 0.01 * i;
    r.views.push_back(v);
  }
  r.views[2].discarded = true;
  r.views[2].discard_reason = DiscardReason::contradicts_others;
  r.bodies.too_small = 5;
  r.stop_reason = StopReason::low_gain;
  r.cluster_origin = {-0.17, 0.72, -0.02};
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    r.raw.points.push_back(rng.direction().cast<float>());
    r.raw.views.push_back(i % 3);
    if (i % 2) continue;
    r.cloud.points.push_back(r.raw.points.back());
    r.cloud.normals.push_back(rng.direction().cast<float>());
    r.labels.push_back(i % 3);
  }
  for (int i = 0; i < 2; ++i) {
    Fruit f;
    f.id = i + 1;
    f.points = static_cast<std::size_t>(100 + i);
    f.truss = i + 1;
    f.found_by = i ? "dbscan" : "region_growing";
    f.centroid = {0.1 / 3.0, -0.5, 0.2 + i};
    f.centroid_cluster = {1e-9, 2.0, 3.0};
    f.sigma = {0.01, 0.02, 1.0 / 70.0};
    f.orientation = rotation(0.3 + i, 2.0);
    if (i == 0) {
      f.growth_axis_error = 0.21;
      Body b;
      b.center = {0.03, -0.49, 0.21};
      b.radii = {0.041, 0.04, 0.035};
      b.axes = rotation(1.0, -2.5);
      b.center_covariance = Eigen::Vector3d(1e-6, 2e-6, 3e-6).asDiagonal();
      b.rms = 0.0004;
      b.completeness = 0.6;
      b.confidence = 0.9;
      b.center_covariance(0, 1) = b.center_covariance(1, 0) = 1e-7;
      b.volume = 2.4e-4;
      b.volume_error = 1.0 / 3e5;
      b.mass = 0.2352;
      b.mass_error = 0.007;
      f.body = b;
      Picking p;
      p.order = 2;
      p.reachable = true;
      p.reason = PickingReason::reachable;
      p.direction = Eigen::Vector3d(0.1, 0.9, -0.2).normalized();
      p.world_T_pre_grasp = look_along({0.03, -0.64, 1.0 / 3.0}, p.direction);
      p.joints = Joints::Constant(1.0 / 7.0);
      p.after = {2, 12};
      p.crossed = 1.0 / 700.0;
      f.picking = p;
    } else {
      f.picking = Picking{};
      f.picking->order = 3;
      f.picking->reason = PickingReason::no_body;
    }
    r.fruits.push_back(f);
  }
  r.trusses.resize(2);
  r.trusses[1].id = 2;
  r.trusses[1].fruits = {2};
  r.trusses[1].world_T_truss.translation() = Eigen::Vector3d(0.25, 0.5, 0.125);
  r.seconds.capture = 1.5;
  r.seconds.plan = 0.1;
  r.seconds.total = 2.25;
  return r;
}

io::RunInfo some_info() {
  io::RunInfo info;
  info.scene = "truss \"7\" \xC3\xA9";
  info.version = "0.1.0";
  info.time = "2026-03-21T13:07:55Z";
  info.seed = 18446744073709551615ull;
  info.threads = 2;
  info.noise = "gaussian:0.01";
  info.planner = "gain";
  info.parameters_json = R"({"sor": {"mean_k": 20}, "list": [1, 2]})";
  return info;
}

}  // namespace

TEST_CASE("a result folder holds every file of the contract and reads back") {
  const TempFolder folder;
  const ScanResult result = some_result();
  io::write_result(folder / "new/result", result, some_info());
  for (const char* name : {"cloud.ply", "cloud_raw.ply", "views.csv", "fruits.json", "fruits.csv", "run.json"})
    CHECK(std::filesystem::exists(folder / "new/result" / name));
  const auto dir = folder / "new/result";

  const io::CloudFile cloud = io::read_cloud(dir / "cloud.ply");
  CHECK(cloud.cloud.points == result.cloud.points);
  CHECK(cloud.instance == result.labels);
  CHECK(io::read_cloud(dir / "cloud_raw.ply").cloud.views == result.raw.views);

  const std::vector<View> views = io::read_views(dir / "views.csv");
  REQUIRE(views.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(views[i].world_T_optical.isApprox(result.views[i].world_T_optical, 1e-14));
    CHECK(views[i].world_T_optical.translation() == result.views[i].world_T_optical.translation());
    CHECK(views[i].target == result.views[i].target);
    CHECK(views[i].joints.has_value() == result.views[i].joints.has_value());
    if (views[i].joints) CHECK(*views[i].joints == *result.views[i].joints);
    CHECK(views[i].points_in == result.views[i].points_in);
    CHECK(views[i].points_new == result.views[i].points_new);
    CHECK(views[i].plan_seconds == result.views[i].plan_seconds);
  }

  const std::vector<Fruit> fruits = io::read_fruits(dir / "fruits.json");
  REQUIRE(fruits.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Fruit &a = fruits[i], &b = result.fruits[i];
    CHECK(a.id == b.id);
    CHECK(a.points == b.points);
    CHECK(a.truss == b.truss);
    CHECK(a.found_by == b.found_by);
    CHECK(a.centroid == b.centroid);
    CHECK(a.centroid_cluster == b.centroid_cluster);
    CHECK(a.sigma == b.sigma);
    CHECK(a.orientation.isApprox(b.orientation, 1e-14));
    CHECK(a.growth_axis_error == b.growth_axis_error);
    CHECK(a.body.has_value() == b.body.has_value());
  }
  CHECK(fruits[0].body->center == result.fruits[0].body->center);
  CHECK(fruits[0].body->radii == result.fruits[0].body->radii);
  CHECK(fruits[0].body->axes.isApprox(result.fruits[0].body->axes, 1e-14));
  CHECK(fruits[0].body->center_covariance == result.fruits[0].body->center_covariance);
  CHECK(fruits[0].body->rms == 0.0004);
  CHECK(fruits[0].body->completeness == 0.6);
  CHECK(fruits[0].body->confidence == 0.9);
  CHECK(fruits[0].body->volume == 2.4e-4);
  CHECK(fruits[0].body->volume_error == 1.0 / 3e5);
  CHECK(fruits[0].body->mass == 0.2352);
  CHECK(fruits[0].body->mass_error == 0.007);
  REQUIRE(fruits[0].picking);
  const Picking &pick = *fruits[0].picking, &written = *result.fruits[0].picking;
  CHECK(pick.order == 2);
  CHECK(pick.reachable);
  CHECK(pick.reason == PickingReason::reachable);
  CHECK(pick.direction == written.direction);
  CHECK(pick.world_T_pre_grasp.translation() == written.world_T_pre_grasp.translation());
  CHECK(pick.world_T_pre_grasp.isApprox(written.world_T_pre_grasp, 1e-14));
  CHECK(pick.joints == written.joints);
  CHECK(pick.after == written.after);
  CHECK(pick.crossed == written.crossed);
  REQUIRE(fruits[1].picking);
  CHECK(fruits[1].picking->order == 3);
  CHECK_FALSE(fruits[1].picking->reachable);
  CHECK(fruits[1].picking->reason == PickingReason::no_body);
  CHECK(fruits[1].picking->direction.isZero());
  CHECK_FALSE(fruits[1].picking->joints);

  const io::RunFile run = io::read_run(dir / "run.json");
  CHECK(run.info.scene == some_info().scene);
  CHECK(run.info.seed == some_info().seed);
  CHECK(run.info.threads == 2);
  CHECK(run.info.time == "2026-03-21T13:07:55Z");
  CHECK(run.info.frame_id == "world");
  CHECK(run.info.noise == "gaussian:0.01");
  CHECK(run.info.planner == "gain");
  CHECK(nlohmann::json::parse(run.info.parameters_json) == nlohmann::json::parse(some_info().parameters_json));
  CHECK(run.views == 3);
  CHECK(run.stop_reason == "low_gain");
  CHECK(run.merged == 50);
  CHECK(run.filtered == 25);
  CHECK(run.labelled == static_cast<std::size_t>(
                            std::count_if(result.labels.begin(), result.labels.end(), [](int l) { return l > 0; })));
  CHECK(run.seconds.capture == 1.5);
  CHECK(run.seconds.total == 2.25);
}

TEST_CASE("the text files have the contract's keys and columns") {
  const TempFolder folder;
  io::write_result(folder.path(), some_result(), some_info());
  const std::string views = slurp(folder / "views.csv");
  CHECK(views.rfind("view,x,y,z,dx,dy,dz,ox,oy,oz,qx,qy,qz,qw,q1,q2,q3,q4,q5,q6,points_in,points_new,plan_s\n0,0,0.1,0."
                    "3333333333333333,",
                    0) == 0);
  CHECK(views.find(",,,,,,,1001,499,0.01\n") != std::string::npos);  // a view without an arm
  const auto fruits = nlohmann::json::parse(slurp(folder / "fruits.json"));
  for (const char* key :
       {"id", "points", "found_by", "centroid_cluster", "centroid_world", "sigma_world", "orientation_world"})
    for (const auto& fruit : fruits) CHECK(fruit.contains(key));
  for (const char* key : {"picking_order", "picking_after", "reachable", "picking_reason"})
    for (const auto& fruit : fruits) CHECK(fruit.contains(key));
  for (const char* key :
       {"center_world", "radii", "body_orientation_world", "center_covariance_world", "completeness", "confidence",
        "volume", "volume_error", "mass", "mass_error", "growth_axis_error", "approach_direction_world",
        "pre_grasp_position_world", "pre_grasp_orientation_world", "pre_grasp_joints", "approach_crossed"}) {
    CHECK(fruits[0].contains(key));
    CHECK_FALSE(fruits[1].contains(key));
  }
  // One position: that of the body where there is one, else the centroid.
  const auto is = [](const nlohmann::json& list, double x, double y, double z) {
    for (int a = 0; a < 3; ++a)
      CHECK(list[std::size_t(a)].get<double>() == Approx(a == 0 ? x : a == 1 ? y : z).margin(1e-8));
  };
  is(fruits[0]["position_world"], 0.03, -0.49, 0.21);
  is(fruits[0]["position_cluster"], 0.03 - 0.1 / 3.0, 2.01, 3.01);
  is(fruits[1]["position_world"], 0.1 / 3.0, -0.5, 1.2);
  is(fruits[1]["position_cluster"], 0.0, 2.0, 3.0);
  const Eigen::Quaterniond q = quaternion(some_result().fruits[0].orientation);
  CHECK(fruits[0]["orientation_world"][0].get<double>() == Approx(q.x()));
  CHECK(fruits[0]["orientation_world"][3].get<double>() == Approx(q.w()));
  const auto run = nlohmann::json::parse(slurp(folder / "run.json"));
  for (const char* key : {"format_version", "scene", "version", "seed", "threads", "noise", "preset", "planner",
                          "parameters", "views", "stop_reason", "points", "seconds"})
    CHECK(run.contains(key));
  for (const char* key : {"merged", "filtered", "labelled"}) CHECK(run["points"].contains(key));
  for (const char* key : {"capture", "plan", "fuse", "filter", "normals", "segment", "locate", "total"})
    CHECK(run["seconds"].contains(key));
  CHECK(run["parameters"]["sor"]["mean_k"] == 20);
  CHECK(run["time"] == "2026-03-21T13:07:55Z");
  CHECK(run["frame_id"] == "world");
  REQUIRE(run["trusses"].size() == 2);
  CHECK(
      run["trusses"][1] ==
      nlohmann::json::parse(
          R"({"id": 2, "fruits": [2], "position_world": [0.25, 0.5, 0.125], "orientation_world": [0.0, 0.0, 0.0, 1.0]})"));
  CHECK(run["views_discarded"] == 1);
  CHECK(run["discarded_views"] == nlohmann::json::parse(R"([{"view": 2, "reason": "contradicts_others"}])"));
  CHECK(run["bodies"]["too_small"] == 5);
  CHECK_FALSE(run.contains("no_fruit"));
  CHECK(run["cluster_origin_world"] == nlohmann::json({-0.17, 0.72, -0.02}));
  const std::string table = slurp(folder / "fruits.csv");
  const std::string head = table.substr(0, table.find('\n'));
  CHECK(head.rfind("id,points,found_by,centroid_cluster_x,", 0) == 0);
  const auto commas = [](const std::string& s) { return std::count(s.begin(), s.end(), ','); };
  std::size_t lines = 0;
  for (std::size_t at = 0, end; (end = table.find('\n', at)) != std::string::npos; at = end + 1, ++lines)
    CHECK(commas(table.substr(at, end - at)) == commas(head));
  CHECK(lines == 3);
  // The cells stand under their names.
  const auto cells = [](const std::string& line) {
    std::vector<std::string> out{""};
    for (char c : line)
      if (c == ',')
        out.emplace_back();
      else
        out.back().push_back(c);
    return out;
  };
  const auto names = cells(head),
             row = cells(table.substr(head.size() + 1, table.find('\n', head.size() + 1) - head.size() - 1));
  const auto cell = [&](const char* name) {
    const auto at = std::find(names.begin(), names.end(), name);
    REQUIRE(at != names.end());
    return row.at(static_cast<std::size_t>(at - names.begin()));
  };
  CHECK(cell("volume") == "0.00024");
  CHECK(cell("mass_error") == "0.007");
  CHECK(cell("center_covariance_world_xy") == "1e-07");
  CHECK(cell("center_covariance_world_zz") == "3e-06");
  CHECK(cell("picking_order") == "2");
  CHECK(cell("picking_after") == "2 12");
  CHECK(cell("reachable") == "true");
  CHECK(cell("picking_reason") == "reachable");
  CHECK(cell("pre_grasp_position_world_y") == "-0.64");
  CHECK(cell("position_world_y") == "-0.49");
  CHECK(cell("truss") == "1");
  CHECK(cell("pre_grasp_q6") == "0.14285714285714285");
  CHECK(cell("approach_crossed") == "0.0014285714285714286");
}

TEST_CASE("every reason of a picking is read as written, and files without what is crossed are read") {
  const TempFolder folder;
  ScanResult result = some_result();
  for (int i = 0; i <= static_cast<int>(PickingReason::arm_meets_fruit); ++i) {
    result.fruits[0].picking->reason = static_cast<PickingReason>(i);
    io::write_fruits(folder / "fruits.json", result.fruits);
    CHECK(io::read_fruits(folder / "fruits.json")[0].picking->reason == static_cast<PickingReason>(i));
  }
  CHECK(std::string(to_string(PickingReason::blocked_by_surroundings)) == "blocked_by_surroundings");
  auto json = nlohmann::json::parse(io::fruits_to_json(result.fruits));
  json[0].erase("approach_crossed");
  const Picking old = *io::read_fruits(folder.file("old.json", json.dump()))[0].picking;
  CHECK(old.crossed == 0.0);
  CHECK(old.direction == result.fruits[0].picking->direction);
  result.fruits[0].picking->crossed = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(io::fruits_to_json(result.fruits), "fruit: approach_crossed is not finite");
}

TEST_CASE("equal results leave equal bytes") {
  const TempFolder a, b;
  io::write_result(a.path(), some_result(), some_info());
  io::write_result(b.path(), some_result(), some_info());
  for (const char* name : {"cloud.ply", "cloud_raw.ply", "views.csv", "fruits.json", "fruits.csv", "run.json"})
    CHECK(slurp(a / name) == slurp(b / name));
  CHECK(a.files() == 6);
}

TEST_CASE("the time is that of the clock, or the one that SOURCE_DATE_EPOCH gives") {
  const std::string now = io::utc_now();
  REQUIRE(now.size() == 20);
  CHECK(now > "2024");
  CHECK(now.back() == 'Z');
  setenv("SOURCE_DATE_EPOCH", "1774098475", 1);
  CHECK(io::utc_now() == "2026-03-21T13:07:55Z");
  setenv("SOURCE_DATE_EPOCH", "soon", 1);
  CHECK(io::utc_now() > "2024");
  unsetenv("SOURCE_DATE_EPOCH");
}

TEST_CASE("an empty result is a result") {
  const TempFolder folder;
  io::write_result(folder.path(), ScanResult{}, io::RunInfo{});
  CHECK(io::read_views(folder / "views.csv").empty());
  CHECK(io::read_fruits(folder / "fruits.json").empty());
  CHECK(io::read_cloud(folder / "cloud.ply").cloud.empty());
  CHECK(io::read_run(folder / "run.json").stop_reason == "not_stopped");
  CHECK(io::read_run(folder / "run.json").info.time.empty());
  CHECK(nlohmann::json::parse(slurp(folder / "run.json"))["no_fruit"] == why_no_fruit(ScanResult()));
}

TEST_CASE("a scan in progress leaves its views and points") {
  const TempFolder folder;
  const ScanResult result = some_result();
  for (std::size_t n = 1; n <= 3; ++n) {
    io::write_views(folder / "views.csv",
                    {result.views.begin(), result.views.begin() + static_cast<std::ptrdiff_t>(n)});
    io::write_raw_ply(folder / "cloud_raw.ply", result.raw);
    CHECK(io::read_views(folder / "views.csv").size() == n);
  }
  CHECK(folder.files() == 2);
}

TEST_CASE("a result that is not finite or does not fit together is not written") {
  const TempFolder folder;
  const auto refuse = [&](const char* what, auto&& spoil) {
    ScanResult bad = some_result();
    spoil(bad);
    INFO(what);
    CHECK_THROWS_AS(io::write_result(folder.path(), bad, some_info()), InputError);
    CHECK(folder.files() == 0);
  };
  refuse("centroid", [](ScanResult& r) { r.fruits[1].centroid.x() = kNan; });
  refuse("orientation", [](ScanResult& r) { r.fruits[1].orientation(0, 0) = kNan; });
  refuse("radii", [](ScanResult& r) { r.fruits[0].body->radii.y() = kNan; });
  refuse("confidence", [](ScanResult& r) { r.fruits[0].body->confidence = 1.0 / 0.0; });
  refuse("volume", [](ScanResult& r) { r.fruits[0].body->volume = kNan; });
  refuse("approach", [](ScanResult& r) { r.fruits[0].picking->direction.x() = kNan; });
  refuse("pre-grasp", [](ScanResult& r) { r.fruits[0].picking->world_T_pre_grasp.translation().x() = kNan; });
  refuse("pre-grasp joints", [](ScanResult& r) { (*r.fruits[0].picking->joints)[5] = kNan; });
  refuse("pose", [](ScanResult& r) { r.views[2].world_T_optical.translation().z() = kNan; });
  refuse("joints", [](ScanResult& r) { (*r.views[2].joints)[0] = kNan; });
  refuse("time", [](ScanResult& r) { r.seconds.plan = kNan; });
  refuse("labels", [](ScanResult& r) { r.labels.pop_back(); });
  refuse("normals", [](ScanResult& r) { r.cloud.normals.pop_back(); });
  refuse("views of points", [](ScanResult& r) { r.raw.views.pop_back(); });
  refuse("ids", [](ScanResult& r) { r.fruits[1].id = r.fruits[0].id; });
  std::vector<Fruit> same = some_result().fruits;
  same[1].id = same[0].id = 7;
  CHECK_THROWS_WITH(io::write_fruits(folder / "fruits.json", same), "fruits: two have the id 7");
  CHECK_THROWS_WITH(io::write_fruits_csv(folder / "fruits.csv", same), "fruits: two have the id 7");
  CHECK(folder.files() == 0);
  io::RunInfo info = some_info();
  info.parameters_json = "{";
  CHECK_THROWS_AS(io::write_result(folder.path(), some_result(), info), InputError);
  CHECK(folder.files() == 0);
  folder.file("plain", "a file");
  CHECK_THROWS_AS(io::write_result(folder / "plain", some_result(), some_info()), FileError);
}

TEST_CASE("result files that are not right are refused by name") {
  const TempFolder folder;
  io::write_result(folder.path(), some_result(), some_info());
  const auto views = [](const auto& p) { io::read_views(p); };
  const auto fruits = [](const auto& p) { io::read_fruits(p); };
  const auto run = [](const auto& p) { io::read_run(p); };
  require_file_error(folder / "none.csv", "no such file", views);
  require_file_error(folder / "none.json", "no such file", fruits);
  require_file_error(folder.path(), "directory", run);
  const std::string csv = slurp(folder / "views.csv");
  const auto spoilt = [&](std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return folder.file("bad", text.replace(at, what.size(), by));
  };
  require_file_error(folder.file("bad", ""), "empty", views);
  require_file_error(spoilt(csv, "qx", "qq"), ":1: no column 'qx'", views);
  require_file_error(spoilt(csv, "\n1,", "\n1,2,"), ":3: expected 23 cells, got 24", views);
  require_file_error(spoilt(csv, "0.3333333333333333", "third"), ":2: z: 'third' is not a number", views);
  require_file_error(spoilt(csv, ",1001,", ",many,"), ":3: points_in: 'many' is not a count", views);
  require_file_error(spoilt(csv, ",,,,,,,1001", ",1,,,,,,1001"), ":3: q2: '' is not a number", views);
  require_file_error(spoilt(csv, "\n1,", "\n2,"), ":3: view: expected 1", views);
  require_file_error(folder.file("bad", csv.substr(0, csv.size() - 12)), "cells", views);

  const std::string json = slurp(folder / "fruits.json");
  require_file_error(folder.file("bad", ""), "empty", fruits);
  require_file_error(folder.file("bad", "{"), "not JSON", fruits);
  require_file_error(folder.file("bad", "{}"), "expected a list", fruits);
  require_file_error(folder.file("bad", "[3]"), "[0]: expected an object", fruits);
  require_file_error(spoilt(json, "\"sigma_world\"", "\"sigma\""), "[0]: missing key 'sigma_world'", fruits);
  require_file_error(spoilt(json, "\"id\": 2", "\"id\": 1"), "[1].id: two fruits", fruits);
  require_file_error(spoilt(json, "\"id\": 2", "\"id\": -2"), "[1].id: expected a whole number", fruits);
  require_file_error(spoilt(json, "\"dbscan\"", "5"), "[1].found_by: expected a text", fruits);
  require_file_error(spoilt(json, "[0.041,", "[null,"), "radii[0]: expected a number", fruits);

  require_file_error(spoilt(json, "\"reachable\": true", "\"reachable\": 1"), "[0].reachable: expected true or false",
                     fruits);
  require_file_error(spoilt(json, "\"no_body\"", "\"no_mind\""), "[1].picking_reason: unknown picking reason 'no_mind'",
                     fruits);
  require_file_error(spoilt(json, "\"picking_order\": 2", "\"picking_order\": 0"),
                     "[0].picking_order: must be from 1 to 1000000", fruits);
  const std::string text = slurp(folder / "run.json");
  require_file_error(spoilt(text, "\"format_version\": 1", "\"format_version\": 2"), "only version 1", run);
  require_file_error(spoilt(text, "\"seed\"", "\"sown\""), "missing key 'seed'", run);
  require_file_error(spoilt(text, "\"fuse\"", "\"melt\""), "seconds: missing key 'fuse'", run);
  survive_damage(folder, "bad", csv, views);
  survive_damage(folder, "bad", json, fruits);
  survive_damage(folder, "bad", text, run);
}

TEST_CASE("foreign results: columns in another order, further columns and keys") {
  const TempFolder folder;
  const auto csv =
      folder.file("views.csv",
                  "note,view,plan_s,x,y,z,dx,dy,dz,ox,oy,oz,qw,qx,qy,qz,q1,q2,q3,q4,q5,q6,points_in,points_new\r\n"
                  "\"a, \"\"b\"\"\",0,0.5,1,2,3,0,0,1,4,5,6,1,0,0,0,,,,,,,7,8\r\n");
  const std::vector<View> views = io::read_views(csv);
  REQUIRE(views.size() == 1);
  CHECK(views[0].world_T_optical.translation() == Eigen::Vector3d(1, 2, 3));
  CHECK(views[0].world_T_optical.linear().isIdentity());
  CHECK(views[0].points_new == 8);
  CHECK_FALSE(views[0].joints);
  const auto fruits = io::read_fruits(folder.file(
      "fruits.json",
      R"([{"id": 3, "points": 5, "found_by": "hand", "centroid_cluster": [1, 2, 3], "centroid_world": [4, 5, 6],
      "sigma_world": [0, 0, 0], "orientation_world": [0, 0, 0, 1], "mass": 0.1, "center_world": [1, 1, 1], "radii": [3, 2, 1]}])"));
  REQUIRE(fruits.size() == 1);
  REQUIRE(fruits[0].body);
  CHECK(fruits[0].body->axes.isIdentity());
}

}  // namespace results_test
