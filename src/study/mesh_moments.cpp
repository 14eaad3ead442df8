// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/pca.hpp>
#include <agrisee/study/mesh_moments.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::study {

MeshMoments mesh_moments(const Mesh& mesh) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& v : mesh.vertices) origin += v.cast<double>();
  origin /= std::max<double>(1.0, static_cast<double>(mesh.vertices.size()));

  // Integrals of 1, of the position and of its outer product, over the solid and over the surface.
  double solid = 0.0, surface = 0.0;
  Eigen::Vector3d areas = Eigen::Vector3d::Zero(), solid_first = areas, surface_first = areas;
  Eigen::Matrix3d solid_second = Eigen::Matrix3d::Zero(), surface_second = solid_second;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) check_input(i < mesh.vertices.size(), "mesh: a triangle names a missing vertex");
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - origin;
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - origin;
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - origin;
    const Eigen::Vector3d normal = 0.5 * (b - a).cross(c - a), sum = a + b + c;
    const Eigen::Matrix3d squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
    const double v = a.dot(normal) / 3.0, s = normal.norm();
    areas += normal;
    solid += v;
    solid_first += v / 4.0 * sum;
    solid_second += v / 20.0 * squares;
    surface += s;
    surface_first += s / 3.0 * sum;
    surface_second += s / 12.0 * squares;
  }
  check_input(std::isfinite(surface) && surface > 0.0, "mesh: it has no area or is not finite");

  MeshMoments out;
  out.area = surface;
  // Of all solids with this area, a ball has the largest volume. Less than a millionth of it counts as flat.
  const double ball = std::pow(surface, 1.5) / (6.0 * std::sqrt(kPi));
  out.closed = areas.norm() < 0.01 * surface && std::abs(solid) > 1e-6 * ball;
  if (out.closed) out.volume = std::abs(solid);
  const double mass = out.closed ? solid : surface;
  const Eigen::Vector3d mean = (out.closed ? solid_first : surface_first) / mass;
  const Eigen::Matrix3d second = (out.closed ? solid_second : surface_second) / mass;
  const auto pca = principal_axes<double>(mean, Eigen::Matrix3d(second - mean * mean.transpose()));
  out.center = origin + mean;
  for (int i = 0; i < 3; ++i) {
    out.radii[i] = std::sqrt((out.closed ? 5.0 : 3.0) * pca.variance[2 - i]);
    out.axes.col(i) = pca.axes.col(2 - i);
  }
  if (out.axes.determinant() < 0.0) out.axes.col(2) = -out.axes.col(2);
  return out;
}

}  // namespace agrisee::study
