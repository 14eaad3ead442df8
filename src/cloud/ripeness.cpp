// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/ripeness.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace agrisee {
namespace {

/// linear_light of each value of 8 bits.
const std::array<double, 256>& linear_table() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = linear_light(static_cast<double>(i) / 255.0);
    return t;
  }();
  return table;
}

/// The function f of CIE 15:2004, 8.2.1.
double lightness_of(double ratio) {
  constexpr double kDelta = 6.0 / 29.0;
  return ratio > kDelta * kDelta * kDelta ? std::cbrt(ratio) : ratio / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

/// Share of a normal distribution below x standard deviations.
double below(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// The colors without the brightest and darkest.
std::vector<Eigen::Vector3d> trimmed(std::vector<Eigen::Vector3d> lab, double trim) {
  std::stable_sort(lab.begin(), lab.end(),
                   [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() < b.x(); });
  const auto cut = static_cast<std::ptrdiff_t>(trim * static_cast<double>(lab.size()));
  return {lab.begin() + cut, lab.end() - cut};
}

/// The mean share of the surface whose hue is below the ripe one, if all hues are off by `shift` (rad).
double share_below(const std::vector<double>& hues, double shift, const RipenessParameters& parameters) {
  double sum = 0.0;
  for (const double hue : hues) sum += below((parameters.ripe_hue - hue - shift) / parameters.hue_error);
  return sum / static_cast<double>(hues.size());
}

/// Above which share each class begins, and where the last one ends.
std::array<double, kRipenessClasses + 1> class_limits(const RipenessParameters& p) {
  return {-1e9, p.breakers, p.turning, p.pink, p.light_red, p.red, 1e9};
}

/// Set the class, and how sure it is.
void grade(Ripeness& out, const RipenessParameters& p) {
  const auto from = class_limits(p);
  const double error = std::max(out.ripe_share_error, 1e-6);
  out.grade = class_of(out.ripe_share, p);
  const auto c = static_cast<std::size_t>(out.grade);
  out.probability = below((from[c + 1] - out.ripe_share) / error) - below((from[c] - out.ripe_share) / error);
}

}  // namespace

const char* to_string(RipenessClass ripeness) {
  constexpr std::array<const char*, kRipenessClasses> kNames{"green", "breakers",  "turning",
                                                             "pink",  "light_red", "red"};
  return kNames[static_cast<std::size_t>(ripeness)];
}

std::optional<RipenessClass> ripeness_named(std::string_view name) {
  for (std::size_t c = 0; c < kRipenessClasses; ++c)
    if (name == to_string(static_cast<RipenessClass>(c))) return static_cast<RipenessClass>(c);
  return std::nullopt;
}

RipenessClass class_of(double ripe_share, const RipenessParameters& parameters) {
  check_input(!std::isnan(ripe_share), "class_of: the ripe share is NaN");
  const auto from = class_limits(parameters);
  std::size_t c = 0;
  while (c + 1 < kRipenessClasses && ripe_share > from[c + 1]) ++c;
  return static_cast<RipenessClass>(c);
}

double hue_of(const Eigen::Vector3d& lab) {
  const double hue = std::atan2(lab.z(), lab.y());
  return hue < -0.5 * kPi ? hue + kTwoPi : hue;
}

double linear_light(double channel) {
  return channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4);
}

Eigen::Vector3d to_lab(const Rgb& color) {
  const auto& table = linear_table();
  const Eigen::Vector3d rgb(table[color[0]], table[color[1]], table[color[2]]);
  Eigen::Matrix3d xyz_of;  // IEC 61966-2-1
  xyz_of << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Eigen::Vector3d white = xyz_of * Eigen::Vector3d::Ones(), xyz = xyz_of * rgb;
  const double x = lightness_of(xyz.x() / white.x()), y = lightness_of(xyz.y() / white.y()),
               z = lightness_of(xyz.z() / white.z());
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

std::optional<Ripeness> ripeness_of(const std::vector<Rgb>& colors, double seen, const RipenessParameters& parameters) {
  parameters.check();
  if (!(seen >= 0.0 && seen <= 1.0))
    throw InputError("ripeness_of: the share that was seen must be from 0 to 1, got " + number_text(seen, 9));
  constexpr std::size_t kFewest = 8;
  constexpr double kPatches = 12.0;
  if (colors.size() < kFewest) return std::nullopt;
  Ripeness out;
  std::vector<Eigen::Vector3d> lab;
  std::vector<double> hues;  // of all: what is ripe is darker than the rest, and must not be left out for that
  for (const Rgb& c : colors) {
    lab.push_back(to_lab(c));
    if (std::hypot(lab.back().y(), lab.back().z()) >= parameters.min_chroma) hues.push_back(hue_of(lab.back()));
  }
  if (hues.empty()) return std::nullopt;
  lab = trimmed(std::move(lab), parameters.trim);
  for (const Eigen::Vector3d& c : lab) out.lab += c / static_cast<double>(lab.size());
  out.points = hues.size();
  out.hue = hue_of(out.lab);
  const double patches = std::max(1.0, kPatches * seen);
  double spread = 0.0;
  for (const double hue : hues) spread += std::pow(std::remainder(hue - out.hue, kTwoPi), 2);
  spread /= static_cast<double>(hues.size());
  const double common = 0.5 * parameters.hue_error;
  out.hue_error = std::sqrt(common * common + spread / patches);
  out.ripe_share = share_below(hues, 0.0, parameters);
  const double unseen = std::sqrt(out.ripe_share * (1.0 - out.ripe_share) / patches * (1.0 - seen));
  const double shifted = 0.5 * (share_below(hues, -common, parameters) - share_below(hues, common, parameters));
  out.ripe_share_error = std::hypot(unseen, shifted);
  grade(out, parameters);
  return out;
}

}  // namespace agrisee
