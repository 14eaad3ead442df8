// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/overlap.hpp>

namespace agrisee {

Capsule enclosing_capsule(const OrientedCylinder& c) {
  const double inset = std::min(0.5 * c.radius, 0.5 * c.height);
  const Eigen::Vector3d half = (0.5 * c.height - inset) * c.axis;
  return {c.center - half, c.center + half, std::hypot(c.radius, inset)};
}

Eigen::Vector3d nearest_point(const Box& box, const Eigen::Vector3d& p) {
  return p.cwiseMax(box.center - 0.5 * box.size).cwiseMin(box.center + 0.5 * box.size);
}

Eigen::Vector3d nearest_point(const OrientedCylinder& c, const Eigen::Vector3d& p) {
  const Eigen::Vector3d d = p - c.center;
  const double along = d.dot(c.axis);
  Eigen::Vector3d across = d - along * c.axis;
  const double rho = across.norm();
  if (rho > c.radius) across *= c.radius / rho;
  return c.center + std::clamp(along, -0.5 * c.height, 0.5 * c.height) * c.axis + across;
}

Eigen::Vector3d nearest_point(const Cylinder& c, const Eigen::Vector3d& p) {
  return nearest_point(OrientedCylinder{c.center, Eigen::Vector3d::UnitZ(), c.radius, c.height}, p);
}

double support(const Box& box, const Eigen::Vector3d& v) {
  return v.dot(box.center) + 0.5 * v.cwiseAbs().dot(box.size);
}

double support(const Cylinder& c, const Eigen::Vector3d& v) {
  return v.dot(c.center) + c.radius * std::hypot(v.x(), v.y()) + 0.5 * c.height * std::abs(v.z());
}

double support(const OrientedCylinder& c, const Eigen::Vector3d& v) {
  const double along = v.dot(c.axis);
  return v.dot(c.center) + 0.5 * c.height * std::abs(along) + c.radius * (v - along * c.axis).norm();
}

bool overlap(const Capsule& a, const Capsule& b) {
  const double reach = touching_distance(a.radius + b.radius);
  const double halves = 0.5 * ((a.b - a.a).norm() + (b.b - b.a).norm());
  if (0.5 * (a.a + a.b - b.a - b.b).norm() >= reach + halves) return false;
  return !(segment_distance(a.a, a.b, b.a, b.b) >= reach);
}

bool overlap(const OrientedCylinder& body, const KeepOut& space) {
  return std::visit([&](const auto& shape) { return overlap(body, shape); }, space.shape);
}

}  // namespace agrisee
