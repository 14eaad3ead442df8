// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the stages that work on clouds, apart from the stages: whoever sets them need not compile those.
/// Metres, radians. Those of ICP are in icp_parameters.hpp.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

/// Parameters of estimate_normals.
struct NormalParameters {
  double radius = 0.006;   ///< r_n: neighbours are at most this far (m)
  int max_neighbors = 25;  ///< k_n: of those, at most this many, the nearest; the point itself counts

  /// The paper's values (table of parameters): r_n = 6 mm, k_n = 25.
  static NormalParameters paper() { return {}; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(std::isfinite(radius) && radius > 0, "radius", "positive and finite", radius);
    check_parameter(max_neighbors >= 3, "max_neighbors", "at least 3", max_neighbors);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius", p.radius);
    f("max_neighbors", p.max_neighbors);
  }
};

/// Parameters of remove_statistical_outliers.
struct SorParameters {
  int mean_k = 20;                ///< K, neighbours of a point without itself; fewer where the cloud has fewer
  double std_ratio = 2.0;         ///< alpha, deviations above the mean that are still kept
  bool sample_deviation = false;  ///< divide by N - 1 as PCL and Open3D do, instead of by N

  /// The paper's values (table of parameters): K = 20, alpha = 2.
  static SorParameters paper() { return {}; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(mean_k >= 1, "mean_k", "at least 1", mean_k);
    check_parameter(std::isfinite(std_ratio) && std_ratio >= 0, "std_ratio", "finite and not negative", std_ratio);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("mean_k", p.mean_k);
    f("std_ratio", p.std_ratio);
    f("sample_deviation", p.sample_deviation);
  }
};

/// Parameters of grow_regions.
struct RegionGrowingParameters {
  double radius = 0.006;            ///< r_v: neighbours are nearer than this (m)
  double smoothness = deg(12.0);    ///< theta_th: their normals differ by less than this (rad)
  int min_size = 350;               ///< N_min: smaller regions are none; their points go back to the residual
  int neighbors = 0;                ///< > 0: the k nearest points, itself included, instead of those within `radius`
  bool seeds_by_curvature = false;  ///< seeds in rising curvature instead of in index order
  double max_curvature = 1.0;       ///< points above it join but do not grow; 1/3 and more lets all grow
  bool unsigned_normals = false;    ///< n and -n are the same direction

  /// The paper's values (table of parameters): r_v = 6 mm, theta_th = 12 degrees, N_min = 350.
  static RegionGrowingParameters paper() { return {}; }

  /// Whether curvatures are asked for.
  bool needs_curvature() const { return seeds_by_curvature || max_curvature < 1.0 / 3.0; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(std::isfinite(radius) && radius > 0, "radius", "positive and finite", radius);
    check_parameter(smoothness >= 0 && smoothness <= kPi, "smoothness", "from 0 to pi", smoothness);
    check_parameter(min_size >= 1, "min_size", "at least 1", min_size);
    check_parameter(neighbors >= 0, "neighbors", "0 (use radius) or more", neighbors);
    check_parameter(max_curvature >= 0, "max_curvature", "not negative", max_curvature);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius", p.radius);
    f("smoothness", p.smoothness);
    f("min_size", p.min_size);
    f("neighbors", p.neighbors);
    f("seeds_by_curvature", p.seeds_by_curvature);
    f("max_curvature", p.max_curvature);
    f("unsigned_normals", p.unsigned_normals);
  }
};

/// Parameters of dbscan.
struct DbscanParameters {
  double eps = 0.007;   ///< radius of a neighbourhood (m)
  int min_points = 60;  ///< points, itself included, that make a point a core point

  /// The paper's values (table of parameters): eps = 7 mm, N_min = 60.
  static DbscanParameters paper() { return {}; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(std::isfinite(eps) && eps > 0, "eps", "positive and finite", eps);
    check_parameter(min_points >= 1, "min_points", "at least 1", min_points);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("eps", p.eps);
    f("min_points", p.min_points);
  }
};

/// Parameters of fit_ellipsoid.
struct FitParameters {
  double noise = 0.001;  ///< expected standard deviation of points about a fruit's ellipsoid, its lobes included (m)
  double shape_prior = 0.04;   ///< standard deviation of the relative semi-axes about a sphere
  double max_angle = deg(50);  ///< points whose normals differ by more from the body's do not count (rad)
  int independent = 150;       ///< points above this number add no certainty: neighbours err together
  int iterations = 12;         ///< at most
  int max_points = 400;        ///< of more points so many are used, evenly picked; neighbours tell the same

  /// @throws ParameterError
  void check() const {
    check_parameter(noise > 0, "fit.noise", "positive", noise);
    check_parameter(shape_prior > 0, "fit.shape_prior", "positive", shape_prior);
    check_parameter(max_angle > 0 && max_angle <= kPi, "fit.max_angle", "in (0, pi]", max_angle);
    check_parameter(independent >= 1, "fit.independent", ">= 1", independent);
    check_parameter(iterations >= 1, "fit.iterations", ">= 1", iterations);
    check_parameter(max_points >= 1, "fit.max_points", ">= 1", max_points);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("noise", p.noise);
    f("shape_prior", p.shape_prior);
    f("max_angle", p.max_angle);
    f("independent", p.independent);
    f("iterations", p.iterations);
    f("max_points", p.max_points);
  }
};

/// Parameters of the competition.
struct BodyParameters {
  double radius_min = 0.020;    ///< smallest expected radius of a fruit (m)
  double radius_max = 0.050;    ///< largest expected radius of a fruit (m)
  double tolerance = 0.08;      ///< points within this share of the radius belong to the body's surface
  double max_angle = deg(35);   ///< and their normals within this angle of the body's (rad)
  double min_coverage = 0.08;   ///< share of the surface that must be covered, contradictions taken off
  double min_roundness = 0.35;  ///< smaller over larger principal curvature of the support
  double max_overlap = 0.30;    ///< deepest interpenetration of two bodies, as a share of the smaller radius
  FitParameters fit;            ///< of the ellipsoids

  /// Whether a body of mean radius r (m) could be a fruit: within the expected range or hardly out of it.
  bool plausible(double r) const { return r >= 0.85 * radius_min && r <= 1.15 * radius_max; }
  /// @throws ParameterError
  void check() const {
    check_parameter(radius_min > 0, "bodies.radius_min", "positive", radius_min);
    check_parameter(radius_max >= radius_min && std::isfinite(radius_max), "bodies.radius_max", ">= radius_min",
                    radius_max);
    check_parameter(radius_max <= 20.0 * radius_min, "bodies.radius_max", "at most 20 times radius_min", radius_max);
    check_parameter(tolerance > 0 && tolerance < 1, "bodies.tolerance", "in (0, 1)", tolerance);
    check_parameter(max_angle > 0 && max_angle < kPi, "bodies.max_angle", "in (0, pi)", max_angle);
    check_parameter(min_coverage > 0 && min_coverage < 1, "bodies.min_coverage", "in (0, 1)", min_coverage);
    check_parameter(min_roundness >= 0 && min_roundness <= 1, "bodies.min_roundness", "in [0, 1]", min_roundness);
    check_parameter(max_overlap >= 0, "bodies.max_overlap", ">= 0", max_overlap);
    fit.check();
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius_min", p.radius_min);
    f("radius_max", p.radius_max);
    f("tolerance", p.tolerance);
    f("max_angle", p.max_angle);
    f("min_coverage", p.min_coverage);
    f("min_roundness", p.min_roundness);
    f("max_overlap", p.max_overlap);
    f("fit", p.fit);
  }
};

/// Parameters of split.
struct SplitParameters {
  bool adaptive = true;  ///< derive the lengths and sizes below from the cloud's spacing and `bodies.radius_min`
  RegionGrowingParameters growing;  ///< as given when not adaptive; otherwise its radius and min_size are derived
  DbscanParameters clustering;      ///< as given when not adaptive; otherwise derived
  double growing_reach = 2.2;       ///< adaptive: growth radius in spacings
  double clustering_reach = 2.5;    ///< adaptive: DBSCAN's eps in spacings
  double min_region = 0.03;         ///< adaptive: least region or cluster, as a share of the smallest fruit's surface
  int min_residual = 350;           ///< DBSCAN runs when the residual holds more points than this (not adaptive)
  bool fit_bodies = true;           ///< let bodies compete; off: the paper's two stages alone
  BodyParameters bodies;            ///< what may be a fruit

  /// The paper's values and stages.
  static SplitParameters paper() {
    SplitParameters p;
    p.adaptive = false;
    p.growing = RegionGrowingParameters::paper();
    p.clustering = DbscanParameters::paper();
    p.fit_bodies = false;
    return p;
  }
  /// @throws ParameterError
  void check() const {
    growing.check();
    clustering.check();
    bodies.check();
    check_parameter(growing_reach > 0, "split.growing_reach", "positive", growing_reach);
    check_parameter(clustering_reach > 0, "split.clustering_reach", "positive", clustering_reach);
    check_parameter(min_region > 0 && min_region < 1, "split.min_region", "in (0, 1)", min_region);
    check_parameter(min_residual >= 0, "split.min_residual", ">= 0", min_residual);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("adaptive", p.adaptive);
    f("growing", p.growing);
    f("clustering", p.clustering);
    f("growing_reach", p.growing_reach);
    f("clustering_reach", p.clustering_reach);
    f("min_region", p.min_region);
    f("min_residual", p.min_residual);
    f("fit_bodies", p.fit_bodies);
    f("bodies", p.bodies);
  }
};

/// Parameters of growth_axis.
struct GrowthAxisParameters {
  double shell = 0.45;      ///< points outside a fruit within this share of its radius may be its calyx and pedicel
  double up_weight = 0.35;  ///< weight of "fruit hang below their stem" against the evidence
  double stem_certainty = 10.0;  ///< of the direction that stem points tell, 1 / variance (1/rad2), against the body's

  /// @throws ParameterError
  void check() const {
    check_parameter(shell > 0, "axis.shell", "positive", shell);
    check_parameter(up_weight >= 0, "axis.up_weight", ">= 0", up_weight);
    check_parameter(stem_certainty > 0 && std::isfinite(stem_certainty), "axis.stem_certainty", "positive",
                    stem_certainty);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("shell", p.shell);
    f("up_weight", p.up_weight);
    f("stem_certainty", p.stem_certainty);
  }
};

/// Parameters of SurfelMap.
struct SurfelParameters {
  double separation = 0.0024;  ///< least distance between surfels of one surface (m)
  double max_angle = deg(60);  ///< samples whose normals differ by more belong to another surface (rad)
  double agreement = 0.0015;   ///< samples this far off along the normal agree in any case (m), beside 3 sigma

  /// @throws ParameterError
  void check() const {
    check_parameter(separation > 0 && std::isfinite(separation), "surfels.separation", "positive", separation);
    check_parameter(max_angle > 0 && max_angle < kPi, "surfels.max_angle", "in (0, pi)", max_angle);
    check_parameter(agreement >= 0, "surfels.agreement", ">= 0", agreement);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("separation", p.separation);
    f("max_angle", p.max_angle);
    f("agreement", p.agreement);
  }
};

/// Parameters of mass_of.
struct MassParameters {
  double density = 980.0;       ///< of the fruit (kg/m3): tomatoes mostly float, just; set that of your cultivar
  double density_error = 20.0;  ///< standard deviation of the density among fruit (kg/m3)
  double shape_error = 0.01;  ///< standard deviation of a fruit's volume about its ellipsoid's, relative: lobes, dents

  /// @throws ParameterError
  void check() const {
    check_parameter(density > 0 && std::isfinite(density), "mass.density", "positive", density);
    check_parameter(density_error >= 0 && std::isfinite(density_error), "mass.density_error", ">= 0", density_error);
    check_parameter(shape_error >= 0 && std::isfinite(shape_error), "mass.shape_error", ">= 0", shape_error);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("density", p.density);
    f("density_error", p.density_error);
    f("shape_error", p.shape_error);
  }
};

}  // namespace agrisee
