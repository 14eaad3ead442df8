// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/sensor/detection_check.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace agrisee::sensor {
namespace {

/// A connected part of a mask: its pixels, and the rectangle around them.
struct MaskPart {
  std::size_t pixels = 0;
  int u0, v0, u1, v1;

  int size() const { return std::max(u1 - u0, v1 - v0) + 1; }
  /// Whether a gap as wide as the larger of both is between them.
  bool is_far_from(const MaskPart& other) const {
    const int gap =
        std::max(std::max(u0, other.u0) - std::min(u1, other.u1), std::max(v0, other.v0) - std::min(v1, other.v1));
    return gap > std::max(size(), other.size());
  }
};

/// The parts of each instance; those with a hundredth of its pixels or less are noise.
std::map<std::uint16_t, std::vector<MaskPart>> parts_of(const DepthFrame& frame) {
  const int width = frame.intrinsics.width, height = frame.intrinsics.height;
  std::map<std::uint16_t, std::vector<MaskPart>> out;
  std::vector<char> known(frame.instances.size(), 0);
  std::vector<std::pair<int, int>> open;
  const auto visit = [&](int u, int v, std::uint16_t instance) {
    if (u < 0 || v < 0 || u >= width || v >= height) return;
    const std::size_t i = frame.intrinsics.index(u, v);
    if (known[i] || frame.instances[i] != instance) return;
    known[i] = 1;
    open.emplace_back(u, v);
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const std::uint16_t instance = frame.instances[frame.intrinsics.index(u, v)];
      if (instance == 0) continue;
      visit(u, v, instance);
      if (open.empty()) continue;
      MaskPart part{0, u, v, u, v};
      while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        ++part.pixels;
        part.u0 = std::min(part.u0, x), part.u1 = std::max(part.u1, x);
        part.v0 = std::min(part.v0, y), part.v1 = std::max(part.v1, y);
        visit(x - 1, y, instance), visit(x + 1, y, instance), visit(x, y - 1, instance), visit(x, y + 1, instance);
      }
      out[instance].push_back(part);
    }
  for (auto& [instance, parts] : out) {
    std::size_t all = 0;
    for (const MaskPart& p : parts) all += p.pixels;
    parts.erase(std::remove_if(parts.begin(), parts.end(), [all](const MaskPart& p) { return 100 * p.pixels <= all; }),
                parts.end());
  }
  return out;
}

/// The number of parts of a mask, none of them near to another.
std::size_t far_parts(const std::vector<MaskPart>& parts) {
  std::vector<const MaskPart*> apart;
  for (const MaskPart& p : parts)
    if (std::all_of(apart.begin(), apart.end(), [&](const MaskPart* other) { return p.is_far_from(*other); }))
      apart.push_back(&p);
  return apart.size();
}

/// A sentence if a detection that needs a mask has no pixel. @param masks the instances that have pixels
std::optional<std::string> doubt_of_list(const std::vector<Detection>& detections,
                                         const std::map<std::uint16_t, std::vector<MaskPart>>& masks) {
  std::size_t listed = 0, missing = 0;
  int first = 0;
  for (const Detection& d : detections) {
    ++listed;
    if (d.box || masks.count(static_cast<std::uint16_t>(d.instance))) continue;
    if (missing++ == 0) first = d.instance;
  }
  if (missing == 0) return std::nullopt;
  if (masks.empty())
    return "the masks are empty: all pixels are 0, although " + std::to_string(listed) + " detections are listed";
  return std::to_string(missing) + " of " + std::to_string(listed) + " listed detections have no pixel in the masks (" +
         std::to_string(first) + (missing > 1 ? ", for instance" : "") + "), so they are not used";
}

}  // namespace

void check_masks(const DepthFrame& frame) {
  constexpr std::size_t kMost = 1000, kFew = 20;  // instances
  constexpr double kMostEdges = 0.25;             // share of neighbors of which one belongs to another instance
  const std::set<std::uint16_t> numbers(frame.instances.begin(), frame.instances.end());
  const std::size_t count = numbers.size() - numbers.count(0);
  if (count < kFew) return;
  std::size_t neighbors = 0, differ = 0;
  for (std::size_t i = 1; i < frame.instances.size(); ++i) {
    if (i % static_cast<std::size_t>(frame.intrinsics.width) == 0) continue;
    const std::uint16_t left = frame.instances[i - 1], here = frame.instances[i];
    if (left == 0 || here == 0) continue;
    ++neighbors;
    differ += left != here;
  }
  if (count > kMost || static_cast<double>(differ) > kMostEdges * static_cast<double>(neighbors))
    throw InputError("holds " + std::to_string(count) +
                     " instances, which are no masks: is it a depth image? Each pixel has to state the number of its "
                     "instance, 0 = none");
}

std::optional<std::string> doubt_of_masks(const DepthFrame& frame) {
  constexpr double kMostOfImage = 0.6;
  if (frame.instances.empty()) return std::nullopt;
  const auto masks = parts_of(frame);
  std::size_t torn = 0, most = 0;
  std::uint16_t first = 0;
  for (const auto& [instance, parts] : masks) {
    std::size_t pixels = 0;
    for (const MaskPart& p : parts) pixels += p.pixels;
    const double share = static_cast<double>(pixels) / static_cast<double>(frame.instances.size());
    if (share > kMostOfImage)
      return "instance " + std::to_string(instance) + " of the masks covers " + percentage(share) +
             " of the image: is it the background? Its pixels have to be 0";
    const std::size_t apart = far_parts(parts);
    torn += apart > 1;
    if (apart > most) most = apart, first = instance;
  }
  if (torn == 0 || 2 * torn < masks.size()) return doubt_of_list(frame.detections, masks);
  return "instance " + std::to_string(first) + " of the masks lies in " + std::to_string(most) +
         " places far apart: does it stand for all fruit? Each fruit needs a number of its own";
}

}  // namespace agrisee::sensor
