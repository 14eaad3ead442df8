// SPDX-License-Identifier: BSD-3-Clause
#include "truss_layout.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace agrisee::study {

double PlacedFruit::depth(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d d = p - center();
  const double distance = d.norm();
  if (distance < 1e-9) return shape.polar;
  return shape.radius(world_T_body.linear().transpose() * (d / distance)) - distance;
}

double interpenetration(const PlacedFruit& a, const PlacedFruit& b, double far) {
  double deepest = -far;
  const auto probe = [&](const PlacedFruit& from, const PlacedFruit& to) {
    const double reach = to.shape.max_radius() + far;
    for (const Eigen::Vector3d& offset : from.surface) {
      const Eigen::Vector3d p = from.center() + offset;
      if ((p - to.center()).squaredNorm() < reach * reach) deepest = std::max(deepest, to.depth(p));
    }
  };
  const double bound = a.shape.max_radius() + b.shape.max_radius() + far;
  if ((a.center() - b.center()).squaredNorm() >= bound * bound) return deepest;
  probe(a, b);
  probe(b, a);
  return deepest;
}

double TrussLayout::deepest() const {
  double d = -1.0;
  for (std::size_t i = 0; i < fruits.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) d = std::max(d, interpenetration(fruits[i], fruits[j]));
  return d;
}

FruitShape draw_shape(const TrussParameters& parameters, double size, Rng& rng) {
  FruitShape s;
  s.lobes = 4 + static_cast<int>(rng.below(4));
  s.lobe_amplitude = rng.uniform(0.005, 0.018);
  s.lobe_phase = rng.uniform(0.0, kTwoPi);
  s.dimple_depth = rng.uniform(0.06, 0.13);
  s.dimple_width = rng.uniform(0.28, 0.42);
  double flat = rng.uniform(0.86, 0.96);  // polar / equatorial semi-axis, before the elongation
  const double largest = parameters.radius_max / (1.0 + s.lobe_amplitude);
  s.equatorial = std::clamp(size, std::min(parameters.radius_min / (1.0 - s.lobe_amplitude), largest), largest);
  flat = std::max(flat, std::min(1.0, parameters.radius_min / s.equatorial));
  s.polar = parameters.elongation * flat * s.equatorial;
  return s;
}

PlacedFruit place_fruit(const FruitShape& shape, const Eigen::Vector3d& center, const Eigen::Vector3d& axis,
                        double turn, int around, int rows) {
  PlacedFruit f;
  f.shape = shape;
  const Eigen::Vector3d z = axis.normalized(), x = any_orthogonal(z);
  f.world_T_body.linear().col(0) = x;
  f.world_T_body.linear().col(1) = z.cross(x);
  f.world_T_body.linear().col(2) = z;
  f.world_T_body.translation() = center;
  if (turn != 0.0) f.world_T_body.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  const Mesh mesh = fruit_mesh(shape, around, rows);
  for (const Eigen::Vector3f& v : mesh.vertices) f.surface.push_back(f.world_T_body.linear() * v.cast<double>());
  return f;
}

namespace {

/// Draws the direction of a fruit's growth axis: up, towards the rachis, and a little at random.
Eigen::Vector3d draw_growth_axis(const std::vector<Eigen::Vector3d>& rachis, const Eigen::Vector3d& center, Rng& rng) {
  Eigen::Vector3d inward = at_height(rachis, center.z()) - center;
  inward.z() = 0.0;
  inward = inward.norm() > 1e-6 ? inward.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitY());
  const Eigen::Vector3d random = rng.direction();
  const double random_share = rng.uniform(0.0, 0.25), inward_share = rng.uniform(0.35, 0.85);
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ() + inward_share * inward + random_share * random;
  return axis.normalized();
}

/// Adds up how far the fruit from index `first` on must move so that nothing interpenetrates.
/// @param push receives one displacement per fruit (m)
/// @return the deepest interpenetration (m)
double push_apart(const TrussLayout& layout, std::size_t first, std::vector<Eigen::Vector3d>& push) {
  const std::vector<PlacedFruit>& fruits = layout.fruits;
  double deepest = 0.0;
  push.assign(fruits.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = first; i < fruits.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double depth = interpenetration(fruits[i], fruits[j], 0.0);
      if (depth <= 1e-4) continue;
      deepest = std::max(deepest, depth);
      const Eigen::Vector3d d = fruits[i].center() - fruits[j].center();
      const Eigen::Vector3d away = d.norm() > 1e-6 ? d.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitY());
      const bool both = j >= first;
      push[i] += (both ? 0.5 : 1.0) * depth * away;
      if (both) push[j] -= 0.5 * depth * away;
    }
    for (const Eigen::Vector3d& p : layout.rachis) {
      const double depth = fruits[i].depth(p) + layout.rachis_radius + 5e-4;
      if (depth <= 0.0) continue;
      deepest = std::max(deepest, depth);
      Eigen::Vector3d away = fruits[i].center() - p;
      away.z() = 0.0;
      if (away.norm() > 1e-6) push[i] += 0.5 * depth * away.normalized();
    }
  }
  return deepest;
}

}  // namespace

PlacedFruit draw_fruit(const FruitShape& shape, const Eigen::Vector3d& center,
                       const std::vector<Eigen::Vector3d>& rachis, Rng& rng) {
  const double turn = rng.uniform(0.0, kTwoPi);
  const Eigen::Vector3d axis = draw_growth_axis(rachis, center, rng);
  return place_fruit(shape, center, axis, turn, 26, 18);
}

Eigen::Vector3d at_height(const std::vector<Eigen::Vector3d>& polyline, double z) {
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Eigen::Vector3d &a = polyline[i], &b = polyline[i + 1];
    if (z >= a.z()) return a;
    if (z > b.z()) return a + (b - a) * ((a.z() - z) / (a.z() - b.z()));
  }
  return polyline.back();
}

void settle(TrussLayout& layout, std::size_t first) {
  constexpr int kRounds = 150;
  std::vector<Eigen::Vector3d> push;
  for (int round = 0; round < kRounds; ++round) {
    if (push_apart(layout, first, push) <= 2e-4) break;
    for (std::size_t i = first; i < layout.fruits.size(); ++i) layout.fruits[i].world_T_body.translation() += push[i];
  }
}

void hide_behind(TrussLayout& layout, int count, const TrussParameters& parameters, double spread, Rng& rng) {
  const std::size_t front = layout.fruits.size();
  std::vector<std::size_t> hosts(front);  // the fruit to hide behind, in random order
  for (std::size_t i = 0; i < front; ++i) hosts[i] = i;
  for (std::size_t i = front; i > 1; --i) std::swap(hosts[i - 1], hosts[rng.below(i)]);
  for (int k = 0; k < count; ++k) {
    const PlacedFruit& host = layout.fruits[hosts[static_cast<std::size_t>(k)]];
    const FruitShape shape = draw_shape(parameters, host.shape.equatorial * rng.uniform(0.85, 1.0), rng);
    const Eigen::Vector3d ray = (host.center() - layout.eye).normalized();
    const Eigen::Vector3d across = ray.cross(rng.direction());
    const Eigen::Vector3d stray = 0.4 * spread * shape.equatorial * rng.uniform() * across;
    const Eigen::Vector3d center = host.center() + 0.97 * (host.shape.equatorial + shape.equatorial) * ray + stray;
    PlacedFruit fruit = draw_fruit(shape, center, layout.rachis, rng);
    fruit.hidden = true;
    layout.fruits.push_back(std::move(fruit));
  }
  settle(layout, front);
}

namespace {

/// The fruit in front, in the frame of the truss: the rachis is the z axis, and the fruit hang at x < 0 and x > 0 in
/// turn, the largest on top.
struct TwoRows {
  std::vector<FruitShape> shapes;        ///< from top to bottom
  std::vector<Eigen::Vector3d> centers;  ///< one per shape (m)
  double height = 0.0;                   ///< of the longer row (m); it reaches from z = 0 down to -height
};

/// @param mean_radius mean of the smallest and the largest semi-axis (m)
TwoRows draw_two_rows(const TrussParameters& parameters, double spread, double mean_radius, double rachis_radius,
                      Rng& rng) {
  TwoRows rows;
  const int front = parameters.total - parameters.hidden;
  const double first_side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  double bottom[2] = {0.0, -rng.uniform(0.3, 0.9) * mean_radius};  // height down to which each row is filled
  for (int i = 0; i < front; ++i) {
    const double rank = parameters.total > 1 ? static_cast<double>(i) / (parameters.total - 1) : 0.5;
    const double range = parameters.radius_max - parameters.radius_min;
    const double size = parameters.radius_min + range * std::clamp(0.9 - 0.65 * rank + 0.12 * rng.normal(), 0.0, 1.0);
    const FruitShape s = draw_shape(parameters, size, rng);
    const int row = i % 2;
    const double side = first_side * (row == 0 ? -1.0 : 1.0);
    rows.centers.emplace_back(side * (0.96 * s.equatorial + rachis_radius), spread * 0.12 * mean_radius * rng.normal(),
                              bottom[row] - s.polar);
    bottom[row] -= 1.96 * s.polar;
    rows.shapes.push_back(s);
  }
  rows.height = -std::min(bottom[0], front > 1 ? bottom[1] : 0.0);
  return rows;
}

}  // namespace

TrussLayout herringbone(const TrussParameters& parameters, double spread, Rng& rng) {
  TrussLayout layout;
  layout.eye = frontal_eye(parameters.center);
  const double mean = 0.5 * (parameters.radius_min + parameters.radius_max);
  layout.rachis_radius = std::clamp(0.07 * mean, 0.001, 0.003);
  const TwoRows rows = draw_two_rows(parameters, spread, mean, layout.rachis_radius, rng);

  const double height = rows.height;
  const double yaw = spread * rng.uniform(-deg(22), deg(22));
  const double lean = spread * rng.uniform(-0.1, 0.35);  // how far the top leans away from the robot (m per m)
  const double sway = spread * rng.uniform(-0.012, 0.012), sway_phase = rng.uniform(0.0, kTwoPi);
  const auto in_world = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const double t = p.z() + 0.5 * height;
    const Eigen::Vector3d hung(p.x() + sway * std::sin(sway_phase + 3.0 * t / height), p.y() + lean * t, t);
    return parameters.center + Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * hung;
  };
  const double behind = 0.45 * mean;  // the rachis runs a little behind the fruit, where there is room between them
  for (int i = 0; i <= 40; ++i)
    layout.rachis.push_back(in_world({0.0, behind, 0.9 * mean - (height + 0.2 * mean) * i / 40.0}));
  for (std::size_t i = 0; i < rows.shapes.size(); ++i)
    layout.fruits.push_back(draw_fruit(rows.shapes[i], in_world(rows.centers[i]), layout.rachis, rng));
  settle(layout, 0);
  hide_behind(layout, parameters.hidden, parameters, spread, rng);
  return layout;
}

}  // namespace agrisee::study
