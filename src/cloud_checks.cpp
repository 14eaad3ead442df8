// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_checks.hpp"

#include <agrisee/cloud/convexity.hpp>
#include <agrisee/cloud/hidden_points.hpp>
#include <agrisee/cloud/spacing.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <algorithm>

#include "cloud/searches.hpp"
#include "cloud_normals.hpp"
#include "cloud_origin.hpp"
#include "input_checks.hpp"

namespace agrisee {
namespace {

/// What speaks against one viewpoint. @throws InputError with it, unless the viewpoint is trusted or the doubt is small
void doubt(const std::string& what, bool small, const CloudOrigin& origin, std::vector<std::string>& warnings) {
  if (!small && !origin.trust_viewpoint) throw InputError(what);
  warnings.push_back(what);
}

/// From this share of the largest expected radius on, a curved surface tells where it was seen from; small bumps do
/// not.
constexpr double kMedium = 0.33;

}  // namespace

void check_origin(const Cloud& cloud, const CloudOrigin& origin) {
  const auto finite = [](const Eigen::Vector3d& p) { return p.allFinite(); };
  check_input(std::all_of(origin.sensors.begin(), origin.sensors.end(), finite) &&
                  (!origin.viewpoint || finite(*origin.viewpoint)),
              "the position of a sensor (the viewpoint) is not finite");
  check_input(!origin.cluster_origin || finite(*origin.cluster_origin), "CloudOrigin::cluster_origin is not finite");
  for (std::size_t v = 0; v < origin.detected.size(); ++v)
    if (!origin.detected[v].frame)
      throw InputError("CloudOrigin::detected: view " + std::to_string(v) + " has no frame");
  if (Aabb box = bounding_box(cloud.points); !box.empty()) {
    if (origin.volume && !origin.volume->empty()) box.extend(origin.volume->min), box.extend(origin.volume->max);
    for (const Eigen::Vector3d& sensor : origin.sensors) check_distance("a sensor", sensor, box, "the cloud");
    if (origin.viewpoint) check_distance("a sensor", *origin.viewpoint, box, "the cloud");
  }
  if (!origin.sensors.empty() && !cloud.empty() && cloud.views.empty() && cloud.normals.empty())
    throw InputError(
        "positions of sensors are given, but the cloud does not say from which view each point comes "
        "(Cloud::views)");
  if (!origin.sensors.empty())
    for (const int view : cloud.views)
      if (view >= 0 && static_cast<std::size_t>(view) >= origin.sensors.size())
        throw InputError("view " + std::to_string(view) +
                         " of a point has no sensor position: CloudOrigin::sensors has " +
                         std::to_string(origin.sensors.size()));
  if (!has_one_viewpoint(origin) || cloud.views.empty()) return;
  int first = -1;  // of the views that are known
  for (const int view : cloud.views) {
    if (view < 0 || view == first) continue;
    if (first >= 0)
      throw InputError(
          "its points come from several views (" + std::to_string(first) + " and " + std::to_string(view) +
          ", for instance), so one viewpoint is not right for all: give the sensor's position of each view");
    first = view;
  }
}

void check_units(const Cloud& cloud, const Parameters& parameters) {
  constexpr double kLarge = 10.0;  // m; clouds of scanned trusses are smaller, and in millimetres they are larger
  constexpr std::size_t kFew = 100;
  const Aabb box = bounding_box(cloud.points);
  if (box.empty()) return;
  if (box.size().norm() > kLarge) {
    const Cloud finite = select(cloud, finite_indices(cloud));
    const double spacing = estimate_spacing(finite), largest = 2.0 * parameters.split.bodies.radius_max;
    if (finite.size() >= kFew && spacing > largest)
      throw InputError("the cloud is " + metres(box.size().norm()) + " across and its points are " + metres(spacing) +
                       " apart, farther than the largest expected fruit (" + metres(largest) +
                       "): is it in millimetres? Coordinates have to be in metres");
  }
  const auto is_far = [](const Eigen::Vector3f& p) {
    return is_finite(p) && p.cwiseAbs().maxCoeff() > float(kFarFromOrigin);
  };
  const auto far = std::count_if(cloud.points.begin(), cloud.points.end(), is_far);
  if (2 * far > static_cast<std::ptrdiff_t>(cloud.size()))
    throw InputError(far_from_origin("the cloud", box.center().norm(), "all points, and from the sensors' positions"));
}

void check_hidden(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                  std::vector<std::string>& warnings) {
  constexpr double kMost = 0.03;
  if (!has_one_viewpoint(origin) || cloud.empty()) return;
  const BodyParameters& bodies = parameters.split.bodies;
  const double deep = kMedium * bodies.radius_max, noise = noise_within(cloud, 0.5 * deep, bodies);
  const double hidden = hidden_share(cloud, *origin.viewpoint, deep + 4.0 * noise);
  if (hidden > kMost)
    doubt(percentage(hidden) +
              " of the points lie hidden behind others as seen from the viewpoint, so they were seen from elsewhere",
          false, origin, warnings);
}

void check_side(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                std::vector<std::string>& warnings) {
  constexpr double kLeast = 1.0 / 3.0, kUsual = 0.45;  // share that bulges; on real trees seen rightly 0.55 or more
  if (!has_one_viewpoint(origin)) return;
  const BodyParameters& bodies = parameters.split.bodies;
  const auto convex = convex_share(cloud, kMedium * bodies.radius_max, bodies.radius_max);
  if (convex && *convex < kUsual)
    doubt(percentage(1.0 - *convex) +
              " of what is curved as fruit is hollow as seen from the viewpoint, so it may lie behind the cloud",
          *convex >= kLeast, origin, warnings);
}

}  // namespace agrisee
