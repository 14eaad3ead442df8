// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_picture.hpp>

#include <limits>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

sensor::DepthFrame frame_of(int width, int height, float z) {
  sensor::DepthFrame frame;
  frame.intrinsics.width = width;
  frame.intrinsics.height = height;
  frame.intrinsics.fx = frame.intrinsics.fy = 100.0;
  frame.depth.assign(frame.intrinsics.size(), z);
  return frame;
}

int big_endian(const std::string& bytes, std::size_t at) {
  int value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[at + i]);
  return value;
}

}  // namespace

TEST_CASE("a depth picture is a small gray PNG file whose range is that of the returns") {
  sensor::DepthFrame frame = frame_of(1024, 768, 0.0f);
  frame.depth[5] = 0.4f;
  frame.depth[1000] = 2.0f;
  frame.depth[2000] = std::numeric_limits<float>::infinity();
  frame.depth[3000] = -1.0f;
  const io::DepthPicture picture = io::depth_picture(frame);
  CHECK(picture.width == 256);
  CHECK(picture.height == 192);
  CHECK(picture.nearest == double(0.4f));
  CHECK(picture.farthest == 2.0);
  REQUIRE(picture.png.size() > 60);
  CHECK(picture.png.size() < 2000);
  CHECK(picture.png.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0);
  CHECK(big_endian(picture.png, 16) == 256);
  CHECK(big_endian(picture.png, 20) == 192);
  CHECK(picture.png[24] == 8);  // bits
  CHECK(picture.png[25] == 0);  // gray
  CHECK(picture.png.compare(picture.png.size() - 8, 4, "IEND") == 0);
  CHECK(picture.png == io::depth_picture(frame).png);
}

TEST_CASE("a few wrong returns do not widen the range of a depth picture") {
  sensor::DepthFrame frame = frame_of(100, 100, 0.5f);
  for (std::size_t i = 0; i < 5000; ++i) frame.depth[i] = 0.8f;
  const io::DepthPicture clean = io::depth_picture(frame);
  CHECK((clean.nearest == 0.5 && clean.farthest == double(0.8f)));
  for (std::size_t i = 0; i < 40; ++i) frame.depth[100 * i] = i % 2 ? 0.01f : 90.0f;
  const io::DepthPicture struck = io::depth_picture(frame);
  CHECK((struck.nearest == clean.nearest && struck.farthest == clean.farthest));
}

TEST_CASE("the range of a depth picture leaves out half a percent at either end") {
  sensor::DepthFrame frame = frame_of(100, 10, 0.0f);
  for (std::size_t i = 0; i < 1000; ++i)
    frame.depth[i * 387 % 1000] = 1.0f + static_cast<float>(i);  // 1 to 1000, mixed
  const io::DepthPicture picture = io::depth_picture(frame);
  CHECK(picture.nearest == 6.0);
  CHECK(picture.farthest == 995.0);
}

TEST_CASE("every depth image has a picture, and an impossible one a message") {
  const io::DepthPicture none = io::depth_picture(frame_of(7, 5, 0.0f), 3);
  CHECK((none.width == 3 && none.height == 2 && none.nearest == 0.0 && none.farthest == 0.0));
  const io::DepthPicture flat = io::depth_picture(frame_of(1, 1, 0.5f));
  CHECK((flat.width == 1 && flat.height == 1 && flat.nearest == 0.5 && flat.farthest == 0.5));
  CHECK(none.png != io::depth_picture(frame_of(7, 5, 0.5f), 3).png);
  const float tiny = std::numeric_limits<float>::denorm_min(), huge = std::numeric_limits<float>::max();
  sensor::DepthFrame extreme = frame_of(2, 1, tiny);
  extreme.depth[1] = huge;
  CHECK(io::depth_picture(extreme).farthest == double(huge));
  CHECK_THROWS_AS(io::depth_picture(frame_of(4, 4, 1.0f), 0), ParameterError);
  extreme.depth.pop_back();
  CHECK_THROWS_AS(io::depth_picture(extreme), InputError);
}
