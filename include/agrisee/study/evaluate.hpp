// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Computes the metrics of a result from the true surfaces of the scene; metrics.hpp says what each figure means.
/// World frame, metres. Cost: one or two nearest-point queries per point of the cloud and two per sample; some 0.1 s
/// for 15,000 points.
///
/// Surface IoU counts observable samples. A sample belongs to the instance of its nearest labeled point within
/// `threshold`, or to none. For fruit f and instance k, IoU = |f and k| / (|f or k| + penalty). The penalty is for the
/// points of k that are farther than `threshold` from every fruit: each counts as many samples as one of k's other
/// points stands for. Point IoU counts points of the cloud; the true label of a point is that of the nearest surface of
/// any object. For each kind of IoU, fruit and instances are matched one to one with the largest total
/// (best_matching()).
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/sensor/depth_camera.hpp>
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/metrics.hpp>
#include <agrisee/study/samples.hpp>
#include <agrisee/study/traced_scene.hpp>
#include <agrisee/study/visibility.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace agrisee::study {

/// What the results of one scene are judged by. Made once, used for any number of results.
struct Truth {
  TracedScene traced;                           ///< the surfaces of all objects
  std::shared_ptr<const Bvh> fruit_surface;     ///< the surfaces of the fruit alone
  std::vector<int> object_label;                ///< for each object of the scene its fruit id, or 0
  Samples samples;                              ///< of the fruit's surface
  GroundTruth fruits;                           ///< in the order of the scene's objects
  sensor::DepthCamera sensor = sensor::l515();  ///< the camera that took the views
};

/// Prepare the truth of a scene.
/// @param scene its objects
/// @param known the ground truth, if more is known than the meshes tell (growth axes, hidden fruit)
/// @param sensor the robot's camera
/// @param parameters how the fruit's surface is sampled
/// @throws InputError if `known` does not list the scene's fruit in the scene's order, and as ground_truth() does
Truth make_truth(const Scene& scene, const std::optional<GroundTruth>& known = std::nullopt,
                 const sensor::DepthCamera& sensor = sensor::l515(), const SampleParameters& parameters = {});

/// Which samples are near the points of a cloud.
struct Coverage {
  Flags covered;             ///< per sample: a point lies within the threshold
  std::vector<int> nearest;  ///< per sample: index of the nearest such point, -1 if there is none
};

/// Find the samples that points cover.
/// @param samples of the fruit's surface
/// @param points of a cloud (m, world)
/// @param threshold a sample is covered if a point lies within this distance (m)
/// @param threads number of threads; the result does not depend on it
Coverage cover(const Samples& samples, const std::vector<Eigen::Vector3f>& points, double threshold, int threads = 1);

/// Judge a result.
///
/// The instances of a result are its positive labels and the positive ids of `result.fruits`; other labels are none.
/// Instance numbers only need to be different; they need not agree with the fruit's ids.
/// @param truth of the scene
/// @param result its raw cloud, consolidated cloud, labels, fruit and views are read; any of them may be empty
/// @param observable one flag per sample of `truth` (see limit.hpp); empty: all of the surface counts as observable
/// @param parameters thresholds
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError; InputError if labels and cloud, or flags and samples, differ in number
Metrics evaluate(const Truth& truth, const ScanResult& result, const Flags& observable = {},
                 const MetricParameters& parameters = {}, int threads = 1);

}  // namespace agrisee::study
