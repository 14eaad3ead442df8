// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The metrics of a result: those of [1], 4 (precision, recall, counting error, object precision and
/// recall, mIoU) as shares of 0..1, and the errors of each fruit. evaluate() computes them (evaluate.hpp). World frame,
/// metres, radians.
#pragma once

#include <agrisee/core/parameter_range.hpp>

#include <Eigen/Core>

#include <cmath>
#include <optional>
#include <vector>

namespace agrisee::study {

/// Thresholds of the metrics.
struct MetricParameters {
  double threshold = 0.005;  ///< a point lies on a surface, and a sample is covered, within this distance (m)
  double strict = 0.002;     ///< distance for the second, stricter precision (m)
  double min_iou = 0.5;      ///< a detection is true from this surface IoU on

  /// The values of [1].
  static MetricParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("threshold", p.threshold, Range::positive());
    f("strict", p.strict, Range::positive());
    f("min_iou", p.min_iou, Range::above(0.0).up_to(1.0));
  }
};

/// Metrics of one fruit. An error is present if the fruit was matched to an instance that has the quantity.
struct FruitMetrics {
  int id = 0;                                 ///< of the true fruit
  int instance = 0;                           ///< the instance matched to it; 0 = none
  bool detected = false;                      ///< its surface IoU is at least `min_iou`
  double surface_iou = 0.0;                   ///< with the matched instance
  double point_iou = 0.0;                     ///< with the instance that the matching by point IoU gives it
  double recall = 0.0;                        ///< share of its surface within `threshold` of a labeled point
  double recall_obs = 0.0;                    ///< `recall` of its observable surface
  double scanned = 0.0;                       ///< share of its surface within `threshold` of any raw point
  double observable = 0.0;                    ///< share of its surface that can be observed
  std::optional<double> centroid_error;       ///< centroid, from the mean of its observable surface (m)
  std::optional<double> centroid_error_seen;  ///< centroid, from the mean of the surface that the views saw (m)
  std::optional<double> center_error;         ///< center of the fitted body, from the volume centroid (m)
  /// `center_error` in standard deviations: (e^T C^-1 e / 3)^1/2 with the body's covariance C; 1 in the root mean
  /// square over many fruit if the covariances are right. None if the body has no covariance.
  std::optional<double> center_error_normalised;
  std::optional<double> radius_error;        ///< cube root of the product of the semi-axes, fitted minus true (m)
  std::optional<double> semi_axis_error;     ///< largest difference between semi-axes ordered by size (m)
  std::optional<double> axis_error;          ///< angle between the pose's z axis and the true growth axis (rad)
  std::optional<double> completeness_error;  ///< completeness of the fitted body minus `scanned`

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("id", p.id);
    f("instance", p.instance);
    f("detected", p.detected);
    f("surface_iou", p.surface_iou);
    f("point_iou", p.point_iou);
    f("recall", p.recall);
    f("recall_obs", p.recall_obs);
    f("scanned", p.scanned);
    f("observable", p.observable);
    f("centroid_error", p.centroid_error);
    f("centroid_error_seen", p.centroid_error_seen);
    f("center_error", p.center_error);
    f("center_error_normalised", p.center_error_normalised);
    f("radius_error", p.radius_error);
    f("semi_axis_error", p.semi_axis_error);
    f("axis_error", p.axis_error);
    f("completeness_error", p.completeness_error);
  }
};

/// Metrics of a result. A share of nothing is 0, so that an empty result never looks good.
struct Metrics {
  double precision = 0.0;             ///< share of the labeled points within `threshold` of a fruit's surface
  double precision_strict = 0.0;      ///< `precision` within `strict`
  double precision_all = 0.0;         ///< share of all cloud points within `threshold` of a fruit's surface
  double precision_all_strict = 0.0;  ///< `precision_all` within `strict`
  double recall = 0.0;                ///< share of the fruit's surface within `threshold` of a labeled point
  double recall_obs = 0.0;            ///< `recall` of the observable surface
  double scanned = 0.0;               ///< share of the fruit's surface within `threshold` of any raw point
  double scanned_obs = 0.0;           ///< `scanned` of the observable surface
  double f1 = 0.0;                    ///< harmonic mean of `precision` and `recall`
  double observable = 0.0;            ///< share of the fruit's surface that can be observed
  int n_real = 0;                     ///< number of true fruit
  int n_det = 0;                      ///< number of instances found
  int n_true = 0;                     ///< number of true detections
  int counting_error = 0;             ///< |n_real - n_det|
  double object_precision = 0.0;      ///< n_true / n_det
  double object_recall = 0.0;         ///< n_true / n_real
  double miou_surface = 0.0;          ///< mean surface IoU over the fruit matched by it
  double miou_point = 0.0;            ///< mean point IoU over the fruit matched by it
  std::vector<FruitMetrics> fruits;   ///< in the order of the ground truth

  /// f(name, field) for every field except `fruits`.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("precision", p.precision);
    f("precision_strict", p.precision_strict);
    f("precision_all", p.precision_all);
    f("precision_all_strict", p.precision_all_strict);
    f("recall", p.recall);
    f("recall_obs", p.recall_obs);
    f("scanned", p.scanned);
    f("scanned_obs", p.scanned_obs);
    f("f1", p.f1);
    f("observable", p.observable);
    f("n_real", p.n_real);
    f("n_det", p.n_det);
    f("n_true", p.n_true);
    f("counting_error", p.counting_error);
    f("object_precision", p.object_precision);
    f("object_recall", p.object_recall);
    f("miou_surface", p.miou_surface);
    f("miou_point", p.miou_point);
  }
};

/// An error over all fruit that have it.
struct ErrorSummary {
  double mean = 0.0;   ///< mean magnitude
  double worst = 0.0;  ///< largest magnitude
  int count = 0;       ///< number of fruit that have the error
};

/// Summarize one error of all fruit that have it.
/// @param metrics of a result
/// @param error the field, for example `&FruitMetrics::center_error`
ErrorSummary summarize(const Metrics& metrics, std::optional<double> FruitMetrics::*error);

/// Repeatability RMSE (m) of one fruit over independent trials: the root of the mean squared distance of its centroids
/// from their mean ([1], 3.2.4). None for fewer than two trials.
/// @param centroids one per trial (m)
std::optional<double> repeatability(const std::vector<Eigen::Vector3d>& centroids);

}  // namespace agrisee::study
