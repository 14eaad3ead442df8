// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/study/mesh_moments.hpp>
#include <agrisee/study/samples.hpp>

#include <algorithm>

namespace agrisee::study {

void append_samples(Samples& samples, const Mesh& mesh, int id, const SampleParameters& parameters) {
  parameters.check();
  const MeshMoments m = mesh_moments(mesh);
  double signed_volume = 0.0;  // negative if the triangles face inwards
  std::vector<double> until;   // total area of the triangles 0 to i
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
  const auto n = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(total / parameters.area)));
  Rng rng(parameters.seed, 0x5A3, static_cast<std::uint64_t>(id));
  std::size_t i = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = std::min((static_cast<double>(k) + rng.uniform()) / static_cast<double>(n), 1.0) * total;
    while (i + 1 < until.size() && until[i] <= at) ++i;
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                          c = mesh.vertices[t[2]].cast<double>();
    // A uniform point of a triangle: Osada et al., "Shape distributions", 2002.
    const double s = std::sqrt(rng.uniform()), v = rng.uniform();
    samples.points.push_back(((1.0 - s) * a + s * (1.0 - v) * b + s * v * c).cast<float>());
    samples.normals.push_back((outward * (b - a).cross(c - a).normalized()).cast<float>());
    samples.fruit.push_back(id);
  }
}

Samples fruit_samples(const Scene& scene, const SampleParameters& parameters) {
  Samples samples;
  for (const Object& object : scene.objects)
    if (object.cls == ObjectClass::fruit) append_samples(samples, object.mesh, object.id, parameters);
  return samples;
}

}  // namespace agrisee::study
