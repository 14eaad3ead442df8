// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Computes the metrics of a result; what each figure means is said in metrics.hpp. World frame, metres.
///
/// Surface IoU: an observable sample belongs to the instance of its nearest labelled point within `threshold`, or to
/// none. For fruit f and instance k, IoU = |f and k| / (|f or k| + penalty), counted in observable samples; the penalty
/// is the number of k's points farther than `threshold` from every fruit, each worth as many samples as one of k's
/// other points stands for. Point IoU: over cloud points, whose true label is that of the nearest surface of any
/// object. Either kind matches fruit and instances one to one with the largest total.
#pragma once

#include <agrisee/study/metrics.hpp>

namespace agrisee::study {
namespace detail {

/// A count of a count; 0 of nothing is 0.
inline double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// What the surfaces say of the points of a cloud.
struct PointTruth {
  std::vector<float> distance;  ///< from the nearest fruit surface (m); infinity for points that are not finite
  std::vector<int> label;       ///< fruit id of the nearest surface, 0 where that is no fruit
};

inline PointTruth point_truth(const Truth& truth, const std::vector<Eigen::Vector3f>& points, int threads) {
  PointTruth out;
  out.distance.assign(points.size(), std::numeric_limits<float>::infinity());
  out.label.assign(points.size(), 0);
  parallel_for(
      points.size(), threads,
      [&](std::size_t i) {
        const auto any = truth.traced.bvh().nearest(points[i]);
        if (!any) return;
        out.label[i] = truth.object_label[truth.traced.object(any->triangle)];
        if (out.label[i] > 0)
          out.distance[i] = any->distance;
        else if (const auto fruit = truth.fruit_surface.nearest(points[i]))
          out.distance[i] = fruit->distance;
      },
      128);
  return out;
}

/// For each sample whether a point of the cloud is within `threshold`, and the value of the nearest one (0 where none
/// is).
inline void cover(const Samples& samples, const std::vector<Eigen::Vector3f>& points, const std::vector<int>& values,
                  double threshold, int threads, Flags& covered, std::vector<int>& value) {
  covered.assign(samples.size(), 0);
  value.assign(samples.size(), 0);
  const KdTree<float> tree(points);
  parallel_chunks(samples.size(), threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<float> nearest;
    for (std::size_t i = begin; i < end; ++i) {
      tree.knn(samples.points[i], 1, nearest);
      if (nearest.empty() || nearest[0].distance > static_cast<float>(threshold)) continue;
      covered[i] = 1;
      if (!values.empty()) value[i] = values[static_cast<std::size_t>(nearest[0].index)];
    }
  });
}

/// Position of an id in an ascending list, -1 when it is not there.
inline int position(const std::vector<int>& ids, int id) {
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  return at != ids.end() && *at == id ? static_cast<int>(at - ids.begin()) : -1;
}

/// IoU of every pair from the table of overlaps (a row a fruit, a column an instance) and the sizes of both.
inline Eigen::MatrixXd iou(const Eigen::MatrixXd& overlap, const Eigen::VectorXd& fruit,
                           const Eigen::VectorXd& instance) {
  Eigen::MatrixXd out = overlap;
  for (Eigen::Index f = 0; f < out.rows(); ++f)
    for (Eigen::Index k = 0; k < out.cols(); ++k)
      out(f, k) = ratio(overlap(f, k), fruit[f] + instance[k] - overlap(f, k));
  return out;
}

/// Mean of the flagged samples of a fruit; none when there are none.
inline std::optional<Eigen::Vector3d> mean_of(const Samples& samples, const Flags& flags, int id) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double n = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples.fruit[i] == id && flags[i]) sum += samples.points[i].cast<double>(), n += 1.0;
  if (n == 0.0) return std::nullopt;
  return Eigen::Vector3d(sum / n);
}

/// Errors of a located fruit against the true one.
inline void locate_errors(FruitMetrics& out, const Fruit& found, const TrueFruit& real,
                          const std::optional<Eigen::Vector3d>& observable_mean,
                          const std::optional<Eigen::Vector3d>& seen_mean) {
  if (observable_mean) out.centroid_error = (found.centroid - *observable_mean).norm();
  if (seen_mean) out.centroid_error_seen = (found.centroid - *seen_mean).norm();
  if (real.growth_axis) {
    const Eigen::Vector3d z = found.orientation.col(2);
    out.axis_error = std::atan2(z.cross(*real.growth_axis).norm(), z.dot(*real.growth_axis));
  }
  if (found.body) {
    out.center_error = (found.body->center - real.center).norm();
    out.radius_error = std::cbrt(found.body->radii.prod()) - std::cbrt(real.radii.prod());
    out.semi_axis_error = (found.body->radii - real.radii).cwiseAbs().maxCoeff();
    out.completeness_error = found.body->completeness - out.scanned;
  }
}

}  // namespace detail

/// Judge a result. Instances are the positive labels and the ids of `result.fruits`; labels of 0 or less are none.
/// Instance numbers carry no meaning beyond equality.
/// @param result its raw cloud, consolidated cloud, labels, fruit and views are read; any of them may be empty
/// @param observable one flag a sample of `truth` (see limit.hpp); empty = all of the surface counts as observable
/// @throws InputError when labels and cloud, or flags and samples, differ in number
inline Metrics evaluate(const Truth& truth, const ScanResult& result, const Flags& observable = {},
                        const MetricParameters& params = {}, int threads = 1) {
  params.check();
  const Samples& samples = truth.samples;
  const std::vector<Eigen::Vector3f>& points = result.cloud.points;
  check_input(result.labels.size() == points.size(), "evaluate: the cloud and its labels differ in size");
  check_input(observable.empty() || observable.size() == samples.size(),
              "evaluate: the observable flags and the samples differ in number");
  const Flags in_sight = observable.empty() ? Flags(samples.size(), 1) : observable;
  Metrics m;

  // Points: precision.
  const detail::PointTruth of_point = detail::point_truth(truth, points, threads);
  std::vector<Eigen::Vector3f> labelled;
  std::vector<int> labelled_as, instances;
  double on = 0.0, on_strict = 0.0, labelled_on = 0.0, labelled_strict = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool near = double(of_point.distance[i]) <= params.threshold;
    const bool nearer = double(of_point.distance[i]) <= params.strict;
    on += near, on_strict += nearer;
    if (result.labels[i] <= 0) continue;
    labelled_on += near, labelled_strict += nearer;
    labelled.push_back(points[i]);
    labelled_as.push_back(result.labels[i]);
  }
  const auto all = static_cast<double>(points.size()), chosen = static_cast<double>(labelled.size());
  m.precision = detail::ratio(labelled_on, chosen);
  m.precision_strict = detail::ratio(labelled_strict, chosen);
  m.precision_all = detail::ratio(on, all);
  m.precision_all_strict = detail::ratio(on_strict, all);

  // Samples: recall and scanned share.
  Flags recalled, scanned;
  std::vector<int> instance_of, unused;
  detail::cover(samples, labelled, labelled_as, params.threshold, threads, recalled, instance_of);
  detail::cover(samples, result.raw.points, {}, params.threshold, threads, scanned, unused);

  // Tables of overlaps: a row a fruit, a column an instance.
  instances = labelled_as;
  for (const Fruit& fruit : result.fruits)
    if (fruit.id > 0) instances.push_back(fruit.id);
  std::sort(instances.begin(), instances.end());
  instances.erase(std::unique(instances.begin(), instances.end()), instances.end());
  std::vector<int> ids;  // of fruit, ascending
  for (const TrueFruit& fruit : truth.fruits.fruits) ids.push_back(fruit.id);
  std::sort(ids.begin(), ids.end());
  const auto n_real = static_cast<Eigen::Index>(ids.size()), n_det = static_cast<Eigen::Index>(instances.size());

  struct Counts {
    double samples = 0.0, observable = 0.0, recalled = 0.0, recalled_obs = 0.0, scanned = 0.0, scanned_obs = 0.0;
  };
  std::vector<Counts> counts(ids.size());
  Eigen::MatrixXd surface = Eigen::MatrixXd::Zero(n_real, n_det), point = surface;
  Eigen::VectorXd surface_real = Eigen::VectorXd::Zero(n_real), point_real = surface_real;
  Eigen::VectorXd surface_det = Eigen::VectorXd::Zero(n_det), point_det = surface_det, bad = surface_det, good = bad;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const int f = detail::position(ids, samples.fruit[i]);
    Counts& c = counts[static_cast<std::size_t>(f)];
    c.samples += 1.0;
    c.recalled += recalled[i];
    c.scanned += scanned[i];
    if (!in_sight[i]) continue;
    c.observable += 1.0;
    c.recalled_obs += recalled[i];
    c.scanned_obs += scanned[i];
    surface_real[f] += 1.0;
    if (instance_of[i] <= 0) continue;
    const int k = detail::position(instances, instance_of[i]);
    surface(f, k) += 1.0;
    surface_det[k] += 1.0;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int f = of_point.label[i] > 0 ? detail::position(ids, of_point.label[i]) : -1;
    const int k = result.labels[i] > 0 ? detail::position(instances, result.labels[i]) : -1;
    if (f >= 0) point_real[f] += 1.0;
    if (k >= 0) {
      point_det[k] += 1.0;
      (double(of_point.distance[i]) <= params.threshold ? good : bad)[k] += 1.0;
    }
    if (f >= 0 && k >= 0) point(f, k) += 1.0;
  }
  for (Eigen::Index k = 0; k < n_det; ++k) surface_det[k] += bad[k] * detail::ratio(surface_det[k], good[k]);
  const Eigen::MatrixXd surface_iou = detail::iou(surface, surface_real, surface_det);
  const Eigen::MatrixXd point_iou = detail::iou(point, point_real, point_det);
  const std::vector<int> match = best_matching(surface_iou), point_match = best_matching(point_iou);

  Counts total;
  for (const Counts& c : counts) {
    total.samples += c.samples, total.observable += c.observable;
    total.recalled += c.recalled, total.recalled_obs += c.recalled_obs;
    total.scanned += c.scanned, total.scanned_obs += c.scanned_obs;
  }
  m.recall = detail::ratio(total.recalled, total.samples);
  m.recall_obs = detail::ratio(total.recalled_obs, total.observable);
  m.scanned = detail::ratio(total.scanned, total.samples);
  m.scanned_obs = detail::ratio(total.scanned_obs, total.observable);
  m.observable = detail::ratio(total.observable, total.samples);
  m.f1 = detail::ratio(2.0 * m.precision * m.recall, m.precision + m.recall);

  // Fruit by fruit.
  Flags seen(samples.size(), 0);
  for (const View& view : result.views) {
    const Flags now = visible_to(truth.traced, samples, view.world_T_optical, truth.sensor, threads);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] |= now[i];
  }
  double matched = 0.0, point_matched = 0.0, sum = 0.0, point_sum = 0.0;
  for (const TrueFruit& real : truth.fruits.fruits) {
    const int f = detail::position(ids, real.id);
    const Counts& c = counts[static_cast<std::size_t>(f)];
    FruitMetrics out;
    out.id = real.id;
    out.recall = detail::ratio(c.recalled, c.samples);
    out.recall_obs = detail::ratio(c.recalled_obs, c.observable);
    out.scanned = detail::ratio(c.scanned, c.samples);
    out.observable = detail::ratio(c.observable, c.samples);
    if (const int k = match[static_cast<std::size_t>(f)]; k >= 0) {
      out.instance = instances[static_cast<std::size_t>(k)];
      out.surface_iou = surface_iou(f, k);
      out.detected = out.surface_iou >= params.min_iou;
      matched += 1.0, sum += out.surface_iou;
      m.n_true += out.detected;
      for (const Fruit& found : result.fruits)
        if (found.id == out.instance)
          detail::locate_errors(out, found, real, detail::mean_of(samples, in_sight, real.id),
                                detail::mean_of(samples, seen, real.id));
    }
    if (const int k = point_match[static_cast<std::size_t>(f)]; k >= 0) {
      out.point_iou = point_iou(f, k);
      point_matched += 1.0, point_sum += out.point_iou;
    }
    m.fruits.push_back(out);
  }
  m.n_real = static_cast<int>(n_real);
  m.n_det = static_cast<int>(n_det);
  m.counting_error = std::abs(m.n_real - m.n_det);
  m.object_precision = detail::ratio(m.n_true, m.n_det);
  m.object_recall = detail::ratio(m.n_true, m.n_real);
  m.miou_surface = detail::ratio(sum, matched);
  m.miou_point = detail::ratio(point_sum, point_matched);
  return m;
}

}  // namespace agrisee::study
