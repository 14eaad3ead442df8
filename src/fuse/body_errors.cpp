// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/volume.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/fuse/body_errors.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace agrisee::fuse {
namespace {

using detail::Matrix9;
using detail::Vector9;

/// Standard deviation of a surfel from its body by what is no error of the sensor: uneven skin, the map's grain (m).
constexpr double kUneven = 0.0002;
/// The part of that deviation due to smoothing, which flattens steep surfaces, over the noise of an image's cells. With
/// it, center errors on simulated trusses at 5 and 10 mm of noise a pixel are as large as reported.
constexpr double kFlattened = 0.1;
/// Variance of the errors that a view's points on a body share, over the one that shows as disagreement of views.
constexpr double kUnseen = 2.0;
/// Variance that registration leaves of a view's pose error along the sight lines, over that error's and the number of
/// views: the fewer there are, the less each overlaps with others. With it, errors of volumes of small fruit in three
/// to five views with poses 0.5 mm off are as large as reported.
constexpr double kLeftOfPoses = 1.5;
/// A view with fewer points on a body tells nothing of it.
constexpr std::size_t kLeastPoints = 10;
/// With fewer views of a body their disagreement tells nothing.
constexpr std::size_t kLeastViews = 3;

/// What some points of a view say of a body.
struct Pull {
  Vector9 sum = Vector9::Zero();  // of the weighted derivatives
  double weights = 0.0;           // their sum
  double residual = 0.0;          // weighted sum; mean after finish() (m)

  void add(const detail::EllipsoidRow& row) {
    sum += row.weight * row.derivatives;
    weights += row.weight;
    residual += row.weight * row.residual;
  }
  void finish() { residual /= weights; }
};

/// Where a view has a body, across its sight lines, by its points there.
struct Aside {
  double squares = 0.0;   ///< of the distance from where the others have it, less what its patches explain (m2)
  double measured = 0.0;  ///< number of axes on which that is known
};

/// What a view's points say of a body.
struct Share {
  Matrix9 normal_matrix = Matrix9::Zero();           // of the weighted derivatives
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // weighted mean
  // From where the reported pose puts the points (m); less the mean of the body's views after center_shifts.
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  Pull all;                   // as registered
  Aside aside;                // as registered
  std::vector<Pull> patches;  // of the points in one direction from the body's center
};

/// How far the patches of a view have a body aside: the shift for which their residuals are best explained, by weighted
/// least squares, across the sight lines. Its square is larger than the true one by what else is in the residuals.
Aside aside_of(const Share& share, double size) {
  constexpr std::size_t kFew = 8;
  constexpr double kSteep = 0.05;  // least share of the normals' squares along an axis that tells of a shift
  if (share.patches.size() < kFew) return {};
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  for (const Pull& patch : share.patches) {
    const double weight = patch.weights / share.all.weights;
    const Eigen::Vector3d by_shift = patch.sum.head<3>() / (size * patch.weights);
    information += weight * by_shift * by_shift.transpose();
    squares += weight * weight * by_shift * by_shift.transpose();
    rhs += weight * patch.residual * by_shift;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  if (!(solver.eigenvalues()[0] > kSteep)) return {};
  const Eigen::Matrix3d inverse = information.inverse();
  const Eigen::Vector3d shift = inverse * rhs, ahead = share.normal.normalized();
  double left = 0.0;
  for (const Pull& patch : share.patches)
    left += patch.weights / share.all.weights *
            std::pow(patch.residual - shift.dot(patch.sum.head<3>()) / (size * patch.weights), 2);
  const auto count = static_cast<double>(share.patches.size());
  const Eigen::Matrix3d covariance = left * count / (count - 3.0) * inverse * squares * inverse;
  return {shift.squaredNorm() - std::pow(shift.dot(ahead), 2) - covariance.trace() + ahead.dot(covariance * ahead),
          2.0};
}

std::optional<Share> share_of(const Ellipsoid& body, const RegisteredView& view, const FitParameters& parameters) {
  const sensor::SurfaceImage& image = *view.image;
  const Pose reported_T_registered = view.reported * image.world_T_optical.inverse(Eigen::Isometry);
  const double size = body.mean_radius();
  const double gate = parameters.gate_of(size), cos_max = std::cos(parameters.max_angle);
  const double reach = body.mean_semi_axis() * 3.0 + gate;  // no semi-axis is longer than three times their mean
  Share out;
  std::size_t points = 0;
  std::array<Pull, DirectionBins::kCount> patches;
  for (std::size_t i = 0; i < image.points.size(); ++i) {
    const Eigen::Vector3d p = image.points[i].cast<double>();
    if ((p - body.center).squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d normal = image.normals[i].cast<double>();
    const auto row = detail::ellipsoid_row(body, p, normal, size, gate, cos_max);
    if (!(row.weight > 0.0)) continue;
    ++points;
    const Eigen::Vector3d shift = p - reported_T_registered * p;
    out.normal_matrix += row.weight * row.derivatives * row.derivatives.transpose();
    out.normal += row.weight * normal;
    out.shift += row.weight * shift;
    out.all.add(row);
    patches[static_cast<std::size_t>(DirectionBins::bin(p - body.center))].add(row);
  }
  if (points < kLeastPoints) return std::nullopt;
  out.all.finish();
  out.normal /= out.all.weights;
  out.shift /= out.all.weights;
  for (Pull& patch : patches) {
    if (!(patch.weights > 0.0)) continue;
    patch.finish();
    out.patches.push_back(patch);
  }
  out.aside = aside_of(out, size);
  return out;
}

/// Take the mean shift of the views on a body off their shifts: a shift that all have alike is no error between them.
void center_shifts(std::vector<Share>& of_body) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Share& s : of_body) mean += s.shift / static_cast<double>(of_body.size());
  for (Share& s : of_body) s.shift -= mean;
}

/// The sum of square(share) over its degrees of freedom: of each body one less than it has views.
template <typename Square>
double variance_of(const std::vector<std::vector<Share>>& shares, Square&& square) {
  double squares = 0.0, count = 0.0;
  for (const auto& of_body : shares) {
    for (const Share& s : of_body) squares += square(s);
    count += static_cast<double>(of_body.size() - 1);
  }
  return count > 0.0 ? squares / count : 0.0;
}

/// Variance of the mean residuals that the views would have on their bodies if none had been registered (m2).
double shared_variance(const std::vector<std::vector<Share>>& shares) {
  return variance_of(shares, [](const Share& s) {
    const double residual = s.all.residual - s.normal.dot(s.shift);
    return residual * residual;
  });
}

/// Variance along one axis of the errors of the views' poses (m2): of the shifts across the sight lines, on two axes.
/// Registration moves a view along its sight lines because of errors of the sensor, too.
double pose_variance(const std::vector<std::vector<Share>>& shares) {
  return 0.5 * variance_of(shares, [](const Share& s) {
           return s.shift.squaredNorm() - std::pow(s.shift.dot(s.normal.normalized()), 2);
         });
}

/// Variance, along an axis across the sight lines, of where the views have a body (m2).
double aside_variance(const std::vector<std::vector<Share>>& shares) {
  double squares = 0.0, measured = 0.0;
  for (const auto& of_body : shares) {
    const auto views = static_cast<double>(of_body.size());
    for (const Share& s : of_body) squares += s.aside.squares, measured += s.aside.measured * (views - 1.0) / views;
  }
  return measured > 0.0 ? std::max(0.0, squares / measured) : 0.0;
}

/// Variance of the mean residuals of the patches about those of their views (m2).
double patch_variance(const std::vector<std::vector<Share>>& shares) {
  double squares = 0.0, count = 0.0;
  for (const auto& of_body : shares)
    for (const Share& s : of_body) {
      if (s.patches.size() < 2) continue;
      for (const Pull& patch : s.patches) squares += std::pow(patch.residual - s.all.residual, 2);
      count += static_cast<double>(s.patches.size() - 1);
    }
  return count > 0.0 ? squares / count : 0.0;
}

/// Variance of the shifts of the views on one body along an axis (m2).
double shift_variance(const std::vector<std::vector<Share>>& shares) {
  return variance_of(shares, [](const Share& s) { return s.shift.squaredNorm() / 3.0; });
}

/// Variance of a surfel's distance from its body by smoothing (m2).
double flattened_variance(const std::vector<RegisteredView>& views) {
  double noise = 0.0;
  for (const RegisteredView& view : views) noise += view.image->noise / static_cast<double>(views.size());
  return std::pow(kFlattened * noise, 2);
}

/// Variances that all bodies of a scan share (m2).
struct Variances {
  double of_views = 0.0;    ///< of the mean residuals of views, without errors of poses
  double of_poses = 0.0;    ///< of the reported poses along an axis
  double of_patches = 0.0;  ///< of the mean residuals of patches about those of their views
  double of_shifts = 0.0;   ///< of the shifts of registration along an axis
  double aside = 0.0;       ///< of where the registered views have a body, across their sight lines, along an axis
  double flattened = 0.0;   ///< of a surfel by smoothing, the same in all views
};

BodyErrors errors_of(const Ellipsoid& body, const std::vector<Share>& shares, const Variances& variances,
                     const FitParameters& parameters) {
  const double size = body.mean_radius(), noise = parameters.noise_of(size);
  Matrix9 normal_matrix = Matrix9::Zero();
  Vector9 sum = Vector9::Zero();
  double weights = 0.0;
  for (const Share& s : shares) normal_matrix += s.normal_matrix, sum += s.all.sum, weights += s.all.weights;
  const double certainty = parameters.independent / (weights * noise * noise);
  Matrix9 information = certainty * normal_matrix + detail::shape_information(body, size, parameters.shape_prior);
  information.diagonal().array() += 1e-9 * information.diagonal().maxCoeff();
  Matrix9 scatter = (kUneven * kUneven + variances.flattened) / (noise * noise) * certainty * normal_matrix;
  const double of_views =
      kUnseen * variances.of_views + kLeftOfPoses / static_cast<double>(shares.size()) * variances.of_poses;
  for (const Share& s : shares) scatter += of_views * certainty * certainty * s.all.sum * s.all.sum.transpose();
  for (const Share& s : shares) {
    const Eigen::Vector3d ahead = s.normal.normalized();
    const Eigen::Matrix<double, 9, 3> by_shift = s.normal_matrix.leftCols<3>() / size;
    scatter += variances.aside * certainty * certainty *
               (by_shift * by_shift.transpose() - by_shift * ahead * (by_shift * ahead).transpose());
  }
  for (const Share& s : shares)
    for (const Pull& patch : s.patches)
      scatter += variances.of_patches * certainty * certainty * patch.sum * patch.sum.transpose();
  const Matrix9 inverse = Eigen::LDLT<Matrix9>(information).solve(Matrix9::Identity());
  const Matrix9 covariance = inverse * scatter * inverse.transpose();
  const Eigen::Matrix3d of_center = size * size * covariance.topLeftCorner<3, 3>();
  const Vector9 gradient = detail::log_volume_gradient(body, size);
  const double by_flattening = certainty * gradient.dot(inverse * sum);  // of the volume's logarithm by all residuals
  return {0.5 * (of_center + of_center.transpose()) +
              variances.of_shifts / static_cast<double>(shares.size()) * Eigen::Matrix3d::Identity(),
          std::sqrt(gradient.dot(covariance * gradient) + variances.flattened * by_flattening * by_flattening)};
}

}  // namespace

std::vector<BodyErrors> body_errors(const std::vector<Ellipsoid>& bodies, const std::vector<RegisteredView>& views,
                                    const FitParameters& parameters) {
  parameters.check();
  std::vector<std::vector<Share>> shares(bodies.size()), measured;  // of all bodies; of those that several views show
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (const RegisteredView& view : views) {
      throw_if_cancelled();
      if (const auto share = share_of(bodies[b], view, parameters)) shares[b].push_back(*share);
    }
    center_shifts(shares[b]);
    if (shares[b].size() >= kLeastViews) measured.push_back(shares[b]);
  }
  std::vector<BodyErrors> out(bodies.size());
  if (measured.empty()) return out;
  const double of_poses = pose_variance(measured);
  const Variances variances{std::max(0.0, shared_variance(measured) - of_poses),
                            of_poses,
                            patch_variance(measured),
                            shift_variance(measured),
                            aside_variance(measured),
                            flattened_variance(views)};
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!shares[b].empty()) out[b] = errors_of(bodies[b], shares[b], variances, parameters);
  return out;
}

}  // namespace agrisee::fuse
