// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/noise_model.hpp>

#include <algorithm>
#include <locale>
#include <sstream>

namespace agrisee::study {

namespace {

using Kind = NoiseModel::Kind;

bool knows_light(Kind kind) { return kind == Kind::l515 || kind == Kind::azure || kind == Kind::d405; }

constexpr std::pair<Kind, const char*> kNames[] = {{Kind::none, "none"},   {Kind::l515_white, "l515-white"},
                                                   {Kind::rough, "rough"}, {Kind::l515, "l515"},
                                                   {Kind::azure, "azure"}, {Kind::d405, "d405"}};

Translucency& of(NoiseParameters& p, ObjectClass c) { return p.translucency[static_cast<std::size_t>(c)]; }

void set_l515_white(NoiseParameters& p) {
  p.white = {0.0009, 0.0016, 0.0};
  p.flying = 0.2;
}

void set_rough(NoiseParameters& p) {
  p.white = {0.002, 0.0, 0.0};
  p.correlation = 3.0;
  p.bias = 0.0015;
  p.flying = 0.5;
  p.position = 0.0005;
  p.rotation = deg(0.1);
}

/// Wall at 0.95 m: 0.28 mm about a plane over 7 x 7 pixels, 1.07 mm over a quarter of the frame, correlated by 0.95,
/// 0.64 and 0.53 over 1, 8 and 20 pixels. How waves grow with the range is not known: half of them is taken as
/// constant.
void set_l515(NoiseParameters& p, bool sun) {
  const auto half_grows = [](double sigma) { return RangeError{0.5 * sigma, 0.5 * sigma / 0.95, 0.0}; };
  p.white = half_grows(sun ? 0.00045 : 0.00022);
  p.waves[0] = {half_grows(0.00068), 0.0101, 0.5};
  p.waves[1] = {half_grows(0.00105), 0.105, 0.5};
  p.flying = 0.2;
  p.edge_width = 2;
  p.skirt = 0.01;
  p.loss = sun ? 0.05 : 0.01;
  if (sun) p.patches_least = 0.2, p.patches_most = 0.7;
  p.mirror = deg(4);
  of(p, ObjectClass::leaf) = {0.014, 0.0015};
  p.unit = 0.00025;
}

/// Orchard at 0.6 to 1.0 m: 0.41 mm about a quadric over 7 x 7 pixels, 78 to 94 % of a fruit's pixels valid. The waves,
/// the share of flying pixels and the depth of leaves are assumptions: there is no figure.
void set_azure(NoiseParameters& p, bool sun) {
  p.white = sun ? RangeError{0.0004, 0.0004, 0.0} : RangeError{0.0002, 0.0003, 0.0};
  p.waves[0] = {{0.0002, 0.0003, 0.0}, 0.008, 0.5};
  p.waves[1] = {{0.0003, 0.0005, 0.0}, 0.1, 0.5};
  p.bias = sun ? 0.001 : 0.0;
  p.flying = 0.4;
  p.edge_width = 3;
  p.skirt = 0.02;
  p.loss = 0.01;
  p.patches_least = sun ? 0.2 : 0.0, p.patches_most = sun ? 0.6 : 0.06;
  p.mirror = deg(3);
  of(p, ObjectClass::leaf) = {0.008, 0.0015};
  p.unit = 0.001;
}

/// Desk at 0.2 to 0.4 m: 0.27 mm about a plane over 7 x 7 pixels (10 to 90 %: 0.17 to 0.41), 38 to 93 % of the pixels
/// valid. The error of a disparity grows with the square of the range.
void set_d405(NoiseParameters& p, bool sun) {
  p.white = {0.00005, 0.0, 0.0008};
  p.waves[0] = {{0.0, 0.0, 0.0055}, 0.0055, 0.2};  // neighbors share their matching window
  p.waves[1] = {{0.0, 0.0, 0.002}, 0.1, 0.5};
  p.edge_width = 2;
  p.smear = 2;
  p.thin = 3;
  p.loss = 0.01;
  p.patches_least = sun ? 0.1 : 0.04, p.patches_most = sun ? 0.55 : 0.45;
  p.patch_spacing = 0.03;
  p.unit = 0.0001;
}

}  // namespace

void NoiseModel::check() const {
  constexpr double kMost = 0.2;  // m
  check_parameter(sigma >= 0.0 && sigma <= kMost, "noise sigma", "from 0 to 0.2 m (0.002 for 2 mm)", sigma);
  if (light == Light::sun && !knows_light(kind))
    throw ParameterError("noise: only l515, azure and d405 have figures for sunlight");
}

bool NoiseParameters::knows_materials() const {
  return mirror > 0.0 ||
         std::any_of(translucency.begin(), translucency.end(), [](const Translucency& t) { return t.depth > 0.0; });
}

NoiseParameters noise_parameters(const NoiseModel& model) {
  model.check();
  const bool sun = model.light == Light::sun;
  NoiseParameters p;
  switch (model.kind) {
    case Kind::none:
      return p;
    case Kind::gaussian:
      p.white.constant = model.sigma;
      return p;
    case Kind::l515_white:
      set_l515_white(p);
      break;
    case Kind::rough:
      set_rough(p);
      break;
    case Kind::l515:
      set_l515(p, sun);
      break;
    case Kind::azure:
      set_azure(p, sun);
      break;
    case Kind::d405:
      set_d405(p, sun);
      break;
  }
  p.loss_begin = deg(60);
  p.loss_end = deg(80);
  return p;
}

NoiseModel parse_noise(const std::string& text) {
  for (const auto& [kind, name] : kNames)
    for (const auto& [light, suffix] : {std::pair(Light::shade, ""), {Light::shade, ":shade"}, {Light::sun, ":sun"}})
      if (text == std::string(name) + suffix && (*suffix == '\0' || knows_light(kind))) return {kind, 0.0, light};
  const std::string prefix = "gaussian:";
  if (text.compare(0, prefix.size(), prefix) == 0) {
    std::istringstream in(text.substr(prefix.size()));
    in.imbue(std::locale::classic());
    NoiseModel model{Kind::gaussian, -1.0, Light::shade};
    in >> std::noskipws >> model.sigma;
    if (in && in.peek() == std::istringstream::traits_type::eof() && model.sigma >= 0.0 && std::isfinite(model.sigma)) {
      model.check();
      return model;
    }
  }
  throw ParameterError(std::string("noise must be ") + kNoiseNames + ", got '" + text +
                       "'; l515, azure and d405 may end in :sun");
}

std::string to_string(const NoiseModel& model) {
  for (const auto& [kind, name] : kNames)
    if (kind == model.kind) return std::string(name) + (model.light == Light::sun ? ":sun" : "");
  for (int digits = 1;; ++digits) {  // the fewest digits that give the same number back
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << "gaussian:" << model.sigma;
    if (digits >= 17 || parse_noise(out.str()).sigma == model.sigma) return out.str();
  }
}

}  // namespace agrisee::study
