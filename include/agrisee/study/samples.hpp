// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Points spread evenly over the fruit of a scene, one per 10 mm2 by default. Recall and visibility are measured on
/// them. World frame, metres. The cost is linear in the number of triangles and samples.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/study/scene.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace agrisee::study {

/// Surface samples. All vectors have one entry per sample.
struct Samples {
  std::vector<Eigen::Vector3f> points;   ///< position (m, world)
  std::vector<Eigen::Vector3f> normals;  ///< unit normal of the triangle, pointing out of the fruit
  std::vector<int> fruit;                ///< Object::id of the fruit

  /// Number of samples.
  std::size_t size() const { return points.size(); }
};

/// Parameters of the sampling.
struct SampleParameters {
  double area = 1e-5;      ///< surface area that one sample stands for (m2)
  std::uint64_t seed = 1;  ///< seed of the random positions; each fruit has its own stream, selected by its id

  /// The defaults; [1] gives no values.
  static SampleParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("area", p.area, Range::positive());
    f("seed", p.seed);
  }
};

/// Appends samples of one mesh: as many as its area divided by `parameters.area`, rounded, but at least one.
///
/// The sampling is stratified: the triangles are put in a row by area, the row is divided into equal shares, and each
/// share gives one point that is uniformly distributed within it. Degenerate triangles get no samples.
/// @param samples receives the samples
/// @param mesh of the fruit (m)
/// @param id of the fruit; it also selects the random stream
/// @param parameters of the sampling
/// @throws ParameterError for unusable parameters, InputError as mesh_moments() does
void append_samples(Samples& samples, const Mesh& mesh, int id, const SampleParameters& parameters = {});

/// Samples every fruit of a scene, in the order of Scene::objects.
/// @throws ParameterError for unusable parameters, InputError as mesh_moments() does
Samples fruit_samples(const Scene& scene, const SampleParameters& parameters = {});

}  // namespace agrisee::study
