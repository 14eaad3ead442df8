// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The last fits of bodies, to the points of their own labels. Metres, any frame.
#pragma once

#include <agrisee/cloud/bodies.hpp>
#include <agrisee/cloud/body_size.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/found_body.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/robust.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace agrisee {

namespace detail {

/// The direction (unit) of the longest semi-axis of a body if it is at least 1.65 times the next; else none.
inline std::optional<Eigen::Vector3d> long_axis(const Ellipsoid& body) {
  constexpr double kLong = 1.65;  // lobed fruit of which little was seen looks up to 1.5 times as long as wide
  const auto [radii, axes] = semi_axes(body);
  if (radii[0] < kLong * radii[1]) return std::nullopt;
  return axes.col(0).eval();
}

/// Parameters by which a fit takes all its points, however many.
template <typename S>
FitParameters with_all_points(FitParameters fit, const PointCloud<S>& cloud) {
  fit.max_points = std::max(fit.max_points, static_cast<int>(cloud.size()));
  return fit;
}

/// Fit a body once more to `own` points; it stays as it is if there is no fit, or not the size of a fruit.
template <typename S>
void fit_again(const PointCloud<S>& cloud, const Indices& own, const FitParameters& how, const BodyParameters& bodies,
               EllipsoidFit& last) {
  if (const auto fit = fit_ellipsoid(cloud, own, last.body, how, last.size_prior, long_axis(last.body)))
    if (plausible(fit->body, bodies)) last = *fit;
}

/// Fit each body once more to all points of its own label, and assign the points anew; twice. Bodies by masks stay.
/// Long bodies are expected to be round about their long axis: of one side seen, they are as deep as they are wide.
/// A body of a single cloud that has a size prior is seen from one side: the errors of its points are alike over larger
/// parts of it than where several views were fused, so they count as fewer, and the priors decide more.
/// @param grid of the cloud's points, with cells of `bodies.cell()`
template <typename S>
void refit(const PointCloud<S>& cloud, const Grid<S>& grid, const BodyParameters& bodies, std::vector<FoundBody>& found,
           Labels& labels) {
  const FitParameters last_fit = with_all_points(bodies.fit, cloud);
  constexpr int kIndependentOnOneSide = 60;
  FitParameters one_sided = last_fit;
  one_sided.independent = std::min(last_fit.independent, kIndependentOnOneSide);
  for (int round = 0; round < 2; ++round) {
    auto own = indices_by_label(labels);
    own.resize(found.size());
    for (std::size_t b = 0; b < found.size(); ++b)
      if (!found[b].by_mask)
        fit_again(cloud, own[b], found[b].fit.size_prior ? one_sided : last_fit, bodies, found[b].fit);
    labels = assign_to_bodies_near(cloud, grid, found, bodies);
  }
}

/// The standard deviation (m) of points about a body, by the median of their distances: few points far off leave it as
/// it is.
template <typename S>
double scatter_about(const PointCloud<S>& cloud, const Indices& points, const Ellipsoid& body) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const Index i : points)
    distances.push_back(std::abs(body.distance(cloud.points[static_cast<std::size_t>(i)].template cast<double>())));
  return robust_scale(distances);
}

}  // namespace detail

/// Fit small bodies that several views show once more, as closely as their own points scatter.
///
/// While bodies compete, lobes and noise may carry a body's points off its surface. But where fruit touch leaves or
/// each other, surfaces in a fused cloud run into one another: points a millimetre or two outside, with normals between
/// those of the two. They make a small fruit too large, and pull it to its hidden side. Most points lie on the surface
/// that was seen well; their scatter, by the median, says which do not. Up to 0.63 usual radii that alone decides, from
/// the usual radius on the parameters of the fit, and between them a mean of both. Bodies by masks, and those with a
/// size prior, stay.
/// @param cloud with normals
/// @param labels one per point: the number of its body in `found` from 1, or 0
template <typename S>
void fit_closely(const PointCloud<S>& cloud, const Labels& labels, const BodyParameters& bodies,
                 std::vector<FoundBody>& found) {
  constexpr double kSmall = 0.63;      // usual radii: 16 mm
  constexpr double kTurned = deg(25);  // largest angle between the normals of a point and the body, without noise
  constexpr double kNoise = 1.2;       // by how much it grows with the noise of the normals
  FitParameters closely = detail::with_all_points(bodies.fit, cloud);
  const double angle = std::min(closely.max_angle, kTurned + kNoise * bodies.normal_noise);
  auto own = indices_by_label(labels);
  own.resize(found.size());
  for (std::size_t b = 0; b < found.size(); ++b) {
    EllipsoidFit& last = found[b].fit;
    const double size = last.body.mean_radius() / bodies.usual_radius;
    const double large = std::clamp((size - kSmall) / (1.0 - kSmall), 0.0, 1.0);
    if (found[b].by_mask || last.size_prior || own[b].empty() || large == 1.0) continue;
    closely.max_angle = angle + large * (bodies.fit.max_angle - angle);
    for (int round = 0; round < 2; ++round) {
      const double scatter = detail::scatter_about(cloud, own[b], last.body);
      const double share = std::min(1.0, scatter / bodies.fit.noise_of(last.body.mean_radius()));
      closely.gate = bodies.fit.gate * (share + large * (1.0 - share));
      if (closely.gate > 0.0) detail::fit_again(cloud, own[b], closely, bodies, last);
    }
  }
}

}  // namespace agrisee
