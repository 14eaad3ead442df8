// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/color_image.hpp>
#include <agrisee/io/detections.hpp>
#include <agrisee/io/pcd.hpp>
#include <agrisee/io/ply.hpp>

#include "io/formats/png_file.hpp"
#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

Cloud colored_cloud() {
  Cloud cloud;
  cloud.points = {{0.1f, 0.2f, 0.3f}, {1.0f, 2.0f, 3.0f}, {-1.0f, 0.5f, 0.25f}};
  cloud.normals.assign(3, {0.0f, 0.0f, 1.0f});
  cloud.colors = {{255, 0, 1}, {12, 200, 34}, {0, 0, 0}};
  cloud.instances = {0, 7, 3};
  return cloud;
}

void check_same(const Cloud& a, const Cloud& b) {
  CHECK(a.points == b.points);
  CHECK(a.colors == b.colors);
  CHECK(a.instances == b.instances);
}

/// A PNG of 2 x 1 pixels.
std::string png(int bits, io::PngKind kind, const std::string& row) {
  return io::png_file(2, 1, bits, kind, std::string(1, '\0') + row);
}

/// A frame of 2 x 1 pixels.
sensor::DepthFrame tiny_frame() {
  sensor::DepthFrame frame;
  frame.intrinsics = {2, 1, 10.0, 10.0, 0.5, 0.0};
  frame.depth = {1.0f, 1.0f};
  return frame;
}

}  // namespace

TEST_CASE("PLY and PCD keep measured colors and detections") {
  const TempFolder folder;
  const Cloud cloud = colored_cloud();
  io::write_ply(folder / "a.ply", cloud, {1, 0, 2});
  const io::CloudFile ply = io::read_ply(folder / "a.ply");
  check_same(ply.cloud, cloud);
  CHECK(ply.instance == Labels{1, 0, 2});
  io::write_pcd(folder / "a.pcd", cloud, {1, 0, 2});
  const io::CloudFile pcd = io::read_pcd(folder / "a.pcd");
  check_same(pcd.cloud, cloud);
  CHECK(pcd.instance == Labels{1, 0, 2});
  CHECK(pcd.cloud.normals == cloud.normals);
}

TEST_CASE("a cloud without colors is written as before, and the colors of fruit are not measured ones") {
  const TempFolder folder;
  Cloud cloud = colored_cloud();
  cloud.colors.clear();
  cloud.instances.clear();
  io::write_ply(folder / "a.ply", cloud, {1, 0, 2});
  CHECK(slurp(folder / "a.ply").find("measured") == std::string::npos);
  CHECK(slurp(folder / "a.ply").find("detection") == std::string::npos);
  CHECK(io::read_ply(folder / "a.ply").cloud.colors.empty());
}

TEST_CASE("colors of other programs are read, packed or by channel") {
  const TempFolder folder;
  const std::vector<Rgb> expected{{255, 128, 1}, {0, 51, 102}};
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  CHECK(io::read_ply(folder.file("a.ply", ply + "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                                "end_header\n0 0 0 255 128 1\n0 0 1 0 51 102\n"))
            .cloud.colors == expected);
  CHECK(io::read_ply(folder.file("b.ply", ply + "property float r\nproperty float g\nproperty float b\n"
                                                "end_header\n0 0 0 1 0.502 0.004\n0 0 1 0 0.2 0.4\n"))
            .cloud.colors == expected);
  const std::string pcd = "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n";
  CHECK(io::read_pcd(folder.file("c.pcd", pcd + "TYPE F F F U\nDATA ascii\n0 0 0 16744449\n0 0 1 13158\n"))
            .cloud.colors == expected);
  std::string body;
  for (const auto& [z, bits] : {std::pair{0.0f, 0xFFFF8001u}, {1.0f, 0xFF003366u}})  // opaque: the float is a NaN
    body += bytes_of(0.0f) + bytes_of(0.0f) + bytes_of(z) + bytes_of(bits);
  CHECK(io::read_pcd(folder.file("d.pcd", pcd + "TYPE F F F F\nDATA binary\n" + body)).cloud.colors == expected);
}

TEST_CASE("a point that is dropped takes its color with it") {
  const TempFolder folder;
  const auto read = io::read_ply(folder.file(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty "
      "uchar red\nproperty uchar green\nproperty uchar blue\nend_header\nnan 0 0 1 2 3\n0 0 1 4 5 6\n"));
  CHECK(read.dropped == 1);
  CHECK(read.cloud.colors == std::vector<Rgb>{{4, 5, 6}});
}

TEST_CASE("color and label images say what is wrong with them") {
  const TempFolder folder;
  const std::string rgb("\x01\x02\x03\x04\x05\x06"), gray8("\x01\x02"), gray16("\x01\x00\x00\x02", 4);
  const auto color = [](const std::filesystem::path& path) { return io::read_color_image(path); };
  const auto label = [](const std::filesystem::path& path) { return io::read_label_image(path); };
  CHECK(color(folder.file("c.png", png(8, io::PngKind::rgb, rgb))).pixels == std::vector<Rgb>{{1, 2, 3}, {4, 5, 6}});
  CHECK(label(folder.file("8.png", png(8, io::PngKind::gray, gray8))).labels == std::vector<std::uint16_t>{1, 2});
  CHECK(label(folder.file("16.png", png(16, io::PngKind::gray, gray16))).labels == std::vector<std::uint16_t>{256, 2});
  require_file_error(folder / "8.png", "is a gray image", color);
  require_file_error(folder.file("c16.png", png(16, io::PngKind::rgb, rgb + rgb)), "16 bits a channel", color);
  require_file_error(folder / "c.png", "one gray channel", label);
  require_file_error(folder.file("x.png", "JFIF"), "is not a PNG", color);
  require_file_error(folder / "none.png", "", label);
}

TEST_CASE("detections are read from CSV and JSON") {
  const TempFolder folder;
  const auto csv = io::read_detections(
      folder.file("a.csv", "label,class,score,box_u,box_v,box_w,box_h\n4,apple,0.9,1,2,3,4\n2,leaf,,5,6,7,8\n"));
  REQUIRE(csv.size() == 2);
  CHECK(csv[0].instance == 4);
  CHECK(csv[0].fruit);
  CHECK(csv[0].score == 0.9);
  CHECK(csv[0].box->height == 4.0);
  CHECK_FALSE(csv[1].fruit);
  CHECK(csv[1].score == 1.0);
  const auto json = io::read_detections(
      folder.file("a.json", R"([{"instance": 3, "class": "tomato", "score": 0.5}, {"box": [1,2,3,4]}])"));
  REQUIRE(json.size() == 2);
  CHECK_FALSE(json[0].box);
  CHECK(json[1].instance == 1);
  CHECK(json[1].box->width == 3.0);
  const auto read = [](const std::filesystem::path& path) { return io::read_detections(path); };
  require_file_error(folder.file("b.csv", "instance,score\n1,1.5\n"), "score: must be from 0 to 1", read);
  require_file_error(folder.file("c.csv", "instance\n1\n1\n"), "is listed twice", read);
  require_file_error(folder.file("d.csv", "instance\n0\n"), "1 to 65535", read);
  require_file_error(folder.file("e.csv", "name\nx\n"), "holds no detections", read);
  require_file_error(folder.file("f.csv", "u,v,width,height\n1,1,0,4\n"), "box: must have a width", read);
  require_file_error(folder.file("g.csv", "instance,u,v\n1,1,2\n"), "needs all of", read);
  require_file_error(folder.file("h.json", R"([{"instance": "one"}])"), "expected a number", read);
}

TEST_CASE("detections may come from a spreadsheet or with a byte order mark") {
  const TempFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text : {mark + "instance,score\r\n4,0.5\r\n", std::string("instance;score\n4;0.5\n"),
                                  mark + R"([{"instance": 4, "score": 0.5}])"}) {
    const auto read = io::read_detections(folder.file("a.csv", text));
    REQUIRE(read.size() == 1);
    CHECK(read[0].instance == 4);
    CHECK(read[0].score == 0.5);
  }
}

TEST_CASE("boxes that name no instance belong to none of the masks") {
  const TempFolder folder;
  sensor::DepthFrame frame = tiny_frame();
  io::ChannelFiles files;
  files.masks = folder.file("m.png", png(8, io::PngKind::gray, "\x01\x02"));
  files.boxes = folder.file("b.csv", "class,u,v,width,height\nleaf,0,0,1,1\napple,1,0,1,1\n");
  io::add_channels(frame, files);
  REQUIRE(frame.detections.size() == 2);
  CHECK(frame.detections[0].instance == 3);
  CHECK(frame.detections[1].instance == 4);
}

TEST_CASE("detections without a number get the lowest that none states") {
  const TempFolder folder;
  const auto numbers = [&](const std::string& name, const std::string& text, std::size_t first = 1) {
    std::vector<int> out;
    for (const sensor::Detection& d : io::read_detections(folder.file(name, text), first)) out.push_back(d.instance);
    return out;
  };
  const std::string one = R"({"box": [1, 2, 3, 4]})", two = R"({"instance": 1, "box": [5, 6, 7, 8]})";
  CHECK(numbers("a.json", "[" + one + "," + two + "]") == std::vector<int>{2, 1});
  CHECK(numbers("a.json", "[" + two + "," + one + "]") == std::vector<int>{1, 2});
  CHECK(numbers("a.json", "[" + one + "," + one + "]", 7) == std::vector<int>{7, 8});
  const std::string table = "instance,u,v,width,height\n,1,1,4,4\n5,1,1,4,4\n,1,1,4,4\n2,1,1,4,4\n,1,1,4,4\n";
  CHECK(numbers("a.csv", table) == std::vector<int>{1, 5, 3, 2, 4});
  CHECK(numbers("a.csv", table, 4) == std::vector<int>{4, 5, 6, 2, 7});
  CHECK(numbers("a.json", "[" + one + "]", 65535) == std::vector<int>{65535});
  const auto full = [](const std::filesystem::path& path) { return io::read_detections(path, 65535); };
  require_file_error(folder.file("b.json", "[" + one + "," + one + "]"), "no number up to 65535 is left", full);
}

TEST_CASE("a misspelled name of a detection is refused, other names pass") {
  const TempFolder folder;
  const auto read = [](const std::filesystem::path& path) { return io::read_detections(path); };
  const auto json = [&](const std::string& text) { return folder.file("a.json", text); };
  require_file_error(json(R"([{"instance": 1, "scor": 0.5}])"), "[0]: unknown key 'scor'; did you mean 'score'?", read);
  require_file_error(json(R"([{"instance": 1, "Class": "leaf"}])"), "did you mean 'class'?", read);
  require_file_error(json(R"([{"instanse": 1, "score": 0.5}])"), "did you mean 'instance'?", read);
  require_file_error(json(R"([{"instance": 1, "bbox": [1, 2, 3, 4]}])"), "did you mean 'box'?", read);
  require_file_error(folder.file("b.csv", "instance,scores\n1,0.5\n"), ":1: unknown column 'scores'; did you mean",
                     read);
  // What is known already is not misspelled, and detectors have keys of their own.
  CHECK(read(json(R"([{"instance": 1, "score": 0.5, "scores": [0.5], "class": "apple", "class_id": 7, "area": 3,
                       "category": "fruit", "name": "apple", "idx": 0, "x1": 3, "mask": [], "track": 2}])"))
            .size() == 1);
  CHECK(read(folder.file("c.csv", "label,confidence,Name,area,x1\n1,0.5,apple,3,4\n")).size() == 1);
}

TEST_CASE("channels are added to a frame, with what is known of their instances") {
  const TempFolder folder;
  sensor::DepthFrame frame = tiny_frame();
  io::ChannelFiles files;
  files.color = folder.file("c.png", png(8, io::PngKind::rgb, "\x01\x02\x03\x04\x05\x06"));
  files.masks = folder.file("m.png", png(8, io::PngKind::gray, "\x01\x02"));
  folder.file("m.csv", "instance,score\n2,0.25\n");
  io::add_channels(frame, files);
  CHECK(frame.color[1] == Rgb{4, 5, 6});
  CHECK(frame.instances == std::vector<std::uint16_t>{1, 2});
  CHECK(frame.detected);
  REQUIRE(frame.detections.size() == 1);
  CHECK(frame.detections[0].score == 0.25);
  sensor::DepthFrame other = tiny_frame();
  other.intrinsics.width = 1;
  other.depth.pop_back();
  CHECK_THROWS_WITH(io::add_channels(other, files), Catch::Contains("has 2 x 1 pixels, but the depth image 1 x 1"));
}

TEST_CASE("NaN is not JSON, and an error says so") {
  const TempFolder folder;
  const auto read = [](const std::filesystem::path& path) { return io::read_detections(path); };
  for (const char* value : {"NaN", "Infinity", "-Infinity"})
    require_file_error(folder.file("a.json", std::string(R"([{"instance": 1, "score": )") + value + "}]"),
                       "JSON has no NaN and no Infinity", read);
  try {
    read(folder.file("a.json", R"([{"instance": 1, "score": x}])"));
    FAIL();
  } catch (const FileError& e) {
    CHECK(std::string(e.what()).find("NaN") == std::string::npos);
  }
}

TEST_CASE("the channels of a frame that are written are read again") {
  const TempFolder folder;
  sensor::DepthFrame frame = tiny_frame();
  const io::ChannelFiles files{folder / "color.png", folder / "masks.png", {}};
  CHECK_THROWS_AS(io::write_channels(frame, files), InputError);
  CHECK_NOTHROW(io::write_channels(frame, {}));
  frame.color = {{255, 0, 1}, {12, 200, 34}};
  frame.instances = {0, 700};
  frame.detections = {{700, 0.1, true, "tomato", {}}, {3, 1.0 / 3.0, false, "", sensor::PixelBox{0.5, 0.0, 1.5, 1.0}}};
  io::write_channels(frame, files);
  sensor::DepthFrame again = tiny_frame();
  io::add_channels(again, files);
  CHECK(again.color == frame.color);
  CHECK(again.instances == frame.instances);
  REQUIRE(again.detections.size() == 2);
  CHECK(again.detections[0].name == "tomato");
  CHECK(again.detections[0].score == 0.1);
  CHECK(again.detections[1].score == 1.0 / 3.0);
  CHECK(!again.detections[1].fruit);
  CHECK(again.detections[1].box->width == 1.5);
}

TEST_CASE("boxes that are shares of the image or corners, and masks that are a depth image, are refused") {
  const TempFolder folder;
  const auto add = [](const std::filesystem::path& boxes) {
    sensor::DepthFrame frame;
    frame.intrinsics = {64, 48, 50.0, 50.0, 31.5, 23.5};
    frame.depth.assign(frame.intrinsics.size(), 1.0f);
    io::add_channels(frame, {{}, {}, boxes});
  };
  const std::string head = "u,v,width,height\n";
  CHECK_NOTHROW(add(folder.file("a.csv", head + "10,10,8,8\n30,10,8,8\n58,40,12,12\n")));
  CHECK_NOTHROW(add(folder.file("b.csv", head + "0,0,64,48\n")));
  CHECK_NOTHROW(add(folder.file("c.csv", head + "0.2,0.2,0.5,0.5\n10,10,8,8\n")));
  CHECK_NOTHROW(add(folder.file("d.csv", head)));
  require_file_error(folder.file("e.csv", head + "0.2,0.2,0.1,0.1\n0.7,0.3,0.2,0.2\n"), "normalized", add);
  require_file_error(folder.file("f.csv", head + "2,2,10,10\n40,10,50,18\n"),
                     "ends outside of the image: are the numbers corners", add);
  require_file_error(folder.file("g.csv", head + "2,2,8,8\n10,2,16,8\n2,10,8,16\n10,10,16,16\n"), "corners", add);
  CHECK_NOTHROW(add(folder.file("h.csv", head + "-5,10,8,8\n60,44,8,8\n")));
  for (const char* box : {"5000,10,8,8", "64,10,8,8", "10,48,8,8", "-9,10,8,8", "10,-8,8,8"})
    require_file_error(folder.file("i.csv", head + "10,10,8,8\n" + box + "\n"),
                       "box of detection 2 (u " + std::string(box).substr(0, std::string(box).find(',')), add);
  sensor::DepthFrame frame;
  frame.intrinsics = {64, 48, 50.0, 50.0, 31.5, 23.5};
  frame.depth.assign(frame.intrinsics.size(), 1.0f);
  std::string rows;
  for (int v = 0; v < 48; ++v) {
    rows += '\0';
    for (int u = 0; u < 64; ++u) rows += static_cast<char>(100 + u);
  }
  const auto depth = folder.file("depth.png", io::png_file(64, 48, 8, io::PngKind::gray, rows));
  CHECK_THROWS_WITH(io::add_channels(frame, {{}, depth, {}}), Catch::Contains("depth.png: holds 64 instances"));
}
