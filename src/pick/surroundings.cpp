// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/voxel.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/pick/surroundings.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace agrisee::pick {
namespace {

/// Sums of integers: the same for any order of what is added.
struct ExactSums {
  std::array<std::int64_t, 3> offset = {};  // from the first point's cell, in units
  std::int64_t normals = 0;                 // of |n_x| + |n_y| + |n_z|, in 1 / kUnits
  std::int64_t points = 0;
};

constexpr double kUnits = 65536.0;  // per cell

/// |n_x| + |n_y| + |n_z| of a unit normal; its mean over all directions where the normal is not known.
double cells_per_face(const Cloud& cloud, std::size_t i) {
  if (!cloud.normals.empty()) {
    const double sum = cloud.normals[i].cast<double>().cwiseAbs().sum();
    if (sum >= 1.0 - 1e-3 && sum <= std::sqrt(3.0) + 1e-3) return sum;
  }
  return 1.5;
}

/// The piece of the points of one cell.
/// @param cell its lowest corner, in edges
SurfacePiece piece_of(const ExactSums& sums, const Eigen::Vector3d& cell) {
  const auto n = static_cast<double>(sums.points) * kUnits;
  SurfacePiece piece;
  for (int a = 0; a < 3; ++a)
    piece.center[a] = kPieceEdge * (cell[a] + static_cast<double>(sums.offset[static_cast<std::size_t>(a)]) / n);
  piece.area = kPieceEdge * kPieceEdge * n / static_cast<double>(sums.normals);
  return piece;
}

/// Directions in bands of about equal height, in each by azimuth, to find those near a given one.
class BandedDirections {
 public:
  explicit BandedDirections(const std::vector<Eigen::Vector3d>& directions)
      : bands_(std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(directions.size()))))) {
    for (std::size_t i = 0; i < directions.size(); ++i)
      bands_[band(directions[i].z())].push_back({std::atan2(directions[i].y(), directions[i].x()), i});
    for (auto& each : bands_) std::sort(each.begin(), each.end());
  }
  /// Calls f(number) once for all directions within an angle of the unit vector `v`, and for some beyond.
  /// @param chord length of the chord of that angle
  /// @param sine of that angle, from 0 to 1; the angle is at most 90 degrees
  template <typename F>
  void near(const Eigen::Vector3d& v, double chord, double sine, F&& f) const {
    const double level = std::hypot(v.x(), v.y());
    // The directions at an angle from v touch two meridians, unless they go round a pole.
    const double turn = sine < level ? std::asin(sine / level) + 1e-6 : kPi;
    const double azimuth = std::atan2(v.y(), v.x());
    for (std::size_t b = band(v.z() - chord), last = band(v.z() + chord); b <= last; ++b) {
      if (turn >= kPi) {
        for (const auto& each : bands_[b]) f(each.second);
        continue;
      }
      const double from = azimuth - turn, to = azimuth + turn;
      between(b, from, to, f);
      if (from < -kPi) between(b, from + kTwoPi, kPi, f);
      if (to > kPi) between(b, -kPi, to - kTwoPi, f);
    }
  }

 private:
  std::size_t band(double z) const {
    const double at = 0.5 * (z + 1.0) * static_cast<double>(bands_.size());
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bands_.size() - 1)));
  }
  template <typename F>
  void between(std::size_t b, double from, double to, F&& f) const {
    const auto& band = bands_[b];
    const auto first = std::lower_bound(band.begin(), band.end(), std::pair(from, std::size_t{0}));
    for (auto at = first; at != band.end() && at->first <= to; ++at) f(at->second);
  }

  std::vector<std::vector<std::pair<double, std::size_t>>> bands_;  // azimuth (rad) and number
};

bool comes_before(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
}

/// The finite points, in order.
std::vector<Eigen::Vector3f> sorted_finite(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3f> out;
  for (const Eigen::Vector3f& p : points)
    if (is_finite(p)) out.push_back(p);
  std::sort(out.begin(), out.end(), comes_before);
  return out;
}

}  // namespace

Cloud surroundings_of(const Cloud& cloud, const Labels& labels, const Cloud& raw) {
  check_lengths(cloud);
  check_lengths(raw);
  check_input(labels.size() == cloud.size(), "surroundings_of: there is not one label for each point");
  const bool with_normals = !cloud.normals.empty() || !raw.normals.empty();
  Cloud out;
  const auto add = [&](const Cloud& from, std::size_t i) {
    out.points.push_back(from.points[i]);
    if (with_normals) out.normals.push_back(from.normals.empty() ? Eigen::Vector3f::Zero() : from.normals[i]);
  };
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (labels[i] <= 0) add(cloud, i);
  if (raw.empty()) return out;
  const std::vector<Eigen::Vector3f> kept = sorted_finite(cloud.points);
  for (std::size_t i = 0; i < raw.size(); ++i)
    if (is_finite(raw.points[i]) && !std::binary_search(kept.begin(), kept.end(), raw.points[i], comes_before))
      add(raw, i);
  return out;
}

std::vector<SurfacePiece> surface_pieces(const Cloud& surroundings) {
  check_lengths(surroundings);
  constexpr double kInverse = 1.0 / kPieceEdge;  // as by_cell has it
  std::vector<SurfacePiece> pieces;
  agrisee::detail::by_cell(surroundings.points, kPieceEdge, [&](const auto& order) {
    for (std::size_t begin = 0; begin < order.size();) {
      const auto first = static_cast<std::size_t>(order[begin].index);
      const Eigen::Vector3d cell = (surroundings.points[first].cast<double>() * kInverse).array().floor();
      ExactSums sums;
      std::size_t j = begin;
      for (; j < order.size() && order[j].key == order[begin].key; ++j) {
        const auto i = static_cast<std::size_t>(order[j].index);
        const Eigen::Vector3d offset = surroundings.points[i].cast<double>() * kInverse - cell;
        for (std::size_t a = 0; a < 3; ++a)
          sums.offset[a] += std::llround(kUnits * offset[static_cast<Eigen::Index>(a)]);
        sums.normals += std::llround(kUnits * cells_per_face(surroundings, i));
        ++sums.points;
      }
      pieces.push_back(piece_of(sums, cell));
      begin = j;
    }
  });
  return pieces;
}

std::vector<SurfacePiece> pieces_beyond(double least, const OrientedEllipsoid& fruit,
                                        const std::vector<SurfacePiece>& pieces) {
  std::vector<SurfacePiece> out;
  const double near = fruit.radii.minCoeff() + least, far = fruit.radii.maxCoeff() + least;
  for (const SurfacePiece& piece : pieces) {
    const double away = (piece.center - fruit.center).squaredNorm();
    if (away >= far * far || (away >= near * near && distance(fruit, piece.center) >= least)) out.push_back(piece);
  }
  return out;
}

std::vector<double> crossed_surface(const std::vector<SurfacePiece>& pieces, const OrientedEllipsoid& fruit,
                                    const std::vector<Eigen::Vector3d>& directions,
                                    const PickingParameters& parameters) {
  std::vector<double> crossed(directions.size(), 0.0), lengths;
  for (const Eigen::Vector3d& d : directions) {
    const Capsule swept = swept_gripper(fruit, d, parameters);
    lengths.push_back((swept.b - swept.a).norm());
  }
  const double radius = parameters.gripper_radius, radius2 = radius * radius;
  const double far = directions.empty() ? 0.0 : *std::max_element(lengths.begin(), lengths.end()) + radius;
  const BandedDirections banded(directions);
  for (const SurfacePiece& piece : pieces) {
    const Eigen::Vector3d v = piece.center - fruit.center;
    const double away2 = v.squaredNorm();
    if (!(away2 <= far * far)) continue;
    throw_if_cancelled();
    const auto test = [&](std::size_t i) {
      const double ahead = -v.dot(directions[i]), along = std::clamp(ahead, 0.0, lengths[i]);
      if (away2 - along * (2.0 * ahead - along) <= radius2) crossed[i] += piece.area;
    };
    // Only directions within asin(radius / away) of the one to the piece come as near to it as that.
    const double away = std::sqrt(away2), sine = std::min(radius / away, 1.0);
    if (away > radius)
      banded.near(-v / away, std::sqrt(2.0 - 2.0 * std::sqrt(1.0 - sine * sine)) + 1e-6, sine, test);
    else
      for (std::size_t i = 0; i < directions.size(); ++i) test(i);
  }
  return crossed;
}

}  // namespace agrisee::pick
