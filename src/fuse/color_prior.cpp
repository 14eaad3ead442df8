// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/fuse/color_prior.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace agrisee::fuse {
namespace {

/// For each pixel whether it has the color of fruit.
std::vector<char> fruit_colored(const sensor::DepthFrame& frame, const ColorPriorParameters& p) {
  std::vector<char> out;
  out.reserve(frame.color.size());
  std::unordered_map<std::uint32_t, char> known;  // images hold far fewer colors than pixels
  for (const Rgb& c : frame.color) {
    const auto key = static_cast<std::uint32_t>(c[0] << 16 | c[1] << 8 | c[2]);
    const auto [entry, added] = known.try_emplace(key);
    if (added) {
      const Eigen::Vector3d lab = to_lab(c);
      const double hue = hue_of(lab);
      entry->second = std::hypot(lab.y(), lab.z()) >= p.min_chroma && hue >= p.hue_from && hue <= p.hue_to;
    }
    out.push_back(entry->second);
  }
  return out;
}

/// The pixels about which, in 5 x 5 pixels, most are set.
std::vector<char> majority(const std::vector<char>& in, int width, int height) {
  constexpr int kReach = 2, kMost = (2 * kReach + 1) * (2 * kReach + 1) / 2;
  const auto at = [width](int u, int v) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  };
  std::vector<char> out(in.size(), 0);
  for (int v = kReach; v + kReach < height; ++v)
    for (int u = kReach; u + kReach < width; ++u) {
      int count = 0;
      for (int b = v - kReach; b <= v + kReach; ++b)
        for (int a = u - kReach; a <= u + kReach; ++a) count += in[at(a, b)];
      out[at(u, v)] = count > kMost;
    }
  return out;
}

/// A patch of the color of fruit.
struct Patch {
  std::vector<std::uint32_t> pixels;  // ascending
  double depth = 0.0;                 // mean (m); 0 without any
};

/// The patches of an image.
std::vector<Patch> patches_of(const sensor::DepthFrame& frame, std::vector<char> open, double step) {
  const int width = frame.intrinsics.width;
  std::vector<Patch> out;
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (!open[first]) continue;
    throw_if_cancelled();
    Patch patch;
    patch.pixels.push_back(static_cast<std::uint32_t>(first));
    open[first] = 0;
    double depths = 0.0, returns = 0.0;
    for (std::size_t next = 0; next < patch.pixels.size(); ++next) {
      const std::uint32_t pixel = patch.pixels[next];
      const float z = frame.depth[pixel];
      const bool valid = sensor::DepthFrame::valid(z);
      if (valid) depths += double(z), returns += 1.0;
      const int u = static_cast<int>(pixel) % width;
      const auto visit = [&](std::int64_t other) {
        if (other < 0 || other >= static_cast<std::int64_t>(open.size())) return;
        const auto o = static_cast<std::size_t>(other);
        if (!open[o]) return;
        if (valid && sensor::DepthFrame::valid(frame.depth[o]) && std::abs(double(frame.depth[o]) - double(z)) > step)
          return;
        open[o] = 0;
        patch.pixels.push_back(static_cast<std::uint32_t>(o));
      };
      if (u > 0) visit(std::int64_t{pixel} - 1);
      if (u + 1 < width) visit(std::int64_t{pixel} + 1);
      visit(std::int64_t{pixel} - width);
      visit(std::int64_t{pixel} + width);
    }
    patch.depth = returns > 0.0 ? depths / returns : 0.0;
    std::sort(patch.pixels.begin(), patch.pixels.end());
    out.push_back(std::move(patch));
  }
  return out;
}

/// How far each pixel of a patch is from its border (pixels): chamfer distance with steps of 1 and 1.4.
/// @param distance receives them at their pixels; 0 everywhere else before and after, but for those of the patch
void measure_depth(const Patch& patch, int width, std::vector<float>& distance) {
  constexpr float kFar = 1e9f, kAside = 1.0f, kCorner = 1.4f;
  const std::int64_t w = width;
  for (const std::uint32_t p : patch.pixels) distance[p] = kFar;
  const auto relax = [&](std::uint32_t p, std::int64_t offset, float step) {
    const std::int64_t other = std::int64_t{p} + offset;
    const bool inside = other >= 0 && other < static_cast<std::int64_t>(distance.size());
    distance[p] = std::min(distance[p], (inside ? distance[static_cast<std::size_t>(other)] : 0.0f) + step);
  };
  for (const std::uint32_t p : patch.pixels)
    for (const auto& [offset, step] : {std::pair(std::int64_t{-1}, kAside), std::pair(-w, kAside),
                                       std::pair(-w - 1, kCorner), std::pair(-w + 1, kCorner)})
      relax(p, offset, step);
  for (auto p = patch.pixels.rbegin(); p != patch.pixels.rend(); ++p)
    for (const auto& [offset, step] : {std::pair(std::int64_t{1}, kAside), std::pair(w, kAside),
                                       std::pair(w + 1, kCorner), std::pair(w - 1, kCorner)})
      relax(*p, offset, step);
}

/// A part of a patch: a disc in it.
struct Part {
  double u, v, radius;
};

/// Whether a patch is narrow between two parts.
bool necked(const Part& a, const Part& b, int width, const std::vector<float>& distance) {
  constexpr double kNeck = 0.85;  // of the smaller radius
  const double steps = std::max(1.0, std::ceil(std::hypot(a.u - b.u, a.v - b.v)));
  for (double i = 0.0; i <= steps; i += 1.0) {
    const long u = std::lround(a.u + i / steps * (b.u - a.u)), v = std::lround(a.v + i / steps * (b.v - a.v));
    if (double(distance[static_cast<std::size_t>(v * width + u)]) < kNeck * std::min(a.radius, b.radius)) return true;
  }
  return false;
}

/// The parts of a patch, the largest first.
/// @param least radius (pixels) of the smallest
std::vector<Part> parts_of(const Patch& patch, int width, const std::vector<float>& distance, double least) {
  constexpr double kApart = 1.3, kAlike = 0.7;  // of the larger disc's radius
  std::vector<std::uint32_t> order = patch.pixels;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return distance[a] > distance[b]; });
  std::vector<Part> parts;
  for (const std::uint32_t p : order) {
    const Part part{double(static_cast<int>(p) % width), double(static_cast<int>(p) / width), double(distance[p])};
    if (!parts.empty() && part.radius < std::max(least, kAlike * parts.front().radius)) break;
    if (std::all_of(parts.begin(), parts.end(), [&](const Part& known) {
          return std::hypot(known.u - part.u, known.v - part.v) > kApart * known.radius &&
                 necked(known, part, width, distance);
        }))
      parts.push_back(part);
  }
  return parts;
}

}  // namespace

sensor::DepthFrame detected_by_color(sensor::DepthFrame frame, const BodyParameters& bodies,
                                     const ColorPriorParameters& parameters) {
  constexpr double kStep = 0.25;  // of the largest radius
  constexpr double kPart = 0.5;   // of the smallest radius
  parameters.check();
  check(frame);
  if (frame.detected || frame.color.empty()) return frame;
  frame.detected = true;
  frame.detections.clear();
  frame.instances.assign(frame.intrinsics.size(), 0);
  const int width = frame.intrinsics.width;
  const std::vector<char> colored = majority(fruit_colored(frame, parameters), width, frame.intrinsics.height);
  std::vector<float> distance(frame.intrinsics.size(), 0.0f);
  for (const Patch& patch : patches_of(frame, colored, kStep * bodies.radius_max)) {
    if (!(patch.depth > 0.0)) continue;
    const double radius = frame.intrinsics.fx * bodies.radius_min / patch.depth;  // of the smallest fruit (pixels)
    const double least = parameters.least_disc * kPi * radius * radius;
    if (static_cast<double>(patch.pixels.size()) < least) continue;
    measure_depth(patch, width, distance);
    const std::vector<Part> parts = parts_of(patch, width, distance, kPart * radius);
    std::vector<std::vector<std::uint32_t>> pixels(parts.size());
    for (const std::uint32_t p : patch.pixels) {
      const double u = static_cast<int>(p) % width, v = static_cast<int>(p) / width;
      std::size_t best = 0;
      double deepest = -1e9;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const double deep = parts[i].radius - std::hypot(parts[i].u - u, parts[i].v - v);
        if (deep > deepest) deepest = deep, best = i;
      }
      pixels[best].push_back(p);
    }
    for (const auto& part : pixels) {
      if (static_cast<double>(part.size()) < least || frame.detections.size() >= 65535) continue;
      const int instance = static_cast<int>(frame.detections.size()) + 1;
      for (const std::uint32_t p : part) frame.instances[p] = static_cast<std::uint16_t>(instance);
      frame.detections.push_back({instance, parameters.score, true, "color", std::nullopt});
    }
    for (const std::uint32_t p : patch.pixels) distance[p] = 0.0f;
  }
  return frame;
}

}  // namespace agrisee::fuse
