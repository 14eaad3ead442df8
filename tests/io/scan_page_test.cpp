// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/scan_page.hpp>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace scan_page_test {

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Two fruit, `n` points on each, `views` views with an arm in the last.
ScanResult scanned(int n, int views) {
  ScanResult r;
  Rng rng(1);
  for (int id = 1; id <= 2; ++id) {
    Fruit f;
    f.id = id;
    f.found_by = "region_growing";
    f.points = static_cast<std::size_t>(n);
    Body b;
    b.center = {0.08 * id, 0.55, 0.2};
    b.radii = {0.036, 0.035, 0.034};
    if (id == 1) f.body = b;
    f.centroid = b.center;
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d d = rng.direction();
      r.cloud.points.push_back((b.center + 0.035 * d).cast<float>());
      r.cloud.normals.push_back(d.cast<float>());
      r.cloud.views.push_back(i % std::max(views, 1));
      r.labels.push_back(i % 7 ? id : 0);
    }
    r.fruits.push_back(f);
  }
  r.raw = r.cloud;
  r.raw.normals.clear();
  for (int i = 0; i < views; ++i) {
    View v;
    v.world_T_optical = look_along({0.1 * i, 0.1, 0.3}, {0.1, 0.9, -0.2});
    v.target = {0.1, 0.5, 0.2};
    if (i + 1 == views) v.joints = Joints::Constant(0.1);
    r.views.push_back(v);
  }
  return r;
}

Workcell cell() {
  Workcell w;
  w.scan_volume.min = {-0.17, 0.40, -0.02};
  w.scan_volume.max = {0.17, 0.72, 0.42};
  w.keep_out.push_back({"plant", Box{{0.0, 0.85, 0.3}, {1.2, 0.5, 1.6}}});
  w.keep_out.push_back({"cluster", Cylinder{{0.0, 0.55, 0.2}, 0.35, 0.9}});
  return w;
}

nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script id=\"data\" type=\"application/json\">";
  const std::size_t at = page.find(begin);
  REQUIRE(at != std::string::npos);
  const std::size_t from = at + begin.size(), to = page.find("</script>", from);
  return nlohmann::json::parse(page.substr(from, to - from));
}

std::string decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned group = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) out += static_cast<char>(group >> (bits -= 8) & 255u);
  }
  return out;
}

template <typename T>
std::vector<T> array_of(const nlohmann::json& text) {
  const std::string bytes = decoded(text.get<std::string>());
  std::vector<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
  return out;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("the page of a scan is complete, loads nothing and contains the result") {
  const TempFolder folder;
  const ScanResult result = scanned(500, 3);
  io::ScanHistory history;
  history.curves.push_back({"seen", {0.25, double(kNan), 0.75}});
  history.frontier.push_back({0.1f, 0.5f, 0.2f});
  io::write_scan_page(folder / "report.html", result, cell(), {}, history);
  CHECK(folder.files() == 1);
  const std::string page = slurp(folder / "report.html");
  CHECK(page.rfind("<!DOCTYPE html>", 0) == 0);
  CHECK(page.compare(page.size() - 8, 8, "</html>\n") == 0);
  CHECK(count(page, "@REPORT_DATA@") == 0);
  CHECK(page.find("default-src 'none'") != std::string::npos);
  CHECK(page.find("Three.js Authors") != std::string::npos);  // its license's condition
  for (const char* loads : {"src=\"", "src='", "href=\"", "href='", "@import", "url(", "fetch(\"http", "import(\""})
    CHECK(count(page, loads) == 0);
  CHECK(page == io::scan_page(result, cell(), {}, history));

  const nlohmann::json data = data_of(page);
  CHECK(data["run"]["format_version"] == 1);
  REQUIRE(data["fruits"].size() == 2);
  CHECK(data["fruits"][0]["radii"] == nlohmann::json({0.036, 0.035, 0.034}));
  CHECK_FALSE(data["fruits"][1].contains("radii"));
  CHECK(data["colors"]["1"] == "#e23d32");
  CHECK(data["keep_out"].size() == 2);
  REQUIRE(data["views"].size() == 3);
  CHECK_FALSE(data["views"][0].contains("arm"));
  REQUIRE(data["views"][2]["arm"].size() == data["arm_radii"].size());
  CHECK(data["curves"][0]["values"] == nlohmann::json({0.25, nullptr, 0.75}));
  CHECK(data["frontier"]["count"] == 1);

  const nlohmann::json& cloud = data["cloud"];
  REQUIRE(cloud["count"] == 1000);
  const auto q = array_of<std::uint16_t>(cloud["positions"]);
  const auto n = array_of<std::int8_t>(cloud["normals"]);
  REQUIRE(q.size() == 3000);
  REQUIRE(n.size() == 3000);
  float worst = 0.0f, turned = 0.0f;
  for (std::size_t i = 0; i < 1000; ++i)
    for (int a = 0; a < 3; ++a) {
      const std::size_t k = 3 * i + static_cast<std::size_t>(a);
      const float x = cloud["origin"][static_cast<std::size_t>(a)].get<float>() +
                      cloud["step"][static_cast<std::size_t>(a)].get<float>() * static_cast<float>(q[k]);
      worst = std::max(worst, std::abs(x - result.cloud.points[i][a]));
      turned = std::max(turned, std::abs(static_cast<float>(n[k]) / 127.0f - result.cloud.normals[i][a]));
    }
  CHECK(worst < 3e-6f);
  CHECK(turned < 0.005f);
  const auto labels = array_of<std::uint16_t>(cloud["labels"]);
  const auto views = array_of<std::int16_t>(cloud["views"]);
  REQUIRE(labels.size() == 1000);
  REQUIRE(views.size() == 1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    CHECK((int(labels[i]) == result.labels[i] && int(views[i]) == result.cloud.views[i]));
  }
}

TEST_CASE("the page draws the arm and the camera of the workcell") {
  Workcell workcell = cell();
  workcell.arm = arm::ur_model("ur10e");
  workcell.sensor.housing_radius = 0.065;
  workcell.sensor.housing_depth = 0.126;
  workcell.world_T_base.translation() = Eigen::Vector3d(0.1, -0.2, 0.7);
  ScanResult result = scanned(10, 1);
  View& view = result.views[0];
  view.joints = workcell.start;
  view.world_T_optical = optical_pose(workcell, workcell.start);
  const nlohmann::json data = data_of(io::scan_page(result, workcell, {}, {}));
  CHECK(data["arm_radii"].back() == 0.065);
  const nlohmann::json housing = data["views"][0]["arm"].back();  // its back, then its front: the optical center
  Eigen::Matrix<double, 6, 1> ends;
  for (Eigen::Index i = 0; i < 6; ++i) ends[i] = housing[static_cast<std::size_t>(i)].get<double>();
  const Eigen::Vector3d camera = view.world_T_optical.translation();
  const Eigen::Vector3d behind = camera - 0.126 * view.world_T_optical.linear().col(2);
  const Eigen::Vector3d first = ends.head<3>(), second = ends.tail<3>();
  CHECK(std::min((first - camera).norm(), (second - camera).norm()) < 1e-4);
  CHECK(std::min((first - behind).norm(), (second - behind).norm()) < 1e-4);
}

TEST_CASE("texts on the page of a scan cannot become markup") {
  ScanResult result = scanned(10, 1);
  Workcell workcell = cell();
  io::RunInfo info;
  const std::string hostile =
      "</script><script>alert(1)</script><!-- <img src=x onerror=alert(1)> \" ' & \xff\xe2\x80\xa8";
  info.scene = info.noise = info.planner = info.preset = hostile;
  info.parameters_json = R"({"</script>": "<!--"})";
  result.fruits[0].found_by = hostile;
  io::ScanHistory history;
  history.curves.push_back({hostile, {0.5}});
  const std::string page = io::scan_page(result, workcell, info, history),
                    plain = io::scan_page(scanned(10, 1), cell(), {});
  for (const char* mark : {"<script", "</script", "<!--", "<img"}) CHECK(count(page, mark) == count(plain, mark));
  const nlohmann::json data = data_of(page);
  CHECK(data["run"]["scene"].get<std::string>().rfind("</script><script>alert(1)", 0) == 0);
  CHECK(data["fruits"][0]["found_by"].get<std::string>().rfind("</script>", 0) == 0);
  CHECK(data["run"]["parameters"]["</script>"] == "<!--");
}

TEST_CASE("every valid result has a page") {
  const auto empty = data_of(io::scan_page({}, {}, {}));
  CHECK(empty["fruits"].empty());
  CHECK(empty["views"].empty());
  CHECK(empty["cloud"]["count"] == 0);
  CHECK(empty["scan_volume"].is_null());
  CHECK(data_of(io::scan_page(scanned(1, 1), cell(), {}))["views"].size() == 1);

  ScanResult odd = scanned(100, 2);
  odd.cloud.points[0].x() = kNan;
  odd.cloud.points[1].y() = std::numeric_limits<float>::infinity();
  odd.cloud.normals[2].setConstant(kNan);
  odd.labels[3] = 100000;
  odd.labels[4] = -5;
  odd.cloud.views[5] = 1000000;
  auto cloud = data_of(io::scan_page(odd, cell(), {}))["cloud"];
  CHECK(cloud["count"] == 198);
  CHECK(cloud["total"] == 200);
  CHECK(array_of<std::uint16_t>(cloud["labels"])[1] == 65535);
  odd.cloud.points[6] = {1e30f, -1e30f, 1e30f};  // single precision, then
  cloud = data_of(io::scan_page(odd, cell(), {}))["cloud"];
  CHECK_FALSE(cloud.contains("step"));
  CHECK(array_of<float>(cloud["positions"]).size() == 3 * 198);
  CHECK(array_of<float>(cloud["positions"])[3 * 4] == 1e30f);
  ScanResult same;
  same.cloud.points.assign(100, Eigen::Vector3f(0.1f, 0.5f, 0.2f));
  cloud = data_of(io::scan_page(same, {}, {}))["cloud"];
  CHECK(cloud["count"] == 100);
  CHECK(cloud["origin"][1].get<float>() == 0.5f);

  ScanResult wrong = scanned(5, 1);
  wrong.labels.pop_back();
  CHECK_THROWS_AS(io::scan_page(wrong, cell(), {}), InputError);
  wrong = scanned(5, 1);
  wrong.views[0].world_T_optical.translation().setConstant(double(kNan));
  CHECK_THROWS_AS(io::scan_page(wrong, cell(), {}), InputError);
  CHECK_THROWS_AS(io::scan_page({}, {}, {}, {}, 0), ParameterError);
  const TempFolder folder;
  require_file_error(folder / "no/report.html", "cannot be written",
                     [&](const auto& p) { io::write_scan_page(p, {}, {}, {}); });
}

TEST_CASE("the page shows a depth image of each view, and whether the scan runs") {
  sensor::DepthFrame frame;
  frame.intrinsics.width = 640;
  frame.intrinsics.height = 480;
  frame.intrinsics.fx = frame.intrinsics.fy = 500.0;
  frame.depth.assign(frame.intrinsics.size(), 3.0f);
  for (std::size_t i = 0; i < 640 * 30; ++i) frame.depth[i] = 0.3f;
  for (std::size_t u = 300; u < 309; ++u)
    for (std::size_t v = 0; v < 480; ++v) frame.depth[640 * v + u] = kNan;
  io::ScanHistory history;
  history.depth.push_back(io::depth_picture(frame));
  history.depth.push_back({});
  CHECK(history.depth[0].nearest == double(0.3f));
  CHECK(history.depth[0].farthest == 3.0);
  CHECK((history.depth[0].width == 214 && history.depth[0].height == 160));  // blocks of 3 by 3 pixels

  auto data = data_of(io::scan_page(scanned(10, 3), cell(), {}, history));
  REQUIRE(data["depth"].size() == 2);
  CHECK(data["depth"][0]["near"].get<float>() == 0.3f);
  CHECK(data["depth"][0]["far"] == 3.0);
  CHECK(data["depth"][1].is_null());
  CHECK(decoded(data["depth"][0]["png"]) == history.depth[0].png);
  CHECK_FALSE(data.contains("running"));
  history.running = true;
  CHECK(data_of(io::scan_page(scanned(10, 3), cell(), {}, history))["running"] == true);

  // Far more than a page should hold: every k-th view.
  history.depth.assign(100, {1, 1, 0.5, 1.0, std::string(100000, 'x')});
  const std::string page = io::scan_page(scanned(10, 100), cell(), {}, history);
  CHECK(page.size() < 5000000);
  data = data_of(page);
  REQUIRE(data["depth"].size() == 100);
  CHECK(decoded(data["depth"][0]["png"]) == history.depth[0].png);
  CHECK(data["depth"][1].is_null());
  CHECK(decoded(data["depth"][4]["png"]) == history.depth[0].png);
}

TEST_CASE("the page holds the table of the fruit as fruits.csv") {
  const ScanResult result = scanned(10, 1);
  const TempFolder folder;
  io::write_fruits_csv(folder / "fruits.csv", result.fruits);
  CHECK(data_of(io::scan_page(result, cell(), {}))["fruits_csv"] == slurp(folder / "fruits.csv"));
}

TEST_CASE("the page of a scan stays small") {
  CHECK(io::scan_page({}, {}, {}).size() < 800000);
  CHECK(io::scan_page(scanned(10000, 20), cell(), {}).size() < 1500000);  // 20000 points, and as many merged
  const auto data = data_of(io::scan_page(scanned(1000, 3), cell(), {}, {}, 300));
  CHECK(data["cloud"]["count"] == 286);  // every 7th
  CHECK(data["cloud"]["total"] == 2000);
  CHECK(array_of<std::uint16_t>(data["cloud"]["labels"]).size() == 286);
}

}  // namespace scan_page_test
