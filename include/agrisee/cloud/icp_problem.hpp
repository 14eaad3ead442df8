// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One registration in progress (see icp.hpp): the matches of the source points at the present pose, their residuals,
/// and the step that lowers these. Metres, radians.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/neighbors/detail/typical_distance.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee {

namespace detail {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Square6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kFew = 4;  ///< target points within the radius of a first query, on average

/// The normal equations of a step.
struct IcpSums {
  Square6 h = Square6::Zero();  ///< lower triangle
  Vector6 g = Vector6::Zero();

  /// Add a residual r (m) with its derivatives by rotation and translation.
  void add(const Vector6& j, double r, double weight) {
    const Vector6 weighted = weight * j;
    for (int c = 0; c < 6; ++c)
      for (int row = c; row < 6; ++row) h(row, c) += weighted[c] * j[row];
    g += r * weighted;
  }
};

/// The source points, their matches in the target at the present pose, and the steps that follow from them.
template <typename S, typename Source, typename Target, typename Search>
class IcpProblem {
 public:
  /// See register_cloud. All references must outlive the problem.
  IcpProblem(const Source& source, const std::vector<Vector3<S>>& source_normals, const Target& target,
             const std::vector<Vector3<S>>& target_normals, const IcpParameters& parameters, const Search& search,
             int threads)
      : target_(target), target_normals_(target_normals), parameters_(parameters), search_(search), threads_(threads) {
    const bool turned = !source_normals.empty() && parameters.max_normal_angle < kPi;
    cos_min_ = turned ? std::cos(parameters.max_normal_angle) : -2.0;
    first_reach_ = std::min(static_cast<S>(parameters.max_distance), typical_distance(target, kFew, threads));
    // The points are taken cell by cell, so that a query finds in the cache what the last one read.
    const Grid<scalar_t<Source>> order(source, static_cast<scalar_t<Source>>(parameters.max_distance), threads);
    points_.reserve(order.stored());
    for (std::size_t j = 0; j < order.stored(); ++j) {
      const auto i = static_cast<std::size_t>(order.ids()[j]);
      if (turned && !(source_normals[i].squaredNorm() > 0)) continue;  // its normal cannot be tested
      points_.push_back(order.stored_point(j).template cast<double>());
      if (turned) normals_.push_back(source_normals[i].template cast<double>());
      centroid_ += points_.back();
    }
    if (!points_.empty()) centroid_ /= static_cast<double>(points_.size());
    double squares = 0.0;
    for (const auto& p : points_) {
      squares += (p - centroid_).squaredNorm();
      radius_ = std::max(radius_, (p - centroid_).norm());
    }
    if (squares > 0.0) length_ = std::sqrt(squares / static_cast<double>(points_.size()));
    match_.assign(points_.size(), -1);
    safe_until_.assign(points_.size(), 0.0);
    residual_.assign(points_.size(), 0.0);
  }

  /// Centroid of the usable source points (m, source frame).
  const Eigen::Vector3d& centroid() const { return centroid_; }
  /// The usable source points (m, source frame).
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// Their normals; empty if these are not tested.
  const std::vector<Eigen::Vector3d>& normals() const { return normals_; }
  /// For each usable source point the index of its match in the target, or -1.
  const std::vector<Index>& matches() const { return match_; }
  /// The residuals (m) of the matched points, in the order of matches().
  const std::vector<double>& residuals() const { return residual_; }
  /// Number of matched points.
  std::size_t matched() const {
    return points_.size() - static_cast<std::size_t>(std::count(match_.begin(), match_.end(), Index(-1)));
  }

  /// Match every source point with the nearest target point whose normal agrees, and compute the residuals. A match is
  /// not looked up again as long as no point can have moved far enough for another target point to be nearer.
  void match(const Pose& target_T_source) {
    const double moved = matched_ ? farthest_move(target_T_source) : 0.0;
    moved_ += moved;
    // Steps get shorter. Queries that reach this far beyond the match save the next few steps a query each.
    const S beyond = 8.0 * moved < double(first_reach_) ? static_cast<S>(8.0 * moved) : S(0);
    parallel_for(points_.size(), threads_, [&](std::size_t i) {
      const Eigen::Vector3d q = target_T_source * points_[i];
      const Eigen::Vector3d normal =
          normals_.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(target_T_source.linear() * normals_[i]);
      if (!(match_[i] >= 0 && moved_ <= safe_until_[i] && agrees(match_[i], normal))) find(i, q, normal, beyond);
      if (match_[i] < 0) return;
      const Eigen::Vector3d gap = q - target_point(match_[i]).template cast<double>();
      residual_[i] = parameters_.point_to_point ? gap.norm() : target_normal(match_[i]).dot(gap);
    });
    matched_ = target_T_source;
  }

  /// The step that lowers the weighted residuals: a pose in the target frame, to be applied after `target_T_source`.
  /// @param scale of the residuals (m)
  /// @param constrained receives how many of the six directions the surface determines
  Pose step(const Pose& target_T_source, double scale, int& constrained) const {
    const IcpSums sums = normal_equations(target_T_source, scale);
    const Eigen::SelfAdjointEigenSolver<Square6> solver(sums.h);
    const Vector6 values = solver.eigenvalues();
    Vector6 x = Vector6::Zero();
    constrained = 0;
    for (int a = 0; a < 6; ++a) {
      if (!(values[a] > parameters_.degeneracy * values[5])) continue;
      x -= solver.eigenvectors().col(a) * (solver.eigenvectors().col(a).dot(sums.g) / values[a]);
      ++constrained;
    }
    const Eigen::Vector3d pivot = target_T_source * centroid_;
    const Eigen::Vector3d turn = x.head<3>() / length_;
    Pose step = Pose::Identity();
    if (turn.norm() > 0.0) step.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    step.translation() = pivot + x.tail<3>() - step.linear() * pivot;
    return step;
  }

 private:
  /// The normal equations at a pose, summed over chunks of points in a fixed order, whatever the number of threads.
  IcpSums normal_equations(const Pose& target_T_source, double scale) const {
    constexpr std::size_t kChunk = 512;
    const Eigen::Vector3d pivot = target_T_source * centroid_;
    std::vector<IcpSums> partial((points_.size() + kChunk - 1) / kChunk);
    parallel_chunks(points_.size(), threads_, kChunk, [&](std::size_t begin, std::size_t end) {
      IcpSums sums;  // local until the end: threads that write to one cache line would wait for each other
      for (std::size_t i = begin; i < end; ++i) {
        if (match_[i] < 0) continue;
        const double weight = robust_weight(parameters_.kernel, residual_[i], scale);
        const Eigen::Vector3d q = target_T_source * points_[i], arm = (q - pivot) / length_;
        const auto add = [&](const Eigen::Vector3d& direction, double r) {
          Vector6 j;
          j << arm.cross(direction), direction;
          sums.add(j, r, weight);
        };
        if (!parameters_.point_to_point) {
          add(target_normal(match_[i]), residual_[i]);
        } else {
          const Eigen::Vector3d gap = q - target_point(match_[i]).template cast<double>();
          for (int a = 0; a < 3; ++a) add(Eigen::Vector3d::Unit(a), gap[a]);
        }
      }
      partial[begin / kChunk] = sums;
    });
    IcpSums total;
    for (const IcpSums& sums : partial) {
      total.h += sums.h;
      total.g += sums.g;
    }
    return total;
  }

  /// The most that a point can have moved (m) since the last matching.
  double farthest_move(const Pose& target_T_source) const {
    const double turn = angle_of(matched_->inverse() * target_T_source);
    return (target_T_source * centroid_ - *matched_ * centroid_).norm() + turn * radius_;
  }

  /// Find the match of source point i, and how far points may move before it has to be looked up again.
  /// @param q the source point at the present pose (m)
  /// @param normal its normal at the present pose
  /// @param beyond how far the query reaches beyond the last match (m)
  void find(std::size_t i, const Eigen::Vector3d& q, const Eigen::Vector3d& normal, S beyond) {
    const S limit = static_cast<S>(parameters_.max_distance);
    const Vector3<S> query = q.template cast<S>();
    Index best = -1;
    S best_sq = limit * limit, reach = first_reach_;
    if (match_[i] >= 0 && agrees(match_[i], normal)) {  // the last match bounds the distance of the next
      const S d_sq = distance_sq<S>(target_point(match_[i]), query);
      if (d_sq <= best_sq) best = match_[i], best_sq = d_sq, reach = std::sqrt(best_sq) + beyond;
    }
    S other_sq;  // squared distance (m2) of the nearest point but the match, whether its normal agrees or not
    for (;; reach *= S(2)) {
      reach = std::min(reach, limit);
      other_sq = reach * reach;
      search_.visit(query, reach, [&](Index j, S d_sq) {
        if (j == best) return;
        const bool nearer = d_sq < best_sq || (d_sq == best_sq && (best < 0 || j < best));
        if (!nearer || !agrees(j, normal)) {
          other_sq = std::min(other_sq, d_sq);
          return;
        }
        if (best >= 0) other_sq = std::min(other_sq, best_sq);
        best = j;
        best_sq = d_sq;
      });
      if (best >= 0 || !(reach < limit)) break;
    }
    match_[i] = best;
    constexpr double kRounding = 1e-6;  // relative rounding of distances in S and of poses
    const double slack = double(std::sqrt(other_sq)) * (1.0 - kRounding) - double(std::sqrt(best_sq)) -
                         kRounding * q.cwiseAbs().maxCoeff();
    safe_until_[i] = moved_ + 0.5 * slack;
  }

  Vector3<S> target_point(Index j) const { return point(target_, static_cast<std::size_t>(j)); }
  Eigen::Vector3d target_normal(Index j) const {
    return target_normals_[static_cast<std::size_t>(j)].template cast<double>();
  }
  bool agrees(Index j, const Eigen::Vector3d& normal) const {
    if (target_normals_.empty()) return true;  // only with point_to_point
    const Eigen::Vector3d n = target_normal(j);
    if (!parameters_.point_to_point && !(n.squaredNorm() > 0.0)) return false;
    return normals_.empty() || n.dot(normal) >= cos_min_;
  }

  const Target& target_;
  const std::vector<Vector3<S>>& target_normals_;
  const IcpParameters& parameters_;
  const Search& search_;
  int threads_;
  S first_reach_;                // radius of the first query for a match (m)
  double cos_min_ = -2.0;        // of the angle between the normals of matched points
  double length_ = 1.0;          // root-mean-square radius of the source about its centroid (m), the unit of rotations
  double radius_ = 0.0;          // largest radius of the source about its centroid (m)
  std::optional<Pose> matched_;  // the pose of the last matching
  double moved_ = 0.0;           // sum over all matchings of the most that a point can have moved (m)
  Eigen::Vector3d centroid_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_, normals_;  // usable source points; normals are empty if they are not tested
  std::vector<Index> match_;                       // in the target, -1 = none
  std::vector<double> residual_;                   // of matched points (m)
  std::vector<double> safe_until_;                 // a match holds while moved_ is at most this (m)
};

}  // namespace detail

}  // namespace agrisee
