// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the fruit of a procedural truss hang: two rows along a rachis (herringbone), touching but not
/// interpenetrating, and the hidden ones behind others as seen from the robot. World frame; the robot looks along +y, z
/// is up; metres. Cost: some tens of milliseconds for a dozen fruit.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/study/truss_mesh.hpp>

namespace agrisee::study {

/// What truss to make.
struct TrussParameters {
  int total = 7;                                  ///< number of fruit, 1 to 12
  int hidden = 1;                                 ///< how many of them are behind the others, 0 to total / 2
  std::uint64_t seed = 1;                         ///< equal parameters and seeds give equal trusses
  double radius_min = 0.028;                      ///< smallest semi-axis of a fruit (m)
  double radius_max = 0.042;                      ///< largest semi-axis of a fruit, its lobes included (m)
  double elongation = 1.0;                        ///< factor on all polar semi-axes after that: 1.5 makes plum types
  int leaflets = 0;                               ///< number of leaflets, 0 to 6
  Eigen::Vector3d center = {0.015, 0.545, 0.21};  ///< middle of the truss (m, world)

  /// The paper's trusses; the defaults.
  static TrussParameters paper() { return {}; }
  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(total >= 1 && total <= 12, "total", "1 to 12", total);
    check_parameter(hidden >= 0 && hidden <= total / 2, "hidden", "0 to half of total", hidden);
    check_parameter(std::isfinite(radius_min) && radius_min >= 0.005, "radius_min", ">= 0.005 m", radius_min);
    check_parameter(std::isfinite(radius_max) && radius_max >= radius_min && radius_max <= 0.06, "radius_max",
                    "between radius_min and 0.06 m", radius_max);
    check_parameter(elongation >= 0.5 && elongation <= 2.0, "elongation", "0.5 to 2", elongation);
    check_parameter(leaflets >= 0 && leaflets <= 6, "leaflets", "0 to 6", leaflets);
    check_parameter(center.allFinite(), "center", "finite", center.x());
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("total", p.total);
    f("hidden", p.hidden);
    f("seed", p.seed);
    f("radius_min", p.radius_min);
    f("radius_max", p.radius_max);
    f("elongation", p.elongation);
    f("leaflets", p.leaflets);
    f("center", p.center);
  }
};

/// A fruit in its place.
struct PlacedFruit {
  FruitShape shape;                      ///< of its surface
  Pose world_T_body = Pose::Identity();  ///< z is the growth axis
  bool hidden = false;                   ///< hangs behind the others
  std::vector<Eigen::Vector3d> surface;  ///< points all over its surface (m, relative to its origin, world axes)

  /// M, world.
  Eigen::Vector3d center() const { return world_T_body.translation(); }
  /// Depth (m) of a world point below the surface, along the radius; negative outside.
  double depth(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - center();
    const double distance = d.norm();
    if (distance < 1e-9) return shape.polar;
    return shape.radius(world_T_body.linear().transpose() * (d / distance)) - distance;
  }
};

/// How deep (m) two fruit interpenetrate, measured along the radius at the points of either surface, and therefore
/// never underestimated but for the spacing of these; negative: about the gap between them (at most `far`).
inline double interpenetration(const PlacedFruit& a, const PlacedFruit& b, double far = 0.01) {
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

/// Fruit on a rachis.
struct TrussLayout {
  std::vector<PlacedFruit> fruits;                ///< those in front from top to bottom, then the hidden ones
  std::vector<int> hosts;                         ///< for each hidden fruit the one it hides behind
  std::vector<Eigen::Vector3d> rachis;            ///< polyline from top to bottom
  double rachis_radius = 0.0025;                  ///< m
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< where the hidden fruit must not be seen from (m)

  /// Largest interpenetration of any two fruit (m); negative when all are apart.
  double deepest() const {
    double d = -1.0;
    for (std::size_t i = 0; i < fruits.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) d = std::max(d, interpenetration(fruits[i], fruits[j]));
    return d;
  }
};

/// Distance (m) from which a fruit counts as hidden or not: straight in front of the truss's middle, along +y.
constexpr double kFrontalDistance = 0.38;

/// A fruit of largest semi-axis about `size` within the parameters' limits, then elongated; `flat` = polar / equatorial
/// semi-axis before that.
inline FruitShape draw_shape(const TrussParameters& params, double size, Rng& rng) {
  FruitShape s;
  s.lobes = 4 + static_cast<int>(rng.below(4));
  s.lobe_amplitude = rng.uniform(0.005, 0.018);
  s.lobe_phase = rng.uniform(0.0, kTwoPi);
  s.dimple_depth = rng.uniform(0.06, 0.13);
  s.dimple_width = rng.uniform(0.28, 0.42);
  double flat = rng.uniform(0.86, 0.96);
  const double largest = params.radius_max / (1.0 + s.lobe_amplitude);
  s.equatorial = std::clamp(size, std::min(params.radius_min / (1.0 - s.lobe_amplitude), largest), largest);
  flat = std::max(flat, std::min(1.0, params.radius_min / s.equatorial));
  s.polar = params.elongation * flat * s.equatorial;
  return s;
}

/// A fruit at `center` whose calyx points along `axis`, turned about it by `turn` (rad).
inline PlacedFruit place(const FruitShape& shape, const Eigen::Vector3d& center, const Eigen::Vector3d& axis,
                         double turn) {
  PlacedFruit f;
  f.shape = shape;
  const Eigen::Vector3d z = axis.normalized(), x = any_orthogonal(z);
  f.world_T_body.linear().col(0) = x;
  f.world_T_body.linear().col(1) = z.cross(x);
  f.world_T_body.linear().col(2) = z;
  f.world_T_body.translation() = center;
  f.world_T_body.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  const Mesh mesh = fruit_mesh(shape, 26, 18);
  for (const Eigen::Vector3f& v : mesh.vertices) f.surface.push_back(f.world_T_body.linear() * v.cast<double>());
  return f;
}

/// The point of a polyline nearest to the height z (m); polylines here descend.
inline Eigen::Vector3d at_height(const std::vector<Eigen::Vector3d>& polyline, double z) {
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Eigen::Vector3d &a = polyline[i], &b = polyline[i + 1];
    if (z >= a.z()) return a;
    if (z > b.z()) return a + (b - a) * ((a.z() - z) / (a.z() - b.z()));
  }
  return polyline.back();
}

/// The direction in which a fruit's calyx points: up, and towards the rachis it hangs from, a little at random.
inline Eigen::Vector3d draw_growth_axis(const std::vector<Eigen::Vector3d>& rachis, const Eigen::Vector3d& center,
                                        Rng& rng) {
  Eigen::Vector3d inward = at_height(rachis, center.z()) - center;
  inward.z() = 0.0;
  inward = inward.norm() > 1e-6 ? inward.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitY());
  const Eigen::Vector3d axis =
      Eigen::Vector3d::UnitZ() + rng.uniform(0.35, 0.85) * inward + rng.uniform(0.0, 0.25) * rng.direction();
  return axis.normalized();
}

/// Push fruit apart, and off the rachis, until nothing is deeper than 0.2 mm; only those from index `first` on move, so
/// that one may settle the front before what hides behind it. Hidden fruit also slide back into the shadow of their
/// hosts.
/// @return the deepest interpenetration that is left (m)
inline double settle(TrussLayout& layout, std::size_t first, int rounds = 150) {
  auto& fruits = layout.fruits;
  double deepest = 0.0;
  for (int round = 0; round < rounds; ++round) {
    deepest = 0.0;
    std::vector<Eigen::Vector3d> push(fruits.size(), Eigen::Vector3d::Zero());
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
    if (deepest <= 2e-4) break;
    for (std::size_t i = first; i < fruits.size(); ++i) fruits[i].world_T_body.translation() += push[i];
  }
  return deepest;
}

/// Hang `count` hidden fruit behind different ones of those in front, and settle them. `spread` (0..1) scales how far
/// they stray.
inline void hide_behind(TrussLayout& layout, int count, const TrussParameters& params, double spread, Rng& rng) {
  const std::size_t front = layout.fruits.size();
  std::vector<int> hosts(front);
  for (std::size_t i = 0; i < front; ++i) hosts[i] = static_cast<int>(i);
  for (std::size_t i = front; i > 1; --i) std::swap(hosts[i - 1], hosts[rng.below(i)]);
  for (int k = 0; k < count; ++k) {
    const int h = hosts[static_cast<std::size_t>(k)];
    const PlacedFruit& host = layout.fruits[static_cast<std::size_t>(h)];
    const FruitShape shape = draw_shape(params, host.shape.equatorial * rng.uniform(0.85, 1.0), rng);
    const Eigen::Vector3d ray = (host.center() - layout.eye).normalized();
    const Eigen::Vector3d stray = 0.4 * spread * shape.equatorial * rng.uniform() * ray.cross(rng.direction());
    const Eigen::Vector3d center = host.center() + 0.97 * (host.shape.equatorial + shape.equatorial) * ray + stray;
    PlacedFruit fruit = place(shape, center, draw_growth_axis(layout.rachis, center, rng), rng.uniform(0.0, kTwoPi));
    fruit.hidden = true;
    layout.fruits.push_back(std::move(fruit));
    layout.hosts.push_back(h);
  }
  settle(layout, front);
}

/// A herringbone truss. `spread` (0..1) scales all that varies from truss to truss: yaw, lean, sway, stray.
inline TrussLayout herringbone(const TrussParameters& params, double spread, Rng& rng) {
  const int front = params.total - params.hidden;
  TrussLayout layout;
  layout.eye = params.center - kFrontalDistance * Eigen::Vector3d::UnitY();
  const double mean = 0.5 * (params.radius_min + params.radius_max);
  layout.rachis_radius = std::clamp(0.07 * mean, 0.001, 0.003);

  // In the truss's own frame: the rachis is the z axis, fruit alternate on either side, the uppermost are the largest.
  std::vector<FruitShape> shapes;
  std::vector<Eigen::Vector3d> centers;
  const double first_side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  double bottom[2] = {0.0, -rng.uniform(0.3, 0.9) * mean};  // height to which each row is filled
  for (int i = 0; i < front; ++i) {
    const double rank = params.total > 1 ? static_cast<double>(i) / (params.total - 1) : 0.5;
    const double range = params.radius_max - params.radius_min;
    const double size = params.radius_min + range * std::clamp(0.9 - 0.65 * rank + 0.12 * rng.normal(), 0.0, 1.0);
    const FruitShape s = draw_shape(params, size, rng);
    const int row = i % 2;
    const double side = first_side * (row == 0 ? -1.0 : 1.0);
    centers.emplace_back(side * (0.96 * s.equatorial + layout.rachis_radius), spread * 0.12 * mean * rng.normal(),
                         bottom[row] - s.polar);
    bottom[row] -= 1.96 * s.polar;
    shapes.push_back(s);
  }
  const double height = -std::min(bottom[0], front > 1 ? bottom[1] : 0.0);
  const double yaw = spread * rng.uniform(-deg(22), deg(22));
  const double lean = spread * rng.uniform(-0.1, 0.35);  // how far the top hangs back (m per m)
  const double sway = spread * rng.uniform(-0.012, 0.012), sway_phase = rng.uniform(0.0, kTwoPi);
  const auto in_world = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const double t = p.z() + 0.5 * height;
    const Eigen::Vector3d hung(p.x() + sway * std::sin(sway_phase + 3.0 * t / height), p.y() + lean * t, t);
    return params.center + Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * hung;
  };
  const double behind = 0.45 * mean;  // the fruit hang a little before their rachis, where there is room between them
  for (int i = 0; i <= 40; ++i)
    layout.rachis.push_back(in_world({0.0, behind, 0.9 * mean - (height + 0.2 * mean) * i / 40.0}));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::Vector3d c = in_world(centers[i]);
    layout.fruits.push_back(place(shapes[i], c, draw_growth_axis(layout.rachis, c, rng), rng.uniform(0.0, kTwoPi)));
  }
  settle(layout, 0);
  hide_behind(layout, params.hidden, params, spread, rng);
  return layout;
}

}  // namespace agrisee::study
