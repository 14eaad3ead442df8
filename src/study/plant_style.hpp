// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What distinguishes the kinds of generated plants: their usual sizes, how their fruit hang, and the shapes of fruit
/// and leaves. Metres.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include <string>

namespace agrisee::study {

/// How the leaves of a plant look.
struct LeafStyle {
  int leaflets_min = 5, leaflets_max = 9;  ///< number of leaflets; odd unless they alternate
  bool alternate = false;                  ///< leaflets sit singly, left and right in turn, instead of in pairs
  double start = 0.45;                     ///< share of the rachis below the first leaflet
  double length = 0.06;                    ///< usual length of a leaflet (m)
  double width = 0.52;                     ///< its width, relative to the length
  double teeth = 0.2;                      ///< depth of the teeth, relative to the width
};

/// One kind of plant.
struct PlantStyle {
  const char* kind = "tomato";           ///< one of kPlantKinds
  int total = 7;                         ///< usual number of fruit
  double shoulder = 0.036, tip = 0.010;  ///< usual half width of the largest and of the smallest fruit (m)
  bool on_stem = false;                  ///< the fruit hang on the main stem instead of on a rachis
  bool trough = false;                   ///< the plant grows in a trough above the fruit instead of on a main stem
  bool string = true;                    ///< a string winds around the main stem
  bool calyces = true;                   ///< the fruit have sepals
  double stem_radius = 0.0065;           ///< of the main stem (m)
  double rachis_radius = 0.0024;         ///< m
  double pedicel_radius = 0.0022;        ///< m
  LeafStyle leaf;                        ///< its leaves
};

/// The style of a kind. @throws FieldError if there is no such kind
const PlantStyle& plant_style(const std::string& kind);

/// Draws the shape that all fruit of one plant have in common. Its half width, without lobes, is 1.
FruitShape draw_cultivar(const PlantStyle& style, Rng& rng);

/// Draws the shape of one fruit: that of the cultivar in the given size, with small deviations.
/// @param style of the plant
/// @param cultivar from draw_cultivar()
/// @param radius half width of the fruit, without lobes (m)
/// @param rng random numbers
FruitShape draw_plant_fruit(const PlantStyle& style, const FruitShape& cultivar, double radius, Rng& rng);

}  // namespace agrisee::study
