// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Computes the metrics of a result; what each figure means is said in metrics.hpp. World frame, metres.
/// Cost: one or two nearest-point queries a point of the cloud and two a sample; some 0.1 s for 15,000 points.
///
/// Surface IoU: an observable sample belongs to the instance of its nearest labelled point within `threshold`, or to
/// none. For fruit f and instance k, IoU = |f and k| / (|f or k| + penalty), counted in observable samples; the penalty
/// is the number of k's points farther than `threshold` from every fruit, each worth as many samples as one of k's
/// other points stands for. Point IoU: over cloud points, whose true label is that of the nearest surface of any
/// object. Either kind matches fruit and instances one to one with the largest total.
#pragma once

#include <agrisee/core/kdtree.hpp>
#include <agrisee/study/matching.hpp>
#include <agrisee/study/metrics.hpp>

namespace agrisee::study {
namespace detail {

/// Part of a whole; of nothing it is 0.
inline double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// Ids in ascending order, and where each is.
struct Ids {
  std::vector<int> ids;

  explicit Ids(std::vector<int> all) : ids(std::move(all)) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    ids.erase(ids.begin(), std::upper_bound(ids.begin(), ids.end(), 0));  // 0 and less name nothing
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(ids.size()); }
  /// Position of an id, -1 when it is not there.
  Eigen::Index at(int id) const {
    const auto found = std::lower_bound(ids.begin(), ids.end(), id);
    return found != ids.end() && *found == id ? found - ids.begin() : -1;
  }
};

/// What the surfaces say of the points of a cloud.
struct PointTruth {
  std::vector<float> distance;  ///< from the nearest fruit surface (m); infinity for points that are not finite
  std::vector<int> label;       ///< fruit id of the nearest surface, 0 where that is no fruit
};

inline PointTruth point_truth(const Truth& truth, const std::vector<Eigen::Vector3f>& points, int threads) {
  PointTruth out;
  out.distance.assign(points.size(), std::numeric_limits<float>::infinity());
  out.label.assign(points.size(), 0);
  const auto look_up = [&](std::size_t i) {
    const auto any = truth.traced.bvh().nearest(points[i]);
    if (!any) return;
    out.label[i] = truth.object_label[truth.traced.object(any->triangle)];
    if (out.label[i] > 0)
      out.distance[i] = any->distance;
    else if (const auto fruit = truth.fruit_surface.nearest(points[i]))
      out.distance[i] = fruit->distance;
  };
  parallel_for(points.size(), threads, look_up, 128);
  return out;
}

/// What the points of a cloud say of the samples.
struct Coverage {
  Flags covered;             ///< a point is within the threshold
  std::vector<int> nearest;  ///< index of the nearest such point, -1 where there is none
};

inline Coverage cover(const Samples& samples, const std::vector<Eigen::Vector3f>& points, double threshold,
                      int threads) {
  Coverage out{Flags(samples.size(), 0), std::vector<int>(samples.size(), -1)};
  const KdTree<float> tree(points);
  parallel_chunks(samples.size(), threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<float> nearest;
    for (std::size_t i = begin; i < end; ++i) {
      tree.knn(samples.points[i], 1, nearest);
      if (nearest.empty() || double(nearest[0].distance) > threshold) continue;
      out.covered[i] = 1;
      out.nearest[i] = nearest[0].index;
    }
  });
  return out;
}

/// Overlaps of fruit (rows) and instances (columns), and the size of each.
struct Overlaps {
  Eigen::MatrixXd both;
  Eigen::VectorXd fruit, instance;

  Overlaps(const Ids& fruits, const Ids& instances)
      : both(Eigen::MatrixXd::Zero(fruits.size(), instances.size())),
        fruit(Eigen::VectorXd::Zero(fruits.size())),
        instance(Eigen::VectorXd::Zero(instances.size())) {}
  /// Count one thing that belongs to fruit f and instance k; -1 = to none.
  void add(Eigen::Index f, Eigen::Index k) {
    if (f >= 0) fruit[f] += 1.0;
    if (k >= 0) instance[k] += 1.0;
    if (f >= 0 && k >= 0) both(f, k) += 1.0;
  }
  Eigen::MatrixXd iou() const {
    Eigen::MatrixXd out = both;
    for (Eigen::Index f = 0; f < out.rows(); ++f)
      for (Eigen::Index k = 0; k < out.cols(); ++k) out(f, k) = ratio(both(f, k), fruit[f] + instance[k] - both(f, k));
    return out;
  }
};

/// Precision of the labelled points, and of all.
inline void judge_points(const PointTruth& of_point, const Labels& labels, const MetricParameters& params, Metrics& m) {
  double labelled = 0.0, on[2] = {0.0, 0.0}, labelled_on[2] = {0.0, 0.0};  // within `threshold`, within `strict`
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double distance = double(of_point.distance[i]);
    const bool near[2] = {distance <= params.threshold, distance <= params.strict};
    if (labels[i] > 0) labelled += 1.0;
    for (int k = 0; k < 2; ++k) {
      on[k] += near[k];
      labelled_on[k] += near[k] && labels[i] > 0;
    }
  }
  const auto all = static_cast<double>(labels.size());
  m.precision = ratio(labelled_on[0], labelled);
  m.precision_strict = ratio(labelled_on[1], labelled);
  m.precision_all = ratio(on[0], all);
  m.precision_all_strict = ratio(on[1], all);
}

/// Shares of the surface of one fruit, or with id 0 of all.
struct SurfaceShares {
  double observable = 0.0, recall = 0.0, recall_obs = 0.0, scanned = 0.0, scanned_obs = 0.0;
};
inline SurfaceShares judge_surface(const Samples& samples, const Flags& in_sight, const Flags& recalled,
                                   const Flags& scanned, int id) {
  double all = 0.0;
  SurfaceShares s;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (id != 0 && samples.fruit[i] != id) continue;
    all += 1.0;
    s.observable += in_sight[i];
    s.recall += recalled[i];
    s.recall_obs += recalled[i] & in_sight[i];
    s.scanned += scanned[i];
    s.scanned_obs += scanned[i] & in_sight[i];
  }
  s.recall_obs = ratio(s.recall_obs, s.observable);
  s.scanned_obs = ratio(s.scanned_obs, s.observable);
  for (double* share : {&s.observable, &s.recall, &s.scanned}) *share = ratio(*share, all);
  return s;
}

/// Errors of a located fruit against the true one.
inline void judge_location(const Fruit& found, const TrueFruit& real, const Samples& samples, const Flags& in_sight,
                           const Flags& seen, FruitMetrics& out) {
  if (const auto mean = mean_of(samples, in_sight, real.id)) out.centroid_error = (found.centroid - *mean).norm();
  if (const auto mean = mean_of(samples, seen, real.id)) out.centroid_error_seen = (found.centroid - *mean).norm();
  if (real.growth_axis) {
    const Eigen::Vector3d z = found.orientation.col(2);
    out.axis_error = std::atan2(z.cross(*real.growth_axis).norm(), z.dot(*real.growth_axis));
  }
  if (!found.body) return;
  out.center_error = (found.body->center - real.center).norm();
  out.radius_error = std::cbrt(found.body->radii.prod()) - std::cbrt(real.radii.prod());
  out.semi_axis_error = (found.body->radii - real.radii).cwiseAbs().maxCoeff();
  out.completeness_error = found.body->completeness - out.scanned;
}

}  // namespace detail

/// Judge a result. Instances are the positive labels and the positive ids of `result.fruits`; other labels are none.
/// Instance numbers carry no meaning beyond equality.
/// @param truth of the scene
/// @param result     its raw cloud, consolidated cloud, labels, fruit and views are read; any of them may be empty
/// @param observable one flag a sample of `truth` (see limit.hpp); empty = all of the surface counts as observable
/// @param params see their struct
/// @param threads the result does not depend on it
/// @throws InputError when labels and cloud, or flags and samples, differ in number
inline Metrics evaluate(const Truth& truth, const ScanResult& result, const Flags& observable = {},
                        const MetricParameters& params = {}, int threads = 1) {
  params.check();
  const Samples& samples = truth.samples;
  const std::vector<Eigen::Vector3f>& points = result.cloud.points;
  const Labels& labels = result.labels;
  check_input(labels.size() == points.size(), "evaluate: the cloud and its labels differ in size");
  check_input(observable.empty() || observable.size() == samples.size(),
              "evaluate: the observable flags and the samples differ in number");
  Flags in_sight(samples.size(), 1);
  for (std::size_t i = 0; i < observable.size(); ++i) in_sight[i] = observable[i] != 0;
  Metrics m;

  const detail::PointTruth of_point = detail::point_truth(truth, points, threads);
  detail::judge_points(of_point, labels, params, m);

  std::vector<Eigen::Vector3f> labelled;
  std::vector<int> labelled_as, real_ids;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (labels[i] > 0) labelled.push_back(points[i]), labelled_as.push_back(labels[i]);
  const detail::Coverage recalled = detail::cover(samples, labelled, params.threshold, threads);
  const Flags scanned = detail::cover(samples, result.raw.points, params.threshold, threads).covered;
  const auto total = detail::judge_surface(samples, in_sight, recalled.covered, scanned, 0);
  m.observable = total.observable;
  m.recall = total.recall;
  m.recall_obs = total.recall_obs;
  m.scanned = total.scanned;
  m.scanned_obs = total.scanned_obs;
  m.f1 = detail::ratio(2.0 * m.precision * m.recall, m.precision + m.recall);

  // Overlaps of fruit and instances, by surface and by points.
  for (const TrueFruit& fruit : truth.fruits.fruits) real_ids.push_back(fruit.id);
  std::vector<int> instance_ids = labelled_as;
  for (const Fruit& fruit : result.fruits) instance_ids.push_back(fruit.id);
  const detail::Ids fruits(real_ids), instances(instance_ids);
  detail::Overlaps surface(fruits, instances), point(fruits, instances);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!in_sight[i]) continue;
    const int p = recalled.nearest[i];
    surface.add(fruits.at(samples.fruit[i]), p < 0 ? -1 : instances.at(labelled_as[static_cast<std::size_t>(p)]));
  }
  Eigen::VectorXd good = Eigen::VectorXd::Zero(instances.size()), bad = good;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Index k = instances.at(labels[i]);
    point.add(fruits.at(of_point.label[i]), k);
    if (k >= 0) (double(of_point.distance[i]) <= params.threshold ? good : bad)[k] += 1.0;
  }
  for (Eigen::Index k = 0; k < instances.size(); ++k)
    surface.instance[k] += bad[k] * detail::ratio(surface.instance[k], good[k]);
  const Eigen::MatrixXd surface_iou = surface.iou(), point_iou = point.iou();
  const std::vector<int> match = best_matching(surface_iou), point_match = best_matching(point_iou);

  // Fruit by fruit.
  Flags seen(samples.size(), 0);
  for (const View& view : result.views) {
    const Flags now = visible_to(truth.traced, samples, view.world_T_optical, truth.sensor, threads);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] |= now[i];
  }
  int matched = 0, point_matched = 0;
  for (const TrueFruit& real : truth.fruits.fruits) {
    const Eigen::Index f = fruits.at(real.id);
    const auto own = detail::judge_surface(samples, in_sight, recalled.covered, scanned, real.id);
    FruitMetrics out;
    out.id = real.id;
    out.recall = own.recall;
    out.recall_obs = own.recall_obs;
    out.scanned = own.scanned;
    out.observable = own.observable;
    if (const int k = match[static_cast<std::size_t>(f)]; k >= 0) {
      out.instance = instances.ids[static_cast<std::size_t>(k)];
      out.surface_iou = surface_iou(f, k);
      out.detected = out.surface_iou >= params.min_iou;
      m.miou_surface += out.surface_iou;
      m.n_true += out.detected;
      ++matched;
      for (const Fruit& found : result.fruits)
        if (found.id == out.instance) detail::judge_location(found, real, samples, in_sight, seen, out);
    }
    if (const int k = point_match[static_cast<std::size_t>(f)]; k >= 0) {
      out.point_iou = point_iou(f, k);
      m.miou_point += out.point_iou;
      ++point_matched;
    }
    m.fruits.push_back(out);
  }
  m.miou_surface = detail::ratio(m.miou_surface, matched);
  m.miou_point = detail::ratio(m.miou_point, point_matched);
  m.n_real = static_cast<int>(fruits.size());
  m.n_det = static_cast<int>(instances.size());
  m.counting_error = std::abs(m.n_real - m.n_det);
  m.object_precision = detail::ratio(m.n_true, m.n_det);
  m.object_recall = detail::ratio(m.n_true, m.n_real);
  return m;
}

}  // namespace agrisee::study
