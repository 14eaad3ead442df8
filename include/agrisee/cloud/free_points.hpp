// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The points of a cloud that no body has taken yet: bodies are fitted to them and judged by them. Metres.
#pragma once

#include <agrisee/cloud/body_evidence.hpp>
#include <agrisee/cloud/body_verdict.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace agrisee::detail {

/// The points of one cloud, all free at first.
template <typename S>
class FreePoints {
 public:
  /// @param cloud with outward unit normals; must outlive this, as must the others
  /// @param grid of its points, with cells of `parameters.cell()`
  FreePoints(const PointCloud<S>& cloud, const Grid<S>& grid, const BodyParameters& parameters)
      : cloud_(cloud), parameters_(parameters), grid_(grid), taken_(cloud.size(), 0) {}

  /// Fit a body to the free points near it; empty if there is no fit, see fit_ellipsoid.
  std::optional<EllipsoidFit> fit(const Ellipsoid& start, const FitParameters& how) {
    near_.clear();
    visit_near(grid_, start, [&](Index i) {
      if (!taken_[static_cast<std::size_t>(i)]) near_.push_back(i);
    });
    return fit_ellipsoid(cloud_, near_, start, how);
  }

  /// Judge a body by all points near it and by sight lines.
  Verdict judge(const Ellipsoid& body, const BodyEvidence& evidence) const {
    return detail::judge(cloud_, grid_, taken_, body, parameters_, evidence);
  }

  /// Judge a body quickly, by some of the points of the last fit().
  /// @param single_view whether all points were seen from one side
  Verdict judge_quickly(const Ellipsoid& body, bool single_view) const {
    return detail::judge_quickly(cloud_, near_, taken_, body, parameters_, single_view);
  }

  /// Take the points that a body explains: those on it within a margin, and everything inside it, such as points in the
  /// dimple at its calyx.
  void take(const Ellipsoid& body) {
    const double margin = 1.5 * parameters_.near(body.mean_radius());
    const double cos_loose = loose_cosine(parameters_);
    visit_near(grid_, body, [&](Index index) {
      const auto i = static_cast<std::size_t>(index);
      const Eigen::Vector3d p = cloud_.points[i].template cast<double>();
      const auto foot = body.foot(p);
      if (foot.distance < margin &&
          (foot.distance < -margin || foot.normal.dot(cloud_.normals[i].template cast<double>()) >= cos_loose))
        taken_[i] = 1;
    });
  }

  /// Make all points free again.
  void release() { std::fill(taken_.begin(), taken_.end(), 0); }

 private:
  const PointCloud<S>& cloud_;
  const BodyParameters& parameters_;
  const Grid<S>& grid_;
  std::vector<char> taken_;  // whether a point belongs to a body that has won
  Indices near_;             // the free points near the last body that was fitted
};

}  // namespace agrisee::detail
