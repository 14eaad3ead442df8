// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/pcd.hpp>

#include <limits>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace pcd_test {

namespace {

const auto reader = [](const std::filesystem::path& path) { return io::read_pcd(path); };
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   const std::string& count, int width, int height, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " +
         type + "\nCOUNT " + count + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA " + data + "\n";
}

std::string xyz_header(int width, int height, const std::string& data) {
  return header("x y z", "4 4 4", "F F F", "1 1 1", width, height, data);
}

/// LZF as simple as can be: runs as they are, but every repetition of the byte before as a copy of it.
std::string lzf(const std::string& in) {
  std::string out;
  for (std::size_t i = 0; i < in.size();) {
    std::size_t run = 0;
    while (i > 0 && i + run < in.size() && in[i + run] == in[i - 1] && run < 264) ++run;
    if (run >= 3) {
      const std::size_t length = run - 2;
      if (length < 7) {
        out += static_cast<char>(length << 5);
      } else {
        out += static_cast<char>(7 << 5);
        out += static_cast<char>(length - 7);
      }
      out += '\0';  // one back
      i += run;
    } else {
      out += '\0';  // one byte as it is
      out += in[i++];
    }
  }
  return out;
}

std::string compressed(const std::string& plain) {
  const std::string packed = lzf(plain);
  return bytes_of<std::uint32_t>(static_cast<std::uint32_t>(packed.size())) +
         bytes_of<std::uint32_t>(static_cast<std::uint32_t>(plain.size())) + packed;
}

}  // namespace

TEST_CASE("ASCII PCD, organized, with points that are not there") {
  const TempFolder folder;
  const auto path = folder.file("a.pcd", xyz_header(2, 2, "ascii") + "1 2 3\nnan nan nan\n4 5 6\n-1 0 0.5\n");
  const io::CloudFile file = io::read_cloud(path);
  REQUIRE(file.cloud.size() == 3);
  CHECK(file.dropped == 1);
  CHECK(file.width == 3);
  CHECK(file.height == 1);
  CHECK(file.cloud.points[1] == Eigen::Vector3f(4, 5, 6));
  const io::CloudFile organized = io::read_cloud(path, io::NonFinite::keep);
  REQUIRE(organized.cloud.size() == 4);
  CHECK(organized.width == 2);
  CHECK(organized.height == 2);
  CHECK(organized.cloud.points[3] == Eigen::Vector3f(-1, 0, 0.5f));
}

TEST_CASE("binary PCD with fields of any type, counts and padding") {
  const TempFolder folder;
  std::string text = header("_ z histogram y x label", "1 8 4 2 4 4", "U F F I F U", "3 1 5 1 1 1", 3, 1, "binary");
  for (int i = 0; i < 3; ++i) {
    text += "pad" + bytes_of<double>(0.25 * i);
    for (int k = 0; k < 5; ++k) text += bytes_of<float>(99.0f);
    text += bytes_of<std::int16_t>(static_cast<std::int16_t>(-i)) + bytes_of<float>(static_cast<float>(i)) +
            bytes_of<std::uint32_t>(i == 2 ? 4294967295u : static_cast<std::uint32_t>(i));
  }
  const io::CloudFile file = io::read_cloud(folder.file("a.pcd", text));
  REQUIRE(file.cloud.size() == 3);
  CHECK(file.cloud.points[2] == Eigen::Vector3f(2.0f, -2.0f, 0.5f));
  CHECK(file.instance == Labels{0, 1, -1});  // an unsigned "none" reads as -1
}

TEST_CASE("compressed PCD equals the binary one") {
  const TempFolder folder;
  Rng rng(2);
  for (const int n : {0, 1, 2, 1000}) {
    std::string rows, columns;
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < n; ++i)
      points.push_back(i % 3 ? Eigen::Vector3f(rng.direction().cast<float>()) : Eigen::Vector3f(0, kNan, 0));
    for (const auto& p : points)
      for (int a = 0; a < 3; ++a) rows += bytes_of(p[a]);
    for (int a = 0; a < 3; ++a)
      for (const auto& p : points) columns += bytes_of(p[a]);
    const io::CloudFile binary = io::read_pcd(folder.file("b.pcd", xyz_header(n, 1, "binary") + rows));
    const io::CloudFile packed =
        io::read_pcd(folder.file("c.pcd", xyz_header(n, 1, "binary_compressed") + compressed(columns)));
    CHECK(binary.cloud.points == packed.cloud.points);
    CHECK(binary.dropped == packed.dropped);
    CHECK(binary.cloud.size() + binary.dropped == static_cast<std::size_t>(n));
  }
}

TEST_CASE("LZF long copies and overlaps come out right") {
  const TempFolder folder;
  // 1000 points all at zero: one byte, then copies of 264, which overlap themselves.
  const std::string zeros(12000, '\0');
  const std::string packed = compressed(zeros);
  REQUIRE(packed.size() < 200);
  const io::CloudFile file = io::read_pcd(folder.file("a.pcd", xyz_header(1000, 1, "binary_compressed") + packed));
  REQUIRE(file.cloud.size() == 1000);
  for (const auto& p : file.cloud.points) REQUIRE(p.isZero(0));
  // A pattern further back than the byte before: "abcdefgh" literally, then 100 bytes from 8 back.
  std::string stream =
      std::string(1, 7) + "abcdefgh" + static_cast<char>(7 << 5) + static_cast<char>(100 - 2 - 7) + '\7';
  const std::string expected = [] {
    std::string s = "abcdefgh";
    while (s.size() < 108) s += s[s.size() - 8];
    return s;
  }();
  const std::string data =
      bytes_of<std::uint32_t>(static_cast<std::uint32_t>(stream.size())) + bytes_of<std::uint32_t>(108) + stream;
  const io::CloudFile pattern =
      io::read_pcd(folder.file("b.pcd", xyz_header(9, 1, "binary_compressed") + data), io::NonFinite::keep);
  REQUIRE(pattern.cloud.size() == 9);
  std::string bytes;
  for (int a = 0; a < 3; ++a)
    for (const auto& p : pattern.cloud.points) bytes += bytes_of(p[a]);
  CHECK(bytes == expected);
}

TEST_CASE("PCD files that are not right are refused by name") {
  const TempFolder folder;
  const auto refuse = [&](const std::string& bytes, const std::string& what) {
    require_file_error(folder.file("bad.pcd", bytes), what, reader);
  };
  require_file_error(folder / "missing.pcd", "no such file", reader);
  require_file_error(folder.path(), "directory", reader);
  refuse("", "empty");
  refuse("VERSION 0.7\nFIELDS x y z\n", "before 'DATA'");
  refuse("nonsense\n", ":1: bad PCD header: unknown keyword 'nonsense'");
  refuse(header("x y", "4 4", "F F", "1 1", 1, 1, "ascii") + "1 2\n", "no property 'z'");
  refuse(header("x y z", "4 4", "F F F", "1 1 1", 1, 1, "ascii") + "1 2 3\n", "differ in length");
  refuse(header("x y z", "4 4 3", "F F F", "1 1 1", 1, 1, "ascii") + "1 2 3\n", "no known type");
  refuse(header("x y x", "4 4 4", "F F F", "1 1 1", 1, 1, "ascii") + "1 2 3\n", "two fields");
  refuse(xyz_header(1, 1, "base64") + "1 2 3\n", "unknown DATA 'base64'");
  refuse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n", "neither WIDTH nor POINTS");
  refuse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 3\nDATA ascii\n1 2 3\n",
         "not WIDTH x HEIGHT");
  refuse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1000000000000\nDATA ascii\n1 2 3\n", "truncated");
  refuse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1000000000000\nDATA binary_compressed\n12345678", "truncated");
  refuse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1000000000000\nHEIGHT 1000000000000\nDATA binary\n", "too large");
  refuse(xyz_header(2, 1, "ascii") + "1 2 3\n4 5 x\n", ":13: 'x' is not a number (z)");
  refuse(xyz_header(2, 1, "ascii") + "1.25 2 3\n4 5\n", ":13: no value for 'z'");
  refuse(xyz_header(2, 1, "ascii") + "1 2 3\n4 5 6 7\n", ":13: more values");
  refuse(xyz_header(2, 1, "ascii") + "1.0 2.0 3.0\n", "truncated");
  refuse(xyz_header(2, 1, "binary") + std::string(23, '\0'), "truncated");
  refuse(xyz_header(2, 1, "binary_compressed") + "1234", "truncated");
  std::string data = compressed(std::string(24, 'a'));
  refuse(xyz_header(3, 1, "binary_compressed") + data, "hold 24 bytes");
  data[8] = '\x7f';  // a copy from before the beginning
  refuse(xyz_header(2, 1, "binary_compressed") + data, "damaged");
}

TEST_CASE("damaged PCD files neither crash nor hang") {
  const TempFolder folder;
  std::string plain;
  for (int i = 0; i < 60; ++i) plain += bytes_of(static_cast<float>(i / 7));
  survive_damage(folder, "a.pcd", xyz_header(20, 1, "binary_compressed") + compressed(plain), reader);
  survive_damage(folder, "b.pcd", xyz_header(20, 1, "binary") + plain, reader);
  survive_damage(folder, "c.pcd", xyz_header(2, 1, "ascii") + "1 2 3\n4 5 6\n", reader);
}

}  // namespace pcd_test
