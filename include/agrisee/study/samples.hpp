// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Points spread evenly over the fruit of a scene, the yardstick of recall and of what can be observed: one per 10 mm2.
/// World frame, metres. Cost: linear in triangles and samples.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/study/ground_truth.hpp>

#include <algorithm>

namespace agrisee::study {

/// Samples of surfaces, as a structure of arrays.
struct Samples {
  std::vector<Eigen::Vector3f> points;   ///< m, world
  std::vector<Eigen::Vector3f> normals;  ///< unit, of the triangle, out of the fruit
  std::vector<int> fruit;                ///< id of the fruit that a sample lies on

  /// Number of samples.
  std::size_t size() const { return points.size(); }
};

/// How samples are drawn.
struct SampleParameters {
  double area = 1e-5;      ///< surface that one sample stands for (m2)
  std::uint64_t seed = 1;  ///< each fruit draws from its own stream, by its id

  /// The paper gives none; the defaults.
  static SampleParameters paper() { return {}; }
  /// @throws ParameterError naming the field
  void check() const { check_parameter(std::isfinite(area) && area > 0.0, "area", "positive and finite", area); }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("area", p.area);
    f("seed", p.seed);
  }
};

/// Append round(area / params.area) samples (at least one) of a mesh: its surface, laid out triangle after triangle, is
/// cut into equal shares and each share gives one point, uniform within it (stratified sampling). Degenerate triangles
/// get none.
/// @param samples receives them
/// @param mesh of the fruit (m)
/// @param id names the samples' fruit and selects the random stream
/// @param params see their struct
/// @throws InputError as mesh_moments() does
inline void append_samples(Samples& samples, const Mesh& mesh, int id, const SampleParameters& params = {}) {
  params.check();
  const MeshMoments m = mesh_moments(mesh);
  double signed_volume = 0.0;  // tells which way the triangles face
  std::vector<double> until;   // area up to and with triangle i
  until.reserve(mesh.triangles.size());
  double total = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - m.center;
    const Eigen::Vector3d n = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                  .cast<double>()
                                  .cross((mesh.vertices[t[2]] - mesh.vertices[t[0]]).cast<double>());
    signed_volume += a.dot(n);
    until.push_back(total += 0.5 * n.norm());
  }
  const double outward = m.closed && signed_volume < 0.0 ? -1.0 : 1.0;
  const auto n = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(total / params.area)));
  Rng rng(params.seed, 0x5A3, static_cast<std::uint64_t>(id));
  std::size_t i = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = std::min((static_cast<double>(k) + rng.uniform()) / static_cast<double>(n), 1.0) * total;
    while (i + 1 < until.size() && until[i] <= at) ++i;
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                          c = mesh.vertices[t[2]].cast<double>();
    const double s = std::sqrt(rng.uniform()), v = rng.uniform();  // Osada et al., "Shape distributions", 2002
    samples.points.push_back(((1.0 - s) * a + s * (1.0 - v) * b + s * v * c).cast<float>());
    samples.normals.push_back((outward * (b - a).cross(c - a).normalized()).cast<float>());
    samples.fruit.push_back(id);
  }
}

/// Samples of every fruit of a scene, in the order of its objects.
/// @throws InputError for a fruit whose mesh has no area; ParameterError for unusable parameters
inline Samples fruit_samples(const Scene& scene, const SampleParameters& params = {}) {
  Samples samples;
  for (const Object& object : scene.objects)
    if (object.cls == ObjectClass::fruit) append_samples(samples, object.mesh, object.id, params);
  return samples;
}

}  // namespace agrisee::study
