// SPDX-License-Identifier: BSD-3-Clause
// Clouds on which every stage is tested, and the laws that every stage obeys.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>

#include <map>
#include <numeric>
#include <string>

#include "catch.hpp"

namespace cases {

using namespace agrisee;

template <typename S>
using Points = std::vector<Vector3<S>>;

/// The indices of all points of a cloud.
template <typename C>
Indices all_of(const C& cloud) {
  Indices indices(agrisee::size(cloud));
  std::iota(indices.begin(), indices.end(), Index{0});
  return indices;
}

inline const std::vector<std::string>& kinds() {
  static const std::vector<std::string> all{"random", "gridded", "duplicated", "spheres", "equal", "line",
                                            "plane",  "nan",     "outliers",   "empty",   "one",   "two"};
  return all;
}

/// A cloud of the kind, about `n` points within 0.1 m of (0.2, 0.5, 0.3) m.
template <typename S>
Points<S> cloud_of(const std::string& kind, std::size_t n = 600) {
  Rng rng(7);
  Points<S> p;
  const Eigen::Vector3d at(0.2, 0.5, 0.3);
  const auto put = [&](const Eigen::Vector3d& v) { p.push_back((at + v).cast<S>()); };
  const auto random = [&](double scale) {
    return Eigen::Vector3d(Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform()) * scale);
  };
  const auto sphere = [&](const Eigen::Vector3d& center, double noise) {
    const Eigen::Vector3d normal = rng.direction();
    put(center + (0.03 + noise * rng.normal()) * normal);
  };
  if (kind == "random")
    for (std::size_t i = 0; i < n; ++i) put(random(0.05));
  if (kind == "gridded")
    for (int i = 0; i < 512; ++i) p.push_back(Vector3<S>(S(i % 8), S(i / 8 % 8), S(i / 64)) * S(0.00390625));
  if (kind == "duplicated")
    for (std::size_t i = 0; i < n; ++i) i % 3 ? p.push_back(p.back()) : put(random(0.05));
  if (kind == "spheres" || kind == "nan" || kind == "outliers")
    for (std::size_t i = 0; i < n; ++i) sphere(i % 2 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0.061, 0, 0), 3e-4);
  if (kind == "equal")
    for (std::size_t i = 0; i < n; ++i) put(Eigen::Vector3d::Zero());
  if (kind == "line")
    for (std::size_t i = 0; i < n; ++i) put(Eigen::Vector3d(1e-4, 2e-4, 1e-4) * double(i));
  if (kind == "plane")
    for (std::size_t i = 0; i < n; ++i) put({rng.uniform(0, 0.06), rng.uniform(0, 0.06), 0});
  if (kind == "nan") {
    p[3].x() = std::numeric_limits<S>::quiet_NaN();
    p[n / 2].y() = std::numeric_limits<S>::infinity();
    p.back().setConstant(std::numeric_limits<S>::quiet_NaN());
  }
  if (kind == "outliers")
    for (std::size_t i = 0; i < n / 20; ++i) put(random(i % 2 ? 1.0 : 0.2) + Eigen::Vector3d(0.1, 0, 0));
  if (kind == "one" || kind == "two") put(Eigen::Vector3d::Zero());
  if (kind == "two") put({0.001, 0, 0});
  return p;
}

/// A shuffle of [0, n).
inline Indices shuffled(std::size_t n) {
  Rng rng(13);
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

/// Points moved rigidly; in double, so that the rounding stays far below any gap between distances.
inline Pose some_motion() { return pose_from_xyz_rpy({0.3, -0.2, 0.1}, {0.4, -0.9, 2.0}); }
inline Points<double> moved(const Pose& motion, Points<double> points) {
  for (auto& p : points) p = motion * p;
  return points;
}

/// Labels as a partition: renumbered by first appearance, 0 stays.
inline Labels canonical(const Labels& labels) {
  std::map<int, int> names{{0, 0}};
  Labels out;
  for (const int label : labels) out.push_back(names.emplace(label, static_cast<int>(names.size())).first->second);
  return out;
}

/// The laws of a stage that gives one value a point: `stage(points, threads)` returns them; `same(a, b)` compares two
/// answers for the same points. Shuffled points give shuffled values, threads change nothing.
template <typename Stage, typename Same>
void check_shuffle_and_threads(const Points<double>& points, const Stage& stage, const Same& same) {
  const auto straight = stage(points, 1);
  REQUIRE(straight.size() == points.size());
  CHECK(stage(points, 2) == straight);
  CHECK(stage(points, 7) == straight);
  const Indices order = shuffled(points.size());
  CHECK(same(stage(pick(points, order), 1), pick(straight, order)));
}

/// As above, and a rigid motion of the points changes nothing.
template <typename Stage, typename Same>
void check_laws(const Points<double>& points, const Stage& stage, const Same& same) {
  check_shuffle_and_threads(points, stage, same);
  CHECK(same(stage(moved(some_motion(), points), 1), stage(points, 1)));
}

/// Whether equal distances occur between equal points alone, so that rounding cannot reorder neighbors.
inline bool irregular(const std::string& kind) { return kind != "gridded" && kind != "line"; }

/// Whether `call()` throws a ParameterError that names the field.
template <typename Call>
bool rejects(const std::string& field, const Call& call) {
  try {
    call();
  } catch (const ParameterError& e) {
    return std::string(e.what()).rfind(field + " must be ", 0) == 0;
  }
  return false;
}

}  // namespace cases
