// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The merged cloud, its volumetric density and the class of each point: core, frontier or outlier ([1], eq. 1; SEE++).
/// World frame, metres.
///
/// - The density of a point is the number of points at most r away, itself included.
/// - A core point has a density of at least k.
/// - A frontier point is not core, but has both a core point and an outlier within r.
/// - All other points are outliers.
///
/// Frontiers and outliers depend on one another, so points are classified one after the other, as SEE++ does. First the
/// new points, in their order: only points that have a class already count as outliers. Then all points that are not
/// core and have a new point within r, itself included, in their order: an outlier finds itself, so it becomes a
/// frontier if a core point is within r. Other points keep their class. A frontier that was given up (give_up()) is an
/// outlier until a new point comes near. Cost: O(pairs within r that involve a new point).
#pragma once

#include <agrisee/core/detail/sums.hpp>
#include <agrisee/core/parallel.hpp>
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
    const std::size_t before = size();
    for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
      const Vector3<S> p = point(cloud, i).template cast<S>();
      if (!is_finite(p) || (separation_ > 0 && grid_.nearer(p, separation_))) continue;
      append(p, view);
      kept.push_back(static_cast<Index>(i));
    }
    added_ = size() - before;
    count(threads);
    classify_near_new();
    return kept;
  }

  /// Remove all points but `kept`: densities are then those of these points alone. Frontiers and outliers keep their
  /// class, but a frontier without a core point within r becomes an outlier. A point that is no longer core becomes a
  /// frontier if a core point is within r, else an outlier. For filters that run between views.
  /// @param kept indices of cloud(), ascending
  /// @param threads the result does not depend on it
  /// @throws InputError when an index is out of range
  void keep(const Indices& kept, int threads = 1) {
    for (Index i : kept)
      check_input(i >= 0 && static_cast<std::size_t>(i) < size(), "DensityMap::keep: an index is out of range");
    const PointCloud<S> old = select(cloud_, kept);
    const std::size_t first_added = size() - added_;
    std::size_t added = 0;
    std::vector<PointClass> classes;
    std::vector<char> near_new;
    for (Index i : kept) {
      classes.push_back(class_of(i));
      near_new.push_back(near_new_[static_cast<std::size_t>(i)]);
      added += static_cast<std::size_t>(i) >= first_added;
    }
    *this = DensityMap(*this, Empty{});
    for (std::size_t i = 0; i < old.size(); ++i) append(old.points[i], old.views[i]);
    count(threads);
    for (std::size_t i = 0; i < size(); ++i) {
      const bool frontier = classes[i] == PointClass::frontier;
      set_class(static_cast<Index>(i), is_core(i) ? PointClass::core
                                       : frontier ? PointClass::frontier
                                                  : PointClass::outlier);
    }
    for (std::size_t i = 0; i < size(); ++i) {
      if (is_core(i) || classes[i] == PointClass::outlier) continue;
      set_class(static_cast<Index>(i),
                has_near(i, PointClass::core, size()) ? PointClass::frontier : PointClass::outlier);
    }
    added_ = added;
    near_new_ = std::move(near_new);
    for (std::size_t i = 0; i < size(); ++i) near_added_ += near_new_[i] && !is_core(i);
  }

  /// Make a frontier an outlier. It becomes a frontier again when a later view adds a point within r, and it still is
  /// near a core point and not core itself.
  /// @throws InputError if point i is not a frontier
  void give_up(Index i) {
    check_input(i >= 0 && static_cast<std::size_t>(i) < size() && class_of(i) == PointClass::frontier,
                "DensityMap::give_up: the point is not a frontier");
    set_class(i, PointClass::outlier);
  }

  /// Number of points that the last insert() added, without those that keep() removed since.
  std::size_t added() const { return added_; }
  /// Number of points that are not core and had a point within r that the last insert() added, themselves included;
  /// without those that keep() removed since.
  std::size_t near_added() const { return near_added_; }
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
    Vector3<S> min, max;                 // bounding box of its points
    Indices near;                        // blocks whose cells may hold points within r, itself included
    std::size_t counted = 0;             // number of points that the last update has counted
    std::array<std::size_t, 3> holds{};  // number of points of each class

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
    near_new_.push_back(0);
    const CellIndex cell = CellTable::cell(p, inverse_);
    Index b = table_.find(cell);
    if (b < 0) b = add_block(cell, p);
    Block& block = blocks_[static_cast<std::size_t>(b)];
    for (int a = 0; a < 3; ++a) block.xyz[static_cast<std::size_t>(a)].push_back(p[a]);
    block.ids.push_back(i);
    ++block.holds[0];
    block_of_.push_back(b);
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

  bool is_core(std::size_t i) const { return static_cast<std::size_t>(result_.counts[i]) >= k_; }
  Block& block_of(std::size_t i) { return blocks_[static_cast<std::size_t>(block_of_[i])]; }

  void set_class(Index i, PointClass c) {
    PointClass& now = result_.classes[static_cast<std::size_t>(i)];
    Block& block = block_of(static_cast<std::size_t>(i));
    --block.holds[static_cast<std::size_t>(now)];
    ++block.holds[static_cast<std::size_t>(c)];
    now = c;
  }

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

  /// Add one to `in` for each of the counted points of a that is within r of p.
  void mark_within(const Block& a, const Vector3<S>& p, std::vector<int>& in) const {
    const S r_sq = radius_ * radius_;
    const Vector3<S> outside = (a.min - p).cwiseMax(p - a.max).cwiseMax(S(0));
    if (outside.squaredNorm() > r_sq * (S(1) + S(16) * std::numeric_limits<S>::epsilon())) return;
    const S* x = a.xyz[0].data();
    const S* y = a.xyz[1].data();
    const S* z = a.xyz[2].data();
    const S px = p.x(), py = p.y(), pz = p.z();
    int* out = in.data();
    const std::size_t n = in.size();
    for (std::size_t i = 0; i < n; ++i) {
      const S dx = px - x[i], dy = py - y[i], dz = pz - z[i];
      out[i] += agrisee::detail::sum_of_squares(dx, dy, dz) <= r_sq ? 1 : 0;
    }
  }

  /// Bring the counts up to date with the points that were appended since the last time, and mark the points that have
  /// one of them within r.
  void count(int threads) {
    parallel_for(
        blocks_.size(), threads, [&](std::size_t b) { recount(blocks_[b]); }, 8);
    for (Block& b : blocks_) b.counted = b.size();
  }

  /// Points that are new are compared with all others, and the others with those that are new: one by one, since that
  /// compares a whole block with each.
  void recount(Block& a) {
    for (Index id : a.ids) near_new_[static_cast<std::size_t>(id)] = 0;
    for (std::size_t i = a.counted; i < a.size(); ++i) {
      int in = 0;
      for (Index n : a.near) in += count_within(blocks_[static_cast<std::size_t>(n)], 0, a.point(i));
      add(a.ids[i], in);
    }
    if (a.counted == 0) return;
    std::vector<int> in;
    for (Index n : a.near) {
      const Block& b = blocks_[static_cast<std::size_t>(n)];
      if (b.fresh() && in.empty()) in.resize(a.counted);
      for (std::size_t j = b.counted; j < b.size(); ++j) mark_within(a, b.point(j), in);
    }
    for (std::size_t i = 0; i < in.size(); ++i) add(a.ids[i], in[i]);
  }

  void add(Index id, int in) {
    result_.counts[static_cast<std::size_t>(id)] += in;
    near_new_[static_cast<std::size_t>(id)] = in > 0;
  }

  /// Classify the points from added_ before the end on, and those near them.
  void classify_near_new() {
    near_added_ = 0;
    for (std::size_t i = 0; i < size(); ++i)
      if (near_new_[i] && is_core(i)) set_class(static_cast<Index>(i), PointClass::core);
    const auto classify = [&](std::size_t i, bool outlier_near) {
      const bool frontier = outlier_near && has_near(i, PointClass::core, size());
      set_class(static_cast<Index>(i), frontier ? PointClass::frontier : PointClass::outlier);
    };
    for (std::size_t i = size() - added_; i < size(); ++i)
      if (!is_core(i)) classify(i, has_near(i, PointClass::outlier, i));
    for (std::size_t i = 0; i < size(); ++i) {
      if (!near_new_[i] || is_core(i)) continue;
      ++near_added_;
      classify(i, result_.classes[i] == PointClass::outlier || has_near(i, PointClass::outlier, size()));
    }
  }

  /// Whether another point of the class, with an index below `end`, is within r of point i.
  bool has_near(std::size_t i, PointClass wanted, std::size_t end) const {
    const Vector3<S> p = cloud_.points[i];
    for (Index n : blocks_[static_cast<std::size_t>(block_of_[i])].near) {
      const Block& b = blocks_[static_cast<std::size_t>(n)];
      if (b.holds[static_cast<std::size_t>(wanted)] == 0) continue;
      for (std::size_t j = 0; j < b.size(); ++j) {
        const auto id = static_cast<std::size_t>(b.ids[j]);
        if (id < end && id != i && result_.classes[id] == wanted && distance_sq<S>(b.point(j), p) <= radius_ * radius_)
          return true;
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
  Indices block_of_;                        // per point
  std::vector<char> near_new_;              // per point: whether one of the last insert() is within r, itself included
  std::size_t added_ = 0, near_added_ = 0;  // see added() and near_added()
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
