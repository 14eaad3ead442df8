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

/// Parameters of free space: nothing is where a sight line passed through.
struct FreeSpaceParameters {
  double margin = 0.006;   ///< a sight line passes through a point if it ends at least this far behind it (m), and at
                           ///< least three standard deviations of the cells' depths (SurfaceImage::noise)
  double min_fill = 0.85;  ///< cells without return count as evidence if surfaces return at least this share of pixels
  double max_incidence = deg(50);  ///< bodies are tested where their surface is seen at less than this angle (rad)
  int min_refuting = 2;            ///< a surfel is removed if this many views looked through it and at most half saw it
  double max_contradiction = 0.45;  ///< a view is discarded if it contradicts more than this share of what others saw
  double leaf_depth = 0.03;  ///< smaller differences of depth between views (m) are no contradiction: leaves read too
                             ///< deep, by an amount that depends on what is behind them

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
    f("leaf_depth", p.leaf_depth, Range::not_negative());
  }
};

/// Parameters of the evidence from a detector's masks (fuse/masks.hpp).
struct MaskParameters {
  double max_score = 0.95;  ///< scores are limited to this, and to 1 minus this from below
  double trust = 0.5;       ///< factor on the log-odds of a score, because detectors are overconfident
  double recall = 0.5;  ///< least share of the fruit for which the detector has a mask; a body without a mask has its
                        ///< odds multiplied by 1 minus this
  double max_log_odds = 4;  ///< largest change of a body's log-odds by all masks together
  double edge = 1.5;        ///< standard deviation of a mask's outline (pixels)
  bool alike = true;        ///< expect fruit whose outline is hidden to be as large as the others in sight

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("max_score", p.max_score, Range::above(0.5).below(1.0));
    f("trust", p.trust, Range::between(0.0, 1.0));
    f("recall", p.recall, Range::at_least(0.0).below(1.0));
    f("max_log_odds", p.max_log_odds, Range::positive());
    f("edge", p.edge, Range::positive());
    f("alike", p.alike);
  }
};

/// Parameters of the color prior, which replaces a detector by a simple rule on colors (fuse/color_prior.hpp).
struct ColorPriorParameters {
  bool enabled = false;      ///< treat patches of fruit color as masks
  double hue_from = -1.1;    ///< smallest hue angle of fruit (rad, CIELAB; red is at 0.6)
  double hue_to = 1.1;       ///< largest hue angle of fruit (rad)
  double min_chroma = 15.0;  ///< smallest chroma of fruit (CIELAB)
  double score = 0.8;        ///< score of a patch, like that of a detector's mask
  double least_disc = 0.25;  ///< smallest patch, as a share of the disc of the smallest expected fruit

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("enabled", p.enabled);
    f("hue_from", p.hue_from, Range::between({-kPi / 2, "-pi/2"}, {1.5 * kPi, "3 pi/2"}).in_radians());
    f("hue_to", p.hue_to, Range::between({p.hue_from, "hue_from"}, {1.5 * kPi, "3 pi/2"}).in_radians());
    f("min_chroma", p.min_chroma, Range::not_negative());
    f("score", p.score, Range::between(0.0, 1.0));
    f("least_disc", p.least_disc, Range::positive());
  }
};

/// Parameters of FusedViews: those of the stages that it calls. Parameters::fusion() returns the pipeline's.
struct FusionParameters {
  sensor::SurfaceParameters surface;              ///< how a surface is reconstructed from each frame
  SurfelParameters surfels;                       ///< how the surfaces are fused
  IcpParameters icp = IcpParameters::of_views();  ///< how each view is registered
  FreeSpaceParameters free_space;                 ///< when a sight line is evidence of free space
  bool register_views = true;  ///< register each view to the map (ICP), discard views that contradict the others
};

}  // namespace agrisee::fuse
