// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/study/true_ripeness.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace agrisee::study {

namespace {

/// Where each class begins, and where the last ends.
std::array<double, kRipenessClasses + 1> class_limits() {
  const RipenessParameters p;
  return {0.0, p.breakers, p.turning, p.pink, p.light_red, p.red, 1.0};
}

}  // namespace

double middle_share(RipenessClass ripeness) {
  if (ripeness == RipenessClass::green) return 0.0;
  const auto limits = class_limits();
  const auto c = static_cast<std::size_t>(ripeness);
  return 0.5 * (limits[c] + limits[c + 1]);
}

std::vector<double> draw_ripeness(std::size_t fruits, Rng& rng) {
  constexpr double kBehind = 0.5, kSpread = 0.4;  // classes
  constexpr double kInner = 2.0 / 3.0;            // of a class
  const auto limits = class_limits();
  const double oldest = rng.uniform(0.5, kRipenessClasses + 1.0);
  std::vector<double> out;
  for (std::size_t i = 0; i < fruits; ++i) {
    const double stage = oldest - kBehind * static_cast<double>(i) + kSpread * rng.normal();
    const auto c = static_cast<std::size_t>(std::clamp(stage, 0.0, kRipenessClasses - 1.0));
    const double within = 0.5 + kInner * (rng.uniform() - 0.5);
    out.push_back(c == 0 ? 0.0 : limits[c] + within * (limits[c + 1] - limits[c]));
  }
  return out;
}

void ripen(Scene& scene, GroundTruth& truth, const std::vector<std::size_t>& trusses, std::uint64_t seed) {
  constexpr std::uint64_t kStream = 0x21BE;
  std::vector<double> shares;
  for (std::size_t t = 0; t < trusses.size(); ++t) {
    Rng rng(seed, kStream, t);
    for (const double share : draw_ripeness(trusses[t], rng)) shares.push_back(share);
  }
  std::size_t i = 0;
  for (Object& object : scene.objects)
    if (object.cls == ObjectClass::fruit) object.ripeness = shares.at(i++);
  for (std::size_t f = 0; f < truth.fruits.size(); ++f) truth.fruits[f].ripeness = shares.at(f);
}

std::vector<RipenessMetrics> judge_ripeness(const GroundTruth& truth, const Metrics& metrics,
                                            const std::vector<Fruit>& found) {
  std::vector<RipenessMetrics> out;
  for (const TrueFruit& real : truth.fruits) {
    const auto match = std::find_if(metrics.fruits.begin(), metrics.fruits.end(),
                                    [&](const FruitMetrics& m) { return m.id == real.id && m.detected; });
    if (!real.ripeness || match == metrics.fruits.end()) continue;
    for (const Fruit& f : found)
      if (f.id == match->instance && f.ripeness)
        out.push_back({real.id, *real.ripeness, class_of(*real.ripeness), f.ripeness->ripe_share, f.ripeness->grade,
                       f.ripeness->probability});
  }
  return out;
}

RipenessSummary summarize(const std::vector<RipenessMetrics>& fruits) {
  RipenessSummary out;
  out.judged = static_cast<int>(fruits.size());
  const double each = 1.0 / std::max(1.0, static_cast<double>(fruits.size()));
  for (const RipenessMetrics& f : fruits) {
    out.right += f.off() == 0 ? each : 0.0;
    out.adjacent += f.off() == 1 ? each : 0.0;
    out.share_error += each * std::abs(f.found_share - f.real_share);
  }
  return out;
}

}  // namespace agrisee::study
