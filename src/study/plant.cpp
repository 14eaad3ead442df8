// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/plant.hpp>
#include <agrisee/study/true_ripeness.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "plant_foliage.hpp"
#include "plant_layout.hpp"
#include "plant_surroundings.hpp"

namespace agrisee::study {

namespace {

/// How deep the vertices of the stems reach into a fruit (m). Every pedicel starts some millimetres inside its fruit.
double stem_depth(const PlantLayout& layout, const Mesh& stem) {
  double deepest = 0.0;
  for (const TrussLayout& truss : layout.trusses)
    for (const PlacedFruit& fruit : truss.fruits) {
      const double reach = fruit.shape.max_radius();
      for (const Eigen::Vector3f& v : stem.vertices) {
        const Eigen::Vector3d p = v.cast<double>();
        if ((p - fruit.center()).squaredNorm() < reach * reach) deepest = std::max(deepest, fruit.depth(p));
      }
    }
  return deepest;
}

/// Appends the fruit of a layout with their ids. @return the box around them
Aabb append_fruits(Scene& scene, const PlantLayout& layout) {
  Aabb box;
  int id = 0;
  for (const TrussLayout& truss : layout.trusses)
    for (const PlacedFruit& fruit : truss.fruits) {
      const bool ribbed = fruit.shape.lobe_amplitude > 0.03;
      const Mesh mesh =
          transformed(ribbed ? fruit_mesh(fruit.shape, 72, 40) : fruit_mesh(fruit.shape), fruit.world_T_body);
      for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v.cast<double>());
      scene.objects.push_back({++id, ObjectClass::fruit, mesh});
    }
  return box;
}

/// Samples of the fruit: some thousands in all, and enough on the smallest fruit.
Samples plant_samples(const Scene& scene) {
  double all = 0.0, smallest = 1.0;
  for (const Object& object : scene.objects) {
    if (object.cls != ObjectClass::fruit) continue;
    all += area(object.mesh);
    smallest = std::min(smallest, area(object.mesh));
  }
  SampleParameters parameters;
  parameters.area = std::min(all / 4000.0, smallest / 150.0);
  return fruit_samples(scene, parameters);
}

/// Makes the plant of a layout; none if its stems meet fruit or too little or too much of the fruit is hidden.
std::optional<Plant> grow_plant(const PlantParameters& parameters, const PlantStyle& style, const PlantLayout& layout,
                                Rng& rng) {
  constexpr double kStemDepth = 0.004, kFoliageError = 0.04;
  const Mesh stem = plant_stem_mesh(layout, style, rng);
  if (stem_depth(layout, stem) > kStemDepth) return std::nullopt;
  Plant plant;
  const Aabb box = append_fruits(plant.scene, layout);
  plant.scene.objects.push_back({0, ObjectClass::stem, stem});
  for (const Mesh& mesh : draw_surroundings(parameters, layout, rng))
    plant.scene.objects.push_back({0, ObjectClass::other, mesh});

  const Eigen::Vector3d eye = frontal_eye(parameters.center);
  const Samples samples = plant_samples(plant.scene);
  const Flags without_leaves = visible_from(TracedScene(plant.scene), samples, eye);
  Mesh solids;
  for (const Object& object : plant.scene.objects) append(solids, object.mesh);
  const Foliage foliage = grow_leaves(parameters, style, layout, solids, samples, without_leaves, eye, rng);
  plant.foliage = foliage.share;
  if (std::abs(plant.foliage - parameters.foliage) > kFoliageError) return std::nullopt;
  for (const Mesh& leaf : foliage.leaves) plant.scene.objects.push_back({0, ObjectClass::leaf, leaf});

  plant.workcell = truss_workcell(box, parameters.center);
  plant.truth = ground_truth(plant.scene);
  const Flags seen = visible_from(TracedScene(plant.scene), samples, eye);
  std::size_t i = 0;
  for (const TrussLayout& truss : layout.trusses)
    for (const PlacedFruit& fruit : truss.fruits) {
      TrueFruit& truth = plant.truth.fruits[i++];
      truth.growth_axis = fruit.world_T_body.linear().col(2);
      truth.visible_share = share(samples, seen, truth.id);
      truth.hidden = *truth.visible_share < kHiddenBelow;
    }
  std::vector<std::size_t> trusses;
  for (const TrussLayout& truss : layout.trusses) trusses.push_back(truss.fruits.size());
  ripen(plant.scene, plant.truth, trusses, parameters.seed);
  return plant;
}

}  // namespace

Plant make_plant(const PlantParameters& parameters) {
  constexpr int kAttempts = 30;
  parameters.check();
  const PlantStyle& style = plant_style(parameters.kind);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Rng rng(parameters.seed, 0x91A7, static_cast<std::uint64_t>(attempt));
    const PlantLayout layout = draw_plant(parameters, style, rng);
    if (layout.deepest() > 6e-4) continue;
    if (std::optional<Plant> plant = grow_plant(parameters, style, layout, rng)) return std::move(*plant);
  }
  throw ParameterError("foliage, total: no plant of kind " + parameters.kind + " with " +
                       std::to_string(parameters.total) + " fruit, of which leaves hide " +
                       Range::number(100.0 * parameters.foliage) + " %, was found with seed " +
                       std::to_string(parameters.seed));
}

}  // namespace agrisee::study
