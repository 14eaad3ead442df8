// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All parameters of the pipeline in one plain struct: our defaults, and the paper's values.
#pragma once

#include <agrisee/cloud/icp_parameters.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/plan/gain_parameters.hpp>
#include <agrisee/plan/parameters.hpp>
#include <agrisee/see/params.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <string>

namespace agrisee {

/// Parameters of the whole pipeline. `Parameters{}` are our defaults, `Parameters::paper()` the paper's stages and
/// values.
struct Parameters {
  std::string preset = "default";  ///< name of the preset that these values started from
  std::string planner = "gain";    ///< gain (default), see (SEE++), fixed or random
  int max_views = 20;              ///< view budget, whatever the planner
  bool fuse_surfaces = true;       ///< smooth frames and fuse them as surfels; off: merge raw points, the first wins
  bool register_views = true;      ///< lay each view on what is fused so far (ICP) before fusing it
  bool filter_each_view = false;   ///< outlier removal after every view, besides the one at the end (raw points only)
  bool adaptive_normals = true;    ///< derive the normals' radius from the cloud's spacing
  double normal_reach = 3.0;       ///< adaptive: that many spacings
  bool growth_axis = true;         ///< pose frames: z towards the calyx; off: towards the cloud's highest point (paper)
  sensor::SurfaceParameters surface;     ///< a surface from each frame
  SurfelParameters surfels;              ///< fusing views
  IcpParameters icp;                     ///< registration of views
  SorParameters sor{20, 6.0, false};     ///< a wider gate than the paper's, which costs the borders of what was seen
  NormalParameters normals;              ///< of clouds without any
  SplitParameters split;                 ///< which points are which fruit
  GrowthAxisParameters axis;             ///< z of the pose frames
  MassParameters mass;                   ///< for yield
  plan::FreeSpaceParameters free_space;  ///< evidence of what sight lines went through
  plan::GainPlannerParameters gain;      ///< the default planner
  plan::PickingParameters picking;       ///< how to approach each fruit
  see::Parameters see;                   ///< SEE++

  /// The paper's stages with the paper's values.
  static Parameters paper() {
    Parameters p;
    p.preset = "paper";
    p.planner = "see";
    p.max_views = 50;
    p.fuse_surfaces = false;
    p.register_views = false;
    p.filter_each_view = true;
    p.adaptive_normals = false;
    p.growth_axis = false;
    p.icp = IcpParameters::paper();
    p.sor = SorParameters::paper();
    p.normals = NormalParameters::paper();
    p.split = SplitParameters::paper();
    p.picking = plan::PickingParameters::paper();
    p.see = see::Parameters::paper();
    return p;
  }
  /// The preset of that name. @throws ParameterError for any but `default` and `paper`
  static Parameters named(const std::string& preset) {
    if (preset == "default") return {};
    if (preset == "paper") return paper();
    throw ParameterError("preset must be default or paper, got " + preset);
  }
  /// Expect fruit with radii from `smallest` to `largest` (m) and set what follows from it: the range of bodies and,
  /// for fruit smaller than the 20 mm that the defaults are made for, the lengths at which surfaces are sampled, fused
  /// and fitted, in proportion. Sampling twice as finely gives four times the points, in about as much more time.
  /// @throws ParameterError when the range is empty or spans more than a factor of 20
  void expect_radii(double smallest, double largest) {
    BodyParameters bodies = split.bodies;
    bodies.radius_min = smallest;
    bodies.radius_max = largest;
    bodies.check();
    const double scale = std::min(1.0, smallest / BodyParameters().radius_min);
    bodies.fit.noise = scale * FitParameters().noise;
    split.bodies = bodies;
    surface.spacing = scale * sensor::SurfaceParameters().spacing;
    surface.smallest_radius = scale * sensor::SurfaceParameters().smallest_radius;
    surfels.separation = scale * SurfelParameters().separation;
    surfels.agreement = scale * SurfelParameters().agreement;
  }
  /// @throws ParameterError naming the first field out of its range
  void check() const {
    if (preset != "default" && preset != "paper")
      throw ParameterError("preset must be default or paper, got " + preset);
    if (planner != "gain" && planner != "see" && planner != "fixed" && planner != "random")
      throw ParameterError("planner must be gain, see, fixed or random, got " + planner);
    check_parameter(max_views >= 1, "max_views", ">= 1", max_views);
    check_parameter(normal_reach > 0, "normal_reach", "positive", normal_reach);
    surface.check();
    surfels.check();
    icp.check();
    sor.check();
    normals.check();
    split.check();
    axis.check();
    mass.check();
    free_space.check();
    gain.check();
    picking.check();
    see.check();
  }
  /// f(name, field) for every field; nested parameter structs have `fields` of their own.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("preset", p.preset);
    f("planner", p.planner);
    f("max_views", p.max_views);
    f("fuse_surfaces", p.fuse_surfaces);
    f("register_views", p.register_views);
    f("filter_each_view", p.filter_each_view);
    f("adaptive_normals", p.adaptive_normals);
    f("normal_reach", p.normal_reach);
    f("growth_axis", p.growth_axis);
    f("surface", p.surface);
    f("surfels", p.surfels);
    f("icp", p.icp);
    f("sor", p.sor);
    f("normals", p.normals);
    f("split", p.split);
    f("axis", p.axis);
    f("mass", p.mass);
    f("free_space", p.free_space);
    f("gain", p.gain);
    f("picking", p.picking);
    f("see", p.see);
  }
};

}  // namespace agrisee
