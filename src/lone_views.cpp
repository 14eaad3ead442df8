// SPDX-License-Identifier: BSD-3-Clause
#include "lone_views.hpp"

#include <agrisee/process.hpp>

#include <algorithm>

namespace agrisee {
namespace {

/// A view, and the number of fruit that it shows by itself.
struct LoneView {
  std::size_t fruits = 0, number = 0;
};

/// The views that are not discarded and show something, but at most `most`, evenly picked.
std::vector<std::size_t> some_of(const std::vector<View>& views, std::size_t most) {
  std::vector<std::size_t> all, some;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (!views[v].discarded && views[v].points_in > 0) all.push_back(v);
  const std::size_t used = std::min(most, all.size());
  for (std::size_t k = 0; k < used; ++k) some.push_back(all[k * all.size() / used]);
  return some;
}

}  // namespace

std::optional<std::string> doubt_of_agreement(const fuse::Views& map, const std::vector<View>& views,
                                              const Parameters& parameters, const Aabb& volume, std::size_t fruits,
                                              int threads) {
  constexpr std::size_t kFew = 1, kMore = 3;     // fruit of all views together; more fruit, of a view alone
  constexpr std::size_t kViews = 3, kAgree = 2;  // views that are asked, and that have to say so
  if (fruits > kFew) return std::nullopt;
  const std::vector<std::size_t> asked = some_of(views, kViews);
  if (asked.size() < kViews) return std::nullopt;
  Parameters sure = parameters;  // leaves look like fruit in single views more often than in several
  sure.split.bodies.min_confidence = std::max(sure.split.bodies.min_confidence, 0.8);
  std::vector<LoneView> lone;
  for (const std::size_t v : asked) {
    CloudOrigin origin;
    origin.viewpoint = views[v].world_T_optical.translation();
    origin.trust_viewpoint = true;
    origin.volume = volume;
    lone.push_back({process(map.alone(v), sure, origin, {}, threads).fruits.size(), v});
  }
  std::stable_sort(lone.begin(), lone.end(), [](const LoneView& a, const LoneView& b) { return a.fruits > b.fruits; });
  if (lone[kAgree - 1].fruits < fruits + kMore) return std::nullopt;
  const auto alone = [](const LoneView& v) {
    return "view " + std::to_string(v.number) + " alone shows " + std::to_string(v.fruits) + " fruit";
  };
  return alone(lone[0]) + " and " + alone(lone[1]) + ", but all views together show " + std::to_string(fruits) +
         ". If these are no curled leaves, the views do not show the plant in the same place: are the poses those of "
         "the images? Are the hand-eye transform and the depth scale right? Did the plant move?";
}

}  // namespace agrisee
