// SPDX-License-Identifier: BSD-3-Clause
// Friendly and awkward clouds, and neighbors by brute force.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <string>
#include <vector>

namespace agrisee::shapes {

inline std::vector<std::string> cloud_kinds() {
  return {"random",   "gridded", "duplicated", "clustered", "equal", "line",
          "outliers", "nan",     "subnormal",  "offset",    "one",   "empty"};
}

template <typename S>
using Points = std::vector<Vector3<S>>;

/// A cloud of about n points (m) of one of cloud_kinds(); another name gives an empty one.
template <typename S>
Points<S> cloud_of(const std::string& kind, std::size_t n) {
  Rng rng(7);
  Points<S> p;
  const auto random = [&](double scale) {
    return Vector3<S>((Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform()) * scale).cast<S>());
  };
  if (kind == "random")
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
  if (kind == "gridded")
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z) p.push_back(Vector3<S>(S(x), S(y), S(z)) * S(0.01));
  if (kind == "duplicated")
    for (std::size_t i = 0; i < n; ++i) p.push_back(i % 3 ? p[i - 1] : random(0.3));
  if (kind == "clustered")
    for (std::size_t i = 0; i < n; ++i) p.push_back(Vector3<S>(random(0.001) + Vector3<S>::Constant(S(i % 4) * S(10))));
  if (kind == "equal") p.assign(n, Vector3<S>(S(0.1), S(0.2), S(0.3)));
  if (kind == "line")
    for (std::size_t i = 0; i < n; ++i) p.push_back(Vector3<S>(S(i) * S(0.001), 0, 0));
  if (kind == "outliers") {
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
    p.push_back(Vector3<S>::Constant(S(1e6)));
    p.push_back(Vector3<S>::Constant(S(-1e5)));
  }
  if (kind == "nan") {
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
    p[3].x() = std::numeric_limits<S>::quiet_NaN();
    p[n / 2].y() = std::numeric_limits<S>::infinity();
  }
  if (kind == "subnormal") {  // squared distances vanish in float
    for (std::size_t i = 0; i < n; ++i) p.push_back(Vector3<S>(S(i % 7), S(i % 11), S(i % 13)) * S(1e-30));
    p.push_back(Vector3<S>::Ones());
  }
  if (kind == "offset")  // far from the origin, where coordinates are coarse
    for (std::size_t i = 0; i < n; ++i) p.push_back(Vector3<S>(random(0.3) + Vector3<S>::Constant(S(1e6))));
  if (kind == "one") p.push_back(Vector3<S>::Zero());
  return p;
}

/// All points within sqrt(r_sq) of q, nearest first, ties by index.
template <typename S>
Neighbors<S> brute(const Points<S>& cloud, const Vector3<S>& q, S r_sq) {
  Neighbors<S> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const S d_sq = distance_sq<S>(cloud[i], q);
    if (is_finite(cloud[i]) && d_sq <= r_sq) out.push_back({static_cast<Index>(i), d_sq});
  }
  std::sort(out.begin(), out.end(), detail::Nearest<S>::before);
  for (auto& n : out) n.distance = std::sqrt(n.distance);
  return out;
}

}  // namespace agrisee::shapes
