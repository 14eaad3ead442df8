// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Iterative closest point, point to plane (Chen & Medioni, 1992) or point to point (Besl & McKay, 1992): the small
/// rigid motion that lays a source cloud (one view) on a target cloud (what is merged so far), or a report that there
/// is none to be trusted. The paper (its AgriSEE + SOR algorithm, last line) names ICP and gives no more.
///
/// Both clouds in one frame but for a small error; metres, radians. Cost an iteration: a neighbour query, with a radius
/// that shrinks to the distance of the last match, for every source point whose match may have changed, and one 6 x 6
/// eigenproblem.
///
/// Each iteration solves the weighted normal equations of the linearised residuals (Gauss-Newton) for a rotation about
/// the source's centroid, in units of its root-mean-square radius so that turns and shifts weigh alike, and a
/// translation. Directions that the surface leaves free (slides on a plane, turns of a sphere) have small eigenvalues
/// and are left out of the step (Zhang, Kaess & Singh, ICRA 2016), so nothing drifts along them.
#pragma once

#include <agrisee/cloud/icp_parameters.hpp>
#include <agrisee/core/grid.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/typical_distance.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <Eigen/Eigenvalues>

#include <optional>

namespace agrisee {

/// What register_cloud found.
struct IcpResult {
  Pose target_T_source = Pose::Identity();  ///< the correction, or the initial pose when none is accepted
  bool accepted = false;                    ///< the correction lowers the residual and is within its limits
  /// Residuals (m) at the initial pose and at the end of the search, over the points matched at both:
  /// sqrt(mean(2 rho(r))), the root mean square where the kernel is `none`. 0 without matches.
  double rms_before = 0.0;
  double rms_after = 0.0;          ///< the same at the end
  std::size_t matches_before = 0;  ///< matched points at the initial pose
  std::size_t matches = 0;         ///< and at the end
  int iterations = 0;              ///< steps taken
  int constrained = 0;             ///< of six directions, those that the surface determines, last step
  double translation = 0.0;        ///< size of the motion found (m, at the source's centroid)
  double rotation = 0.0;           ///< and its turn (rad)
};

namespace detail {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kFew = 4;  ///< points of the target that a first look for a match should find

/// Source points, their matches at the present pose and the sums made of them.
template <typename S, typename Source, typename Target, typename Search>
class IcpProblem {
 public:
  IcpProblem(const Source& source, const std::vector<Vector3<S>>& source_normals, const Target& target,
             const std::vector<Vector3<S>>& target_normals, const IcpParameters& params, const Search& search,
             int threads)
      : target_(target), target_normals_(target_normals), params_(params), search_(search), threads_(threads) {
    const bool turned = !source_normals.empty() && params.max_normal_angle < kPi;
    cos_min_ = turned ? std::cos(params.max_normal_angle) : -2.0;
    first_reach_ = std::min(static_cast<S>(params.max_distance), typical_distance(target, kFew, threads));
    // In an order that keeps neighbours together, so that one query finds in the cache what the last one read.
    const Grid<scalar_t<Source>> order(source, static_cast<scalar_t<Source>>(params.max_distance), threads);
    points_.reserve(order.stored());
    for (std::size_t j = 0; j < order.stored(); ++j) {
      const auto i = static_cast<std::size_t>(order.ids()[j]);
      if (turned && !(source_normals[i].squaredNorm() > 0)) continue;  // no test is possible
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

  const Eigen::Vector3d& centroid() const { return centroid_; }
  /// The source's usable points, in the order of matches() and residuals().
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// Their normals; empty where these are not tested.
  const std::vector<Eigen::Vector3d>& normals() const { return normals_; }
  const std::vector<Index>& matches() const { return match_; }
  const std::vector<double>& residuals() const { return residual_; }
  std::size_t matched() const {
    return points_.size() - static_cast<std::size_t>(std::count(match_.begin(), match_.end(), Index(-1)));
  }

  /// The nearest target point with a normal that agrees, for every source point, and its residual.
  /// A match stays without being looked for while no point can have moved far enough for another to be nearer.
  void match(const Pose& target_T_source) {
    const double moved = matched_ ? farthest_move(target_T_source) : 0.0;
    moved_ += moved;
    // Steps get shorter: so far beyond a match the next few of them reach, and are saved a search each.
    const S beyond = 8.0 * moved < double(first_reach_) ? static_cast<S>(8.0 * moved) : S(0);
    parallel_for(points_.size(), threads_, [&](std::size_t i) {
      const Eigen::Vector3d q = target_T_source * points_[i];
      const Eigen::Vector3d normal =
          normals_.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(target_T_source.linear() * normals_[i]);
      if (!(match_[i] >= 0 && moved_ <= safe_until_[i] && agrees(match_[i], normal))) find(i, q, normal, beyond);
      if (match_[i] < 0) return;
      const Eigen::Vector3d gap = q - target_point(match_[i]).template cast<double>();
      residual_[i] = params_.point_to_point ? gap.norm() : target_normal(match_[i]).dot(gap);
    });
    matched_ = target_T_source;
  }

  /// The step (a pose in the target frame, to be applied after `target_T_source`) that lowers the weighted residuals.
  Pose step(const Pose& target_T_source, double scale, int& constrained) const {
    constexpr std::size_t kChunk = 512;
    struct Sums {
      Matrix6 h = Matrix6::Zero();  // the lower triangle
      Vector6 g = Vector6::Zero();
    };
    const Eigen::Vector3d pivot = target_T_source * centroid_;
    std::vector<Sums> partial((points_.size() + kChunk - 1) / kChunk);  // added in order, whatever the threads
    parallel_chunks(points_.size(), threads_, kChunk, [&](std::size_t begin, std::size_t end) {
      Sums sums;  // its own until the end: two threads that write to one line of the cache take turns
      for (std::size_t i = begin; i < end; ++i) {
        if (match_[i] < 0) continue;
        const double weight = robust_weight(params_.kernel, residual_[i], scale);
        const Eigen::Vector3d q = target_T_source * points_[i], arm = (q - pivot) / length_;
        const auto add = [&](const Eigen::Vector3d& direction, double r) {
          Vector6 j;
          j << arm.cross(direction), direction;
          const Vector6 weighted = weight * j;
          for (int c = 0; c < 6; ++c)
            for (int row = c; row < 6; ++row) sums.h(row, c) += weighted[c] * j[row];
          sums.g += r * weighted;
        };
        if (!params_.point_to_point) {
          add(target_normal(match_[i]), residual_[i]);
        } else {
          const Eigen::Vector3d gap = q - target_point(match_[i]).template cast<double>();
          for (int a = 0; a < 3; ++a) add(Eigen::Vector3d::Unit(a), gap[a]);
        }
      }
      partial[begin / kChunk] = sums;
    });
    Sums total;
    for (const Sums& sums : partial) {
      total.h += sums.h;
      total.g += sums.g;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(total.h);
    const Vector6 values = solver.eigenvalues();
    Vector6 x = Vector6::Zero();
    constrained = 0;
    for (int a = 0; a < 6; ++a) {
      if (!(values[a] > params_.degeneracy * values[5])) continue;
      x -= solver.eigenvectors().col(a) * (solver.eigenvectors().col(a).dot(total.g) / values[a]);
      ++constrained;
    }
    const Eigen::Vector3d turn = x.head<3>() / length_;
    Pose step = Pose::Identity();
    if (turn.norm() > 0.0) step.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    step.translation() = pivot + x.tail<3>() - step.linear() * pivot;
    return step;
  }

 private:
  /// How far (m) a point may have moved since the last matching, at most.
  double farthest_move(const Pose& target_T_source) const {
    const double turn = angle_of(matched_->inverse() * target_T_source);
    return (target_T_source * centroid_ - *matched_ * centroid_).norm() + turn * radius_;
  }

  /// The match of source point i, which is at q, and how far the points may move before it has to be looked for again.
  void find(std::size_t i, const Eigen::Vector3d& q, const Eigen::Vector3d& normal, S beyond) {
    const S limit = static_cast<S>(params_.max_distance);
    const Vector3<S> query = q.template cast<S>();
    Index best = -1;
    S best_sq = limit * limit, reach = first_reach_;
    if (match_[i] >= 0 && agrees(match_[i], normal)) {  // the last match bounds the distance of the next
      const S d_sq = distance_sq<S>(target_point(match_[i]), query);
      if (d_sq <= best_sq) best = match_[i], best_sq = d_sq, reach = std::sqrt(best_sq) + beyond;
    }
    S other_sq;  // of the nearest but the match, whether its normal agrees or not
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
    constexpr double kRounding = 1e-6;  // of distances in S, of poses
    const double slack = double(std::sqrt(other_sq)) * (1.0 - kRounding) - double(std::sqrt(best_sq)) -
                         kRounding * q.cwiseAbs().maxCoeff();
    safe_until_[i] = moved_ + 0.5 * slack;
  }

  Vector3<S> target_point(Index j) const { return point(target_, static_cast<std::size_t>(j)); }
  Eigen::Vector3d target_normal(Index j) const {
    return target_normals_[static_cast<std::size_t>(j)].template cast<double>();
  }
  bool agrees(Index j, const Eigen::Vector3d& normal) const {
    if (target_normals_.empty()) return true;  // point to point alone comes here
    const Eigen::Vector3d n = target_normal(j);
    if (!params_.point_to_point && !(n.squaredNorm() > 0.0)) return false;
    return normals_.empty() || n.dot(normal) >= cos_min_;
  }

  const Target& target_;
  const std::vector<Vector3<S>>& target_normals_;
  const IcpParameters& params_;
  const Search& search_;
  int threads_;
  S first_reach_;  // where a match is looked for first (m)
  double cos_min_ = -2.0, length_ = 1.0;
  double radius_ = 0.0;          // of the source about its centroid (m)
  std::optional<Pose> matched_;  // the pose of the last matching
  double moved_ = 0.0;           // how far a point may have moved by then (m), all steps added up
  Eigen::Vector3d centroid_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_, normals_;
  std::vector<Index> match_;        // in the target, -1 = none
  std::vector<double> residual_;    // of matched points
  std::vector<double> safe_until_;  // a match holds while moved_ is not beyond
};

/// Cells (m) of a grid over the target: its own spacing, as most matches are no farther away than that, or as much more
/// as keeps the cells few.
template <typename Target>
scalar_t<Target> icp_cell(const Target& target, const IcpParameters& params, int threads) {
  using S = scalar_t<Target>;
  Aabb box;
  for (std::size_t i = 0; i < agrisee::size(target); ++i)
    if (is_finite(point(target, i))) box.extend(point(target, i).template cast<double>());
  const double few = box.empty() ? 0.0 : std::cbrt(box.size().prod() / (8.0 * double(agrisee::size(target))));
  return static_cast<S>(
      std::min(0.5 * params.max_distance, std::max(few, double(typical_distance(target, kFew, threads)))));
}

}  // namespace detail

/// Register `source` to `target`; neither is changed.
///
/// A source point is matched with the nearest target point within `max_distance` whose normal agrees; points without a
/// normal (zero), where one is needed, are not matched. The motion found is dropped (`accepted` false, the initial pose
/// returned) when it does not lower the residual, is larger than the limits, loses half of the matches, or there are
/// fewer than `min_matches`.
/// @param source points (m) that are laid on the target
/// @param source_normals one unit normal a source point, or empty: the angle between normals is not tested then
/// @param target points (m) that stay
/// @param target_normals one unit normal a target point; may be empty for point to point
/// @param params see their struct
/// @param search a KdTree or Grid over `target`; a grid with cells of the target's spacing is fastest
/// @param initial pose of the source frame in the target frame to start from and to measure the correction against
/// @param threads the result does not depend on it
/// @throws ParameterError for a bad parameter; InputError when sizes disagree, target normals are missing or `initial`
/// is
///         not rigid
template <typename Source, typename Target, typename Search>
IcpResult register_cloud(const Source& source, const std::vector<Vector3<scalar_t<Target>>>& source_normals,
                         const Target& target, const std::vector<Vector3<scalar_t<Target>>>& target_normals,
                         const IcpParameters& params, const Search& search, const Pose& initial = Pose::Identity(),
                         int threads = 1) {
  params.check();
  check_input(search.size() == agrisee::size(target), "the search and the target differ in size");
  check_input(source_normals.empty() || source_normals.size() == agrisee::size(source),
              "ICP needs one normal a source point");
  check_input((params.point_to_point && target_normals.empty()) || target_normals.size() == agrisee::size(target),
              "ICP needs one normal a target point");
  check_input(is_rigid(initial), "the initial pose of ICP is not rigid");

  // Without target normals there is nothing to test the source's against.
  const std::vector<Vector3<scalar_t<Target>>> none;
  detail::IcpProblem<scalar_t<Target>, Source, Target, Search> problem(
      source, target_normals.empty() ? none : source_normals, target, target_normals, params, search, threads);
  IcpResult result;
  result.target_T_source = initial;
  problem.match(initial);
  result.matches_before = result.matches = problem.matched();
  const auto enough = [&] { return result.matches >= static_cast<std::size_t>(params.min_matches); };
  const std::vector<Index> matches_before = problem.matches();
  const std::vector<double> residuals_before = problem.residuals();
  const auto scale_of = [&](const std::vector<Index>& matches, const std::vector<double>& residuals) {
    const bool wanted = params.kernel != RobustKernel::none;
    return wanted ? robust_scale(matches, residuals, params.min_scale()) : params.min_scale();
  };
  const double scale_before = scale_of(matches_before, residuals_before);

  Pose pose = initial;
  while (enough() && result.iterations < params.max_iterations) {
    throw_if_cancelled();
    const double scale = scale_of(problem.matches(), problem.residuals());
    const Pose step = problem.step(pose, scale, result.constrained);
    const double shift = (step * (pose * problem.centroid()) - pose * problem.centroid()).norm();
    pose = step * pose;
    pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
    ++result.iterations;
    problem.match(pose);
    result.matches = problem.matched();
    if (shift < params.translation_tolerance && angle_of(step) < params.rotation_tolerance) break;
  }

  double before = 0.0, after = 0.0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < matches_before.size(); ++i) {
    if (matches_before[i] < 0 || problem.matches()[i] < 0) continue;
    before += 2.0 * robust_cost(params.kernel, residuals_before[i], scale_before);
    after += 2.0 * robust_cost(params.kernel, problem.residuals()[i], scale_before);
    ++common;
  }
  if (common > 0) {
    result.rms_before = std::sqrt(before / static_cast<double>(common));
    result.rms_after = std::sqrt(after / static_cast<double>(common));
  }
  result.translation = (pose * problem.centroid() - initial * problem.centroid()).norm();
  result.rotation = angle_of(initial.inverse() * pose);
  result.accepted = enough() && 2 * result.matches > result.matches_before && result.rms_after < result.rms_before &&
                    result.translation <= params.max_translation && result.rotation <= params.max_rotation;
  if (result.accepted) result.target_T_source = pose;
  return result;
}

/// The same with a search built for the call.
template <typename Source, typename Target>
IcpResult register_cloud(const Source& source, const std::vector<Vector3<scalar_t<Target>>>& source_normals,
                         const Target& target, const std::vector<Vector3<scalar_t<Target>>>& target_normals,
                         const IcpParameters& params = {}, const Pose& initial = Pose::Identity(), int threads = 1) {
  params.check();
  using S = scalar_t<Target>;
  return register_cloud(source, source_normals, target, target_normals, params,
                        Grid<S>(target, detail::icp_cell(target, params, threads), threads), initial, threads);
}

}  // namespace agrisee
