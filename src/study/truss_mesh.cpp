// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include <cmath>

#include "leaf_sheet.hpp"

namespace agrisee::study {

double FruitShape::radius(const Eigen::Vector3d& d) const {
  const double u = d.z(), s_sq = std::max(0.0, 1.0 - u * u);
  const double across = equatorial * (1.0 + taper * u);
  double body = 1.0 / std::sqrt(s_sq / (across * across) + u * u / (polar * polar));
  if (blockiness != 2.0)
    body = std::pow(std::pow(std::sqrt(s_sq) / across, blockiness) + std::pow(std::abs(u) / polar, blockiness),
                    -1.0 / blockiness);
  double wave = std::cos(lobes * std::atan2(d.y(), d.x()) + lobe_phase);
  if (lobe_sharpness != 1.0) wave = 1.0 - 2.0 * std::pow(0.5 * (1.0 - wave), lobe_sharpness);
  // The lobes fade out towards both poles and are stronger at the shoulders (z > 0).
  const double fade = lobe_reach == 1.0 ? s_sq : std::pow(s_sq, lobe_reach);
  const double lobe = lobe_amplitude * fade * (0.7 + 0.3 * u) * wave;
  const double dimple = dimple_depth * std::exp(-2.0 * (1.0 - u) / (dimple_width * dimple_width));
  const double blossom = blossom_depth * std::exp(-2.0 * (1.0 + u) / (blossom_width * blossom_width));
  return body * (1.0 + lobe) * (1.0 - dimple) * (1.0 - blossom);
}

Mesh fruit_mesh(const FruitShape& shape, int slices, int stacks) {
  check_parameter(slices >= 3, "slices", "3 or more", slices);
  check_parameter(stacks >= 2, "stacks", "2 or more", stacks);
  Mesh mesh;
  const auto add = [&](const Eigen::Vector3d& d) { mesh.vertices.push_back((shape.radius(d) * d).cast<float>()); };
  add(Eigen::Vector3d::UnitZ());
  for (int i = 1; i < stacks; ++i) {
    const double theta = kPi * i / stacks;
    for (int j = 0; j < slices; ++j) {
      const double phi = kTwoPi * (j + 0.5 * (i % 2)) / slices;
      add({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  add(-Eigen::Vector3d::UnitZ());
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>(1 + (i - 1) * slices + (j + slices) % slices);
  };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int j = 0; j < slices; ++j) mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
  for (int i = 1; i + 1 < stacks; ++i)
    for (int j = 0; j < slices; ++j) {  // odd rings are turned by half a slice
      if (i % 2) {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      } else {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
      }
    }
  for (int j = 0; j < slices; ++j) mesh.triangles.push_back({at(stacks - 1, j), last, at(stacks - 1, j + 1)});
  return mesh;
}

Mesh tube_mesh(const std::vector<Eigen::Vector3d>& path, double radius_begin, double radius_end, int sides) {
  check_parameter(sides >= 3, "sides", "3 or more", sides);
  std::vector<Eigen::Vector3d> p;
  for (const Eigen::Vector3d& q : path)
    if (p.empty() || (q - p.back()).norm() > 1e-9) p.push_back(q);
  check_input(p.size() >= 2, "tube: the path needs two different points");
  Mesh mesh;
  const std::size_t n = p.size();
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d t = (p[std::min(i + 1, n - 1)] - p[i == 0 ? 0 : i - 1]).normalized();
    if (i == 0 || (x - x.dot(t) * t).norm() < 1e-6) x = any_orthogonal(t);
    x = (x - x.dot(t) * t).normalized();
    const Eigen::Vector3d y = t.cross(x);
    const double r = radius_begin + (radius_end - radius_begin) * static_cast<double>(i) / static_cast<double>(n - 1);
    for (int j = 0; j < sides; ++j) {
      const double a = kTwoPi * j / sides;
      mesh.vertices.push_back((p[i] + r * (std::cos(a) * x + std::sin(a) * y)).cast<float>());
    }
  }
  const auto at = [&](std::size_t i, int j) {
    return static_cast<std::uint32_t>(i * static_cast<std::size_t>(sides) + static_cast<std::size_t>(j % sides));
  };
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (int j = 0; j < sides; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  const auto begin = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(p.front().cast<float>());
  mesh.vertices.push_back(p.back().cast<float>());
  for (int j = 0; j < sides; ++j) {
    mesh.triangles.push_back({begin, at(0, j + 1), at(0, j)});
    mesh.triangles.push_back({begin + 1, at(n - 1, j), at(n - 1, j + 1)});
  }
  return mesh;
}

Mesh calyx_mesh(const FruitShape& shape, int sepals, double length, double lift, double phase) {
  Mesh mesh;
  constexpr int kRows = 5;
  const double reach = length / shape.equatorial;  // angle at the origin
  for (int k = 0; k < sepals; ++k) {
    const double middle = phase + kTwoPi * k / sepals;
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i <= kRows; ++i) {
      const double t = static_cast<double>(i) / kRows;
      const double theta = 0.05 + reach * t;
      const double half_width = 0.11 * length * (1.0 - t) * (1.0 + 1.5 * t) / shape.equatorial;  // angle at the origin
      for (const double side : {-1.0, 1.0}) {
        const double phi = middle + side * std::min(0.9 * kPi / sepals, half_width / std::sin(theta));
        const Eigen::Vector3d d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
        mesh.vertices.push_back(((shape.radius(d) + 0.0008 + lift * t * t) * d).cast<float>());
      }
    }
    for (std::uint32_t i = 0; i < kRows; ++i) {
      const std::uint32_t a = base + 2 * i;
      mesh.triangles.push_back({a, a + 2, a + 1});
      if (i + 1 < kRows) mesh.triangles.push_back({a + 1, a + 2, a + 3});
    }
  }
  return mesh;
}

Mesh leaf_mesh(double length, double width, double fold, double droop) {
  constexpr int kRows = 24, kAcross = 3;  // rows along the midrib, strips on either side of it
  Mesh mesh;
  for (int i = 0; i <= kRows; ++i) {
    const double t = static_cast<double>(i) / kRows;
    const double half = leaf_half_width(i, kRows, width, 0.86);
    for (int j = -kAcross; j <= kAcross; ++j) {
      const double across = half * j / kAcross;
      mesh.vertices.push_back(
          Eigen::Vector3d(length * t, across * std::cos(fold), std::abs(across) * std::sin(fold) - droop * t * t)
              .cast<float>());
    }
  }
  connect_rows(mesh, kRows, 2 * kAcross + 1);
  return mesh;
}

}  // namespace agrisee::study
