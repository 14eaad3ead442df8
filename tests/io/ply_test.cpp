// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/palette.hpp>
#include <agrisee/io/ply.hpp>

#include <clocale>
#include <fstream>
#include <limits>
#include <sys/stat.h>
#include <thread>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace ply_test {

namespace {

const auto reader = [](const std::filesystem::path& path) { return io::read_ply(path); };

Cloud some_cloud(std::size_t n) {
  Rng rng(5);
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    cloud.points.push_back((rng.direction() * 0.3).cast<float>());
    cloud.normals.push_back(rng.direction().cast<float>().normalized());
    cloud.views.push_back(static_cast<int>(rng.below(9)) - 1);
  }
  return cloud;
}

/// A binary file whose properties stand in an odd order and type, beside a face element with lists before the vertices.
std::string awkward_binary(bool big) {
  std::string out =
      std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
      "_endian 1.0\r\ncomment x y z\r\nobj_info none\r\nelement face 2\r\nproperty list uchar int vertex_indices\r\n"
      "property short flag\r\nelement vertex 3\r\nproperty double z\r\nproperty uchar quality\r\nproperty float x\r\n"
      "property int16 y\r\nproperty ushort label\r\nend_header\r\n";
  for (int face = 0; face < 2; ++face) {
    out += bytes_of<std::uint8_t>(static_cast<std::uint8_t>(3 + face), big);
    for (int i = 0; i < 3 + face; ++i) out += bytes_of<std::int32_t>(i, big);
    out += bytes_of<std::int16_t>(7, big);
  }
  for (int i = 0; i < 3; ++i)
    out += bytes_of<double>(0.5 * i, big) + bytes_of<std::uint8_t>(9, big) +
           bytes_of<float>(1.25f * static_cast<float>(i), big) +
           bytes_of<std::int16_t>(static_cast<std::int16_t>(-2 * i), big) +
           bytes_of<std::uint16_t>(static_cast<std::uint16_t>(i + 40000), big);
  return out;
}

constexpr std::size_t kMany = 20000;  // points of a file that is read in many blocks

/// A binary file of kMany points (i, 2 i, -i) with labels, behind `padding` bytes of comments and one other element.
std::string many_points(bool big, std::size_t padding = 0, const std::string& after_header = "\n") {
  std::string out = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n";
  for (std::size_t left = padding; left > 0;) {
    const std::size_t line = left < 40 ? left : 20;
    out += "comment " + std::string(line - 9, '.') + '\n';
    left -= line;
  }
  out += "element camera 3\nproperty double focus\nelement vertex " + std::to_string(kMany) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty double label\nend_header" + after_header;
  for (int i = 0; i < 3; ++i) out += bytes_of(0.5, big);
  for (std::size_t i = 0; i < kMany; ++i) {
    const auto x = static_cast<float>(i);
    for (const float c : {x, 2 * x, -x}) out += bytes_of(c, big);
    out += bytes_of(static_cast<double>(i % 7), big);
  }
  return out;
}

bool are_many_points(const io::CloudFile& file) {
  bool same = file.cloud.size() == kMany && file.instance.size() == kMany;
  for (std::size_t i = 0; same && i < kMany; ++i) {
    const auto x = static_cast<float>(i);
    same = file.cloud.points[i] == Eigen::Vector3f(x, 2 * x, -x) && file.instance[i] == static_cast<int>(i % 7);
  }
  return same;
}

std::string ascii(const std::string& body, const std::string& count = "2") {
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + body;
}

}  // namespace

TEST_CASE("cloud.ply round trip: points, normals and labels bit by bit") {
  const TempFolder folder;
  for (const std::size_t n : {0u, 1u, 2u, 5000u}) {
    Cloud cloud = some_cloud(n);
    Labels labels;
    for (std::size_t i = 0; i < n; ++i) labels.push_back(static_cast<int>(i % 4));
    io::write_ply(folder / "cloud.ply", cloud, labels);
    const io::CloudFile back = io::read_cloud(folder / "cloud.ply");
    CHECK(back.cloud.points == cloud.points);
    CHECK(back.cloud.normals == cloud.normals);
    CHECK(back.cloud.views.empty());
    CHECK(back.instance == labels);
    CHECK(back.dropped == 0);
    CHECK(back.width == n);
    CHECK(back.height == 1);
  }
}

TEST_CASE("cloud.ply has exactly the properties of the contract") {
  const TempFolder folder;
  io::write_ply(folder / "cloud.ply", some_cloud(3), {0, 1, 2});
  const std::string text = slurp(folder / "cloud.ply");
  const std::string wanted =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int "
      "instance\nend_header\n";
  const std::size_t at = text.find(wanted);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.size() == at + wanted.size() + 3 * 31);
  for (int i = 0; i < 3; ++i) {  // the color is the fruit's
    const io::Rgb rgb = io::fruit_color(i);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(static_cast<std::uint8_t>(text[at + wanted.size() + 31 * static_cast<std::size_t>(i) + 24 + c]) == rgb[c]);
  }
  CHECK(io::fruit_color(0) == io::fruit_color(-3));
  for (int a = 1; a <= 40; ++a)
    for (int b = 0; b < a; ++b) CHECK(io::fruit_color(a) != io::fruit_color(b));
}

TEST_CASE("cloud_raw.ply keeps the view of each point") {
  const TempFolder folder;
  Cloud cloud = some_cloud(4097);
  io::write_raw_ply(folder / "raw.ply", cloud);
  const io::CloudFile back = io::read_ply(folder / "raw.ply");
  CHECK(back.cloud.points == cloud.points);
  CHECK(back.cloud.views == cloud.views);
  CHECK(back.cloud.normals.empty());
  CHECK(back.instance.empty());
  CHECK(slurp(folder / "raw.ply").find("property float z\nproperty int view\nend_header\n") != std::string::npos);
  cloud.views.clear();
  io::write_raw_ply(folder / "raw.ply", cloud);
  CHECK(io::read_ply(folder / "raw.ply").cloud.views == std::vector<int>(4097, -1));
}

TEST_CASE("PLY of either byte order, any types, any order, other elements and carriage returns") {
  const TempFolder folder;
  for (const bool big : {false, true}) {
    const io::CloudFile file = io::read_cloud(folder.file("a.ply", awkward_binary(big)));
    REQUIRE(file.cloud.size() == 3);
    for (int i = 0; i < 3; ++i)
      CHECK(file.cloud.points[static_cast<std::size_t>(i)] == Eigen::Vector3f(1.25f * static_cast<float>(i),
                                                                              -2.0f * static_cast<float>(i),
                                                                              0.5f * static_cast<float>(i)));
    CHECK(file.instance == Labels{40000, 40001, 40002});
  }
}

TEST_CASE("PLY vertices that carry a list are read too") {
  const TempFolder folder;
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty list uchar float tags\n"
      "property float y\nproperty float z\nproperty int instance\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    text += bytes_of(1.0f) + bytes_of<std::uint8_t>(static_cast<std::uint8_t>(2 * i));
    for (int k = 0; k < 2 * i; ++k) text += bytes_of(99.0f);
    text += bytes_of(2.0f) + bytes_of(3.0f) + bytes_of<std::int32_t>(i);
  }
  const io::CloudFile file = io::read_ply(folder.file("a.ply", text));
  REQUIRE(file.cloud.size() == 2);
  CHECK(file.cloud.points[1] == Eigen::Vector3f(1, 2, 3));
  CHECK(file.instance == Labels{0, 1});
  CHECK_THROWS_AS(io::read_ply(folder.file("b.ply", text.substr(0, text.size() - 1))), FileError);
}

TEST_CASE("ASCII PLY: numbers as anybody writes them, in any locale") {
  const TempFolder folder;
  const std::string text =
      ascii("  1 -2.5e-3 +.5 \n\n0.1234567890123456789 1E2 123456789012345678901234567890e-30\r\n");
  for (const char* locale : {"C", "de_DE.UTF-8"}) {
    if (!std::setlocale(LC_ALL, locale)) continue;
    const Cloud cloud = io::read_ply(folder.file("a.ply", text)).cloud;
    REQUIRE(cloud.size() == 2);
    CHECK(cloud.points[0] == Eigen::Vector3f(1.0f, -0.0025f, 0.5f));
    CHECK(cloud.points[1] == Eigen::Vector3f(0.12345678901234568f, 100.0f, 0.12345678901234568f));
  }
  std::setlocale(LC_ALL, "C");
}

TEST_CASE("points that are not finite are dropped and counted, or kept when asked") {
  const TempFolder folder;
  const auto path = folder.file("a.ply", ascii("nan 1 2\n1 2 3\n1 -inf 3\n1 1e300 3\n", "4"));
  const io::CloudFile dropped = io::read_ply(path);
  REQUIRE(dropped.cloud.size() == 1);
  CHECK(dropped.cloud.points[0] == Eigen::Vector3f(1, 2, 3));
  CHECK(dropped.dropped == 3);
  const io::CloudFile kept = io::read_ply(path, io::NonFinite::keep);
  CHECK(kept.cloud.size() == 4);
  CHECK(kept.dropped == 0);
  CHECK(std::isnan(kept.cloud.points[0].x()));
}

TEST_CASE("normals are brought to unit length, unusable ones are unknown") {
  const TempFolder folder;
  const io::CloudFile file = io::read_ply(folder.file(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "normal_x\n"
      "property float normal_y\nproperty float normal_z\nend_header\n0 0 0 0 0 2\n0 0 0 nan 0 1\n0 0 0 0 0 0\n"));
  REQUIRE(file.cloud.normals.size() == 3);
  CHECK(file.cloud.normals[0] == Eigen::Vector3f(0, 0, 1));
  CHECK(file.cloud.normals[1].isZero(0));
  CHECK(file.cloud.normals[2].isZero(0));
}

TEST_CASE("PLY files that are not right are refused by name") {
  const TempFolder folder;
  const auto refuse = [&](const std::string& bytes, const std::string& what) {
    require_file_error(folder.file("bad.ply", bytes), what, reader);
  };
  require_file_error(folder / "missing.ply", "no such file", reader);
  require_file_error(folder.path(), "directory", reader);
  require_file_error(folder / "missing.xyz", "no such file", [](const auto& p) { io::read_cloud(p); });
  require_file_error(folder.file("a.txt", "no cloud\n"), "neither", [](const auto& p) { io::read_cloud(p); });
  refuse("", "empty");
  refuse("plx\n", "does not begin");
  refuse("ply\nformat ascii 1.0\n", "before 'end_header'");
  refuse("ply\nelement vertex 0\nend_header\n", "no format");
  refuse("ply\nformat ebcdic 1.0\nend_header\n", ":2: bad PLY header: unknown format 'ebcdic'");
  refuse("ply\nformat ascii 1.0\nelement vertex many\nend_header\n", ":3:");
  refuse("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", ":3:");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n", ":4: bad PLY header: unknown type");
  refuse("ply\nformat ascii 1.0\nproperty float x\nend_header\n", "before the first element");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nend_header\n1 1\n",
         "two properties");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\nend_header\n", "two elements");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n", "no properties");
  refuse("ply\nformat ascii 1.0\nfoo\nend_header\n", "unknown keyword 'foo'");
  refuse("ply\nformat ascii 1.0\nelement point 1\nproperty float x\nend_header\n1\n", "no element 'vertex'");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
         "no property 'z'");
  refuse(ascii("1 2 3\n4 5 six\n"), ":9: 'six' is not a number (z)");
  refuse(ascii("1 2 3\n4 5\n6\n"), ":9: no value for 'z'");
  refuse(ascii("1 2 3\n4 5 6 7\n"), ":9: more values");
  refuse(ascii("1 2 3\n4 5 6x\n"), ":9: '6x' is not a number");
  refuse(ascii("1.0 2.0 3.0\n"), "truncated");
  refuse(ascii("1 2 3\n", "1000000000000"), "promises 1000000000000");
  const std::string good = awkward_binary(false);
  refuse(good.substr(0, good.size() - 1), "truncated");
  refuse(
      "ply\nformat binary_little_endian 1.0\nelement vertex 100000000000\nproperty float x\nproperty float y\nproperty "
      "float z\nend_header\n0123",
      "truncated");
  refuse(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "label\n"
      "end_header\n1 2 3 0.5\n",
      "not a whole number");
}

TEST_CASE("PLY files of many blocks, with headers of any length") {
  const TempFolder folder;
  for (const bool big : {false, true}) CHECK(are_many_points(reader(folder.file("a.ply", many_points(big)))));
  // The header ends anywhere about 2 KiB, the part of a file that is read first.
  const std::string text = many_points(false);
  const std::size_t header = text.find("end_header") + std::string("end_header\n").size();
  for (std::size_t end = 2048 - 14; end <= 2048 + 14; ++end) {
    INFO(end);
    CHECK(are_many_points(reader(folder.file("a.ply", many_points(false, end - header)))));
    CHECK(are_many_points(reader(folder.file("a.ply", many_points(false, end - header, "\r\n")))));
  }
  CHECK(are_many_points(reader(folder.file("a.ply", many_points(false, 200000)))));
  CHECK(are_many_points(reader(folder.file("a.ply", many_points(false, 0, std::string(70000, ' ') + '\n')))));
}

TEST_CASE("PLY files of many blocks that are not right are refused by name") {
  const TempFolder folder;
  const std::string good = many_points(false);
  for (const std::size_t kept : {good.size() - 1, good.size() / 2, std::size_t(70000), std::size_t(2048)})
    require_file_error(folder.file("a.ply", good.substr(0, kept)), "truncated", reader);
  for (const std::size_t bad : {std::size_t(1), std::size_t(2047), std::size_t(2048), kMany - 1}) {
    std::string text = good;
    text.replace(text.size() - (kMany - bad) * 20 + 12, 8, bytes_of(0.5));
    require_file_error(folder.file("a.ply", text), "'vertex' " + std::to_string(bad) + ": a label", reader);
  }
  survive_damage(folder, "b.ply", good, reader);
}

TEST_CASE("PLY from a pipe, whose length nobody knows") {
  const TempFolder folder;
  REQUIRE(::mkfifo((folder / "pipe.ply").c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(folder / "pipe.ply", std::ios::binary) << many_points(false); });
  const io::CloudFile file = reader(folder / "pipe.ply");
  writer.join();
  CHECK(are_many_points(file));
}

TEST_CASE("damaged PLY files neither crash nor hang") {
  const TempFolder folder;
  survive_damage(folder, "a.ply", awkward_binary(false), reader);
  survive_damage(folder, "b.ply", ascii("1 2 3\n4 5 6\n"), reader);
}

TEST_CASE("writing is atomic: a failure leaves the old file and no litter") {
  const TempFolder folder;
  io::write_ply(folder / "a.ply", some_cloud(3));
  const std::string before = slurp(folder / "a.ply");
  CHECK_THROWS_AS(io::write_ply(folder / "a.ply", some_cloud(3), {1}), InputError);
  {
    io::AtomicFile file(folder / "a.ply");
    file.write("half of it");
  }
  CHECK(slurp(folder / "a.ply") == before);
  CHECK(folder.files() == 1);
  require_file_error(folder / "no/such/folder.ply", "cannot be written", [](const auto& p) { io::write_ply(p, {}); });
  require_file_error(folder.path(), "directory", [](const auto& p) { io::write_ply(p, {}); });
  CHECK(folder.files() == 1);
}

}  // namespace ply_test
