// SPDX-License-Identifier: BSD-3-Clause
#include "plant_surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace agrisee::study {

namespace {

Mesh box_mesh(const Aabb& box) {
  Mesh mesh;
  for (unsigned i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(static_cast<float>(i & 1u ? box.max.x() : box.min.x()),
                               static_cast<float>(i & 2u ? box.max.y() : box.min.y()),
                               static_cast<float>(i & 4u ? box.max.z() : box.min.z()));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A rough trunk with burls and a branch. It leans a little; its axis is at (x, y) at the height z.
Mesh draw_trunk(double x, double y, double z, double radius, Rng& rng) {
  const double lean_x = rng.uniform(-0.12, 0.12), lean_y = rng.uniform(0.0, 0.1);
  const auto axis = [&](double height) {
    return Eigen::Vector3d(x + lean_x * (height - z), y + lean_y * std::max(0.0, height - z), height);
  };
  Polyline path;
  for (int i = 0; i <= 100; ++i) path.push_back(axis(z - 0.55 + 0.0105 * i));
  Mesh trunk = tube_mesh(path, radius, 0.85 * radius, 28);
  struct Burl {
    double height, angle, size;
  };
  std::vector<Burl> burls;
  for (int i = 0; i < 7; ++i)
    burls.push_back({z + rng.uniform(-0.25, 0.25), rng.uniform(0.0, kTwoPi), rng.uniform(0.08, 0.25)});
  const double phase = rng.uniform(0.0, kTwoPi);
  for (std::size_t i = 0; i + 2 < trunk.vertices.size(); ++i) {  // the last two are the middles of the ends
    const Eigen::Vector3d v = trunk.vertices[i].cast<double>(), middle = axis(v.z()), out = v - middle;
    const double angle = std::atan2(out.y(), out.x());
    double swell = 0.025 * std::sin(7.0 * angle + phase + 12.0 * v.z()) + 0.02 * std::sin(60.0 * v.z() + 3.0 * angle);
    for (const Burl& burl : burls) {
      const double around = 1.0 - std::cos(angle - burl.angle), along = (v.z() - burl.height) / radius;
      swell += burl.size * std::exp(-4.0 * around - 2.0 * along * along);
    }
    trunk.vertices[i] = (middle + (1.0 + swell) * out).cast<float>();
  }
  const double fork = z + rng.uniform(0.0, 0.12), side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  const Polyline branch = smooth_curve({axis(fork - 0.02), axis(fork + 0.06) + Eigen::Vector3d(side * 0.07, 0.015, 0.0),
                                        axis(fork + 0.2) + Eigen::Vector3d(side * 0.16, 0.05, 0.0),
                                        axis(fork + 0.4) + Eigen::Vector3d(side * 0.22, 0.08, 0.0)},
                                       8);
  append(trunk, tube_mesh(branch, 0.6 * radius, 0.4 * radius, 18));
  return trunk;
}

/// Appends the pots and their bench. @return the box around them, empty without pots
Aabb append_pots(std::vector<Mesh>& out, const PlantParameters& parameters, const PlantLayout& layout, Rng& rng) {
  Aabb box;
  if (parameters.pots == 0) return box;
  Eigen::Vector3d first(layout.fruits.center().x(), layout.fruits.center().y() + 0.02, layout.ground);
  if (layout.trough.empty()) {  // below the middle of the main stems
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Polyline& stem : layout.stems) sum += stem.back();
    first = sum / static_cast<double>(layout.stems.size());
    first.z() = layout.ground;
  } else {
    first.y() = layout.trough.center().y();
    first.z() = std::min(first.z(), layout.trough.min.z() - 0.03);
  }
  const double radius = rng.uniform(0.075, 0.1), height = 1.5 * radius, side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  for (int i = 0; i < parameters.pots; ++i) {
    const Eigen::Vector3d top = first + Eigen::Vector3d(i * side * 2.3 * radius, 0.0, 0.0);
    const Eigen::Vector3d bottom = top - Eigen::Vector3d(0.0, 0.0, height);
    Mesh pot = tube_mesh({bottom, top}, 0.75 * radius, radius, 40);
    append(pot, tube_mesh({top - Eigen::Vector3d(0.0, 0.0, 0.02), top}, 1.06 * radius, 1.06 * radius, 40));
    out.push_back(pot);
    box.extend(bottom - Eigen::Vector3d(1.1 * radius, 1.1 * radius, 0.0));
    box.extend(top + Eigen::Vector3d(1.1 * radius, 1.1 * radius, 0.0));
  }
  Aabb bench;
  bench.extend({box.min.x() - 0.1, box.min.y() - 0.02, box.min.z() - 0.02});
  bench.extend({box.max.x() + 0.1, box.max.y() + 0.05, box.min.z()});
  out.push_back(box_mesh(bench));
  return box;
}

void append_posts(std::vector<Mesh>& out, const PlantParameters& parameters, const PlantLayout& layout,
                  const Aabb& pots, Rng& rng) {
  const Aabb& box = layout.fruits;
  const double first_side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  for (int i = 0; i < parameters.posts; ++i) {
    const double radius = rng.uniform(0.012, 0.025), gap = radius + rng.uniform(0.015, 0.05);
    const double side = i % 2 ? -first_side : first_side;
    double x = side < 0.0 ? box.min.x() - gap : box.max.x() + gap;
    if (!pots.empty())
      x = side < 0.0 ? std::min(x, pots.min.x() - radius - 0.005) : std::max(x, pots.max.x() + radius + 0.005);
    double y = rng.uniform(box.center().y(), std::max(box.center().y() + 0.001, box.max.y() - radius));
    if (i == 2) {  // behind the plant, past the first
      x += side * 0.09;
      y = layout.back + 0.04 + radius;
    }
    const double low = pots.empty() ? parameters.center.z() - 0.6 : pots.min.z();
    const int sides = rng.uniform() < 0.4 ? 4 : 32;  // square or round
    out.push_back(tube_mesh({{x, y, low}, {x, y, parameters.center.z() + 0.5}}, radius, radius, sides));
  }
}

void append_wires(std::vector<Mesh>& out, const PlantParameters& parameters, const PlantLayout& layout, Rng& rng) {
  const Aabb& box = layout.fruits;
  const double y = layout.trough.empty() ? layout.back + 0.005 : box.max.y() + 0.006;
  for (int i = 0; i < parameters.wires; ++i) {
    const double share = (i + rng.uniform(0.2, 0.8)) / parameters.wires;
    const double z = box.min.z() + share * (box.size().z() + (layout.trough.empty() ? 0.06 : -0.02));
    const double sag = rng.uniform(0.0, 0.012), radius = rng.uniform(0.001, 0.002);
    Polyline path;
    for (int k = -20; k <= 20; ++k) path.emplace_back(parameters.center.x() + 0.03 * k, y, z + sag * k * k / 400.0);
    out.push_back(tube_mesh(path, radius, radius, 8));
  }
}

}  // namespace

std::vector<Mesh> draw_surroundings(const PlantParameters& parameters, const PlantLayout& layout, Rng& rng) {
  std::vector<Mesh> out;
  if (!layout.trough.empty()) out.push_back(box_mesh(layout.trough));
  const Aabb pots = append_pots(out, parameters, layout, rng);
  append_posts(out, parameters, layout, pots, rng);
  append_wires(out, parameters, layout, rng);
  if (parameters.trunk) {
    const double radius = rng.uniform(0.028, 0.05), back = std::max(layout.back, pots.empty() ? 0.0 : pots.max.y());
    const double x = layout.fruits.center().x() + rng.uniform(-0.08, 0.08);
    out.push_back(draw_trunk(x, back + 0.02 + 1.3 * radius, parameters.center.z(), radius, rng));
  }
  return out;
}

}  // namespace agrisee::study
