// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds candidate centers of round bodies: every point votes along its inward normal.
///
/// A point p with outward normal n lies on a sphere of radius r about p - r n. Every point votes for the centers of all
/// radii in the expected range; the votes meet at the centers of spheres (a Hough transform, cf. Rabbani & van den
/// Heuvel, 2005), even if little of each sphere is seen and spheres touch. Cost and memory: linear in points times
/// radii. If points were added to a cloud, their votes alone show which places to examine again.
#pragma once

#include <agrisee/cloud/vote_grid.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/uninitialized.hpp>
#include <agrisee/neighbors/detail/radix_sort.hpp>
#include <agrisee/neighbors/hash_grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee {

/// A place where votes meet.
struct VotedCenter {
  Eigen::Vector3d center;  ///< m
  double votes;            ///< points that voted for it
};

/// How many centers vote_for_centers finds by default: enough for a cloud of a few trusses.
constexpr std::size_t kMostVotedCenters = 400;

namespace detail {

/// A cell and the number of its votes.
struct VotedCell {
  std::uint64_t key;
  float votes;
};

/// The votes about a cell.
struct VoteSum {
  std::uint64_t key;       ///< of the cell
  double votes;            ///< of the cell and its 26 neighbors
  Eigen::Vector3d center;  ///< their mean place (m)
};

/// The votes of the points that `votes(i)` admits, as the packed cells they are for, ascending; those that
/// `keeps(cell)` refuses are left out.
template <typename S, typename Votes, typename Keeps>
Uninitialized<std::uint64_t> cast_votes(const PointCloud<S>& cloud, const VoteGrid& grid, double radius_min,
                                        double radius_max, Votes&& votes, Keeps&& keeps) {
  const int steps = std::max(1, static_cast<int>(std::lround((radius_max - radius_min) / grid.pitch)) + 1);
  Uninitialized<std::uint64_t> cells;
  const double limit = grid.widest(radius_max);
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5) - grid.before.template cast<double>();
  // None is negative. Numbers with a sign are converted by one instruction.
  const auto whole = [](double x) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(x)); };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if ((i & 0xFFF) == 0) throw_if_cancelled();
    if (!votes(i) || !is_finite(cloud.points[i]) || !VoteGrid::admits<S>(cloud.normals[i])) continue;
    const Eigen::Vector3d p = cloud.points[i].template cast<double>() - grid.origin;
    if (p.cwiseAbs().maxCoeff() > limit) continue;
    const Eigen::Vector3d n = cloud.normals[i].template cast<double>();
    const Eigen::Vector3d first = (p - radius_min * n) / grid.pitch + half;
    for (int s = 0; s < steps; ++s) {
      const Eigen::Vector3d c = first - double(s) * n;
      const std::uint64_t cell = grid.pack(whole(c.x()), whole(c.y()), whole(c.z()));
      if (keeps(cell)) cells.push_back(cell);
    }
  }
  radix_sort(cells, [](std::uint64_t cell) { return cell; });
  return cells;
}

/// The cells that have votes, ascending.
inline std::vector<VotedCell> count_votes(const Uninitialized<std::uint64_t>& votes) {
  std::vector<VotedCell> cells;
  for (std::size_t i = 0; i < votes.size();) {
    std::size_t j = i;
    while (j < votes.size() && votes[j] == votes[i]) ++j;
    cells.push_back({votes[i], static_cast<float>(j - i)});
    i = j;
  }
  return cells;
}

/// Sums over the 27 cells about each cell, over which a center's votes spread. The cells with the same y and z are a
/// line. The votes of a line and of the eight lines about it are added up once, by x, for all cells of the line.
class SumsOfCells {
 public:
  /// @param cells ascending; must outlive this
  SumsOfCells(const std::vector<VotedCell>& cells, const VoteGrid& grid)
      : cells_(cells), grid_(grid), by_x_(grid.cells_of_line() + 1, Sums::Zero()) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::uint64_t line = grid.line(cells[i].key);
      if (lines_.empty() || lines_.back().number != line) lines_.push_back({line, i});
    }
    lines_.push_back({std::numeric_limits<std::uint64_t>::max(), cells.size()});
  }

  /// Calls f(begin, end) for the cells of each line, ascending, after adding up the votes about the line.
  template <typename F>
  void for_each_line(F&& f) {
    for (std::size_t l = 0; l + 1 < lines_.size(); ++l) {
      if ((l & 0xFF) == 0) throw_if_cancelled();
      for_each_near(lines_[l], [&](const VotedCell& c, const Sums& one) { by_x_[grid_.x(c.key)] += c.votes * one; });
      f(cells_.data() + lines_[l].first, cells_.data() + lines_[l + 1].first);
      for_each_near(lines_[l], [&](const VotedCell& c, const Sums&) { by_x_[grid_.x(c.key)].setZero(); });
    }
  }

  /// The votes about a cell of the present line.
  float total(std::uint64_t cell) const {
    const std::size_t x = grid_.x(cell);
    return by_x_[x - 1][0] + by_x_[x][0] + by_x_[x + 1][0];
  }

  /// The mean place of the votes (m) about a cell of the present line.
  Eigen::Vector3d center(std::uint64_t cell) const {
    const std::size_t x = grid_.x(cell);
    const Eigen::Vector4d sums = (by_x_[x - 1] + by_x_[x] + by_x_[x + 1]).cast<double>();
    const Eigen::Vector3d off(double(by_x_[x + 1][0] - by_x_[x - 1][0]), sums[1], sums[2]);
    const Eigen::Vector3d at = (grid_.unpack(cell) + grid_.before).cast<double>();
    return grid_.origin + grid_.pitch * (sums[0] * at + off) / sums[0];
  }

 private:
  /// Of cells with the same x: their votes, and these times how far their line is from the present one in y and in z.
  /// Whole numbers, which single precision holds exactly.
  using Sums = Eigen::Vector4f;
  struct Line {
    std::uint64_t number;
    std::size_t first;  // its first cell
  };

  /// Calls f(cell, sums of one vote for it) for the cells of a line and of the eight about it. Call it for ascending
  /// lines.
  template <typename F>
  void for_each_near(const Line& line, F&& f) {
    for (std::size_t plane = 0; plane < 3; ++plane) {
      const std::uint64_t first = line.number - 1 + plane * grid_.lines_of_plane() - grid_.lines_of_plane();
      std::size_t& at = first_near_[plane];
      while (lines_[at].number < first) ++at;
      for (std::size_t n = at; lines_[n].number - first <= 2; ++n) {
        const Sums one(1.0f, static_cast<float>(lines_[n].number - first) - 1.0f, static_cast<float>(plane) - 1.0f,
                       0.0f);
        for (std::size_t c = lines_[n].first; c < lines_[n + 1].first; ++c) f(cells_[c], one);
      }
    }
  }

  const std::vector<VotedCell>& cells_;
  const VoteGrid& grid_;
  std::vector<Line> lines_;                  // ascending; one more marks the end
  std::array<std::size_t, 3> first_near_{};  // of the lines about the present one, in each plane
  std::vector<Sums> by_x_;                   // of the present line and the eight about it
};

/// The cells about which at least `min_votes` votes lie, ascending, with their sums.
/// @param wanted bool(cell), called for ascending cells: the others are left out
/// @param found found(cell, total, sums) receives them
template <typename Wanted, typename Found>
void sum_votes(const std::vector<VotedCell>& cells, const VoteGrid& grid, double min_votes, Wanted&& wanted,
               Found&& found) {
  SumsOfCells sums(cells, grid);
  sums.for_each_line([&](const VotedCell* begin, const VotedCell* end) {
    for (const VotedCell* c = begin; c != end; ++c) {
      if (double(c->votes) < min_votes / 27.0) continue;  // a center has at least the mean of the cells about it
      const auto total = double(sums.total(c->key));
      if (total >= min_votes && wanted(c->key)) found(c->key, total, std::as_const(sums));
    }
  });
}

/// Most votes first; equal ones in the order of their cells.
inline void sort_by_votes(std::vector<VoteSum>& sums) {
  std::sort(sums.begin(), sums.end(), [](const VoteSum& a, const VoteSum& b) {
    return a.votes > b.votes || (a.votes == b.votes && a.key < b.key);
  });
}

/// The cells about which some votes meet, and a quick test of whether a cell is one of them or next to one.
class VotedPlaces {
 public:
  explicit VotedPlaces(const VoteGrid& grid) : grid_(grid), bits_(kBits, false) {}

  /// Add a cell that comes after those added before.
  void add(std::uint64_t cell) {
    cells_.push_back(cell);
    const std::uint64_t first = cell - grid_.pack(1, 1, 1);
    for (const std::uint64_t z : {0, 1, 2})
      for (const std::uint64_t y : {0, 1, 2})
        for (const std::uint64_t x : {0, 1, 2}) bits_[bit(first + grid_.pack(x, y, z))] = true;
  }
  /// Whether a cell is one of the places; ask for ascending cells.
  bool has(std::uint64_t cell) {
    while (next_ < cells_.size() && cells_[next_] < cell) ++next_;
    return next_ < cells_.size() && cells_[next_] == cell;
  }
  /// False only if a cell is neither one of the places nor next to one.
  bool may_touch(std::uint64_t cell) const { return bits_[bit(cell)]; }

 private:
  static constexpr std::size_t kBits = std::size_t{1} << 20;
  static std::size_t bit(std::uint64_t cell) { return (cell * 0x9E3779B97F4A7C15ull) >> 44; }

  const VoteGrid& grid_;
  std::vector<std::uint64_t> cells_;  // ascending
  std::size_t next_ = 0;              // the place to compare next in has()
  std::vector<bool> bits_;
};

/// The first of the sums, and every other that is at least `apart` (m) from those before it; at most so many.
inline std::vector<VotedCenter> thin_out(const std::vector<VoteSum>& sums, double apart, std::size_t most) {
  std::vector<VotedCenter> out;
  HashGrid<double> kept(2.0 * apart);
  for (const VoteSum& s : sums) {
    if (((&s - sums.data()) & 0xFFF) == 0) throw_if_cancelled();
    if (out.size() >= most) break;
    if (kept.nearer(s.center, apart)) continue;
    kept.insert(s.center);
    out.push_back({s.center, s.votes});
  }
  return out;
}

}  // namespace detail

/// Local maxima of the votes for sphere centers, best first (of equal ones, in the order of their position).
/// @param cloud points (m) with outward unit normals; points with other normals, such as zero, do not vote
/// @param radius_min smallest expected radius (m), positive
/// @param radius_max largest expected radius (m), at least `radius_min`
/// @param min_votes weaker maxima are left out
/// @param fresh one per point, nonzero for new ones, or empty: centers for which new points cast less than half of
///   `min_votes` are left out, which is fast if few points are new
/// @param most the largest number of maxima; weaker ones are left out
/// @throws ParameterError; InputError if the cloud has no normals, or `fresh` has not one value per point; Cancelled
template <typename S>
std::vector<VotedCenter> vote_for_centers(const PointCloud<S>& cloud, double radius_min, double radius_max,
                                          double min_votes, const std::vector<char>& fresh = {},
                                          std::size_t most = kMostVotedCenters) {
  check_parameter(radius_min > 0, "radius_min", "positive", radius_min);
  check_parameter(radius_max >= radius_min && std::isfinite(radius_max), "radius_max", "radius_min or more and finite",
                  radius_max);
  check_input(cloud.normals.size() == cloud.points.size(), "vote_for_centers: the cloud has no normals");
  check_input(fresh.empty() || fresh.size() == cloud.size(), "vote_for_centers: fresh needs one value a point");
  if (cloud.empty()) return {};
  constexpr double kFreshShare = 0.5;
  const detail::VoteGrid grid(cloud, radius_max, radius_min / 5.0);
  const auto all = [](auto) { return true; };
  const auto cells_of = [&](const auto& votes, const auto& keeps) {
    return detail::count_votes(detail::cast_votes(cloud, grid, radius_min, radius_max, votes, keeps));
  };
  std::vector<detail::VoteSum> sums;
  const auto keep_sum = [&](std::uint64_t cell, double total, const detail::SumsOfCells& about) {
    sums.push_back({cell, total, about.center(cell)});
  };
  if (fresh.empty()) {
    detail::sum_votes(cells_of(all, all), grid, min_votes, all, keep_sum);
  } else {
    const auto is_fresh = [&](std::size_t i) { return fresh[i] != 0; };
    detail::VotedPlaces places(grid);
    detail::sum_votes(cells_of(is_fresh, all), grid, kFreshShare * min_votes, all,
                      [&](std::uint64_t cell, double, const detail::SumsOfCells&) { places.add(cell); });
    const auto touches = [&](std::uint64_t cell) { return places.may_touch(cell); };
    detail::sum_votes(
        cells_of(all, touches), grid, min_votes, [&](std::uint64_t cell) { return places.has(cell); }, keep_sum);
  }
  detail::sort_by_votes(sums);
  return detail::thin_out(sums, 0.6 * radius_min, most);
}

}  // namespace agrisee
