// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/geometry/angle.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/matching.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace agrisee::study {
namespace {

/// Part of a whole; 0 if there is no whole.
double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// Positive ids in ascending order, each once, and the position of each.
struct SortedIds {
  std::vector<int> ids;

  explicit SortedIds(std::vector<int> all) : ids(std::move(all)) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    ids.erase(ids.begin(), std::upper_bound(ids.begin(), ids.end(), 0));
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(ids.size()); }
  /// Position of an id, -1 if it is not there.
  Eigen::Index at(int id) const {
    const auto found = std::lower_bound(ids.begin(), ids.end(), id);
    return found != ids.end() && *found == id ? found - ids.begin() : -1;
  }
};

/// What the true surfaces say about the points of a cloud, one entry per point.
struct PointTruth {
  std::vector<float> distance;  // from the nearest fruit surface (m); infinity for points that are not finite
  std::vector<int> label;       // fruit id of the nearest surface, 0 if that is not a fruit
};

PointTruth point_truth(const Truth& truth, const std::vector<Eigen::Vector3f>& points, int threads) {
  PointTruth out;
  out.distance.assign(points.size(), std::numeric_limits<float>::infinity());
  out.label.assign(points.size(), 0);
  const auto look_up = [&](std::size_t i) {
    const auto any = truth.traced.bvh().nearest(points[i]);
    if (!any) return;
    out.label[i] = truth.object_label[truth.traced.object(any->triangle)];
    if (out.label[i] > 0)
      out.distance[i] = any->distance;
    else if (const auto fruit = truth.fruit_surface->nearest(points[i]))
      out.distance[i] = fruit->distance;
  };
  parallel_for(points.size(), threads, look_up, 128);
  return out;
}

/// The points of a result that have a positive label.
struct LabelledPoints {
  std::vector<Eigen::Vector3f> points;  // m, world
  std::vector<int> labels;
};

LabelledPoints labelled_points(const ScanResult& result) {
  LabelledPoints out;
  for (std::size_t i = 0; i < result.labels.size(); ++i)
    if (result.labels[i] > 0) out.points.push_back(result.cloud.points[i]), out.labels.push_back(result.labels[i]);
  return out;
}

/// What is known of the samples of the true surface, one flag per sample each.
struct SampleFlags {
  Flags observable;  // some view of the arm can see it
  Flags recalled;    // a labeled point is near
  Flags scanned;     // a raw point is near
  Flags seen;        // a view of the result saw it
};

/// Samples that the views of a result saw.
Flags seen_by_views(const Truth& truth, const std::vector<View>& views, int threads) {
  Flags seen(truth.samples.size(), 0);
  for (const View& view : views) {
    const Flags now = visible_to(truth.traced, truth.samples, view.world_T_optical, truth.sensor, threads);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] |= now[i];
  }
  return seen;
}

/// Overlaps of fruit (rows) and instances (columns), and the size of each.
struct Overlaps {
  Eigen::MatrixXd both;
  Eigen::VectorXd fruit, instance;

  Overlaps(const SortedIds& fruits, const SortedIds& instances)
      : both(Eigen::MatrixXd::Zero(fruits.size(), instances.size())),
        fruit(Eigen::VectorXd::Zero(fruits.size())),
        instance(Eigen::VectorXd::Zero(instances.size())) {}
  /// Count one sample or point that belongs to fruit f and instance k; -1 = to none.
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

/// Fruit and instances matched one to one, by surface and by points.
struct Matches {
  SortedIds fruits, instances;
  Eigen::MatrixXd surface_iou, point_iou;  // rows: fruit, columns: instances
  std::vector<int> by_surface, by_points;  // for each fruit the column of its instance, or -1
};

/// @param covered the samples that the labeled points cover
Matches match_instances(const Truth& truth, const ScanResult& result, const PointTruth& of_point,
                        const LabelledPoints& labelled, const Coverage& covered, const Flags& observable,
                        double threshold) {
  std::vector<int> fruit_ids, instance_ids = labelled.labels;
  for (const TrueFruit& fruit : truth.fruits.fruits) fruit_ids.push_back(fruit.id);
  for (const Fruit& fruit : result.fruits) instance_ids.push_back(fruit.id);
  const SortedIds fruits(fruit_ids), instances(instance_ids);
  Overlaps surface(fruits, instances), point(fruits, instances);
  for (std::size_t i = 0; i < truth.samples.size(); ++i) {
    if (!observable[i]) continue;
    const int p = covered.nearest[i];
    surface.add(fruits.at(truth.samples.fruit[i]),
                p < 0 ? -1 : instances.at(labelled.labels[static_cast<std::size_t>(p)]));
  }
  // The penalty: the points of an instance that lie on no fruit, in samples.
  Eigen::VectorXd good = Eigen::VectorXd::Zero(instances.size()), bad = good;
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    const Eigen::Index k = instances.at(result.labels[i]);
    point.add(fruits.at(of_point.label[i]), k);
    if (k >= 0) (double(of_point.distance[i]) <= threshold ? good : bad)[k] += 1.0;
  }
  for (Eigen::Index k = 0; k < instances.size(); ++k)
    surface.instance[k] += bad[k] * ratio(surface.instance[k], good[k]);
  const Eigen::MatrixXd surface_iou = surface.iou(), point_iou = point.iou();
  return {fruits, instances, surface_iou, point_iou, best_matching(surface_iou), best_matching(point_iou)};
}

/// Precision of the labeled points, and of all points of the cloud.
void judge_points(const PointTruth& of_point, const Labels& labels, const MetricParameters& parameters, Metrics& m) {
  double labelled = 0.0, on[2] = {0.0, 0.0}, labelled_on[2] = {0.0, 0.0};  // within `threshold`, within `strict`
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double distance = double(of_point.distance[i]);
    const bool near[2] = {distance <= parameters.threshold, distance <= parameters.strict};
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

/// Shares of a surface; see Metrics.
struct SurfaceShares {
  double observable = 0.0, recall = 0.0, recall_obs = 0.0, scanned = 0.0, scanned_obs = 0.0;
};

/// Shares of the surface of fruit `id`, or of all fruit if `id` is 0.
SurfaceShares surface_shares(const Samples& samples, const SampleFlags& flags, int id) {
  double all = 0.0;
  SurfaceShares s;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (id != 0 && samples.fruit[i] != id) continue;
    all += 1.0;
    s.observable += flags.observable[i];
    s.recall += flags.recalled[i];
    s.recall_obs += flags.recalled[i] & flags.observable[i];
    s.scanned += flags.scanned[i];
    s.scanned_obs += flags.scanned[i] & flags.observable[i];
  }
  s.recall_obs = ratio(s.recall_obs, s.observable);
  s.scanned_obs = ratio(s.scanned_obs, s.observable);
  for (double* share : {&s.observable, &s.recall, &s.scanned}) *share = ratio(*share, all);
  return s;
}

/// Recall, scanned and observable shares of all fruit together, and F1 (the precision is known already).
void judge_surface(const Samples& samples, const SampleFlags& flags, Metrics& m) {
  const SurfaceShares total = surface_shares(samples, flags, 0);
  m.observable = total.observable;
  m.recall = total.recall;
  m.recall_obs = total.recall_obs;
  m.scanned = total.scanned;
  m.scanned_obs = total.scanned_obs;
  m.f1 = ratio(2.0 * m.precision * m.recall, m.precision + m.recall);
}

/// Errors of a located fruit against the true one; `out.scanned` is known already.
void judge_location(const Fruit& found, const TrueFruit& real, const Samples& samples, const SampleFlags& flags,
                    FruitMetrics& out) {
  if (const auto mean = mean_of(samples, flags.observable, real.id))
    out.centroid_error = (found.centroid - *mean).norm();
  if (const auto mean = mean_of(samples, flags.seen, real.id))
    out.centroid_error_seen = (found.centroid - *mean).norm();
  if (real.growth_axis) out.axis_error = angle_between(found.orientation.col(2), *real.growth_axis);
  if (!found.body) return;
  const Eigen::Vector3d off = found.body->center - real.center;
  out.center_error = off.norm();
  if (const Eigen::LLT<Eigen::Matrix3d> covariance(found.body->center_covariance); covariance.info() == Eigen::Success)
    out.center_error_normalised = std::sqrt(off.dot(covariance.solve(off)) / 3.0);
  out.radius_error = std::cbrt(found.body->radii.prod()) - std::cbrt(real.radii.prod());
  out.semi_axis_error = (found.body->radii - real.radii).cwiseAbs().maxCoeff();
  out.completeness_error = found.body->completeness - out.scanned;
}

/// The metrics of one true fruit, and what it adds to the sums of all: n_true, and IoU in miou_surface and miou_point.
FruitMetrics judge_fruit(const TrueFruit& real, const Matches& matches, const std::vector<Fruit>& found,
                         const Samples& samples, const SampleFlags& flags, double min_iou, Metrics& m) {
  const Eigen::Index f = matches.fruits.at(real.id);
  const SurfaceShares own = surface_shares(samples, flags, real.id);
  FruitMetrics out;
  out.id = real.id;
  out.recall = own.recall;
  out.recall_obs = own.recall_obs;
  out.scanned = own.scanned;
  out.observable = own.observable;
  if (const int k = matches.by_surface[static_cast<std::size_t>(f)]; k >= 0) {
    out.instance = matches.instances.ids[static_cast<std::size_t>(k)];
    out.surface_iou = matches.surface_iou(f, k);
    out.detected = out.surface_iou >= min_iou;
    m.miou_surface += out.surface_iou;
    m.n_true += out.detected;
    for (const Fruit& fruit : found)
      if (fruit.id == out.instance) judge_location(fruit, real, samples, flags, out);
  }
  if (const int k = matches.by_points[static_cast<std::size_t>(f)]; k >= 0) {
    out.point_iou = matches.point_iou(f, k);
    m.miou_point += out.point_iou;
  }
  return out;
}

/// All that is judged fruit by fruit, and the counts and means over the fruit.
void judge_fruits(const Truth& truth, const ScanResult& result, const Matches& matches, const SampleFlags& flags,
                  double min_iou, Metrics& m) {
  for (const TrueFruit& real : truth.fruits.fruits)
    m.fruits.push_back(judge_fruit(real, matches, result.fruits, truth.samples, flags, min_iou, m));
  const auto matched = [](const std::vector<int>& match) {
    return static_cast<double>(std::count_if(match.begin(), match.end(), [](int k) { return k >= 0; }));
  };
  m.miou_surface = ratio(m.miou_surface, matched(matches.by_surface));
  m.miou_point = ratio(m.miou_point, matched(matches.by_points));
  m.n_real = static_cast<int>(matches.fruits.size());
  m.n_det = static_cast<int>(matches.instances.size());
  m.counting_error = std::abs(m.n_real - m.n_det);
  m.object_precision = ratio(m.n_true, m.n_det);
  m.object_recall = ratio(m.n_true, m.n_real);
}

}  // namespace

Truth make_truth(const Scene& scene, const std::optional<GroundTruth>& known, const sensor::DepthCamera& sensor,
                 const SampleParameters& parameters) {
  GroundTruth fruits = ground_truth(scene);
  if (known) {
    check_input(known->fruits.size() == fruits.fruits.size(),
                "ground truth: it does not list as many fruit as the scene has");
    for (std::size_t i = 0; i < fruits.fruits.size(); ++i)
      check_input(known->fruits[i].id == fruits.fruits[i].id, "ground truth: its ids differ from the scene's");
    GroundTruth all = *known;
    for (std::size_t i = 0; i < all.fruits.size(); ++i)
      if (!all.fruits[i].ripeness) all.fruits[i].ripeness = fruits.fruits[i].ripeness;
    fruits = std::move(all);
  }
  Mesh surface;
  std::vector<int> labels;
  for (const Object& object : scene.objects) {
    labels.push_back(object.cls == ObjectClass::fruit ? object.id : 0);
    if (object.cls == ObjectClass::fruit) append(surface, object.mesh);
  }
  return {TracedScene(scene), std::make_shared<const Bvh>(surface),
          std::move(labels),  fruit_samples(scene, parameters),
          std::move(fruits),  sensor};
}

Coverage cover(const Samples& samples, const std::vector<Eigen::Vector3f>& points, double threshold, int threads) {
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

Metrics evaluate(const Truth& truth, const ScanResult& result, const Flags& observable,
                 const MetricParameters& parameters, int threads) {
  parameters.check();
  const Samples& samples = truth.samples;
  check_input(result.labels.size() == result.cloud.points.size(), "evaluate: the cloud and its labels differ in size");
  check_input(observable.empty() || observable.size() == samples.size(),
              "evaluate: the observable flags and the samples differ in number");

  const PointTruth of_point = point_truth(truth, result.cloud.points, threads);
  const LabelledPoints labelled = labelled_points(result);
  const Coverage covered = cover(samples, labelled.points, parameters.threshold, threads);
  SampleFlags flags;
  flags.observable.assign(samples.size(), 1);
  for (std::size_t i = 0; i < observable.size(); ++i) flags.observable[i] = observable[i] != 0;
  flags.recalled = covered.covered;
  flags.scanned = cover(samples, result.raw.points, parameters.threshold, threads).covered;
  flags.seen = seen_by_views(truth, result.views, threads);
  const Matches matches =
      match_instances(truth, result, of_point, labelled, covered, flags.observable, parameters.threshold);

  Metrics m;
  judge_points(of_point, result.labels, parameters, m);
  judge_surface(samples, flags, m);
  judge_fruits(truth, result, matches, flags, parameters.min_iou, m);
  return m;
}

}  // namespace agrisee::study
