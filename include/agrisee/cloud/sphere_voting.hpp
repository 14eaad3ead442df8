// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds where the centres of round bodies may lie: every point votes along its inward normal.
///
/// A point p with outward normal n lies on a sphere of radius r about p - r n. The votes of all points for all radii in
/// the expected range meet at the centres of spheres (a Hough transform, cf. Rabbani & van den Heuvel, 2005), however
/// little of each shows and however they touch. Cost: linear in points times radii; memory linear in the votes.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/random.hpp>

#include <algorithm>
#include <array>

namespace agrisee {

/// A place where votes meet.
struct VotedCenter {
  Eigen::Vector3d center;  ///< m
  double votes;            ///< points that voted for it
};

/// Local maxima of the votes for sphere centres, best first (ties: by position).
/// @param cloud points with outward unit normals (zero normals do not vote)
/// @param radius_min, radius_max expected radii (m), 0 < min <= max
/// @param min_votes weaker maxima are left out
/// @throws ParameterError; InputError when the cloud has no normals
template <typename S>
std::vector<VotedCenter> vote_for_centers(const PointCloud<S>& cloud, double radius_min, double radius_max,
                                          double min_votes) {
  check_parameter(radius_min > 0, "radius_min", "positive", radius_min);
  check_parameter(radius_max >= radius_min && std::isfinite(radius_max), "radius_max", ">= radius_min", radius_max);
  check_input(cloud.normals.size() == cloud.points.size(), "vote_for_centers: the cloud has no normals");
  if (cloud.empty()) return {};
  const double pitch = radius_min / 5.0;
  const int steps = std::max(1, static_cast<int>(std::lround((radius_max - radius_min) / pitch)) + 1);

  // Cells are packed into one integer; 21 bits an axis around the first finite point.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (const auto& p : cloud.points)
    if (is_finite(p)) {
      origin = p.template cast<double>();
      break;
    }
  constexpr std::int64_t kHalf = 1 << 20;
  const auto pack = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (static_cast<std::uint64_t>(z + kHalf) << 42) | (static_cast<std::uint64_t>(y + kHalf) << 21) |
           static_cast<std::uint64_t>(x + kHalf);
  };
  std::vector<std::uint64_t> votes;
  votes.reserve(cloud.size() * static_cast<std::size_t>(steps));
  const double limit = pitch * double(kHalf - 4) - radius_max;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if ((i & 0xFFF) == 0) throw_if_cancelled();
    if (!is_finite(cloud.points[i]) || !(cloud.normals[i].squaredNorm() > S(0.5))) continue;
    const Eigen::Vector3d p = cloud.points[i].template cast<double>() - origin;
    if (p.cwiseAbs().maxCoeff() > limit) continue;
    const Eigen::Vector3d n = cloud.normals[i].template cast<double>();
    for (int s = 0; s < steps; ++s) {
      const Eigen::Vector3d c = (p - (radius_min + pitch * s) * n) / pitch;
      votes.push_back(pack(std::llround(c.x()), std::llround(c.y()), std::llround(c.z())));
    }
  }
  detail::sort_cancellably(votes.begin(), votes.end());
  struct Cell {
    std::uint64_t key;
    float votes;
  };
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < votes.size();) {
    std::size_t j = i;
    while (j < votes.size() && votes[j] == votes[i]) ++j;
    cells.push_back({votes[i], static_cast<float>(j - i)});
    i = j;
  }
  // A centre's votes spread over neighbouring cells: sum the 27 around each cell that could matter.
  struct Sum {
    std::uint64_t key;
    double votes;
    Eigen::Vector3d center;
  };
  std::vector<Sum> sums;
  // The cells of the nine rows about a cell are consecutive in the list, and move forward as the cell does.
  std::array<std::size_t, 9> rows{};
  for (const Cell& c : cells) {
    if (((&c - cells.data()) & 0xFFFF) == 0) throw_if_cancelled();
    if (double(c.votes) < min_votes / 27.0) continue;
    double total = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const auto x = static_cast<std::int64_t>(c.key & 0x1FFFFF) - kHalf;
    const auto y = static_cast<std::int64_t>((c.key >> 21) & 0x1FFFFF) - kHalf;
    const auto z = static_cast<std::int64_t>(c.key >> 42) - kHalf;
    for (std::size_t row = 0; row < 9; ++row) {
      const auto dy = static_cast<std::int64_t>(row % 3) - 1, dz = static_cast<std::int64_t>(row / 3) - 1;
      const std::uint64_t first = pack(x - 1, y + dy, z + dz);
      std::size_t& at = rows[row];
      while (at < cells.size() && cells[at].key < first) ++at;
      for (std::size_t k = at; k < cells.size() && cells[k].key <= first + 2; ++k) {
        const double v = double(cells[k].votes);
        total += v;
        mean += v * Eigen::Vector3d(double(x - 1) + static_cast<double>(cells[k].key - first), double(y + dy),
                                    double(z + dz));
      }
    }
    if (total >= min_votes) sums.push_back({c.key, total, origin + pitch * mean / total});
  }
  std::sort(sums.begin(), sums.end(),
            [](const Sum& a, const Sum& b) { return a.votes > b.votes || (a.votes == b.votes && a.key < b.key); });
  std::vector<VotedCenter> out;
  const double apart = 0.6 * radius_min;
  for (const Sum& s : sums) {
    if (((&s - sums.data()) & 0xFFF) == 0) throw_if_cancelled();
    const bool free = std::none_of(out.begin(), out.end(),
                                   [&](const VotedCenter& o) { return (o.center - s.center).norm() < apart; });
    if (free) out.push_back({s.center, s.votes});
    if (out.size() >= 400) break;  // more would only be noise
  }
  return out;
}

}  // namespace agrisee
