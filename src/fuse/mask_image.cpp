// SPDX-License-Identifier: BSD-3-Clause
#include "fuse/mask_image.hpp"

#include <agrisee/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace agrisee::fuse {
namespace {

/// Add the pixels of the ellipse that is inscribed in a box, those that no instance holds.
void fill_ellipse(const sensor::PixelBox& box, const sensor::Intrinsics& k, std::uint16_t instance,
                  std::vector<std::uint16_t>& instances) {
  const double a = 0.5 * box.width, b = 0.5 * box.height, cu = box.u + a - 0.5, cv = box.v + b - 0.5;
  const auto first = [](double x, int size) { return static_cast<int>(std::ceil(std::clamp(x, 0.0, double(size)))); };
  const auto last = [](double x, int size) { return static_cast<int>(std::floor(std::clamp(x, -1.0, size - 1.0))); };
  for (int v = first(cv - b, k.height); v <= last(cv + b, k.height); ++v)
    for (int u = first(cu - a, k.width); u <= last(cu + a, k.width); ++u) {
      const double x = (u - cu) / a, y = (v - cv) / b;
      std::uint16_t& pixel = instances[k.index(u, v)];
      if (pixel == 0 && x * x + y * y <= 1.0) pixel = instance;
    }
}

/// @throws InputError for a detection that cannot be
void check_detections(const std::vector<sensor::Detection>& detections) {
  std::set<int> known;
  for (const sensor::Detection& d : detections) {
    const auto require = [&](bool ok, const char* what) {
      if (!ok) throw InputError("detection " + std::to_string(d.instance) + ": " + what);
    };
    require(d.instance >= 1 && d.instance <= 65535, "an instance is from 1 to 65535");
    require(known.insert(d.instance).second, "is listed twice");
    require(d.score >= 0.0 && d.score <= 1.0, "a score is from 0 to 1");
    if (!d.box) continue;
    const sensor::PixelBox& b = *d.box;
    require(b.width > 0.0 && b.height > 0.0 && std::isfinite(b.u + b.width) && std::isfinite(b.v + b.height),
            "its box is empty or not finite");
  }
}

/// The detections that have a box and no mask, those with the highest score first.
std::vector<const sensor::Detection*> boxes_without_mask(const sensor::DepthFrame& frame) {
  std::vector<const sensor::Detection*> boxes;
  for (const sensor::Detection& d : frame.detections)
    if (d.box) boxes.push_back(&d);
  if (boxes.empty()) return boxes;
  std::vector<char> has_pixels(65536, 0);
  for (const std::uint16_t i : frame.instances) has_pixels[i] = 1;
  const auto has_mask = [&](const sensor::Detection* d) {
    return has_pixels[static_cast<std::size_t>(d->instance)] != 0;
  };
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(), has_mask), boxes.end());
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const sensor::Detection* a, const sensor::Detection* b) { return a->score > b->score; });
  return boxes;
}

}  // namespace

double MaskImage::distance(std::size_t pixel) const {
  const sensor::Intrinsics& k = frame->intrinsics;
  const float z = frame->depth[pixel];
  if (!sensor::DepthFrame::valid(z)) return 0.0;
  const auto width = static_cast<std::size_t>(k.width);
  return double(z) * k.ray(double(pixel % width), double(pixel / width)).norm();
}

Eigen::Vector3d MaskImage::direction(double u, double v) const {
  return (world_T_optical.linear() * frame->intrinsics.ray(u, v)).normalized();
}

std::vector<std::uint16_t> instances_of(const sensor::DepthFrame& frame) {
  check(frame);
  check_detections(frame.detections);
  std::vector<std::uint16_t> instances = frame.instances;
  if (instances.empty()) instances.assign(frame.intrinsics.size(), 0);
  for (const sensor::Detection* d : boxes_without_mask(frame))
    fill_ellipse(*d->box, frame.intrinsics, static_cast<std::uint16_t>(d->instance), instances);
  return instances;
}

MaskImage mask_image(const DetectedView& view) {
  MaskImage image;
  image.frame = view.frame;
  image.world_T_optical = view.world_T_optical;
  image.instances = instances_of(*view.frame);
  for (const sensor::Detection* d : boxes_without_mask(*view.frame))
    image.boxed.insert(static_cast<std::uint16_t>(d->instance));
  for (const sensor::Detection& d : view.frame->detections) image.found[static_cast<std::uint16_t>(d.instance)] = d;
  std::vector<std::uint32_t>* own = nullptr;  // the pixels of the last instance: neighbors mostly have the same
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < image.instances.size(); ++i) {
    const std::uint16_t instance = image.instances[i];
    if (instance == 0) continue;
    if (instance != last) own = &image.pixels[instance], last = instance;
    own->push_back(static_cast<std::uint32_t>(i));
  }
  return image;
}

}  // namespace agrisee::fuse
