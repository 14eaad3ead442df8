// SPDX-License-Identifier: BSD-3-Clause
// Colors and labels that come as further images beside a depth image.
#include <agrisee/interop/ros.hpp>

#include "catch.hpp"
#include "support/ros_messages.hpp"
#include "support/says.hpp"

using namespace agrisee;
using interop::Channels;

namespace {

constexpr std::uint32_t kWidth = 4, kHeight = 3;

/// An image of which each row ends in bytes of no meaning.
mock::Image image(const char* encoding, std::uint32_t bytes, const std::vector<std::uint8_t>& pixels) {
  mock::Image m;
  m.width = kWidth;
  m.height = kHeight;
  m.encoding = encoding;
  m.step = kWidth * bytes + 5;
  m.data.assign(std::size_t{m.step} * kHeight, 0xee);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    m.data[i / (kWidth * bytes) * m.step + i % (kWidth * bytes)] = pixels[i];
  return m;
}

mock::Image depth() { return image("16UC1", 2, std::vector<std::uint8_t>(kWidth * kHeight * 2, 2)); }

mock::CameraInfo camera() {
  mock::CameraInfo c;
  c.width = kWidth;
  c.height = kHeight;
  c.k = {4, 0, 1.5, 0, 4, 1, 0, 0, 1};
  c.p = {4, 0, 1.5, 0, 0, 4, 1, 0, 0, 0, 1, 0};
  return c;
}

/// Pixel i has red i, green 100 + i, blue 200 + i, in the order of the encoding.
mock::Image color(const std::string& encoding) {
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < static_cast<int>(kWidth * kHeight); ++i) {
    for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<std::uint8_t>(i + 100 * (encoding[0] == 'r' ? c : 2 - c)));
    if (encoding.size() == 5) pixels.push_back(0x55);
  }
  return image(encoding.c_str(), encoding.size() == 5 ? 4 : 3, pixels);
}

}  // namespace

TEST_CASE("colors of a registered image are those of the frame's pixels") {
  for (const char* encoding : {"rgb8", "bgr8", "rgba8", "bgra8"}) {
    INFO(encoding);
    const mock::Image colors = color(encoding);
    const sensor::DepthFrame frame = interop::depth_frame(depth(), camera(), true, {&colors, nullptr, 1.0});
    REQUIRE(frame.color.size() == frame.depth.size());
    for (std::size_t i = 0; i < frame.color.size(); ++i) {
      const auto red = static_cast<std::uint8_t>(i);
      CHECK((frame.color[i] == Rgb{red, static_cast<std::uint8_t>(red + 100), static_cast<std::uint8_t>(red + 200)}));
    }
    CHECK(frame.instances.empty());
    CHECK_FALSE(frame.detected);
  }
}

TEST_CASE("labels of one or two bytes, in either byte order, are the frame's instances") {
  std::vector<std::uint8_t> narrow(kWidth * kHeight, 0), little(2 * kWidth * kHeight, 0), big = little;
  narrow[3] = 7;
  narrow[5] = 2;
  little[2 * 3] = big[2 * 3 + 1] = 7;
  little[2 * 5 + 1] = big[2 * 5] = 2;  // 512
  for (const auto& [labels, second] :
       {std::pair(image("8UC1", 1, narrow), 2), std::pair(image("16UC1", 2, little), 512),
        std::pair(image("mono16", 2, big), 512), std::pair(image("mono8", 1, narrow), 2)}) {
    mock::Image message = labels;
    message.is_bigendian = message.encoding == "mono16";
    const sensor::DepthFrame frame = interop::depth_frame(depth(), camera(), true, {nullptr, &message, 0.8});
    REQUIRE(frame.instances.size() == frame.depth.size());
    CHECK(frame.instances[3] == 7);
    CHECK(frame.instances[5] == second);
    CHECK(std::count(frame.instances.begin(), frame.instances.end(), 0) == kWidth * kHeight - 2);
    CHECK(frame.detected);
    REQUIRE(frame.detections.size() == 2);
    CHECK(frame.detections[0].instance == std::min(7, second));
    CHECK(frame.detections[1].instance == std::max(7, second));
    for (const sensor::Detection& d : frame.detections) {
      CHECK(d.score == 0.8);
      CHECK(d.fruit);
    }
  }
}

TEST_CASE("a label image without labels says that a detector found nothing") {
  const mock::Image labels = image("8UC1", 1, std::vector<std::uint8_t>(kWidth * kHeight, 0));
  const sensor::DepthFrame frame = interop::depth_frame(depth(), camera(), true, {nullptr, &labels, 1.0});
  CHECK(frame.detected);
  CHECK(frame.detections.empty());
  CHECK_FALSE(interop::depth_frame(depth(), camera(), true).detected);
}

TEST_CASE("the lens's distortion is taken out of all channels alike") {
  mock::CameraInfo lens = camera();
  lens.d = {0.0, 0.0, 0.5, 0.0, 0.0};  // by up to one pixel
  std::vector<std::uint8_t> pixels, numbers;
  for (std::uint8_t i = 0; i < kWidth * kHeight; ++i) {
    pixels.insert(pixels.end(), {static_cast<std::uint8_t>(100 + i), 0});
    numbers.push_back(static_cast<std::uint8_t>(100 + i));
  }
  const mock::Image depths = image("16UC1", 2, pixels), labels = image("8UC1", 1, numbers), colors = color("rgb8");
  const sensor::DepthFrame frame = interop::depth_frame(depths, lens, false, {&colors, &labels, 1.0});
  bool moved = false;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.depth[i] == 0.0f) continue;  // beyond what the lens saw
    const auto source = static_cast<std::size_t>(std::lround(1000.0 * double(frame.depth[i]))) - 100;
    moved = moved || source != i;
    CHECK(frame.instances[i] == 100 + source);
    CHECK(frame.color[i][0] == source);
  }
  CHECK(moved);
}

TEST_CASE("images that do not fit the depth image are refused") {
  const mock::Image good_color = color("rgb8"), good_labels = image("8UC1", 1, {});
  const auto refuses = [&](const std::function<void(mock::Image&, mock::Image&, double&)>& change, const char* text) {
    mock::Image colors = good_color, labels = good_labels;
    double score = 1.0;
    change(colors, labels, score);
    INFO(text);
    const Channels<mock::Image> channels{&colors, &labels, score};
    CHECK_THROWS_AS(interop::depth_frame(depth(), camera(), true, channels), InputError);
    CHECK_THROWS_WITH(interop::depth_frame(depth(), camera(), true, channels), test::says(text));
  };
  using I = mock::Image;
  refuses([](I& c, I&, double&) { c.width = 5; }, "color: 5 x 3 pixels, but the depth image has 4 x 3");
  refuses([](I&, I& l, double&) { l.height = 2; }, "labels: 4 x 2 pixels");
  refuses([](I& c, I&, double&) { c.encoding = "mono8"; }, "rgb8 or bgr8, got 'mono8'");
  refuses([](I&, I& l, double&) { l.encoding = "32SC1"; }, "16UC1 or 8UC1, got '32SC1'");
  refuses([](I& c, I&, double&) { c.step = 11; }, "step 11 is below the row's 12");
  refuses([](I& c, I&, double&) { c.data.pop_back(); }, "step * height");
  refuses([](I&, I& l, double&) { l.data.clear(); }, "step * height");
  refuses([](I&, I&, double& score) { score = 1.1; }, "outside of 0..1");
}
