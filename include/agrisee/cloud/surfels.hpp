// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fuses the surfaces of many views into one: surfels at a minimum separation, each the weighted average of all that
/// was measured of its place (point-based fusion, cf. Keller et al., 3DV 2013).
///
/// A sample that falls within the separation of a surfel and whose normal agrees moves it along its normal, by inverse
/// variance; any other founds a new surfel. So density stays even however often a place is seen, and noise averages
/// out. Metres, world. Cost: a few cells a sample; memory about 80 bytes a surfel.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/hash_grid.hpp>

#include <cmath>

namespace agrisee {

/// A small piece of measured surface.
struct Surfel {
  Eigen::Vector3f position;  ///< m, world
  Eigen::Vector3f normal;    ///< unit, towards the sensors that saw it
  float weight = 0.0f;       ///< sum of 1 / sigma^2 of its samples (1/m2)
  int view = -1;             ///< the view that founded it
  int samples = 0;           ///< number of samples
  int seen_by = 0;           ///< number of views with a sample
  int last_view = -1;        ///< the last of them

  /// Standard deviation of the position along the normal (m), neighbours' common errors left aside.
  float sigma() const { return 1.0f / std::sqrt(weight); }
};

/// The growing set of surfels.
class SurfelMap {
 public:
  /// @throws ParameterError
  explicit SurfelMap(const SurfelParameters& parameters = {}) : parameters_(parameters) {
    parameters_.check();
    inverse_cell_ = 1.0 / parameters_.separation;
  }

  /// All surfels, in the order in which they were founded.
  const std::vector<Surfel>& surfels() const { return surfels_; }
  /// Number of surfels.
  std::size_t size() const { return surfels_.size(); }

  /// Take in a sample of view `view`: position (m, world), unit normal, standard deviation along it (m, > 0).
  /// @return true when it founded a new surfel; samples that are not finite are ignored
  bool add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float sigma, int view) {
    if (!is_finite(p) || !is_finite(n) || !(sigma > 0.0f) || !std::isfinite(sigma)) return false;
    const float separation = static_cast<float>(parameters_.separation);
    const float cos_max = static_cast<float>(std::cos(parameters_.max_angle));
    const float weight = 1.0f / (sigma * sigma);
    const CellIndex center = cell(p);
    Index best = -1;
    float best_sq = separation * separation;
    CellIndex c;
    for (c.z() = center.z() - 1; c.z() <= center.z() + 1; ++c.z())
      for (c.y() = center.y() - 1; c.y() <= center.y() + 1; ++c.y())
        for (c.x() = center.x() - 1; c.x() <= center.x() + 1; ++c.x())
          for (Index i = table_.find(c); i >= 0; i = next_[static_cast<std::size_t>(i)]) {
            const Surfel& s = surfels_[static_cast<std::size_t>(i)];
            if (s.normal.dot(n) < cos_max) continue;
            const Eigen::Vector3f d = p - s.position;
            const float along = s.normal.dot(d);
            const float across_sq = d.squaredNorm() - along * along;
            const float off =
                static_cast<float>(parameters_.agreement) + 3.0f * std::sqrt(sigma * sigma + 1.0f / s.weight);
            if (std::abs(along) > off) continue;
            if (across_sq < best_sq || (across_sq == best_sq && i < best)) {
              best = i;
              best_sq = across_sq;
            }
          }
    if (best >= 0) {
      Surfel& s = surfels_[static_cast<std::size_t>(best)];
      const float share = weight / (s.weight + weight);
      s.position += s.normal * (s.normal.dot(p - s.position) * share);
      s.normal = (s.normal * (1.0f - share) + n * share).normalized();
      s.weight += weight;
      ++s.samples;
      if (s.last_view != view) ++s.seen_by;
      s.last_view = view;
      return false;
    }
    Surfel s;
    s.position = p;
    s.normal = n;
    s.weight = weight;
    s.view = s.last_view = view;
    s.samples = s.seen_by = 1;
    const auto id = static_cast<Index>(surfels_.size());
    surfels_.push_back(s);
    next_.push_back(table_.exchange(center, id));
    return true;
  }

  /// The surfels as a cloud: points, normals and founding views.
  Cloud cloud() const {
    Cloud out;
    out.points.reserve(surfels_.size());
    out.normals.reserve(surfels_.size());
    out.views.reserve(surfels_.size());
    for (const Surfel& s : surfels_) {
      out.points.push_back(s.position);
      out.normals.push_back(s.normal);
      out.views.push_back(s.view);
    }
    return out;
  }

 private:
  CellIndex cell(const Eigen::Vector3f& p) const {
    return {CellTable::coordinate(double(p.x()), inverse_cell_), CellTable::coordinate(double(p.y()), inverse_cell_),
            CellTable::coordinate(double(p.z()), inverse_cell_)};
  }

  SurfelParameters parameters_;
  double inverse_cell_ = 1.0;
  std::vector<Surfel> surfels_;
  CellTable table_;          // the last surfel founded in each cell
  std::vector<Index> next_;  // the one founded there before, or -1
};

}  // namespace agrisee
