// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/missing_file.hpp>

#include <limits>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace depth_image_test {

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A frame of 40 x 30 pixels: a slope, with holes.
sensor::DepthFrame some_frame() {
  sensor::DepthFrame frame;
  frame.intrinsics = {40, 30, 35.0, 36.0, 19.5, 14.5};
  for (std::size_t i = 0; i < frame.intrinsics.size(); ++i)
    frame.depth.push_back(i % 7 == 0 ? 0.0f : 0.4f + 0.000317f * static_cast<float>(i));
  return frame;
}

io::DepthImage load(const std::filesystem::path& path) { return io::read_depth_image(path); }

/// An NPY file as numpy writes it.
std::string npy(const std::string& type, const std::string& shape, const std::string& data, bool fortran = false) {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
  header += std::string(64 - (10 + header.size() + 1) % 64, ' ') + "\n";
  return std::string("\x93NUMPY\1\0", 8) + bytes_of(static_cast<std::uint16_t>(header.size())) + header + data;
}

std::string from_hex(const std::string& digits) {
  std::string out;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    out += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return out;
}

const std::string kPngBegin = "89504e470d0a1a0a0000000d49484452", kPngEnd = "0000000049454e44ae426082";

}  // namespace

TEST_CASE("a depth image in NPY gives the frame back bit for bit") {
  const TempFolder folder;
  const sensor::DepthFrame frame = some_frame();
  io::write_depth_npy(folder / "a.npy", frame);
  const io::DepthImage image = io::read_depth_image(folder / "a.npy");
  CHECK(image.width == 40);
  CHECK(image.height == 30);
  CHECK_FALSE(image.whole_numbers);
  CHECK(io::default_depth_scale(image) == 1.0);
  CHECK(io::to_frame(image, frame.intrinsics, 1.0).depth == frame.depth);
}

TEST_CASE("a depth image in PNG gives the frame back to half a unit") {
  const TempFolder folder;
  const sensor::DepthFrame frame = some_frame();
  for (const double scale : {0.001, 0.0001}) {
    io::write_depth_png(folder / "a.png", frame, scale);
    const io::DepthImage image = io::read_depth_image(folder / "a.png");
    CHECK(image.whole_numbers);
    CHECK(io::default_depth_scale(image) == 0.001);
    const sensor::DepthFrame again = io::to_frame(image, frame.intrinsics, scale);
    REQUIRE(again.depth.size() == frame.depth.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      CHECK((again.depth[i] == 0.0f) == (frame.depth[i] == 0.0f));
      worst = std::max(worst, std::abs(double(again.depth[i]) - double(frame.depth[i])));
    }
    CHECK(worst > 0.1 * scale);
    CHECK(worst <= 0.5 * scale + 1e-7);
  }
  sensor::DepthFrame far = frame;
  far.depth.assign(frame.depth.size(), 70.0f);
  far.depth[1] = -1.0f;
  far.depth[2] = kNan;
  far.depth[3] = 65.534f;
  io::write_depth_png(folder / "far.png", far);
  const io::DepthImage image = io::read_depth_image(folder / "far.png");
  CHECK(image.values[0] == 0.0f);
  CHECK(image.values[1] == 0.0f);
  CHECK(image.values[2] == 0.0f);
  CHECK(image.values[3] == 65534.0f);
  CHECK_THROWS_AS(io::write_depth_png(folder / "x.png", frame, 0.0), ParameterError);
  CHECK_THROWS_AS(io::write_depth_png(folder / "x.png", sensor::DepthFrame{}), InputError);
}

TEST_CASE("numbers of every type and byte order are read from NPY") {
  const TempFolder folder;
  const auto values = [&](const std::string& type, const std::string& data) {
    return io::read_depth_image(folder.file("a.npy", npy(type, "(1, 2)", data))).values;
  };
  const std::vector<float> expected{500.0f, 650.0f};
  CHECK(values("<u2", bytes_of(std::uint16_t{500}) + bytes_of(std::uint16_t{650})) == expected);
  CHECK(values(">u2", bytes_of(std::uint16_t{500}, true) + bytes_of(std::uint16_t{650}, true)) == expected);
  CHECK(values("<i4", bytes_of(500) + bytes_of(650)) == expected);
  CHECK(values("<f8", bytes_of(500.0) + bytes_of(650.0)) == expected);
  CHECK(values(">f4", bytes_of(500.0f, true) + bytes_of(650.0f, true)) == expected);
  CHECK(io::read_depth_image(folder.file("a.npy", npy("<i8", "(1, 1)", bytes_of(std::int64_t{7})))).whole_numbers);
}

TEST_CASE("PNG images that other programs made") {  // these with Python's zlib, rows with the filters none and sub
  const TempFolder folder;
  const auto image = [&](const std::string& middle) {
    return folder.file("a.png", from_hex(kPngBegin + middle + kPngEnd));
  };
  const io::DepthImage gray = io::read_depth_image(
      image("00000002000000021000000000074d8ebb000000124944415478da636060606064647ef1471c0004e802018257cfc7"));
  CHECK(gray.width == 2);
  CHECK(gray.height == 2);
  CHECK(gray.values == std::vector<float>{0, 1, 1000, 65535});
  require_file_error(image("000000010000000108000000003a7e9b550000000a4944415478da63600500000700062d451807"),
                     "8 bits a pixel; depth needs 16", load);
  require_file_error(image("00000001000000011002000000c0e78f9d0000000c4944415478da636060044100001000041852a5e5"),
                     "color image", load);
  require_file_error(image("00003e8000003e80100000000034855c41000000094944415478da63000000010001b10db693"),
                     "too short for its size", load);
}

TEST_CASE("pixels without a return") {
  io::DepthImage image{5, 1, {0.0f, -2.0f, kNan, 65535.0f, 3.0f}, true};
  const sensor::Intrinsics k{5, 1, 1.0, 1.0, 0.0, 0.0};
  CHECK(io::to_frame(image, k, 0.5).depth == std::vector<float>{0, 0, 0, 0, 1.5f});
  image.whole_numbers = false;
  image.values[3] = std::numeric_limits<float>::infinity();
  CHECK(io::to_frame(image, k, 2.0).depth == std::vector<float>{0, 0, 0, 0, 6.0f});
  CHECK_THROWS_AS(io::to_frame(image, {4, 1, 1.0, 1.0, 0.0, 0.0}, 1.0), InputError);
}

TEST_CASE("images that are no depth images are refused") {
  const TempFolder folder;
  require_file_error(folder / "none.png", "no such file", load);
  try {
    load(folder / "none.png");
    FAIL("read a missing file");
  } catch (const io::MissingFile& e) {
    CHECK(e.path == folder / "none.png");
  }
  require_file_error(folder.file("a.png", ""), "empty", load);
  require_file_error(folder.file("a.png", "GIF89a"), "neither a PNG nor an NPY", load);
  const std::string four(16, '\0');
  require_file_error(folder.file("a.npy", npy("<f2", "(2, 2)", four)), "'<f2'", load);
  require_file_error(folder.file("a.npy", npy("|b1", "(2, 2)", four)), "float32", load);
  require_file_error(folder.file("a.npy", npy("<f4", "(4,)", four)), "shape (4,)", load);
  require_file_error(folder.file("a.npy", npy("<f4", "(0, 4)", four)), "shape (0, 4)", load);
  require_file_error(folder.file("a.npy", npy("<f4", "(2, 3)", four)), "cut off", load);
  require_file_error(folder.file("a.npy", npy("<f4", "(99999999999, 99999999999)", four)), "too large", load);
  require_file_error(folder.file("a.npy", npy("<f4", "(2, 2)", four, true)), "ascontiguousarray", load);
  require_file_error(folder.file("a.npy", npy("<f4", "[2, 2]", four)), "shape", load);

  io::write_depth_png(folder / "good.png", some_frame());
  const std::string png = slurp(folder / "good.png");
  require_file_error(folder.file("a.png", png.substr(0, png.size() - 1)), "cut off", load);
  require_file_error(folder.file("a.png", png.substr(0, 8)), "cut off", load);
  std::string damaged = png;
  damaged[png.size() / 2] = static_cast<char>(damaged[png.size() / 2] ^ 1);
  require_file_error(folder.file("a.png", damaged), "checksum", load);
  survive_damage(folder, "a.png", png, load);
  survive_damage(folder, "a.npy", npy("<f4", "(2, 2)", four), load);
}

}  // namespace depth_image_test
