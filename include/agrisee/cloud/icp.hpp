// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Iterative closest point, point to plane (Chen & Medioni, 1992) or point to point (Besl & McKay, 1992): the small
/// rigid motion that aligns a source cloud (one view) with a target cloud (the map so far), or a report that no motion
/// can be trusted. [1] mentions ICP in the last line of alg. 1, without details.
///
/// Both clouds are in one frame, up to a small error; metres, radians. Cost of an iteration: one neighbor query for
/// every source point whose match may have changed, with a radius that shrinks to the distance of its last match, and
/// one 6 x 6 eigenproblem.
///
/// Each iteration solves the weighted normal equations of the linearised residuals (Gauss-Newton) for a rotation about
/// the source's centroid and a translation. Rotations are measured in units of the source's root-mean-square radius, so
/// that turns and shifts weigh alike. Directions that the surface leaves free (slides on a plane, turns of a sphere)
/// have small eigenvalues and are left out of the step (Zhang, Kaess & Singh, ICRA 2016), so nothing drifts along them.
#pragma once

#include <agrisee/cloud/icp_problem.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace agrisee {

/// The result of register_cloud.
struct IcpResult {
  Pose target_T_source = Pose::Identity();  ///< the corrected pose, or the initial one if no correction is accepted
  bool accepted = false;                    ///< whether the correction lowers the residual and is within its limits
  /// Residual (m) at the initial pose: sqrt(mean(2 rho(r))) over the points that are matched both at the initial pose
  /// and at the end; that is the root mean square if the kernel is `none`. 0 without matches.
  double rms_before = 0.0;
  double rms_after = 0.0;  ///< residual (m) at the end, over the same points
  /// Of these points in cubes with at least 8 of them, the share in cubes whose median residual grew clearly. The cubes
  /// have edges of six times `max_distance`, in the source's frame. 0 if no cube has 8.
  double worse = 0.0;
  std::size_t matches_before = 0;  ///< number of matched points at the initial pose
  std::size_t matches = 0;         ///< number of matched points at the end
  int iterations = 0;              ///< steps taken
  int constrained = 0;             ///< how many of the six directions the surface determined in the last step
  double translation = 0.0;        ///< how far the source's centroid moved (m), even if that was not accepted
  double rotation = 0.0;           ///< how far the source turned (rad), even if that was not accepted
};

namespace detail {

/// Edge length (m) of the cells of a grid over the target: at most the largest distance of a match, as half of a new
/// view may have none and is searched that far; less for a dense target, but so large that there are not many more
/// cells than points.
template <typename Target>
scalar_t<Target> icp_cell(const Target& target, const IcpParameters& parameters, int threads) {
  using S = scalar_t<Target>;
  Aabb box;
  for (std::size_t i = 0; i < agrisee::size(target); ++i)
    if (is_finite(point(target, i))) box.extend(point(target, i).template cast<double>());
  const double few = box.empty() ? 0.0 : std::cbrt(box.size().prod() / (8.0 * double(agrisee::size(target))));
  return static_cast<S>(
      std::min(parameters.max_distance, std::max(few, double(typical_distance(target, kFew, threads)))));
}

/// The scale (m) of the residuals of matched points.
inline double icp_scale(const std::vector<Index>& matches, const std::vector<double>& residuals,
                        const IcpParameters& parameters) {
  const bool wanted = parameters.kernel != RobustKernel::none;
  return wanted ? robust_scale(matches, residuals, parameters.min_scale()) : parameters.min_scale();
}

/// Step until the steps are small or the iterations are used up; `result` counts them.
/// @return the pose found
template <typename Problem>
Pose converge(Problem& problem, const IcpParameters& parameters, const Pose& initial, IcpResult& result) {
  Pose pose = initial;
  const auto enough = static_cast<std::size_t>(parameters.min_matches);
  while (result.matches >= enough && result.iterations < parameters.max_iterations) {
    throw_if_cancelled();
    const double scale = icp_scale(problem.matches(), problem.residuals(), parameters);
    const Pose step = problem.step(pose, scale, result.constrained);
    const double shift = (step * (pose * problem.centroid()) - pose * problem.centroid()).norm();
    pose = step * pose;
    pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
    ++result.iterations;
    problem.match(pose);
    result.matches = problem.matched();
    if (shift < parameters.translation_tolerance && angle_of(step) < parameters.rotation_tolerance) break;
  }
  return pose;
}

/// Enter the residuals before and after, over the points that are matched at both times.
template <typename Problem>
void compare_residuals(const Problem& problem, const std::vector<Index>& matches_before,
                       const std::vector<double>& residuals_before, const IcpParameters& parameters,
                       IcpResult& result) {
  const double scale_before = icp_scale(matches_before, residuals_before, parameters);
  double before = 0.0, after = 0.0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < matches_before.size(); ++i) {
    if (matches_before[i] < 0 || problem.matches()[i] < 0) continue;
    before += 2.0 * robust_cost(parameters.kernel, residuals_before[i], scale_before);
    after += 2.0 * robust_cost(parameters.kernel, problem.residuals()[i], scale_before);
    ++common;
  }
  if (common > 0) {
    result.rms_before = std::sqrt(before / static_cast<double>(common));
    result.rms_after = std::sqrt(after / static_cast<double>(common));
  }
}

/// Enter the share of the points in regions that fit worse than before, of those that are matched at both times.
template <typename Problem>
void compare_regions(const Problem& problem, const std::vector<Index>& matches_before,
                     const std::vector<double>& residuals_before, const IcpParameters& parameters, IcpResult& result) {
  constexpr double kEdge = 6.0;                      // edge of a region, in units of max_distance
  constexpr double kClearly = 1.3, kAtLeast = 0.02;  // grown by this factor, and by this much in units of max_distance
  constexpr std::size_t kFewest = 8;                 // points in a region that counts
  std::map<std::array<double, 3>, std::array<std::vector<double>, 2>> regions;
  for (std::size_t i = 0; i < matches_before.size(); ++i) {
    if (matches_before[i] < 0 || problem.matches()[i] < 0) continue;
    const Eigen::Vector3d cell = (problem.points()[i] / (kEdge * parameters.max_distance)).array().floor();
    auto& [before, after] = regions[{cell.x(), cell.y(), cell.z()}];
    before.push_back(std::abs(residuals_before[i]));
    after.push_back(std::abs(problem.residuals()[i]));
  }
  std::size_t points = 0, worse = 0;
  for (auto& region : regions) {
    auto& [before, after] = region.second;
    if (before.size() < kFewest) continue;
    points += before.size();
    if (median(after) > kClearly * median(before) + kAtLeast * parameters.max_distance) worse += before.size();
  }
  if (points > 0) result.worse = static_cast<double>(worse) / static_cast<double>(points);
}

/// True if the data favor the correction that `result` describes over the pose that was given. Compared
/// are the likelihood of the residuals, if one in `independent` matches has an error of its own, and what the
/// correction costs: half the logarithm of that number for each direction that is corrected (Schwarz, Annals of
/// Statistics 6:461, 1978), and its size against the pose's expected error.
inline bool worth_a_correction(const IcpResult& result, const IcpParameters& parameters) {
  if (!(result.rms_after < result.rms_before)) return false;
  if (parameters.independent == 0.0 || result.rms_after == 0.0) return true;
  const double samples = std::max(1.0, static_cast<double>(result.matches) / parameters.independent);
  const double gain = samples * std::log(result.rms_before / result.rms_after);
  const double shift = result.translation / parameters.pose_translation;
  const double turn = result.rotation / parameters.pose_rotation;
  return gain > 0.5 * (result.constrained * std::log(samples) + shift * shift + turn * turn);
}

}  // namespace detail

/// Register `source` to `target`; neither is changed.
///
/// A source point is matched with the nearest target point within `max_distance` whose normal agrees; a point whose
/// normal is needed but zero is not matched. The motion found is dropped (`accepted` is false and the initial pose is
/// returned) if it does not lower the residual (by more than chance would, see IcpParameters::independent), raises it
/// for too many points (IcpParameters::max_worse), is larger than the limits, loses half of the matches, or has fewer
/// than `min_matches`.
/// @param source points (m) to be aligned with the target
/// @param source_normals one unit normal per source point, or empty: the angle between normals is not tested then
/// @param target points (m) that stay where they are
/// @param target_normals one unit normal per target point; may be empty for point to point
/// @param parameters see their struct
/// @param search a KdTree or Grid over `target`; a grid with cells of the target's spacing is fastest
/// @param initial pose of the source frame in the target frame to start from and to measure the correction against
/// @param threads the result does not depend on it
/// @throws ParameterError for a bad parameter; InputError if sizes disagree, target normals are missing or `initial` is
///   not rigid; Cancelled
template <typename Source, typename Target, typename Search>
IcpResult register_cloud(const Source& source, const std::vector<Vector3<scalar_t<Target>>>& source_normals,
                         const Target& target, const std::vector<Vector3<scalar_t<Target>>>& target_normals,
                         const IcpParameters& parameters, const Search& search, const Pose& initial = Pose::Identity(),
                         int threads = 1) {
  parameters.check();
  check_input(search.size() == agrisee::size(target), "the search and the target differ in size");
  check_input(source_normals.empty() || source_normals.size() == agrisee::size(source),
              "ICP needs one normal a source point");
  check_input((parameters.point_to_point && target_normals.empty()) || target_normals.size() == agrisee::size(target),
              "ICP needs one normal a target point: give target_normals, or set point_to_point");
  check_input(is_rigid(initial), "the initial pose of ICP is not rigid");

  // Without target normals there is nothing to test the source's against.
  const std::vector<Vector3<scalar_t<Target>>> none;
  detail::IcpProblem<scalar_t<Target>, Source, Target, Search> problem(
      source, target_normals.empty() ? none : source_normals, target, target_normals, parameters, search, threads);
  IcpResult result;
  result.target_T_source = initial;
  problem.match(initial);
  result.matches_before = result.matches = problem.matched();
  const std::vector<Index> matches_before = problem.matches();
  const std::vector<double> residuals_before = problem.residuals();
  const Pose pose = detail::converge(problem, parameters, initial, result);
  detail::compare_residuals(problem, matches_before, residuals_before, parameters, result);
  detail::compare_regions(problem, matches_before, residuals_before, parameters, result);
  result.translation = (pose * problem.centroid() - initial * problem.centroid()).norm();
  result.rotation = angle_of(initial.inverse() * pose);
  result.accepted = result.matches >= static_cast<std::size_t>(parameters.min_matches) &&
                    2 * result.matches > result.matches_before && detail::worth_a_correction(result, parameters) &&
                    result.worse <= parameters.max_worse && result.translation <= parameters.max_translation &&
                    result.rotation <= parameters.max_rotation;
  if (result.accepted) result.target_T_source = pose;
  return result;
}

/// Register `source` to `target` with a search built for the call.
template <typename Source, typename Target>
IcpResult register_cloud(const Source& source, const std::vector<Vector3<scalar_t<Target>>>& source_normals,
                         const Target& target, const std::vector<Vector3<scalar_t<Target>>>& target_normals,
                         const IcpParameters& parameters = {}, const Pose& initial = Pose::Identity(),
                         int threads = 1) {
  parameters.check();
  using S = scalar_t<Target>;
  return register_cloud(source, source_normals, target, target_normals, parameters,
                        Grid<S>(target, detail::icp_cell(target, parameters, threads), threads), initial, threads);
}

/// Register `source` to `target` by the normals that both clouds hold. For point to point they may hold none; normals
/// of both, if there are any, still have to agree.
/// @param source points (m) to be aligned with the target, with normals
/// @param target points (m) that stay where they are, with normals
/// @param parameters, initial, threads as above
/// @throws ParameterError for a bad parameter; InputError if an array of a cloud has a wrong length (check_lengths), if
///   normals are missing or `initial` is not rigid; Cancelled
template <typename S>
IcpResult register_cloud(const PointCloud<S>& source, const PointCloud<S>& target, const IcpParameters& parameters = {},
                         const Pose& initial = Pose::Identity(), int threads = 1) {
  check_lengths(source);
  check_lengths(target);
  check_input(parameters.point_to_point || source.empty() || !source.normals.empty(),
              "ICP needs the normals of the source: estimate them, or set point_to_point");
  check_input(parameters.point_to_point || target.empty() || !target.normals.empty(),
              "ICP needs the normals of the target: estimate them, or set point_to_point");
  return register_cloud(source, source.normals, target, target.normals, parameters, initial, threads);
}

}  // namespace agrisee
