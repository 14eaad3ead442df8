// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the steps on clouds. They stand apart from the steps so that a program that only sets them need not
/// compile those. Metres, radians.
#pragma once

#include <agrisee/cloud/robust.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

namespace agrisee {

/// Parameters of estimate_normals.
struct NormalParameters {
  double radius = 0.006;   ///< r_n: points within this distance are neighbors (m)
  int max_neighbors = 25;  ///< k_n: of those, only this many nearest ones are used; the point itself counts

  /// The values of [1], table of parameters: r_n = 6 mm, k_n = 25.
  static NormalParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius", p.radius, Range::positive());
    f("max_neighbors", p.max_neighbors, Range::at_least(3));
  }
};

/// Parameters of remove_statistical_outliers. The pipeline uses a larger `std_ratio` by default, see wide().
struct SorParameters {
  int mean_k = 20;                ///< K: neighbors of a point, itself not counted; fewer where the cloud has fewer
  double std_ratio = 2.0;         ///< alpha: points up to this many standard deviations above the mean are kept
  bool sample_deviation = false;  ///< divide by N - 1 as PCL and Open3D do, instead of by N

  /// The values of [1], table of parameters: K = 20, alpha = 2.
  static SorParameters paper() { return {}; }

  /// The pipeline's default: alpha = 6. With the 2 of [1] the borders of what was seen are removed as outliers.
  static SorParameters wide() {
    SorParameters p;
    p.std_ratio = 6.0;
    return p;
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("mean_k", p.mean_k, Range::at_least(1));
    f("std_ratio", p.std_ratio, Range::not_negative());
    f("sample_deviation", p.sample_deviation);
  }
};

/// Parameters of grow_regions.
struct RegionGrowingParameters {
  double radius = 0.006;            ///< r_v: points nearer than this are neighbors (m)
  double smoothness = deg(12.0);    ///< theta_th: a region grows to neighbors whose normals differ by less (rad)
  int min_size = 350;               ///< N_min: smaller regions are dissolved and their points returned to the residual
  int neighbors = 0;                ///< above 0: use the k nearest points, itself included, instead of `radius`
  bool seeds_by_curvature = false;  ///< take seeds in order of rising curvature instead of in index order
  double max_curvature = 1.0;       ///< points above it join a region but do not grow it; 1/3 or more: no limit
  bool unsigned_normals = false;    ///< treat n and -n as the same direction

  /// The values of [1], table of parameters: r_v = 6 mm, theta_th = 12 degrees, N_min = 350.
  static RegionGrowingParameters paper() { return {}; }

  /// Whether grow_regions needs the curvature of every point.
  bool needs_curvature() const { return seeds_by_curvature || max_curvature < 1.0 / 3.0; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius", p.radius, Range::positive());
    f("smoothness", p.smoothness, Range::between(0.0, {kPi, "pi"}).in_radians());
    f("min_size", p.min_size, Range::at_least(1));
    f("neighbors", p.neighbors, Range::not_negative());
    f("seeds_by_curvature", p.seeds_by_curvature);
    f("max_curvature", p.max_curvature, Range::not_negative());
    f("unsigned_normals", p.unsigned_normals);
  }
};

/// Parameters of dbscan.
struct DbscanParameters {
  double eps = 0.007;   ///< radius of a neighborhood (m)
  int min_points = 60;  ///< a point with this many points within `eps`, itself included, is a core point

  /// The values of [1], table of parameters: eps = 7 mm, N_min = 60.
  static DbscanParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("eps", p.eps, Range::positive());
    f("min_points", p.min_points, Range::at_least(1));
  }
};

/// Parameters of register_cloud (ICP).
struct IcpParameters {
  bool point_to_point = false;  ///< minimize the distances between points instead of those to the target's planes
  double max_distance = 0.005;  ///< points farther apart than this are not matched (m)
  double max_normal_angle = deg(30.0);        ///< nor are points whose normals differ by more (rad); pi: no such test
  RobustKernel kernel = RobustKernel::tukey;  ///< how much large residuals count
  int max_iterations = 30;                    ///< largest number of iterations
  double translation_tolerance = 1e-6;  ///< ICP has converged when a step moves the centroid by less than this (m)
  double rotation_tolerance = 1e-5;     ///< and rotates by less than this (rad)
  double degeneracy = 0.01;  ///< directions with eigenvalues below this share of the largest one are not corrected
  int min_matches = 20;      ///< with fewer matches the cloud is not moved
  double max_translation = 0.005;  ///< larger corrections are rejected (m, at the source's centroid)
  double max_rotation = deg(1.0);  ///< larger rotations are rejected (rad)
  /// Number of matches that count as one independent measurement, because errors of neighboring pixels are correlated.
  /// A correction must lower the residual by more than chance would. 0: every correction that lowers it is accepted.
  double independent = 0.0;
  double pose_translation = 0.002;  ///< expected error of the initial position (m); only `independent` > 0 reads it
  double pose_rotation = deg(0.3);  ///< expected error of the initial rotation (rad); only `independent` > 0 reads it
  /// A correction is rejected if more than this share of the matched points lies in regions where it makes the
  /// residuals larger. The correction of a wrong pose makes them smaller everywhere. A sensor that sees one material
  /// too deep, such as leaves, causes a correction that helps there and harms elsewhere. 1: no such test.
  double max_worse = 1.0;

  /// The defaults, which suit the stages of [1]; it does no registration and gives no values.
  static IcpParameters paper() { return {}; }
  /// For dense views of a depth camera.
  static IcpParameters of_views() {
    IcpParameters p;
    p.independent = 30.0;
    p.max_worse = 0.1;
    return p;
  }

  /// Smallest scale (m) of the robust kernels: a thousandth of `max_distance`, for data without noise.
  double min_scale() const { return 1e-3 * max_distance; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none. `kernel` is an enumeration with
  /// to_string and robust_kernel.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("point_to_point", p.point_to_point);
    f("max_distance", p.max_distance, Range::positive());
    f("max_normal_angle", p.max_normal_angle, Range::between(0.0, {kPi, "pi"}).in_radians());
    f("kernel", p.kernel);
    f("max_iterations", p.max_iterations, Range::at_least(1));
    f("translation_tolerance", p.translation_tolerance, Range::not_negative());
    f("rotation_tolerance", p.rotation_tolerance, Range::not_negative());
    f("degeneracy", p.degeneracy, Range::at_least(0.0).below(1.0));
    f("min_matches", p.min_matches, Range::at_least(6));
    f("max_translation", p.max_translation, Range::positive());
    f("max_rotation", p.max_rotation, Range::above(0.0).up_to({kPi, "pi"}).in_radians());
    f("independent", p.independent, Range::not_negative());
    f("pose_translation", p.pose_translation, Range::positive());
    f("pose_rotation", p.pose_rotation, Range::above(0.0).up_to({kPi, "pi"}).in_radians());
    f("max_worse", p.max_worse, Range::between(0.0, 1.0));
  }
};

/// Parameters of fit_ellipsoid.
struct FitParameters {
  double noise = 0.001;       ///< standard deviation of points from a fruit's ellipsoid, including its lobes (m)
  double max_noise = 0.05;    ///< `noise` is at most this share of the radius, as small bodies have smaller lobes
  double sensor_noise = 0.0;  ///< `noise` is at least this: standard deviation due to the sensor alone (m)
  /// Points farther from the ellipsoid than this many times the noise, and than a twentieth of its radius, are ignored.
  double gate = 4.0;
  double shape_prior = 0.04;   ///< standard deviation of the semi-axes from those of a sphere, relative to its radius
  double max_angle = deg(50);  ///< points whose normals differ from the ellipsoid's by more are ignored (rad)
  int independent = 150;       ///< points beyond this number add no certainty, since errors of neighbors correlate
  int iterations = 12;         ///< largest number of iterations
  int max_points = 400;        ///< larger sets of points are thinned evenly to this many

  /// Standard deviation (m) of points about a body of this mean radius (m).
  double noise_of(double radius) const { return std::max(sensor_noise, std::min(noise, max_noise * radius)); }

  /// Points farther (m) than this from a body of this mean radius (m) are ignored.
  double gate_of(double radius) const { return std::max(gate * noise_of(radius), 0.05 * radius); }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("noise", p.noise, Range::positive());
    f("max_noise", p.max_noise, Range::positive());
    f("sensor_noise", p.sensor_noise, Range::not_negative().in_metres());
    f("gate", p.gate, Range::positive());
    f("shape_prior", p.shape_prior, Range::positive());
    f("max_angle", p.max_angle, Range::above(0.0).up_to({kPi, "pi"}).in_radians());
    f("independent", p.independent, Range::at_least(1));
    f("iterations", p.iterations, Range::between(1, 1000));
    f("max_points", p.max_points, Range::at_least(1));
  }
};

/// Parameters of find_bodies: which ellipsoids may be fruit, and how they compete for points.
struct BodyParameters {
  double radius_min = 0.008;      ///< smallest expected radius of a fruit (m)
  double radius_max = 0.060;      ///< largest expected radius of a fruit (m)
  double usual_radius = 0.0252;   ///< bodies below this radius (m) are small: in several views their points count as
                                  ///< many as on one of this radius; see also fit_closely and doubt_bodies_alone
  double tolerance = 0.08;        ///< points within this share of the radius from the surface may belong to the body
  double min_tolerance = 0.0014;  ///< on small bodies, points within this distance from the surface (m)
  double max_angle = deg(35);     ///< if their normals are also within this angle of the body's (rad)
  double min_coverage = 0.08;     ///< least share of the surface that is covered by points, minus contradictions
  double min_roundness = 0.35;    ///< least ratio of the smallest to the largest curvature of its points
  double min_confidence = 0.5;    ///< least probability that it is a fruit (detail::fruit_probability)
  double point_noise = 0.0;       ///< standard deviation of a point from its surface due to the sensor alone (m)
  double normal_noise = 0.0;      ///< standard deviation of the angle of a normal due to the sensor alone (rad)
  double alike = 0.7;             ///< how much it counts that the fruit of a single cloud are alike in size (0..1)
  /// Several views: log-odds against a fruit for each unit of roundness below 0.5 (stumps, pipes), and for each 0.67
  /// rad by which the spread of its normals exceeds 0.3 rad (boxes).
  double ridge = 12.0;
  double max_overlap = 0.30;  ///< deepest penetration of two bodies, as a share of the smaller radius
  FitParameters fit;          ///< fit of the ellipsoids

  /// Whether a body of mean radius r (m) could be a fruit. The expected range is widened by 15 percent at both ends.
  bool plausible(double r) const { return r >= 0.85 * radius_min && r <= 1.15 * radius_max; }

  /// Points within this distance (m) from the surface of a body of mean radius r (m) may belong to it. Where the
  /// sensor's errors are larger than `tolerance`, they widen it, up to a limit.
  double near(double r) const {
    constexpr double kNoise = 0.6, kWidest = 0.12;
    return std::max({tolerance * r, min_tolerance, std::min(kNoise * fit.sensor_noise, kWidest * r)});
  }

  /// Whether a cloud that is not of a single view (BodyEvidence) is that of a scan of several views, the fruit of which
  /// need not be alike (Parameters::scan_split).
  bool several_views() const { return alike == 0.0; }

  /// How near the noise of the normals is to that at which small fruit looks least like fruit (0 to 1).
  double share_of_much_noise() const {
    constexpr double kMuch = 0.15;  // rad; more changes nothing
    return std::min(normal_noise / kMuch, 1.0);
  }

  /// Cell size (m) of a grid in which the points about bodies of all expected radii are looked up.
  double cell() const { return 0.3 * std::sqrt(radius_min * radius_max); }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("radius_min", p.radius_min, Range::positive().up_to(1.0).in_metres());
    f("radius_max", p.radius_max,
      Range::between({p.radius_min, "radius_min"}, {20.0 * p.radius_min, "20 times radius_min"}).in_metres());
    f("usual_radius", p.usual_radius, Range::positive().up_to(1.0).in_metres());
    f("tolerance", p.tolerance, Range::above(0.0).below(1.0));
    f("min_tolerance", p.min_tolerance, Range::not_negative().in_metres());
    f("max_angle", p.max_angle, Range::above(0.0).below({kPi, "pi"}).in_radians());
    f("min_coverage", p.min_coverage, Range::above(0.0).below(1.0));
    f("min_roundness", p.min_roundness, Range::between(0.0, 1.0));
    f("min_confidence", p.min_confidence, Range::between(0.0, 1.0));
    f("point_noise", p.point_noise, Range::not_negative().in_metres());
    f("normal_noise", p.normal_noise, Range::not_negative().in_radians());
    f("alike", p.alike, Range::between(0.0, 1.0));
    f("ridge", p.ridge, Range::not_negative());
    f("max_overlap", p.max_overlap, Range::not_negative());
    f("fit", p.fit);
  }
};

/// Parameters of split: the segmentation of a cloud into fruit.
struct SplitParameters {
  bool adaptive = true;  ///< derive the lengths and sizes below from the cloud's spacing and `bodies.radius_min`
  RegionGrowingParameters growing;  ///< region growing; if adaptive, its radius and min_size are derived
  DbscanParameters clustering;      ///< DBSCAN; if adaptive, its values are derived
  double growing_reach = 2.2;       ///< adaptive: radius of region growing, in spacings of the cloud
  double clustering_reach = 2.5;    ///< adaptive: eps of DBSCAN, in spacings of the cloud
  double min_region = 0.03;  ///< adaptive: smallest region or cluster, as a share of the smallest fruit's surface
  int min_residual = 350;    ///< not adaptive: DBSCAN runs if region growing leaves more points than this
  bool fit_bodies = true;    ///< let ellipsoids compete for the points; off: the two stages of [1] alone
  BodyParameters bodies;     ///< which ellipsoids may be fruit

  /// The stages and values of [1].
  static SplitParameters paper() {
    SplitParameters p;
    p.adaptive = false;
    p.growing = RegionGrowingParameters::paper();
    p.clustering = DbscanParameters::paper();
    p.fit_bodies = false;
    return p;
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("adaptive", p.adaptive);
    f("growing", p.growing);
    f("clustering", p.clustering);
    f("growing_reach", p.growing_reach, Range::positive());
    f("clustering_reach", p.clustering_reach, Range::positive());
    f("min_region", p.min_region, Range::above(0.0).below(1.0));
    f("min_residual", p.min_residual, Range::not_negative());
    f("fit_bodies", p.fit_bodies);
    f("bodies", p.bodies);
  }
};

/// Parameters of growth_axis.
struct GrowthAxisParameters {
  double shell = 0.45;      ///< points outside a fruit but within this share of its radius may be its calyx and pedicel
  double up_weight = 0.35;  ///< weight of the assumption that fruit hang below their stem, against the points
  double stem_certainty = 10.0;  ///< 1 / variance (1/rad2) of the direction of stem points, against the body's axis

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("shell", p.shell, Range::positive());
    f("up_weight", p.up_weight, Range::not_negative());
    f("stem_certainty", p.stem_certainty, Range::positive());
  }
};

/// Parameters of mass_of.
struct MassParameters {
  double density = 980.0;       ///< density of the fruit (kg/m3); the default is for tomatoes, which barely float
  double density_error = 20.0;  ///< standard deviation of the density among fruit (kg/m3)
  double shape_error = 0.01;    ///< standard deviation of a fruit's volume from its ellipsoid's, relative

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("density", p.density, Range::between(100.0, 5000.0).in_kilograms_per_cubic_metre());
    f("density_error", p.density_error, Range::not_negative());
    f("shape_error", p.shape_error, Range::not_negative());
  }
};

}  // namespace agrisee
