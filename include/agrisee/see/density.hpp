// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The merged cloud, its volumetric density and the class of each point: core, frontier or outlier ([1], eq. 1; SEE++).
/// World frame, metres.
///
/// - The density of a point is the number of points at most r away, itself included.
/// - A core point has a density of at least k.
/// - A frontier point is not core, but has both a core point and another point that is not core within r.
/// - All other points are outliers.
///
/// SEE's rule for frontiers says "outlier" where this says "not core": so the classes do not depend on an order.
///
/// After a new view, points are counted again only around its new points, and classified again only near those and
/// near points that became core. The result equals a classification from scratch. Cost: O(pairs within r that involve
/// a new point).
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/core/sums.hpp>
#include <agrisee/neighbors/hash_grid.hpp>
#include <agrisee/see/parameters.hpp>

#include <array>

namespace agrisee::see {

/// Class of a point.
enum class PointClass : std::uint8_t { outlier, frontier, core };

/// Density and class of every point of a cloud.
struct Classification {
  std::vector<int> counts;          ///< points within r, itself included; 0 for points that are not finite
  std::vector<PointClass> classes;  ///< outlier for points that are not finite
};

/// A cloud that grows view by view, with the density and the class of every point. Points that are nearer to an older
/// one than the minimum separation are dropped.
template <typename S = float>
class DensityMap {
 public:
  /// A map with the minimum separation Parameters::min_separation().
  /// @throws FieldError if a parameter is out of its range
  explicit DensityMap(const Parameters& parameters) : DensityMap(parameters, parameters.min_separation()) {}

  /// A map with another minimum separation (m); 0: every point is kept.
  /// @throws FieldError if a parameter is out of its range; ParameterError for a negative separation
  DensityMap(const Parameters& parameters, double separation)
      : k_((parameters.check(), parameters.k())),
        radius_(static_cast<S>(parameters.radius)),
        separation_(static_cast<S>(separation)),
        inverse_(double(kReach) / (1.00001 * parameters.radius)),
        grid_(static_cast<S>(separation > 0.0 ? 2.0 * separation : parameters.radius)) {
    check_parameter(std::isfinite(separation) && separation >= 0.0, "separation", "zero or more and finite",
                    separation);
  }

  /// Add the points of a view. A point is kept if no point kept earlier is nearer than the minimum separation. Points
  /// that are not finite are dropped. Kept points are appended in order.
  /// @param cloud points of the view, any cloud type (m, world)
  /// @param view number of the view; it is stored with the points
  /// @param threads the result does not depend on it
  /// @return indices of the kept points in `cloud`, ascending
  template <typename C>
  Indices insert(const C& cloud, int view, int threads = 1) {
    Indices kept;
    for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
      const Vector3<S> p = point(cloud, i).template cast<S>();
      if (!is_finite(p) || (separation_ > 0 && grid_.nearer(p, separation_))) continue;
      append(p, view);
      kept.push_back(static_cast<Index>(i));
    }
    update(threads);
    return kept;
  }

  /// Remove all points but `kept`: densities and classes are then those of these points alone. For filters that run
  /// between views.
  /// @param kept indices of cloud(), ascending
  /// @param threads the result does not depend on it
  /// @throws InputError when an index is out of range
  void keep(const Indices& kept, int threads = 1) {
    for (Index i : kept)
      check_input(i >= 0 && static_cast<std::size_t>(i) < size(), "DensityMap::keep: an index is out of range");
    const PointCloud<S> old = select(cloud_, kept);
    *this = DensityMap(*this, Empty{});
    for (std::size_t i = 0; i < old.size(); ++i) append(old.points[i], old.views[i]);
    update(threads);
  }

  /// Number of points.
  std::size_t size() const { return cloud_.size(); }
  /// The merged points and, for each, the view that saw it first.
  const PointCloud<S>& cloud() const { return cloud_; }
  /// Density of every point: number of points within the radius, itself included.
  const std::vector<int>& counts() const { return result_.counts; }
  /// Class of every point.
  const std::vector<PointClass>& classes() const { return result_.classes; }
  /// Density and class of every point.
  const Classification& classification() const { return result_; }
  /// Class of point i.
  PointClass class_of(Index i) const { return result_.classes[static_cast<std::size_t>(i)]; }
  /// A neighbor search over the points, for radii of about the minimum separation. Indices are those of cloud().
  const HashGrid<S>& grid() const { return grid_; }

  /// Indices of the points of a class, ascending. Cost: O(n).
  Indices of_class(PointClass wanted) const {
    Indices out;
    for (std::size_t i = 0; i < size(); ++i)
      if (result_.classes[i] == wanted) out.push_back(static_cast<Index>(i));
    return out;
  }

 private:
  static constexpr std::int32_t kReach = 3;  // cells per radius; cells are slightly larger than radius / kReach

  /// The points of one cell as a structure of arrays, so that many can be counted at once.
  struct Block {
    CellIndex cell;
    std::array<std::vector<S>, 3> xyz;
    Indices ids;
    Vector3<S> min, max;      // bounding box of its points
    Indices near;             // blocks whose cells may hold points within r, itself included
    std::size_t counted = 0;  // number of points that the last update has counted
    std::size_t cores = 0;    // number of core points
    bool changed = false;     // holds a new point or one that became core

    std::size_t size() const { return ids.size(); }
    bool fresh() const { return counted < ids.size(); }
    Vector3<S> point(std::size_t i) const { return {xyz[0][i], xyz[1][i], xyz[2][i]}; }
  };
  struct Empty {};

  DensityMap(const DensityMap& like, Empty)
      : k_(like.k_), radius_(like.radius_), separation_(like.separation_), inverse_(like.inverse_), grid_(like.grid_) {
    grid_ = HashGrid<S>(separation_ > 0 ? S(2) * separation_ : radius_);
  }

  void append(const Vector3<S>& p, int view) {
    const Index i = grid_.insert(p);
    cloud_.points.push_back(p);
    cloud_.views.push_back(view);
    result_.counts.push_back(0);
    result_.classes.push_back(PointClass::outlier);
    const CellIndex cell = CellTable::cell(p, inverse_);
    Index b = table_.find(cell);
    if (b < 0) b = add_block(cell, p);
    Block& block = blocks_[static_cast<std::size_t>(b)];
    for (int a = 0; a < 3; ++a) block.xyz[static_cast<std::size_t>(a)].push_back(p[a]);
    block.ids.push_back(i);
    block.min = block.min.cwiseMin(p);
    block.max = block.max.cwiseMax(p);
  }

  Index add_block(const CellIndex& cell, const Vector3<S>& p) {
    const auto b = static_cast<Index>(blocks_.size());
    Block block;
    block.cell = cell;
    block.min = block.max = p;
    table_.exchange(cell, b);
    CellIndex d;
    for (d.z() = -kReach; d.z() <= kReach; ++d.z())
      for (d.y() = -kReach; d.y() <= kReach; ++d.y())
        for (d.x() = -kReach; d.x() <= kReach; ++d.x()) {
          const CellIndex gap = (d.cwiseAbs().array() - 1).cwiseMax(0).matrix();  // number of cells between the two
          if (gap.squaredNorm() >= kReach * kReach) continue;
          const CellIndex other = cell + d;
          if (other.cwiseAbs().maxCoeff() > CellTable::kLimit) continue;
          const Index o = table_.find(other);
          if (o < 0) continue;
          block.near.push_back(o);
          if (o != b) blocks_[static_cast<std::size_t>(o)].near.push_back(b);
        }
    blocks_.push_back(std::move(block));
    return b;
  }

  bool is_core(Index i) const { return static_cast<std::size_t>(result_.counts[static_cast<std::size_t>(i)]) >= k_; }

  /// Number of points of b, from the one at `begin` on, that are within r of p.
  int count_within(const Block& b, std::size_t begin, const Vector3<S>& p) const {
    const S r_sq = radius_ * radius_;
    const S slack = S(16) * std::numeric_limits<S>::epsilon();
    const Vector3<S> to_min = p - b.min, to_max = b.max - p;
    if (to_min.cwiseAbs().cwiseMax(to_max.cwiseAbs()).squaredNorm() <= r_sq * (S(1) - slack))
      return static_cast<int>(b.size() - begin);
    if ((-to_min).cwiseMax(-to_max).cwiseMax(S(0)).squaredNorm() > r_sq * (S(1) + slack)) return 0;
    const S* x = b.xyz[0].data();
    const S* y = b.xyz[1].data();
    const S* z = b.xyz[2].data();
    const S px = p.x(), py = p.y(), pz = p.z();
    int in = 0;
    for (std::size_t j = begin; j < b.size(); ++j) {
      const S dx = x[j] - px, dy = y[j] - py, dz = z[j] - pz;
      in += agrisee::detail::sum_of_squares(dx, dy, dz) <= r_sq ? 1 : 0;
    }
    return in;
  }

  /// Bring counts and classes up to date with the points that were appended since the last update.
  void update(int threads) {
    parallel_for(
        blocks_.size(), threads, [&](std::size_t b) { recount(blocks_[b]); }, 8);
    for (Block& b : blocks_) b.counted = b.size();
    parallel_for(
        blocks_.size(), threads, [&](std::size_t b) { reclassify(blocks_[b]); }, 8);
    for (Block& b : blocks_) b.changed = false;
  }

  void recount(Block& a) {
    bool affected = false;
    for (Index n : a.near) affected = affected || blocks_[static_cast<std::size_t>(n)].fresh();
    if (!affected) return;
    a.changed = a.fresh();
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Vector3<S> p = a.point(i);
      const bool is_new = i >= a.counted;
      int in = 0;
      for (Index n : a.near) {
        const Block& b = blocks_[static_cast<std::size_t>(n)];
        if (is_new || b.fresh()) in += count_within(b, is_new ? 0 : b.counted, p);
      }
      const bool was_core = is_core(a.ids[i]);
      result_.counts[static_cast<std::size_t>(a.ids[i])] += in;
      if (!was_core && is_core(a.ids[i])) {
        ++a.cores;
        a.changed = true;
      }
    }
  }

  void reclassify(const Block& a) {
    bool affected = false;
    for (Index n : a.near) affected = affected || blocks_[static_cast<std::size_t>(n)].changed;
    if (!affected) return;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Index id = a.ids[i];
      result_.classes[static_cast<std::size_t>(id)] = is_core(id)         ? PointClass::core
                                                      : is_frontier(a, i) ? PointClass::frontier
                                                                          : PointClass::outlier;
    }
  }

  bool is_frontier(const Block& a, std::size_t i) const {
    const Vector3<S> p = a.point(i);
    bool has_core = false, has_other = false;
    for (Index n : a.near) {
      const Block& b = blocks_[static_cast<std::size_t>(n)];
      if ((has_core || b.cores == 0) && (has_other || b.cores == b.size())) continue;
      for (std::size_t j = 0; j < b.size(); ++j) {
        bool& has = is_core(b.ids[j]) ? has_core : has_other;
        if (has || b.ids[j] == a.ids[i] || !(distance_sq<S>(b.point(j), p) <= radius_ * radius_)) continue;
        has = true;
        if (has_core && has_other) return true;
      }
    }
    return false;
  }

  std::size_t k_;
  S radius_, separation_;
  double inverse_;  // cells per metre
  HashGrid<S> grid_;
  PointCloud<S> cloud_;
  Classification result_;
  CellTable table_;
  std::vector<Block> blocks_;
};

/// Density and class of every point of a ready cloud, in which no points are merged.
/// @param cloud any cloud (m)
/// @param parameters radius and rho are used
/// @param threads the result does not depend on it
/// @throws FieldError if a parameter is out of its range
template <typename C>
Classification classify(const C& cloud, const Parameters& parameters, int threads = 1) {
  using S = scalar_t<C>;
  DensityMap<S> map(parameters, 0.0);
  const Indices kept = map.insert(cloud, 0, threads);
  if (kept.size() == agrisee::size(cloud)) return map.classification();
  Classification out;
  out.counts.assign(agrisee::size(cloud), 0);
  out.classes.assign(agrisee::size(cloud), PointClass::outlier);
  for (std::size_t j = 0; j < kept.size(); ++j) {
    out.counts[static_cast<std::size_t>(kept[j])] = map.counts()[j];
    out.classes[static_cast<std::size_t>(kept[j])] = map.classes()[j];
  }
  return out;
}

}  // namespace agrisee::see
