// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/parameters.hpp>

#include <algorithm>

namespace agrisee {

Parameters Parameters::paper() {
  Parameters p;
  p.preset = "paper";
  p.planner = "see";
  p.max_views = 50;
  p.fuse_surfaces = false;
  p.register_views = false;
  p.filter_each_view = true;
  p.adaptive_normals = false;
  p.max_incidence = kPi / 2;
  p.growth_axis = false;
  p.icp = IcpParameters::paper();
  p.sor = SorParameters::paper();
  p.normals = NormalParameters::paper();
  p.split = SplitParameters::paper();
  p.picking = pick::PickingParameters::paper();
  p.see = see::Parameters::paper();
  return p;
}

Parameters Parameters::see_alone() {
  Parameters p;
  p.preset = "see";
  p.planner = "see";
  p.max_views = 50;
  p.fuse_surfaces = false;
  p.register_views = false;
  p.see = see::Parameters::published();
  return p;
}

Parameters Parameters::named(const std::string& preset) {
  if (preset == kPresetNames[0]) return {};
  if (preset == kPresetNames[1]) return paper();
  if (preset == kPresetNames[2]) return see_alone();
  throw FieldError("preset", "must be " + OneOf(kPresetNames).text() + ", got " + preset);
}

void Parameters::expect_radii(double smallest, double largest) {
  BodyParameters bodies = split.bodies;
  bodies.radius_min = smallest;
  bodies.radius_max = largest;
  check_fields(bodies, "split.bodies.");
  constexpr double kSmallest = 0.020, kLargest = 0.050;  // m; from here on the defaults are fine enough
  const double scale = std::min(1.0, std::max(smallest / kSmallest, largest / kLargest));
  bodies.min_tolerance = scale * BodyParameters().min_tolerance;
  split.bodies = bodies;
  surface.spacing = scale * sensor::SurfaceParameters().spacing;
  surface.smallest_radius = scale * sensor::SurfaceParameters().smallest_radius;
  surfels.separation = scale * fuse::SurfelParameters().separation;
  surfels.agreement = scale * fuse::SurfelParameters().agreement;
}

SplitParameters Parameters::scan_split() const {
  SplitParameters out = split;
  out.bodies.alike = 0.0;
  return out;
}

void Parameters::check() const {
  check_fields(*this);
  const Limit most{20.0 * split.bodies.radius_max, "20 times split.bodies.radius_max"};
  const auto below_most = [&](const char* key, double length) {
    detail::check_field("", key, length, Range::finite().below(most).in_metres());
  };
  below_most("surface.spacing", surface.spacing);
  below_most("surface.smallest_radius", surface.smallest_radius);
  below_most("surfels.separation", surfels.separation);
  below_most("surfels.agreement", surfels.agreement);
  below_most("icp.max_distance", icp.max_distance);
  below_most("normals.radius", normals.radius);
  below_most("split.growing.radius", split.growing.radius);
  below_most("split.clustering.eps", split.clustering.eps);
  below_most("split.bodies.fit.noise", split.bodies.fit.noise);
}

}  // namespace agrisee
