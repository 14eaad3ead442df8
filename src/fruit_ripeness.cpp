// SPDX-License-Identifier: BSD-3-Clause
#include "fruit_ripeness.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace agrisee {
namespace {

/// Without the greenest share of some colors: that of the calyx, which lies on the fruit and is labeled with it.
std::vector<Rgb> without_calyx(std::vector<Rgb> colors) {
  constexpr double kCalyx = 0.04;  // of the surface
  std::vector<std::pair<double, std::size_t>> greens;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Eigen::Vector3d lab = to_lab(colors[i]);
    greens.push_back({-std::atan2(lab.z(), lab.y()) * (lab.z() > 0.0), i});  // blue and violet are no green
  }
  std::sort(greens.begin(), greens.end());
  std::vector<Rgb> out;
  for (std::size_t k = static_cast<std::size_t>(kCalyx * static_cast<double>(colors.size())); k < greens.size(); ++k)
    out.push_back(colors[greens[k].second]);
  return out;
}

/// The measured colors of the skin of a fruit (black: none).
std::vector<Rgb> skin_colors(const Cloud& cloud, const Labels& labels, int label) {
  std::vector<Rgb> colors;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (labels[i] == label && cloud.colors[i] != Rgb{0, 0, 0}) colors.push_back(cloud.colors[i]);
  return without_calyx(std::move(colors));
}

/// Share of a fruit's surface that was seen; without a body less than half, as from one side.
double share_seen(const Fruit& fruit) { return fruit.body ? fruit.body->completeness : 0.3; }

}  // namespace

void add_ripeness(ScanResult& result, const RipenessParameters& parameters) {
  if (result.cloud.colors.empty()) return;
  for (Fruit& f : result.fruits)
    f.ripeness = ripeness_of(skin_colors(result.cloud, result.labels, f.id), share_seen(f), parameters);
  for (FoundTruss& t : result.trusses) {
    std::vector<Rgb> colors;
    double seen = 0.0;
    for (const int id : t.fruits) {
      const std::vector<Rgb> own = skin_colors(result.cloud, result.labels, id);
      colors.insert(colors.end(), own.begin(), own.end());
      seen += share_seen(result.fruits[static_cast<std::size_t>(id - 1)]) / static_cast<double>(t.fruits.size());
    }
    t.ripeness = ripeness_of(colors, std::min(1.0, seen), parameters);  // a sum of shares may be rounded up
  }
}

std::optional<std::string> doubt_of_colors(const ScanResult& result, const RipenessParameters& parameters) {
  constexpr int kGray = 8;                                    // steps of 255; compression tints gray images by less
  constexpr double kBlueFrom = deg(200), kBlueTo = -deg(30);  // hue angles; blue lies about -pi/2, where they begin
  const Cloud& cloud = result.cloud;
  if (cloud.colors.empty()) return std::nullopt;
  std::size_t with_hue = 0, blue = 0;  // points of fruit
  bool gray = true;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto [least, most] = std::minmax_element(cloud.colors[i].begin(), cloud.colors[i].end());
    if (*most - *least < kGray) continue;
    gray = false;
    if (result.labels[i] == 0) continue;
    const Eigen::Vector3d lab = to_lab(cloud.colors[i]);
    if (lab.tail<2>().norm() < parameters.min_chroma) continue;
    const double hue = hue_of(lab);
    ++with_hue;
    blue += hue > kBlueFrom || hue < kBlueTo;
  }
  if (gray)
    return "the color of every point is gray or black, so nothing is known of ripeness: is the color image "
           "empty, or that of a gray camera?";
  if (2 * blue > with_hue)
    return "most of the surface of the fruit is blue: are red and blue swapped in the color image (BGR instead of "
           "RGB)? Then ripeness is wrong";
  return std::nullopt;
}

}  // namespace agrisee
