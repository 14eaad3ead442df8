// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/surfels.hpp>

#include <cmath>

namespace agrisee::fuse {

SurfelMap::SurfelMap(const SurfelParameters& parameters) : parameters_(parameters) {
  parameters_.check();
  inverse_cell_ = 1.0 / parameters_.separation;
  cos_max_ = static_cast<float>(std::cos(parameters_.max_angle));
}

/// The surfel that a sample belongs to, -1 for none: the nearest, across the surface, in the cells around the sample;
/// if there is none, in the nearest cells up to the agreement along the sample's normal. Of equally near ones the
/// oldest.
Index SurfelMap::surfel_of(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float sigma) const {
  const auto separation = static_cast<float>(parameters_.separation);
  const auto agreement = static_cast<float>(parameters_.agreement);
  Index best = -1;
  float best_sq = separation * separation;
  const auto visit = [&](const CellIndex& lo, const CellIndex& hi) {
    cells_.visit(lo, hi, [&](Index i) {
      for (; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
        const Surfel& s = surfels_[static_cast<std::size_t>(i)];
        const Eigen::Vector3f d = p - s.position;
        const float along = s.normal.dot(d);
        const float across_sq = d.squaredNorm() - along * along;
        if (!(across_sq < best_sq || (across_sq == best_sq && i < best)) || s.normal.dot(n) < cos_max_) continue;
        if (std::abs(along) > agreement + 3.0f * std::sqrt(sigma * sigma + 1.0f / s.weight)) continue;
        best = i;
        best_sq = across_sq;
      }
    });
  };
  const CellIndex center = CellTable::cell(p, inverse_cell_), one = CellIndex::Ones();
  visit(center - one, center + one);

  int axis;  // the cells in layers across the axis that is nearest to the normal, outwards
  const float slope = n.cwiseAbs().maxCoeff(&axis);
  const auto layers = static_cast<int>(std::ceil(agreement * slope / separation));
  for (int layer = 2; best < 0 && layer <= layers; ++layer)
    for (const int k : {-layer, layer}) {
      const float t = static_cast<float>(k) * separation / n[axis];
      const CellIndex middle = CellTable::cell(Eigen::Vector3f(p + t * n), inverse_cell_);
      CellIndex lo = middle - one, hi = middle + one;
      lo[axis] = hi[axis] = center[axis] + k;
      visit(lo, hi);
    }
  return best;
}

bool SurfelMap::add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float sigma, int view) {
  if (!is_finite(p) || !is_finite(n) || !(sigma > 0.0f) || !std::isfinite(sigma)) return false;
  const float weight = 1.0f / (sigma * sigma);
  if (const Index best = surfel_of(p, n, sigma); best >= 0) {
    Surfel& s = surfels_[static_cast<std::size_t>(best)];
    const float share = weight / (s.weight + weight);
    s.position += s.normal * (s.normal.dot(p - s.position) * share);
    s.normal = (s.normal * (1.0f - share) + n * share).normalized();
    s.weight += weight;
    if (s.last_view != view) ++s.seen_by;
    s.last_view = view;
    return false;
  }
  Surfel s;
  s.position = p;
  s.normal = n;
  s.weight = weight;
  s.view = s.last_view = view;
  s.seen_by = 1;
  const auto id = static_cast<Index>(surfels_.size());
  surfels_.push_back(s);
  next_.push_back(cells_.exchange(CellTable::cell(p, inverse_cell_), id));
  return true;
}

Cloud SurfelMap::cloud() const {
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

}  // namespace agrisee::fuse
