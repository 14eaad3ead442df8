// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The fit of a closed surface in spherical harmonics to a fruit's points, from one first guess of its axis;
/// closed_surface.hpp says how the surface is described. Metres, any frame.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/linear_model.hpp>
#include <agrisee/cloud/robust.hpp>
#include <agrisee/cloud/surface_model.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/geometry/spiral.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace agrisee {

namespace detail {

/// Logarithm of the distance (of m) from a point inside an ellipsoid to its surface, in the direction `u` (unit).
inline double log_distance(const Ellipsoid& body, const Eigen::Vector3d& from, const Eigen::Vector3d& u) {
  const Eigen::Vector3d o = body.times(from - body.center), a = body.times(u);  // |o + r a| = 1
  const double aa = a.squaredNorm(), ao = a.dot(o), root = ao * ao - aa * (o.squaredNorm() - 1.0);
  return std::log(std::max(1e-9, (std::sqrt(std::max(0.0, root)) - ao) / aa));
}

/// Fits a closed surface from one first guess of its axis.
class SurfaceFit {
 public:
  /// The points of a fruit and of what belongs to no fruit around it.
  struct Samples {
    std::vector<Eigen::Vector3d> points, normals;
    std::size_t own = 0;  ///< the first ones are the fruit's
  };

  static constexpr int kExtra = 4;  ///< unknowns beside the harmonics: shift and tilt of the axis, two each

  /// A first guess.
  struct Start {
    Ellipsoid body;
    Eigen::Vector3d axis;  ///< of symmetry, towards the stem
    double top = 1.0;      ///< points in directions nearer to the axis than this cosine are left out until open_top()
  };

  /// How far from the surface a point may lie and still count in a step, relative to the radius; at least four times
  /// the noise.
  struct Gates {
    double outside;  ///< for points outside: small, since other things may lie there
    double inside;   ///< for points inside: larger, since the surface would have hidden whatever lies behind it
    /// The fruit's points inside count if their normals face outwards at all, not only if they agree with the
    /// surface's.
    bool any_normal = false;
    bool join = true;  ///< whether points of no fruit count as well
  };

  /// @param model of revolution
  SurfaceFit(const Samples& samples, const Start& start, const SurfaceModel& model,
             const ClosedSurfaceParameters& parameters)
      : samples_(samples),
        parameters_(parameters),
        center_(start.body.center),
        top_(start.top),
        weights_(samples.points.size(), 0.0) {
    size_ = -std::log(start.body.A.determinant()) / 3.0;
    const Eigen::Vector3d axis = start.axis.normalized();
    turn_.row(2) = axis;
    turn_.row(0) = any_orthogonal<double>(axis);
    turn_.row(1) = turn_.row(2).cross(turn_.row(0));
    for (std::size_t i = 0; i < samples.own; ++i) weights_[i] = at_top(i) ? 0.0 : 1.0;
    constexpr int kDirections = 200;  // to project the ellipsoid onto the harmonics of order 0
    coefficients_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.basis.size()));
    Eigen::VectorXd values(coefficients_.size());
    for (int i = 0; i < kDirections; ++i) {
      const Eigen::Vector3d u = spiral_direction(i, kDirections);
      model.basis.values(u, values.data());
      coefficients_ += (log_distance(start.body, center_, turn_.transpose() * u) - size_) / kDirections * values;
    }
    coefficients_.tail(coefficients_.size() - SurfaceModel::kProfile - 1).setZero();
    residuals_.assign(samples.points.size(), 0.0);
  }

  /// Steps with `model`.
  /// @return false if the surface degenerates
  bool step(const SurfaceModel& model, const Gates& gates) {
    std::vector<RadialBin> bins = radial_bins(weights_);
    if (bins.size() < 12) return false;
    bins.insert(bins.end(), limits_.begin(), limits_.end());
    const LinearPosterior posterior = linear_posterior(problem(model, bins, noise_, 1.0));
    if (!posterior.mean.allFinite()) return false;
    const Eigen::Vector4d extra = posterior.mean.tail<kExtra>();
    Eigen::Vector2d shift = extra.head<2>(), tilt = extra.tail<2>();
    shift /= std::max(1.0, shift.norm() / 0.15);
    tilt /= std::max(1.0, tilt.norm() / 0.3);
    center_ += std::exp(size_) * turn_.topRows<2>().transpose() * shift;
    const Eigen::Vector3d axis = (turn_.row(2).transpose() + turn_.topRows<2>().transpose() * tilt).normalized();
    turn_.row(0) = (turn_.row(0) - axis.dot(turn_.row(0)) * axis.transpose()).normalized();
    turn_.row(2) = axis;
    turn_.row(1) = turn_.row(2).cross(turn_.row(0));
    coefficients_ = posterior.mean.head(posterior.mean.size() - kExtra);
    return weigh(model, gates);
  }

  /// Evidence for `model` about the present axis and center.
  double evidence(const SurfaceModel& model, const std::vector<RadialBin>& bins, double noise) const {
    return robust_evidence(problem(model, bins, noise, 1.0));
  }

  /// Evidence for `model`, with the coefficients of `from` where it has them.
  double evidence_for(const SurfaceModel& model, const SurfaceModel& from, const std::vector<RadialBin>& bins,
                      double noise) {
    const Eigen::VectorXd kept = coefficients_;
    coefficients_ = mapped(model, from, kept);
    const double out = evidence(model, bins, noise);
    coefficients_ = kept;
    return out;
  }

  /// Go on with another model.
  void change(const SurfaceModel& model, const SurfaceModel& from) {
    coefficients_ = mapped(model, from, coefficients_);
    noise_ = 0.01;
  }

  /// Distances that count in the next steps beside those of the points, in the axis' frame.
  void set_limits(std::vector<RadialBin> limits) { limits_ = std::move(limits); }

  /// From now on the points at the top count as all others.
  void open_top() { top_ = 1.0; }

  /// Points closer to the surface than `far` (relative) count fully, others not; only the fruit's.
  std::vector<double> plain_weights(double far) const {
    std::vector<double> weights(samples_.points.size(), 0.0);
    for (std::size_t i = 0; i < samples_.own; ++i) weights[i] = std::abs(residuals_[i]) < far && !at_top(i) ? 1.0 : 0.0;
    return weights;
  }
  void set_weights(std::vector<double> weights) { weights_ = std::move(weights); }

  /// Number of directions (bins) in which a large share of the fruit's points, of few or many, lies deep inside the
  /// surface. They contradict it: if the surface were there, it would have hidden them.
  std::size_t contradictions() const {
    constexpr double kDeep = 0.2, kShare = 0.4;  // relative; of the points in a bin
    using Bins = CubeBins<8>;
    std::array<std::size_t, Bins::kCount> all{}, deep{};
    for (std::size_t i = 0; i < samples_.own; ++i) {
      const auto bin = static_cast<std::size_t>(Bins::bin(samples_.points[i] - center_));
      ++all[bin];
      deep[bin] += residuals_[i] < -kDeep;
    }
    std::size_t out = 0;
    for (std::size_t b = 0; b < Bins::kCount; ++b)
      out += static_cast<double>(deep[b]) > kShare * static_cast<double>(all[b]);
    return out;
  }

  /// Mean distance of the fruit's points from the surface, relative, each at most 0.05.
  double misfit() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < samples_.own; ++i) sum += std::min(std::abs(residuals_[i]), 0.05);
    return sum / static_cast<double>(samples_.own);
  }

  /// Bins of the points by direction from the center, in the axis' frame.
  std::vector<RadialBin> radial_bins(const std::vector<double>& weights) const {
    using Bins = CubeBins<8>;
    std::array<RadialBin, Bins::kCount> all;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (!(weights[i] > 0.0)) continue;
      const Eigen::Vector3d q = samples_.points[i] - center_;
      const double r = q.norm();
      if (!(r > 1e-9)) continue;
      RadialBin& bin = all[static_cast<std::size_t>(Bins::bin(q))];
      bin.direction += weights[i] / r * q;
      bin.logarithm += weights[i] * std::log(r);
      bin.weight += weights[i];
    }
    std::vector<RadialBin> out;
    for (RadialBin& bin : all) {
      if (!(bin.weight > 1e-6) || !(bin.direction.norm() > 0.0)) continue;
      bin.logarithm /= bin.weight;
      bin.direction = (turn_ * bin.direction).normalized();
      out.push_back(bin);
    }
    return out;
  }

  /// Where a point lies relative to the surface.
  struct Foot {
    /// To first order along the normal: the logarithm of the point's distance from the center over that of the surface,
    /// divided by the steepness of the profile; negative inside.
    double distance;
    /// Of the body of revolution (unit, outwards), as lobes do not tilt it; zero for a point at the center.
    Eigen::Vector3d normal;
  };

  /// @param values scratch, so that many points need no memory each
  Foot foot(const SurfaceModel& model, const Eigen::Vector3d& point, Eigen::VectorXd& values) const {
    const Eigen::Vector3d q = turn_ * (point - center_);
    const double r = q.norm();
    if (!(r > 1e-9)) return {-1.0, Eigen::Vector3d::Zero()};
    const Eigen::Vector3d u = q / r;
    values.resize(coefficients_.size());
    model.basis.values(u, values.data());
    const double logarithm = std::log(r) - size_ - values.dot(coefficients_);
    const double slope = model.basis.slope(u, values.data(), coefficients_);
    const double s = std::sqrt(u.x() * u.x() + u.y() * u.y());
    const double c = s > 0.0 ? u.x() / s : 1.0, d = s > 0.0 ? u.y() / s : 0.0;
    const Eigen::Vector3d normal = u - slope * Eigen::Vector3d(u.z() * c, u.z() * d, -s);
    const double steepness = normal.norm();
    return {logarithm / steepness, turn_.transpose() * (normal / steepness)};
  }

  /// Distance (m) of the surface from the center in a direction of the axis' frame (unit).
  double distance(const SurfaceModel& model, const Eigen::Vector3d& u) const {
    Eigen::VectorXd values(coefficients_.size());
    model.basis.values(u, values.data());
    return std::exp(size_ + values.dot(coefficients_));
  }

  /// Values of the harmonics, and of the shift and tilt, in a direction of the axis' frame.
  /// @param out receives them: those of the harmonics, then kExtra
  void values(const SurfaceModel& model, const Eigen::Vector3d& u, double* out) const {
    model.basis.values(u, out);
    const double slope = model.basis.slope(u, out, coefficients_), s = std::sqrt(u.x() * u.x() + u.y() * u.y());
    out += model.basis.size();
    const double c = s > 0.0 ? u.x() / s : 1.0, d = s > 0.0 ? u.y() / s : 0.0;
    // A body of revolution r(theta), shifted by t (in units of its size) or tilted by a (rad) towards phi = 0: to first
    // order ln r changes by t cos(phi) (sin(theta) - slope cos(theta)) and by -a slope cos(phi).
    const double by_shift = s - slope * u.z();
    out[0] = c * by_shift;
    out[1] = d * by_shift;
    out[2] = -slope * c;
    out[3] = -slope * d;
  }

  /// Variances of the bins' logarithms.
  static Eigen::VectorXd variances(const std::vector<RadialBin>& bins, double noise) {
    Eigen::VectorXd out(static_cast<Eigen::Index>(bins.size()));
    for (std::size_t i = 0; i < bins.size(); ++i)
      out[static_cast<Eigen::Index>(i)] = bin_variance(bins[i].weight, noise);
    return out;
  }

  /// The harmonics, and the shift and tilt of the axis, as a linear model of the bins' logarithms.
  /// @param noise standard deviation of a point, relative to the radius
  /// @param freedom scales the standard deviations of shift and tilt
  LinearModel problem(const SurfaceModel& model, const std::vector<RadialBin>& bins, double noise,
                      double freedom) const {
    const auto n = static_cast<Eigen::Index>(bins.size()), terms = static_cast<Eigen::Index>(model.basis.size());
    LinearModel out{Eigen::MatrixXd(terms + kExtra, n), Eigen::VectorXd(n), variances(bins, noise),
                    Eigen::VectorXd(terms + kExtra)};
    for (Eigen::Index i = 0; i < n; ++i) {
      const RadialBin& bin = bins[static_cast<std::size_t>(i)];
      values(model, bin.direction, out.B.col(i).data());
      out.y[i] = bin.logarithm - size_;
    }
    out.prior << model.prior, Eigen::Vector4d(0.04, 0.04, 0.09, 0.09) * (freedom * freedom);
    return out;
  }

  const Eigen::Vector3d& center() const { return center_; }
  const Eigen::Matrix3d& turn() const { return turn_; }  ///< from the given frame to the axis' frame
  double size() const { return size_; }
  double noise() const { return noise_; }
  const std::vector<double>& weights() const { return weights_; }
  const std::vector<RadialBin>& limits() const { return limits_; }
  /// Foot::distance of each point.
  const std::vector<double>& residuals() const { return residuals_; }

 private:
  /// Whether a point lies at the top, where it does not count.
  bool at_top(std::size_t i) const {
    if (!(top_ < 1.0)) return false;
    const Eigen::Vector3d q = samples_.points[i] - center_;
    return turn_.row(2).dot(q) > top_ * q.norm();
  }

  static Eigen::VectorXd mapped(const SurfaceModel& model, const SurfaceModel& from, const Eigen::VectorXd& old) {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.basis.size()));
    const auto& to = model.basis.terms();
    const auto& have = from.basis.terms();
    for (std::size_t k = 0, j = 0; k < have.size(); ++k, ++j) {  // both ascend by order, then degree; `to` has all
      while (to[j].order != have[k].order || to[j].degree != have[k].degree) ++j;
      out[static_cast<Eigen::Index>(j)] = old[static_cast<Eigen::Index>(k)];
    }
    return out;
  }

  /// New residuals, noise and weights of all points.
  bool weigh(const SurfaceModel& model, const Gates& gates) {
    constexpr double kOwnCosine = 0.9, kJoinedCosine = 0.8;  // of the angle between normals of point and surface
    std::vector<double> cosines(samples_.points.size(), 0.0), sorted;
    sorted.reserve(samples_.own);
    Eigen::VectorXd values;
    for (std::size_t i = 0; i < samples_.points.size(); ++i) {
      const Foot foot = this->foot(model, samples_.points[i], values);
      residuals_[i] = foot.distance;
      cosines[i] = foot.normal.dot(samples_.normals[i]);
      if (i < samples_.own) sorted.push_back(std::abs(foot.distance));
    }
    if (sorted.empty()) return false;
    noise_ = std::clamp(1.4826 * median(sorted), parameters_.noise, std::max(parameters_.noise, 0.03));
    const double outside = std::max(4.0 * noise_, gates.outside), inside = std::max(4.0 * noise_, gates.inside);
    for (std::size_t i = 0; i < samples_.points.size(); ++i) {
      const double r = residuals_[i], t = r / (r > 0.0 ? outside : inside);
      const bool counts = i < samples_.own ? cosines[i] > (gates.any_normal && r < 0.0 ? 0.0 : kOwnCosine)
                                           : gates.join && cosines[i] > kJoinedCosine && std::abs(r) < parameters_.join;
      weights_[i] = counts && !at_top(i) ? biweight(t) : 0.0;
    }
    return true;
  }

  const Samples& samples_;
  const ClosedSurfaceParameters& parameters_;
  Eigen::Vector3d center_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  double top_;           ///< see Start
  double size_ = 0.0;    ///< logarithm of the start's mean radius (of m)
  double noise_ = 0.02;  ///< standard deviation of a point, relative
  Eigen::VectorXd coefficients_;
  std::vector<double> weights_, residuals_;
  std::vector<RadialBin> limits_;
};

}  // namespace detail

}  // namespace agrisee
