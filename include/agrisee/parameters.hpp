// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All parameters of the pipeline in one struct, with the defaults and the values of [1]. Metres, radians, seconds.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/cloud/ripeness.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/pick/parameters.hpp>
#include <agrisee/plan/parameters.hpp>
#include <agrisee/see/parameters.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <array>
#include <string>

namespace agrisee {

/// Names of the presets, see Parameters::named.
constexpr std::array<const char*, 3> kPresetNames{"default", "paper", "see"};

/// Names of the planners, see make_planner.
constexpr std::array<const char*, 4> kPlannerNames{"gain", "see", "fixed", "random"};

/// Parameters of the whole pipeline. `Parameters{}` has the defaults, `Parameters::paper()` the stages and values of
/// [1], `Parameters::see_alone()` those of SEE++ alone.
struct Parameters {
  std::string preset = "default";  ///< name of the preset from which these values were made
  std::string planner = "gain";    ///< one of kPlannerNames: gain, see (SEE++), fixed (even directions) or random
  int max_views = 30;              ///< largest number of views, for every planner
  bool fuse_surfaces = true;  ///< smooth frames and fuse them as surfels; off: merge raw points, keeping the first ones
  bool register_views = true;      ///< register each view to the map (ICP), discard views that contradict the others
  bool filter_each_view = false;   ///< remove outliers after every view, not only at the end; for raw points only
  bool adaptive_normals = true;    ///< derive the radius of the normals from the cloud's spacing
  double normal_reach = 3.0;       ///< adaptive: that radius, in spacings of the cloud
  double max_incidence = deg(75);  ///< largest angle of incidence (rad) of the points of a cloud from one viewpoint;
                                   ///< points seen at a larger one are dropped; pi/2: keep all
  bool growth_axis = true;  ///< z of the pose frames points to the calyx; off: to the cloud's highest point, as in [1]
  double truss_gap = 1.5;   ///< fruit hang on one truss if the gap between them is at most this many of their radii
  sensor::SurfaceParameters surface;              ///< how a surface is reconstructed from each frame
  fuse::SurfelParameters surfels;                 ///< how views are fused
  IcpParameters icp = IcpParameters::of_views();  ///< how views are registered
  SorParameters sor = SorParameters::wide();      ///< outlier removal, with a std_ratio of 6 instead of the 2 of [1]
  NormalParameters normals;                       ///< how missing normals are estimated
  SplitParameters split;                          ///< which points belong to which fruit
  GrowthAxisParameters axis;                      ///< how z of the pose frames is found
  MassParameters mass;                            ///< from volume to mass
  fuse::FreeSpaceParameters free_space;           ///< when a sight line is evidence of free space
  fuse::MaskParameters masks;                     ///< how a detector's masks are weighed
  fuse::ColorPriorParameters color_prior;         ///< fruit color as a substitute for a detector
  RipenessParameters ripeness;                    ///< from colors to ripeness
  plan::GainPlannerParameters gain;               ///< planner `gain`
  pick::PickingParameters picking;                ///< how to approach each fruit
  see::Parameters see;                            ///< planner `see`

  /// The stages of [1] with its values.
  static Parameters paper();

  /// SEE++ as published: it chooses the views and merges their raw points, without smoothing, registration or filtering
  /// between views. After the scan the points are cleaned and segmented with the default parameters.
  static Parameters see_alone();

  /// The preset of that name. @throws FieldError if there is none
  static Parameters named(const std::string& preset);

  /// Expect fruit with radii from `smallest` to `largest` (m). Sets the range of radii of the bodies and, for radii
  /// below the 20 mm for which the defaults are made, scales the lengths at which surfaces are sampled, fused and
  /// fitted. Half the length gives four times the points and takes about four times as long.
  /// @throws FieldError if the range is empty or `largest` is more than 20 times `smallest`
  void expect_radii(double smallest, double largest);

  /// The segmentation parameters of a scan: several views saw each body, so sizes need no comparison.
  SplitParameters scan_split() const;

  /// The parameters of fuse::FusedViews.
  fuse::FusionParameters fusion() const { return {surface, surfels, icp, free_space, register_views}; }

  /// @throws FieldError for the first field that is out of its range; it names the whole key, e.g. `gain.min_gain`. The
  /// lengths of surfaces and neighborhoods must be below 20 times the largest expected radius, as otherwise nothing can
  /// be found.
  void check() const;

  /// f(name, field, range) for every field; without a range where there is none. Nested structs list their fields the
  /// same way.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("preset", p.preset, OneOf(kPresetNames));
    f("planner", p.planner, OneOf(kPlannerNames));
    f("max_views", p.max_views, Range::at_least(1));
    f("fuse_surfaces", p.fuse_surfaces);
    f("register_views", p.register_views);
    f("filter_each_view", p.filter_each_view);
    f("adaptive_normals", p.adaptive_normals);
    f("normal_reach", p.normal_reach, Range::positive());
    f("max_incidence", p.max_incidence, Range::above(0.0).up_to(kPi / 2).in_radians());
    f("growth_axis", p.growth_axis);
    f("truss_gap", p.truss_gap, Range::not_negative());
    f("surface", p.surface);
    f("surfels", p.surfels);
    f("icp", p.icp);
    f("sor", p.sor);
    f("normals", p.normals);
    f("split", p.split);
    f("axis", p.axis);
    f("mass", p.mass);
    f("free_space", p.free_space);
    f("masks", p.masks);
    f("color_prior", p.color_prior);
    f("ripeness", p.ripeness);
    f("gain", p.gain);
    f("picking", p.picking);
    f("see", p.see);
  }
};

}  // namespace agrisee
