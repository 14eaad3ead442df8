// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of fusing views into one surface. Metres, radians.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/sensor/surface_image.hpp>

namespace agrisee::fuse {

/// Parameters of SurfelMap.
struct SurfelParameters {
  double separation = 0.0024;  ///< smallest distance between two surfels of one surface (m)
  double max_angle = deg(60);  ///< samples whose normals differ by more belong to another surface (rad)
  double agreement = 0.0015;   ///< a sample agrees with a surfel that is at most this far off along the normal (m),
                               ///< plus three standard deviations

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("separation", p.separation, Range::positive());
    f("max_angle", p.max_angle, Range::above(0.0).below({kPi, "pi"}).in_radians());
    f("agreement", p.agreement, Range::not_negative());
  }
};

/// Parameters of the tests for free space: what a sight line went through is not there.
struct FreeSpaceParameters {
  double margin = 0.006;   ///< a sight line went through a place if it ended at least this far behind it (m), and at
                           ///< least three standard deviations of the cells' depths (SurfaceImage::noise)
  double min_fill = 0.85;  ///< cells without return count as evidence if surfaces return at least this share of pixels
  double max_incidence = deg(50);  ///< bodies are tested where their surface is seen at less than this angle (rad)
  int min_refuting = 2;            ///< a surfel is removed if this many views looked through it and at most half saw it
  double max_contradiction = 0.3;  ///< a view is rejected if it contradicts more than this share of what others saw

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("margin", p.margin, Range::positive());
    f("min_fill", p.min_fill, Range::not_negative());
    f("max_incidence", p.max_incidence, Range::above(0.0).below({kPi / 2, "pi/2"}).in_radians());
    f("min_refuting", p.min_refuting, Range::at_least(1));
    f("max_contradiction", p.max_contradiction, Range::above(0.0).up_to(1.0));
  }
};

/// Parameters of FusedViews: those of the stages that it calls. Parameters::fusion() returns the pipeline's.
struct FusionParameters {
  sensor::SurfaceParameters surface;  ///< how a surface is reconstructed from each frame
  SurfelParameters surfels;           ///< how the surfaces are fused
  IcpParameters icp;                  ///< how each view is registered
  FreeSpaceParameters free_space;     ///< when a sight line counts as evidence that something is not there
  bool register_views = true;         ///< register each view to what is fused so far (ICP) before it is fused
};

}  // namespace agrisee::fuse
