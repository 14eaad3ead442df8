// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/result.hpp>

#include <algorithm>
#include <utility>

namespace agrisee {
namespace {

/// "a, b and c"
std::string listed(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += (i == 0 ? "" : i + 1 < parts.size() ? ", " : " and ") + parts[i];
  return out;
}

/// A question about the unit of a ready cloud that is larger than a plant or smaller than a fruit; empty for others.
std::string doubt_of_unit(const ScanResult& result) {
  constexpr double kPlant = 3.0, kFruit = 0.01;  // m
  if (!result.views.empty()) return "";
  const double across = bounding_box(result.raw.points).size().norm();
  if (across < kFruit) return ". All points lie within " + metres(across) + ": are their coordinates right, in metres?";
  return across > kPlant ? ". The cloud is " + metres(across) + " across: are its coordinates in metres?" : "";
}

/// That no view saw anything inside the scan volume, and why, as far as depths and distances tell.
std::string nothing_seen(const std::vector<View>& views) {
  const std::string nothing = "no view saw a point inside the scan volume";
  std::vector<double> depths, distances;
  for (const View& v : views) {
    if (v.median_depth > 0.0) depths.push_back(v.median_depth);
    if (v.volume_distance > 0.0) distances.push_back(v.volume_distance);
  }
  if (distances.empty()) return nothing;
  if (depths.empty())
    return nothing +
           ": the views show no return at all; if points were given, are they in the optical frame, with z forward?";
  const double depth = median(depths), distance = median(distances);
  constexpr double kFarthest = 20.0, kFactor = 8.0;  // m; depths of a wrong unit are off by a factor of ten or more
  std::string cause =
      "is the camera turned to it? Poses have to be world_T_optical, with z forward and y down, "
      "quaternions in the order x y z w";
  if (distance > kFarthest)
    cause = "are the poses in millimetres? They have to be in metres";
  else if (depth > kFactor * distance || kFactor * depth < distance)
    cause = "are the depths in another unit than metres (depth_scale)?";
  return nothing + ": the median depth is " + metres(depth) + ", and the sensor stood " + metres(distance) +
         " from the middle of the volume; " + cause;
}

}  // namespace

std::string discarded_views(const std::vector<View>& views) {
  const auto count = [&](DiscardReason reason) {
    std::string numbers;
    std::size_t n = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (!views[v].discarded || views[v].discard_reason != reason) continue;
      numbers += (n++ ? ", " : "") + std::to_string(v);
    }
    return std::pair(n, numbers);
  };
  std::vector<std::string> parts;
  const auto add = [&](DiscardReason reason, const char* one, const char* many) {
    const auto [n, numbers] = count(reason);
    if (n == 1) parts.push_back("view " + numbers + " " + one);
    if (n > 1) parts.push_back("views " + numbers + " " + many);
  };
  // So many hardly go wrong one by one.
  const bool many = 4 * count(DiscardReason::contradicts_others).first > views.size();
  add(DiscardReason::contradicts_others, "contradicts the others (is its pose wrong?)",
      many ? "contradict the others (is each pose that of its image, in metres, from the optical frame to world? Are "
             "the images upright? Are hand-eye transform and intrinsics right? Did the plant move between views?)"
           : "contradict the others (are their poses wrong?)");
  add(DiscardReason::repeated_frame, "repeats the frame before (is the camera frozen?)",
      "repeat the frame before (is the camera frozen?)");
  add(DiscardReason::none, "for an unknown reason", "for an unknown reason");
  const auto n = std::count_if(views.begin(), views.end(), [](const View& v) { return v.discarded; });
  if (n == 0) return "";
  return std::to_string(n) + " of " + std::to_string(views.size()) + (n == 1 ? " views was" : " views were") +
         " discarded: " + listed(parts);
}

std::string why_no_fruit(const ScanResult& result) {
  if (!result.fruits.empty()) return "";
  const auto saw = [](const View& v) { return v.points_in > 0; };
  if (result.raw.empty()) {
    if (result.views.empty() && result.stop_reason == StopReason::no_reachable_view)
      return "no view was taken: the arm can reach no view of the scan volume, or refused every one. Are the scan "
             "volume, the arm's base, the hand-eye transform and the range of the camera right, in metres?";
    if (result.views.empty()) return "there are no points: no view was taken, or the cloud has none that are finite";
    if (std::none_of(result.views.begin(), result.views.end(), saw)) return nothing_seen(result.views);
    return "every view with points inside the scan volume was discarded";
  }
  if (result.cloud.empty()) return "cleaning left none of " + std::to_string(result.raw.size()) + " points";
  const BodyCounts& n = result.bodies;
  if (n.taken == 0 && n.rejected() == 0)
    return "no round surface was found in " + std::to_string(result.cloud.size()) +
           (result.cloud.size() == 1 ? " point" : " points") + doubt_of_unit(result);
  std::vector<std::string> parts;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) parts.push_back(std::to_string(count) + " " + what);
  };
  add(n.too_small, "smaller than the expected radii");
  add(n.too_large, "larger than the expected radii, or flat");
  add(n.inside_out, "with normals that face inwards (is the position of the sensor right?)");
  add(n.little_seen, "of which too little was seen");
  add(n.contradicted, "with points inside, or through which a view looked");
  add(n.too_flat, "too flat, as leaves and stems are, or parts of something larger");
  add(n.doubtful, "too unlike a fruit, as scraps of leaves are (see min_confidence)");
  add(n.overlapping, "inside another");
  add(n.not_fitted, "that no ellipsoid fits");
  return "none of the surfaces that might be fruit is one: " + listed(parts) + doubt_of_unit(result);
}

}  // namespace agrisee
