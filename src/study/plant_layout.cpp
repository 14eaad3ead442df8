// SPDX-License-Identifier: BSD-3-Clause
#include "plant_layout.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truss_parts.hpp"

namespace agrisee::study {

double PlantLayout::deepest() const {
  double depth = -1.0;  // trusses do not touch each other
  for (const TrussLayout& truss : trusses) depth = std::max(depth, truss.deepest());
  return depth;
}

Polyline smooth_curve(const Polyline& through, int segments) {
  Polyline out;
  const std::size_t last = through.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const Eigen::Vector3d &b = through[i], &c = through[i + 1];
    const Eigen::Vector3d a = i > 0 ? through[i - 1] : Eigen::Vector3d(2.0 * b - c);
    const Eigen::Vector3d d = i + 1 < last ? through[i + 2] : Eigen::Vector3d(2.0 * c - b);
    for (int k = 0; k < segments; ++k) {
      const double t = static_cast<double>(k) / segments, t2 = t * t, t3 = t2 * t;
      out.emplace_back(
          0.5 * (2.0 * b + t * (c - a) + t2 * (2.0 * a - 5.0 * b + 4.0 * c - d) + t3 * (3.0 * b - a - 3.0 * c + d)));
    }
  }
  out.push_back(through.back());
  return out;
}

namespace {

/// A fruit at `center`, whose calyx points along `axis`.
PlacedFruit hang(const FruitShape& shape, const Eigen::Vector3d& center, const Eigen::Vector3d& axis) {
  return place_fruit(shape, center, axis, 0.0, 48, 28);
}

/// Draws a growth axis: up, towards the stem by `inward`, and a little at random.
Eigen::Vector3d draw_axis(const Eigen::Vector3d& center, const Eigen::Vector3d& stem, double inward, Rng& rng) {
  Eigen::Vector3d to_stem = stem - center;
  to_stem.z() = 0.0;
  const double distance = to_stem.norm();
  if (distance > 1e-6) to_stem /= distance;
  return Eigen::Vector3d::UnitZ() + inward * to_stem + 0.12 * rng.direction();
}

/// Half width of fruit i of n: it falls steadily from the shoulder to the tip (m).
double radius_of(int i, int n, const PlantParameters& parameters) {
  const double rank = n > 1 ? static_cast<double>(i) / (n - 1) : 0.0;
  return parameters.radius_shoulder + rank * (parameters.radius_tip - parameters.radius_shoulder);
}

/// A truss whose rachis bends down: the fruit hang left and right of it in turn. The top of the fruit is at z = 0.
TrussLayout draw_truss(const PlantParameters& parameters, const PlantStyle& style, const FruitShape& cultivar, int n,
                       Rng& rng) {
  TrussLayout truss;
  truss.rachis_radius = style.rachis_radius;
  const double shoulder = parameters.radius_shoulder;
  const double first_side = rng.uniform() < 0.5 ? -1.0 : 1.0, loose = rng.uniform(0.97, 1.06);
  double bottom[2] = {0.0, -rng.uniform(0.4, 1.0) * shoulder};
  std::vector<FruitShape> shapes;
  Polyline centers;
  for (int i = 0; i < n; ++i) {
    const FruitShape s = draw_plant_fruit(style, cultivar, radius_of(i, n, parameters), rng);
    const double side = i % 2 ? first_side : -first_side, azimuth = rng.uniform(-0.6, 0.5);
    const double reach = radius_of(i, n, parameters) + 2.0 * style.rachis_radius;
    centers.emplace_back(side * std::cos(azimuth) * reach, std::sin(azimuth) * reach, bottom[i % 2] - loose * s.polar);
    bottom[i % 2] -= 1.95 * loose * s.polar;
    shapes.push_back(s);
  }
  const double height = -std::min(bottom[0], n > 1 ? bottom[1] : 0.0), top = 0.7 * shoulder;
  const double yaw = rng.uniform(-deg(25), deg(25)), lean = rng.uniform(0.0, 0.25);
  const double sway = rng.uniform(-0.01, 0.01), phase = rng.uniform(0.0, kTwoPi);
  const auto bent = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d q(p.x() + sway * std::sin(phase + 3.0 * p.z() / height), p.y() + lean * p.z(), p.z());
    return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * q;
  };
  constexpr int kPoints = 50;
  for (int i = 0; i <= kPoints; ++i) {
    const double t = static_cast<double>(i) / kPoints;
    truss.rachis.push_back(bent({0.0, 0.35 * shoulder * (1.0 - t), top - (top + 0.97 * height) * t}));
  }
  const double inward = rng.uniform(0.3, 0.7) * (style.trough ? 0.3 : 1.0);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::Vector3d center = bent(centers[i]);
    truss.fruits.push_back(
        hang(shapes[i], center, draw_axis(center, at_height(truss.rachis, center.z()), inward, rng)));
  }
  settle(truss, 0);
  return truss;
}

/// A main stem with fruit all around it. The top of the fruit is at z = 0.
TrussLayout draw_stem_with_fruit(const PlantParameters& parameters, const PlantStyle& style, const FruitShape& cultivar,
                                 int n, Rng& rng) {
  TrussLayout truss;
  truss.rachis_radius = style.stem_radius + (style.string ? 0.0025 : 0.001);
  const double sway = rng.uniform(0.003, 0.008), phase = rng.uniform(0.0, kTwoPi), twist = rng.uniform(0.5, 1.5);
  for (int i = 0; i <= 240; ++i) {
    const double z = 0.32 - 0.005 * i;
    truss.rachis.emplace_back(sway * std::sin(phase + 9.0 * z), sway * std::cos(phase + 9.0 * twist * z), z);
  }
  double azimuth = rng.uniform(-0.8, 0.8) - 0.5 * kPi, top = 0.0;  // the first fruit hangs in front
  const double golden = deg(137.5), inward = rng.uniform(0.05, 0.3);
  for (int i = 0; i < n; ++i, azimuth += golden + rng.uniform(-0.3, 0.3)) {
    const FruitShape s = draw_plant_fruit(style, cultivar, radius_of(i, n, parameters), rng);
    const double reach = 1.08 * radius_of(i, n, parameters) + truss.rachis_radius + rng.uniform(0.0, 0.008);
    const Eigen::Vector3d center(reach * std::cos(azimuth), reach * std::sin(azimuth), top - s.polar);
    truss.fruits.push_back(hang(s, center, draw_axis(center, at_height(truss.rachis, center.z()), inward, rng)));
    top -= rng.uniform(0.75, 1.05) * s.polar;
  }
  settle(truss, 0);
  return truss;
}

Aabb box_of(const TrussLayout& truss) {
  Aabb box;
  for (const PlacedFruit& fruit : truss.fruits)
    for (const Eigen::Vector3d& offset : fruit.surface) box.extend(fruit.center() + offset);
  return box;
}

void move(TrussLayout& truss, const Eigen::Vector3d& by) {
  for (PlacedFruit& fruit : truss.fruits) fruit.world_T_body.translation() += by;
  for (Eigen::Vector3d& p : truss.rachis) p += by;
}

/// Moves the trusses side by side, and all of them to the middle of the plant.
void arrange(PlantLayout& layout, const Eigen::Vector3d& center, Rng& rng) {
  for (std::size_t i = 0; i < layout.trusses.size(); ++i) {
    TrussLayout& truss = layout.trusses[i];
    truss.eye = frontal_eye(center);
    if (i > 0) {
      const double gap = rng.uniform(0.004, 0.02), rise = rng.uniform(-0.05, 0.05);
      move(truss, {layout.fruits.max.x() + gap - box_of(truss).min.x(), 0.0, rise});
    }
    const Aabb box = box_of(truss);
    layout.fruits.extend(box.min);
    layout.fruits.extend(box.max);
  }
  const Eigen::Vector3d by = center - layout.fruits.center();
  for (TrussLayout& truss : layout.trusses) move(truss, by);
  layout.fruits.min += by;
  layout.fruits.max += by;
}

/// Cuts the main stems that bear fruit at the ground, and lets them join towards it.
void root(PlantLayout& layout) {
  double foot = 0.0;
  for (const TrussLayout& truss : layout.trusses)
    foot += truss.rachis.back().x() / static_cast<double>(layout.trusses.size());
  const double fruit_bottom = layout.fruits.min.z();
  for (TrussLayout& truss : layout.trusses) {
    Polyline& path = truss.rachis;
    while (path.size() > 2 && path.back().z() < layout.ground - 0.01) path.pop_back();
    for (Eigen::Vector3d& p : path) {
      const double below = std::clamp((fruit_bottom - p.z()) / 0.25, 0.0, 1.0);
      p.x() += 0.8 * below * (foot - p.x());
    }
    layout.stems.push_back(path);
  }
}

/// Adds the main stem behind the trusses, or the crown in its trough, and the peduncles.
void add_stem(PlantLayout& layout, const PlantStyle& style, Rng& rng) {
  const Aabb& box = layout.fruits;
  const double aside = layout.trusses.size() > 1 ? 0.0 : rng.uniform(-0.03, 0.03), x = box.center().x() + aside;
  Polyline stem;
  double start = 0.0;  // height at which the peduncles leave the stem, above the rachis
  if (style.trough) {
    double top = box.max.z() + 0.012;
    for (const TrussLayout& truss : layout.trusses) top = std::max(top, truss.rachis.front().z() - 0.004);
    const double front = box.max.y() + 0.014;
    layout.trough.extend({box.center().x() - 0.42, front, top - 0.11});
    layout.trough.extend({box.center().x() + 0.42, front + 0.16, top});
    for (int i = 0; i <= 5; ++i) stem.emplace_back(x, front + 0.05, top + 0.03 - 0.009 * i);
    layout.back = front + 0.16;
  } else {
    const double y = box.max.y() + 1.5 * layout.stem_radius + 0.006, sway = rng.uniform(0.002, 0.006);
    const double phase = rng.uniform(0.0, kTwoPi), top = box.max.z() + 0.3;
    const int points = static_cast<int>((top - layout.ground + 0.01) / 0.008);
    for (int i = 0; i <= points; ++i) {
      const double z = top - 0.008 * i;
      stem.emplace_back(x + sway * std::sin(phase + 8.0 * z), y + std::abs(sway * std::cos(phase + 11.0 * z)), z);
    }
    layout.back = y + sway + layout.stem_radius;
    start = rng.uniform(0.005, 0.03);
  }
  for (const TrussLayout& truss : layout.trusses) {
    const Eigen::Vector3d end = truss.rachis.front();
    const Eigen::Vector3d node = style.trough ? Eigen::Vector3d(stem.front() - Eigen::Vector3d(0.0, 0.0, 0.006))
                                              : at_height(stem, end.z() + start);
    Eigen::Vector3d over = 0.5 * (node + end) + Eigen::Vector3d(0.0, 0.0, 0.015);
    if (style.trough) over = Eigen::Vector3d(end.x(), layout.trough.min.y() - 0.004, layout.trough.max.z() + 0.016);
    layout.peduncles.push_back(smooth_curve({node, over, end, truss.rachis[4]}, 6));
    layout.peduncles.back().resize(layout.peduncles.back().size() - 6);  // ends where the rachis begins
  }
  layout.stems.push_back(std::move(stem));
}

}  // namespace

PlantLayout draw_plant(const PlantParameters& parameters, const PlantStyle& style, Rng& rng) {
  PlantLayout layout;
  layout.stem_radius = style.stem_radius * rng.uniform(0.85, 1.2);
  const FruitShape cultivar = draw_cultivar(style, rng);
  for (int k = 0; k < parameters.trusses; ++k) {
    const int n = parameters.total / parameters.trusses + (k < parameters.total % parameters.trusses ? 1 : 0);
    layout.trusses.push_back(style.on_stem ? draw_stem_with_fruit(parameters, style, cultivar, n, rng)
                                           : draw_truss(parameters, style, cultivar, n, rng));
  }
  arrange(layout, parameters.center, rng);
  layout.ground = parameters.pots > 0 ? layout.fruits.min.z() - rng.uniform(0.03, 0.05) : parameters.center.z() - 0.55;
  if (style.on_stem) {
    root(layout);
    layout.back = layout.fruits.max.y();
  } else {
    add_stem(layout, style, rng);
  }
  return layout;
}

namespace {

/// A string that winds around a main stem.
Mesh string_mesh(const Polyline& stem, double stem_radius, Rng& rng) {
  constexpr double kRadius = 0.0009, kTurn = 0.11;  // of the string, and height of one turn (m)
  const double phase = rng.uniform(0.0, kTwoPi), radius = stem_radius + 0.6 * kRadius;
  Polyline path;
  for (const Eigen::Vector3d& p : stem) {
    const double angle = phase + kTwoPi * p.z() / kTurn;
    path.emplace_back(p + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  }
  return tube_mesh(path, kRadius, kRadius, 6);
}

}  // namespace

Mesh plant_stem_mesh(const PlantLayout& layout, const PlantStyle& style, Rng& rng) {
  Mesh stem;
  for (const Polyline& path : layout.stems) {
    append(stem, tube_mesh(path, layout.stem_radius, layout.stem_radius, 12));
    if (style.string) append(stem, string_mesh(path, layout.stem_radius, rng));
  }
  for (std::size_t i = 0; i < layout.trusses.size(); ++i) {
    const TrussLayout& truss = layout.trusses[i];
    if (!layout.peduncles.empty()) {
      Polyline path = layout.peduncles[i];
      path.insert(path.end(), truss.rachis.begin(), truss.rachis.end());
      append(stem, tube_mesh(path, 1.3 * style.rachis_radius, 0.6 * style.rachis_radius));
    }
    append_pedicels(stem, truss, style.pedicel_radius, style.calyces, rng);
  }
  return stem;
}

}  // namespace agrisee::study
