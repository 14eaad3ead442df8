// SPDX-License-Identifier: BSD-3-Clause
// Judges postures of a UR3 without the library's kinematics and collision tests: forward kinematics from the maker's
// Denavit-Hartenberg table in plain doubles, joint limits, and overlap of solids by sampling them densely. It uses only
// data of the library: the sizes of the arm's pieces, the mount and the keep-out spaces. Metres, radians.
#pragma once

#include <agrisee/arm/collision.hpp>
#include <agrisee/geometry/ellipsoid.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace verify {

using Matrix = std::array<std::array<double, 4>, 4>;
using Vector = std::array<double, 3>;

inline Matrix times(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

inline Matrix turn_z(double angle, double along) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{c, -s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, along}, {0, 0, 0, 1}}};
}

inline Matrix turn_x(double angle, double along) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{1, 0, 0, along}, {0, c, -s, 0}, {0, s, c, 0}, {0, 0, 0, 1}}};
}

inline Matrix matrix_of(const agrisee::Pose& pose) {
  Matrix m{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) m[std::size_t(i)][std::size_t(j)] = pose.matrix()(i, j);
  return m;
}

inline double difference(const Matrix& a, const Matrix& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) most = std::max(most, std::abs(a[i][j] - b[i][j]));
  return most;
}

inline Vector apply(const Matrix& m, const Vector& p) {
  Vector out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3];
  return out;
}

/// Poses of the UR3's links in base_link: each turns with its joint about its own z axis; the last is tool0. The
/// maker's table (theta, d, a, alpha) starts in `base`, which is base_link turned by pi about z.
inline std::array<Matrix, 6> links(const agrisee::Joints& q) {
  constexpr double pi = 3.14159265358979323846;
  const double d[6] = {0.1519, 0, 0, 0.11235, 0.08535, 0.0819}, a[6] = {0, -0.24365, -0.21325, 0, 0, 0};
  const double alpha[6] = {pi / 2, 0, 0, pi / 2, -pi / 2, 0};
  std::array<Matrix, 6> out{};
  Matrix chain = turn_z(pi, 0.0);
  for (std::size_t i = 0; i < 6; ++i) {
    out[i] = times(chain, turn_z(q[int(i)], d[i]));
    chain = times(out[i], turn_x(alpha[i], a[i]));
  }
  return out;
}

/// Points that fill a solid cylinder, at most about `spacing` (m) apart; all of them are inside or on its surface.
inline std::vector<Vector> sampled(const agrisee::OrientedCylinder& c, double spacing) {
  const Eigen::Vector3d u = c.axis.unitOrthogonal(), v = c.axis.cross(u);
  const int slices = std::max(1, int(std::ceil(c.height / spacing))),
            rings = std::max(1, int(std::ceil(c.radius / spacing)));
  std::vector<Vector> out;
  for (int s = 0; s <= slices; ++s)
    for (int r = 0; r <= rings; ++r) {
      const double rho = c.radius * r / rings;
      const int steps = r == 0 ? 1 : std::max(6, int(std::ceil(2 * 3.14159265358979 * rho / spacing)));
      for (int k = 0; k < steps; ++k) {
        const double angle = 2 * 3.14159265358979 * k / steps;
        const Eigen::Vector3d p = c.center + (double(s) / slices - 0.5) * c.height * c.axis +
                                  rho * (std::cos(angle) * u + std::sin(angle) * v);
        out.push_back({p.x(), p.y(), p.z()});
      }
    }
  return out;
}

/// How deep (m) a point is inside a solid, negative outside.
inline double depth(const agrisee::KeepOut& space, const Vector& p) {
  if (const auto* box = std::get_if<agrisee::Box>(&space.shape)) {
    double least = 1e9;
    for (int i = 0; i < 3; ++i)
      least = std::min(least, 0.5 * box->size[i] - std::abs(p[std::size_t(i)] - box->center[i]));
    return least;
  }
  const auto& c = std::get<agrisee::Cylinder>(space.shape);
  const double across = std::hypot(p[0] - c.center.x(), p[1] - c.center.y());
  return std::min(c.radius - across, 0.5 * c.height - std::abs(p[2] - c.center.z()));
}

/// A part of the arm at certain joint angles: its points, and what is needed to test whether a point is inside.
struct Solid {
  agrisee::arm::Part part;
  Matrix world_T_part;
  Matrix part_T_world;
  agrisee::OrientedCylinder cylinder;  // in the part's frame
  std::vector<Vector> points;          // in world

  double depth(const Vector& p) const {
    const Vector q = apply(part_T_world, p);
    const Eigen::Vector3d x = Eigen::Vector3d(q[0], q[1], q[2]) - cylinder.center;
    const double along = x.dot(cylinder.axis), across = (x - along * cylinder.axis).norm();
    return std::min(cylinder.radius - across, 0.5 * cylinder.height - std::abs(along));
  }
};

inline Matrix inverse(const Matrix& m) {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out[i][j] = m[j][i];
    out[i][3] = -(m[0][i] * m[0][3] + m[1][i] * m[1][3] + m[2][i] * m[2][3]);
  }
  out[3][3] = 1.0;
  return out;
}

/// All parts of the arm at joint angles `q` (rad), sampled at `spacing` (m).
inline std::vector<Solid> solids(const agrisee::Joints& q, const agrisee::arm::Mount& mount, double spacing) {
  using agrisee::arm::Part;
  const Matrix world_T_base = matrix_of(mount.world_T_base);
  const auto frames = links(q);
  std::vector<Solid> out;
  const auto add = [&](Part part, const Matrix& world_T_part, const agrisee::OrientedCylinder& cylinder) {
    Solid solid{part, world_T_part, inverse(world_T_part), cylinder, {}};
    for (const Vector& p : sampled(cylinder, spacing)) solid.points.push_back(apply(world_T_part, p));
    out.push_back(std::move(solid));
  };
  for (const auto& piece : agrisee::arm::ur3_pieces())
    add(piece.part, piece.part == Part::base ? world_T_base : times(world_T_base, frames[std::size_t(piece.part)]),
        piece.cylinder);
  const Matrix world_T_optical = times(times(world_T_base, frames[5]), matrix_of(mount.tool0_T_optical));
  agrisee::OrientedCylinder housing;  // behind the optical center
  housing.center = {0, 0, -0.5 * mount.sensor.depth};
  housing.radius = mount.sensor.radius;
  housing.height = mount.sensor.depth;
  add(Part::sensor, world_T_optical, housing);
  return out;
}

/// Whether two parts of the arm can meet at all. Neighboring parts overlap at their joint, which does not count.
inline bool can_meet(agrisee::arm::Part a, agrisee::arm::Part b) {
  // Along the chain: base 0, shoulder 1, upper arm 2, forearm 3, wrists 4 to 6, sensor 7.
  constexpr int along[] = {1, 2, 3, 4, 5, 6, 0, 7};
  int i = along[std::size_t(a)], j = along[std::size_t(b)];
  if (i > j) std::swap(i, j);
  if (j - i < 2) return false;
  // These pairs are kept apart at all angles, or one holds the other: base and upper arm, forearm and wrist 2, wrist 1
  // and 3, wrist 2 and sensor.
  return !(i == 0 && j == 2) && !(i == 3 && j == 5) && !(i == 4 && j == 6) && !(i == 5 && j == 7);
}

/// What is wrong with a posture, or an empty string: a joint outside its limits; a part inside another part; a part
/// other than the base inside a keep-out space or one of some ellipsoids. A part is inside when a sampled point lies
/// deeper than `touch` (m).
inline std::string fault_of(const agrisee::Joints& q, const agrisee::arm::Mount& mount,
                            const std::vector<agrisee::OrientedEllipsoid>& bodies = {}, double spacing = 0.01,
                            double touch = 1e-5) {
  using agrisee::arm::Part;
  for (int j = 0; j < 6; ++j)
    if (!(q[j] >= mount.model.limits.min[j] && q[j] <= mount.model.limits.max[j]))
      return "joint " + std::to_string(j) + " out of limits";
  const auto parts = solids(q, mount, spacing);
  for (const Solid& part : parts) {
    const std::string name(to_string(part.part));
    if (part.part != Part::base) {
      for (const auto& space : mount.keep_out)
        for (const Vector& p : part.points)
          if (depth(space, p) > touch) return name + " in space " + space.name;
      for (const auto& body : bodies)
        for (const Vector& p : part.points) {
          const Eigen::Vector3d x = body.axes.transpose() * (Eigen::Vector3d(p[0], p[1], p[2]) - body.center);
          if (x.cwiseQuotient(body.radii).norm() < 1.0 - touch / body.radii.minCoeff()) return name + " in a fruit";
        }
    }
    for (const Solid& other : parts) {
      if (!can_meet(part.part, other.part)) continue;
      for (const Vector& p : part.points)
        if (other.depth(p) > touch) return name + " in " + std::string(to_string(other.part));
    }
  }
  return {};
}

}  // namespace verify
