// SPDX-License-Identifier: BSD-3-Clause
// What is written is read back by another inflate, that of stb_image.
#include "io/formats/deflate.hpp"
#include "io/formats/png16.hpp"
#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

/// An image whose pixels are value(x, y).
template <typename Value>
io::GrayImage image_of(int width, int height, Value&& value) {
  io::GrayImage image;
  image.width = width;
  image.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.pixels.push_back(static_cast<std::uint16_t>(value(x, y)));
  return image;
}

void check_kept(const io::GrayImage& image) {
  const std::string bytes = io::encode_png16(image);
  const io::GrayImage again = io::decode_png16("test.png", bytes);
  CHECK(again.width == image.width);
  CHECK((again.pixels == image.pixels));
}

}  // namespace

TEST_CASE("images of every kind are read back as they were written") {
  Rng rng(7);
  const auto random = [&] { return static_cast<int>(65536.0 * rng.uniform()); };
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {3, 2}, {129, 1}, {400, 700}}) {  // up to many blocks
    check_kept(image_of(width, height, [](int, int) { return 0; }));
    check_kept(image_of(width, height, [](int, int) { return 0xABAB; }));
    check_kept(image_of(width, height, [](int x, int y) { return 3 * x + 7 * y; }));
    check_kept(image_of(width, height, [&](int, int) { return random(); }));
    check_kept(image_of(width, height, [&](int x, int) { return x / 50 % 2 ? 0 : random() / 700; }));
  }
}

TEST_CASE("runs of every length, and symbols that are far more frequent than others") {
  for (int length = 1; length < 600; length += length < 20 ? 1 : 37)
    check_kept(image_of(length + 2, 1, [&](int x, int) { return x == 0 ? 1 : x <= length ? 0x0505 : 9; }));
  // Counts that grow as Fibonacci numbers make the longest codes; they have to be shortened to 15 bits.
  std::vector<std::uint16_t> pixels;
  for (int symbol = 0, a = 1, b = 1; symbol < 24; ++symbol, std::swap(a, b), b += a)
    for (int k = 0; k < b; ++k) pixels.push_back(static_cast<std::uint16_t>(symbol << 8 | (k % 2 ? 77 : 99)));
  const int width = 100;
  pixels.resize(pixels.size() / width * width);
  check_kept({width, static_cast<int>(pixels.size()) / width, pixels});
}

TEST_CASE("a stream is short where much is equal") {
  CHECK(io::deflate(std::string(1000000, 'a')).size() < 2500);
  CHECK(io::deflate("").size() < 32);
  std::string text;
  for (std::size_t i = 0; i < 100000; ++i) text += "aaabacaaad"[i * 7 % 10];
  CHECK(io::deflate(text).size() < text.size() / 3);
}
