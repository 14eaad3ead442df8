// SPDX-License-Identifier: BSD-3-Clause
// Clouds on which arithmetic is exact and distances tie, clouds on which arithmetic fails, and what is done to them.
//
// Coordinates of the exact clouds are multiples of 2^-14 m over at most 2^-4 m: differences have 10 bits, squared
// distances 22, so that they are the same in float and in double, in whatever order they are summed, wherever the cloud
// stands, however it is turned by right angles. With radii that are exact too, a stage that decides by distances has to
// decide alike, ties included.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <limits>
#include <string>

#include "catch.hpp"

namespace laws {

using namespace agrisee;

template <typename S>
using Points = std::vector<Vector3<S>>;

constexpr double kUnit = 0x1p-14;  // m

inline Eigen::Vector3d draw(Rng& rng, std::uint64_t span) {
  const auto x = double(rng.below(span)), y = double(rng.below(span)), z = double(rng.below(span));
  return kUnit * Eigen::Vector3d(x, y, z);
}

/// Those on which arithmetic is exact.
inline std::vector<std::string> exact_kinds() {
  return {"lattice", "sheet", "line", "equal", "random", "duplicated", "clumps", "shells"};
}

template <typename S>
Points<S> exact_cloud(const std::string& kind) {
  Rng rng(11);
  Points<S> out;
  const auto put = [&](const Eigen::Vector3d& p) { out.push_back(p.cast<S>()); };
  if (kind == "lattice")
    for (int i = 0; i < 343; ++i) put(0x1p-8 * Eigen::Vector3d(i % 7, i / 7 % 7, i / 49));
  if (kind == "sheet")
    for (int i = 0; i < 300; ++i) put(0x1p-9 * Eigen::Vector3d(i % 20, i / 20, 0));
  if (kind == "line")
    for (int i = 0; i < 250; ++i) put(0x1p-12 * Eigen::Vector3d(i, 0, 0));
  if (kind == "equal")
    for (int i = 0; i < 120; ++i) put(0x1p-6 * Eigen::Vector3d::Ones());
  if (kind == "random")
    for (int i = 0; i < 400; ++i) put(draw(rng, 1024));
  if (kind == "duplicated")
    for (int i = 0; i < 390; ++i) i % 3 ? out.push_back(out.back()) : put(draw(rng, 700));
  if (kind == "clumps")
    for (int i = 0; i < 400; ++i) put(draw(rng, 40) + 0x1p-5 * Eigen::Vector3d(i % 3, i % 2, 0));
  if (kind == "shells")  // two touching spheres of radius 2^-6, on the lattice of units
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector3d p = 0x1p-6 * (rng.direction() + Eigen::Vector3d(i % 2 ? 1.0 : 3.0, 1.0, 1.0));
      put(kUnit * (p / kUnit).array().round().matrix());
    }
  return out;
}

/// Those that defy arithmetic; most of their points are those of `exact_cloud("random")` or "sheet".
inline std::vector<std::string> hostile_kinds() {
  return {"far", "denormal", "vanishing", "nan", "huge", "only nan", "mixed scales", "empty", "one"};
}

template <typename S>
Points<S> hostile_cloud(const std::string& kind) {
  using Limits = std::numeric_limits<S>;
  Points<S> out = exact_cloud<S>("random");
  const std::size_t n = out.size();
  if (kind == "far")  // in float neighbors are 62.5 mm apart or at one place
    for (auto& p : out) p += Vector3<S>::Constant(S(1e6));
  if (kind == "denormal")
    for (auto& p : out) p *= Limits::denorm_min() / S(kUnit);
  if (kind == "vanishing")  // points that differ, squares that do not
    for (auto& p : out) p *= std::sqrt(Limits::denorm_min());
  if (kind == "nan")
    for (std::size_t i = 0; i < n; i += 5)
      out[i][static_cast<int>(i % 3)] = i % 2 ? Limits::infinity() : Limits::quiet_NaN();
  if (kind == "huge")  // squares overflow
    for (std::size_t i = 7; i < n; i += 90) out[i] = Vector3<S>(1, -1, S(i)) * (Limits::max() / S(1000));
  if (kind == "only nan") out.assign(40, Vector3<S>::Constant(Limits::quiet_NaN()));
  if (kind == "mixed scales")
    for (std::size_t i = 0; i < n; ++i) out[i] *= std::pow(S(10), S(i % 40) - S(20));
  if (kind == "empty") out.clear();
  if (kind == "one") out.resize(1);
  return out;
}

/// Rotations that only exchange and negate axes: exact.
inline std::vector<Eigen::Matrix3d> right_angles() {
  std::vector<Eigen::Matrix3d> out;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(-1, 0, 0)})
    for (const Eigen::Vector3d& y : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0)}) {
      if (x.dot(y) != 0.0) continue;
      Eigen::Matrix3d r;
      r << x, y, x.cross(y);
      out.push_back(r);
    }
  return out;
}

template <typename S>
Points<S> moved(const Points<S>& points, const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift) {
  Points<S> out;
  for (const auto& p : points) out.push_back((turn * p.template cast<double>() + shift).template cast<S>());
  return out;
}

/// A shift that leaves an exact cloud exact: metres in float, a thousand kilometres in double.
template <typename S>
Eigen::Vector3d far_shift() {
  return std::is_same<S, float>::value ? Eigen::Vector3d(3, -5, 2) : Eigen::Vector3d(0x1p20, -0x1.8p20, 0x1p19);
}

template <typename S>
Points<S> scaled(const Points<S>& points, double by) {
  Points<S> out;
  for (const auto& p : points) out.push_back(p * S(by));
  return out;
}

/// Every point `times` times on end.
template <typename T>
std::vector<T> repeated(const std::vector<T>& values, std::size_t times) {
  std::vector<T> out;
  for (const T& v : values) out.insert(out.end(), times, v);
  return out;
}

inline Indices shuffled(std::size_t n, std::uint64_t seed = 29) {
  Rng rng(seed);
  Indices order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<Index>(i);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
  return order;
}

template <typename T>
std::vector<T> pick(const std::vector<T>& values, const Indices& order) {
  std::vector<T> out;
  for (const Index i : order) out.push_back(values[static_cast<std::size_t>(i)]);
  return out;
}

/// Labels as a partition: renumbered by first appearance; 0 stays.
inline Labels partition(const Labels& labels) {
  std::vector<int> name(labels.size() + 2, 0);
  Labels out;
  int names = 0;
  for (const int label : labels) {
    REQUIRE(label >= 0);
    REQUIRE(static_cast<std::size_t>(label) < name.size());
    int& mine = name[static_cast<std::size_t>(label)];
    if (label > 0 && mine == 0) mine = ++names;
    out.push_back(mine);
  }
  return out;
}

/// What exact motions, exact scales, shuffles, the precision and the number of threads must not change, for a stage
/// that gives one value a point by distances alone: `stage(points, scale, threads)`, its lengths times `scale`.
/// `as(values)` is what has to be the same.
template <typename S, typename Stage, typename As>
void check_exact_laws(const std::string& kind, const Stage& stage, const As& as) {
  const auto cloud = exact_cloud<S>(kind);
  const auto straight = stage(cloud, 1.0, 1);
  REQUIRE(straight.size() == cloud.size());
  CHECK(stage(cloud, 1.0, 2) == straight);
  CHECK(stage(cloud, 1.0, 5) == straight);
  for (const auto& turn : right_angles()) CHECK(stage(moved(cloud, turn, far_shift<S>()), 1.0, 1) == straight);
  for (const double by : {0.125, 3.0, 64.0}) CHECK(stage(scaled(cloud, by), by, 1) == straight);
  for (const std::uint64_t seed : {1u, 2u}) {
    const Indices order = shuffled(cloud.size(), seed);
    CHECK(as(stage(pick(cloud, order), 1.0, 1)) == as(pick(straight, order)));
  }
  CHECK(stage(exact_cloud<double>(kind), 1.0, 1) == straight);
}

}  // namespace laws
