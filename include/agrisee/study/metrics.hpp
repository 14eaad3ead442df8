// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How good a result is, judged by the true surfaces: the figures of the paper (Experiments: precision, recall,
/// counting error, object precision and recall, mIoU) as shares of 0..1, and errors of every fruit. World frame,
/// metres, radians. Cost: two nearest-point queries a point of the cloud and one a sample; some 0.1 s for 15,000
/// points.
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>

namespace agrisee::study {

/// Thresholds of the metrics.
struct MetricParameters {
  double threshold = 0.005;  ///< a point is on a surface, and a sample is covered, within this distance (m)
  double strict = 0.002;     ///< threshold of the second, stricter precision (m)
  double min_iou = 0.5;      ///< surface IoU from which a detection is true

  /// The paper's values.
  static MetricParameters paper() { return {}; }
  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(std::isfinite(threshold) && threshold > 0.0, "threshold", "positive and finite", threshold);
    check_parameter(std::isfinite(strict) && strict > 0.0, "strict", "positive and finite", strict);
    check_parameter(min_iou > 0.0 && min_iou <= 1.0, "min_iou", "in (0, 1]", min_iou);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("threshold", p.threshold);
    f("strict", p.strict);
    f("min_iou", p.min_iou);
  }
};

/// What results of one scene are judged by; made once, used for many results.
struct Truth {
  TracedScene traced;             ///< all surfaces
  Bvh fruit_surface;              ///< those of fruit alone
  std::vector<int> object_label;  ///< for each object of the scene its fruit id, or 0
  Samples samples;                ///< of the fruit's surface
  GroundTruth fruits;             ///< N_real of them
  sensor::L515 sensor;            ///< what views were taken with
};

/// @param scene what is seen
/// @param known the ground truth where more is known than the meshes tell (growth axes, hidden fruit)
/// @param sensor of the robot
/// @param params see their struct
/// @throws InputError when `known` does not list the scene's fruit in its order, and as ground_truth() does
inline Truth make_truth(const Scene& scene, const std::optional<GroundTruth>& known = std::nullopt,
                        const sensor::L515& sensor = {}, const SampleParameters& params = {}) {
  GroundTruth fruits = ground_truth(scene);
  if (known) {
    check_input(known->fruits.size() == fruits.fruits.size(),
                "ground truth: it lists another number of fruit than the scene");
    for (std::size_t i = 0; i < fruits.fruits.size(); ++i)
      check_input(known->fruits[i].id == fruits.fruits[i].id, "ground truth: its ids differ from the scene's");
    fruits = *known;
  }
  Mesh surface;
  std::vector<int> labels;
  for (const Object& object : scene.objects) {
    labels.push_back(object.cls == ObjectClass::fruit ? object.id : 0);
    if (object.cls == ObjectClass::fruit) append(surface, object.mesh);
  }
  return {TracedScene(scene), Bvh(surface), std::move(labels), fruit_samples(scene, params), std::move(fruits), sensor};
}

/// How well one fruit was found. Errors are present where the fruit has been matched to an instance that tells the
/// quantity.
struct FruitMetrics {
  int id = 0;                                 ///< of the scene's fruit
  int instance = 0;                           ///< the matched instance; 0 = none
  bool detected = false;                      ///< matched with a surface IoU of at least min_iou
  double surface_iou = 0.0;                   ///< with the matched instance
  double point_iou = 0.0;                     ///< with the instance that point IoU matches it to
  double recall = 0.0;                        ///< share of its surface within `threshold` of a labelled point
  double recall_obs = 0.0;                    ///< the same of its observable surface
  double scanned = 0.0;                       ///< share of its surface within `threshold` of any raw point
  double observable = 0.0;                    ///< share of its surface that can be observed
  std::optional<double> centroid_error;       ///< from the mean of its observable surface (m)
  std::optional<double> centroid_error_seen;  ///< from the mean of the surface that the views taken saw (m)
  std::optional<double> center_error;         ///< of the fitted body from the volume centroid (m)
  std::optional<double> radius_error;         ///< signed: cbrt of the product of semi-axes, fitted minus true (m)
  std::optional<double> semi_axis_error;      ///< largest difference of a semi-axis, ordered by size (m)
  std::optional<double> axis_error;           ///< angle between the pose's z axis and the true growth axis (rad)
  std::optional<double> completeness_error;   ///< signed: the body's completeness minus `scanned`

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
    f("radius_error", p.radius_error);
    f("semi_axis_error", p.semi_axis_error);
    f("axis_error", p.axis_error);
    f("completeness_error", p.completeness_error);
  }
};

/// How good a result is. A share of nothing is 0, so that an empty result never looks good.
struct Metrics {
  double precision = 0.0;             ///< share of the labelled points within `threshold` of a fruit's surface
  double precision_strict = 0.0;      ///< within `strict`
  double precision_all = 0.0;         ///< share of all cloud points within `threshold` of a fruit's surface
  double precision_all_strict = 0.0;  ///< within `strict`
  double recall = 0.0;                ///< share of the fruit's surface within `threshold` of a labelled point
  double recall_obs = 0.0;            ///< the same of the observable surface
  double scanned = 0.0;               ///< share of the fruit's surface within `threshold` of any raw point
  double scanned_obs = 0.0;           ///< the same of the observable surface
  double f1 = 0.0;                    ///< harmonic mean of `precision` and `recall`
  double observable = 0.0;            ///< share of the fruit's surface that can be observed
  int n_real = 0;                     ///< fruit
  int n_det = 0;                      ///< instances
  int n_true = 0;                     ///< true detections
  int counting_error = 0;             ///< |n_real - n_det|
  double object_precision = 0.0;      ///< n_true / n_det
  double object_recall = 0.0;         ///< n_true / n_real
  double miou_surface = 0.0;          ///< mean surface IoU over the fruit that have been matched to an instance
  double miou_point = 0.0;            ///< mean point IoU over the fruit that it matches
  std::vector<FruitMetrics> fruits;   ///< in the order of the ground truth

  /// All but `fruits`.
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

/// Mean and worst (largest magnitude) of an error over the fruit that have it.
struct ErrorSummary {
  double mean = 0.0;   ///< of the magnitudes
  double worst = 0.0;  ///< largest magnitude
  int count = 0;       ///< fruit that have it
};
/// Of one error over the fruit that have it.
inline ErrorSummary summarize(const Metrics& metrics, std::optional<double> FruitMetrics::*error) {
  ErrorSummary s;
  for (const FruitMetrics& fruit : metrics.fruits) {
    if (!(fruit.*error)) continue;
    s.mean += std::abs(*(fruit.*error));
    s.worst = std::max(s.worst, std::abs(*(fruit.*error)));
    ++s.count;
  }
  if (s.count > 0) s.mean /= s.count;
  return s;
}

/// Repeatability RMSE (m) of one fruit's centroids over independent trials: root of the mean squared distance from
/// their mean; none for fewer than two.
inline std::optional<double> repeatability(const std::vector<Eigen::Vector3d>& centroids) {
  if (centroids.size() < 2) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& c : centroids) mean += c / static_cast<double>(centroids.size());
  double sum = 0.0;
  for (const auto& c : centroids) sum += (c - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(centroids.size()));
}

}  // namespace agrisee::study
