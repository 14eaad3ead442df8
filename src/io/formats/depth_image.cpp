// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/files.hpp>

#include <cmath>
#include <limits>

#include "io/formats/npy.hpp"
#include "io/formats/png16.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

constexpr float kNoReturn = 65535.0f;  // of 16 bits

DepthImage from_npy(const std::filesystem::path& path, std::string_view bytes) {
  const NpyArray array = parse_npy(path, bytes);
  if (array.shape.size() != 2)
    fail(path, "has the shape " + array.shape_text() + "; a depth image has two dimensions, rows and columns");
  if (array.fortran) fail(path, "is stored column by column; save it with numpy.ascontiguousarray");
  constexpr std::size_t kMost = 16384;
  if (array.shape[0] < 1 || array.shape[1] < 1 || array.shape[0] > kMost || array.shape[1] > kMost)
    fail(path, "has the shape " + array.shape_text() + "; 1 to " + std::to_string(kMost) + " each way are read");
  DepthImage image;
  image.height = static_cast<int>(array.shape[0]);
  image.width = static_cast<int>(array.shape[1]);
  image.whole_numbers = array.type != Scalar::f32 && array.type != Scalar::f64;
  image.values.resize(array.size());
  decode({{array.data, size_of(array.type), array.type, array.swapped, {image.values.data(), nullptr, 1}}},
         image.values.size());
  return image;
}

}  // namespace

DepthImage read_depth_image(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  if (is_npy(bytes.view())) return from_npy(path, bytes.view());
  if (!is_png(bytes.view())) fail(path, "is neither a PNG nor an NPY file");
  const GrayImage gray = decode_png16(path, bytes.view());
  DepthImage image;
  image.width = gray.width;
  image.height = gray.height;
  image.values.assign(gray.pixels.begin(), gray.pixels.end());
  image.whole_numbers = true;
  return image;
}

sensor::DepthFrame to_frame(const DepthImage& image, const sensor::Intrinsics& intrinsics, double scale) {
  check_input(
      image.width == intrinsics.width && image.height == intrinsics.height && image.values.size() == intrinsics.size(),
      "depth image: its size differs from the intrinsics");
  sensor::DepthFrame frame;
  frame.intrinsics = intrinsics;
  frame.depth.reserve(image.values.size());
  for (const float value : image.values) {
    const bool returned = sensor::DepthFrame::valid(value) && !(image.whole_numbers && value == kNoReturn);
    frame.depth.push_back(returned ? static_cast<float>(scale * double(value)) : 0.0f);
  }
  return frame;
}

void write_depth_png(const std::filesystem::path& path, const sensor::DepthFrame& frame, double scale) {
  check(frame);
  check_parameter(std::isfinite(scale) && scale > 0.0, "depth scale", "positive", scale);
  GrayImage image{frame.intrinsics.width, frame.intrinsics.height, {}};
  image.pixels.reserve(frame.depth.size());
  for (const float z : frame.depth) {
    const double units = sensor::DepthFrame::valid(z) ? std::round(double(z) / scale) : 0.0;
    image.pixels.push_back(units < double(kNoReturn) ? static_cast<std::uint16_t>(units) : std::uint16_t{0});
  }
  write_file(path, encode_png16(image));
}

void write_depth_npy(const std::filesystem::path& path, const sensor::DepthFrame& frame) {
  check(frame);
  write_file(path, npy_bytes(frame.depth, static_cast<std::size_t>(frame.intrinsics.height),
                             static_cast<std::size_t>(frame.intrinsics.width)));
}

}  // namespace agrisee::io
