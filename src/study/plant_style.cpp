// SPDX-License-Identifier: BSD-3-Clause
#include "plant_style.hpp"

#include <agrisee/study/plant.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace agrisee::study {

namespace {

/// One for each of kPlantKinds.
using Styles = std::array<PlantStyle, kPlantKinds.size()>;

Styles all_styles() {
  PlantStyle tomato;

  PlantStyle cherry = tomato;
  cherry.kind = "cherry";
  cherry.total = 12;
  cherry.shoulder = 0.015;
  cherry.tip = 0.009;
  cherry.rachis_radius = 0.0016;
  cherry.pedicel_radius = 0.0014;
  cherry.leaf.length = 0.052;

  PlantStyle pepper;
  pepper.kind = "pepper";
  pepper.total = 4;
  pepper.shoulder = 0.041;
  pepper.tip = 0.032;
  pepper.on_stem = true;
  pepper.stem_radius = 0.0055;
  pepper.pedicel_radius = 0.0055;
  pepper.leaf = {5, 9, true, 0.35, 0.066, 0.5, 0.0};

  PlantStyle beefsteak = tomato;
  beefsteak.kind = "beefsteak";
  beefsteak.total = 5;
  beefsteak.shoulder = 0.048;
  beefsteak.tip = 0.034;
  beefsteak.rachis_radius = 0.0034;
  beefsteak.pedicel_radius = 0.0034;
  beefsteak.leaf.length = 0.066;

  PlantStyle pear = pepper;
  pear.kind = "pear";
  pear.total = 5;
  pear.shoulder = 0.034;
  pear.tip = 0.028;
  pear.string = false;
  pear.calyces = false;
  pear.stem_radius = 0.009;
  pear.pedicel_radius = 0.0024;
  pear.leaf = {5, 9, true, 0.3, 0.05, 0.6, 0.04};

  PlantStyle strawberry;
  strawberry.kind = "strawberry";
  strawberry.total = 7;
  strawberry.shoulder = 0.020;
  strawberry.tip = 0.010;
  strawberry.trough = true;
  strawberry.string = false;
  strawberry.stem_radius = 0.011;
  strawberry.rachis_radius = 0.0017;
  strawberry.pedicel_radius = 0.0014;
  strawberry.leaf = {3, 3, false, 0.85, 0.062, 0.82, 0.14};

  PlantStyle apple = pear;
  apple.kind = "apple";
  apple.total = 7;
  apple.shoulder = 0.039;
  apple.tip = 0.030;
  apple.stem_radius = 0.011;
  apple.leaf = {5, 9, true, 0.2, 0.062, 0.66, 0.06};

  return {tomato, cherry, pepper, beefsteak, pear, strawberry, apple};
}

/// The traits of the round fruit: tomatoes of all sizes.
void draw_tomato(FruitShape& s, const std::string& kind, Rng& rng) {
  s.lobes = 4 + static_cast<int>(rng.below(4));
  s.lobe_amplitude = rng.uniform(0.005, 0.018);
  s.polar = rng.uniform(0.86, 0.95);
  s.dimple_depth = rng.uniform(0.06, 0.13);
  s.dimple_width = rng.uniform(0.28, 0.42);
  if (kind == "cherry") {
    s.lobe_amplitude *= 0.3;
    s.polar = rng.uniform(0.96, 1.08);
    s.dimple_depth = rng.uniform(0.04, 0.08);
  } else if (kind == "beefsteak") {
    s.lobes = 6 + static_cast<int>(rng.below(4));
    s.lobe_amplitude = rng.uniform(0.045, 0.07);
    s.lobe_sharpness = rng.uniform(2.0, 3.0);
    s.lobe_reach = 0.6;
    s.polar = rng.uniform(0.7, 0.8);
    s.dimple_depth = rng.uniform(0.15, 0.22);
    s.dimple_width = rng.uniform(0.4, 0.5);
    s.blossom_depth = rng.uniform(0.04, 0.08);
    s.blossom_width = 0.3;
  }
}

/// The largest distance of the surface from the growth axis, without lobes (m).
double half_width_of(FruitShape shape) {
  shape.lobe_amplitude = 0.0;
  double largest = 0.0;
  for (int i = 1; i < 180; ++i) {
    const Eigen::Vector3d d(std::sin(deg(i)), 0.0, std::cos(deg(i)));
    largest = std::max(largest, d.x() * shape.radius(d));
  }
  return largest;
}

}  // namespace

const PlantStyle& plant_style(const std::string& kind) {
  static const Styles styles = all_styles();
  for (const PlantStyle& style : styles)
    if (kind == style.kind) return style;
  throw FieldError("kind", "must be " + OneOf(kPlantKinds).text() + ", got " + kind);
}

PlantParameters PlantParameters::of(const std::string& kind) {
  const PlantStyle& style = plant_style(kind);
  PlantParameters parameters;
  parameters.kind = kind;
  parameters.total = style.total;
  parameters.radius_shoulder = style.shoulder;
  parameters.radius_tip = style.tip;
  return parameters;
}

FruitShape draw_cultivar(const PlantStyle& style, Rng& rng) {
  FruitShape s;
  const std::string kind = style.kind;
  s.equatorial = 1.0;
  if (kind == "pepper") {
    s.lobe_amplitude = rng.uniform(0.08, 0.12);
    s.lobe_sharpness = rng.uniform(2.0, 2.6);
    s.lobe_reach = 0.5;
    s.blockiness = rng.uniform(2.5, 3.1);
    s.taper = rng.uniform(0.02, 0.14);
    s.polar = rng.uniform(1.05, 1.4);
    s.dimple_depth = rng.uniform(0.13, 0.19);
    s.dimple_width = rng.uniform(0.4, 0.5);
    s.blossom_depth = rng.uniform(0.08, 0.14);
  } else if (kind == "pear") {
    s.lobes = 3;
    s.lobe_amplitude = rng.uniform(0.0, 0.012);
    s.taper = rng.uniform(-0.58, -0.45);
    s.polar = rng.uniform(1.5, 1.8);
    s.dimple_depth = 0.03;
    s.dimple_width = 0.2;
    s.blossom_depth = 0.05;
    s.blossom_width = 0.2;
  } else if (kind == "apple") {
    s.lobes = 5;
    s.lobe_amplitude = rng.uniform(0.004, 0.02);
    s.taper = rng.uniform(0.04, 0.16);
    s.polar = rng.uniform(0.86, 1.02);
    s.dimple_depth = rng.uniform(0.12, 0.2);
    s.dimple_width = rng.uniform(0.3, 0.4);
    s.blossom_depth = rng.uniform(0.05, 0.1);
    s.blossom_width = rng.uniform(0.25, 0.35);
  } else if (kind == "strawberry") {
    s.lobes = 3;
    s.lobe_amplitude = rng.uniform(0.01, 0.03);
    s.taper = rng.uniform(0.25, 0.4);
    s.polar = rng.uniform(1.15, 1.4);
    s.dimple_depth = rng.uniform(0.12, 0.18);
    s.dimple_width = 0.5;
  } else {
    draw_tomato(s, kind, rng);
  }
  const double half_width = half_width_of(s);
  s.equatorial /= half_width;
  s.polar /= half_width;
  return s;
}

FruitShape draw_plant_fruit(const PlantStyle& style, const FruitShape& cultivar, double radius, Rng& rng) {
  FruitShape s = cultivar;
  s.equatorial = cultivar.equatorial * radius;
  s.polar = cultivar.polar * radius * rng.uniform(0.985, 1.015);
  s.lobe_phase = rng.uniform(0.0, kTwoPi);
  s.lobe_amplitude *= rng.uniform(0.85, 1.15);
  s.dimple_depth *= rng.uniform(0.9, 1.1);
  const double lobes = rng.uniform();
  if (std::string(style.kind) == "pepper") s.lobes = lobes < 0.5 ? 3 : 4;
  return s;
}

}  // namespace agrisee::study
