// SPDX-License-Identifier: BSD-3-Clause
// Each fault of a result changes the figures that it should, by the amount computed by hand, and no others.
#include <agrisee/core/random.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/truss.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include <map>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

constexpr double kRadius[3] = {0.040, 0.030, 0.035};
const Eigen::Vector3d kCenter[3] = {{0.0, 0.5, 0.2}, {0.1, 0.5, 0.2}, {0.0, 0.5, 0.32}};

/// Three balls, numbered 1 to 3 and 20 mm or more apart, and a stem farther than that from all of them.
Scene three_balls() {
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    FruitShape ball;
    ball.equatorial = ball.polar = kRadius[i];
    ball.lobe_amplitude = ball.dimple_depth = 0.0;
    scene.objects.push_back(
        {i + 1, ObjectClass::fruit, transformed(fruit_mesh(ball), Pose(Eigen::Translation3d(kCenter[i])))});
  }
  scene.objects.push_back({0, ObjectClass::stem, tube_mesh({{0.2, 0.5, 0.1}, {0.2, 0.5, 0.4}}, 0.003, 0.003)});
  return scene;
}

const Truth& truth() {
  static const Truth t = make_truth(three_balls());
  return t;
}

/// How many samples fruit `id` has.
double count(int id) { return double(std::count(truth().samples.fruit.begin(), truth().samples.fruit.end(), id)); }

double all() { return double(truth().samples.size()); }

/// The result that the true surface itself would give.
ScanResult perfect() {
  ScanResult result;
  result.cloud.points = result.raw.points = truth().samples.points;
  result.labels = truth().samples.fruit;
  for (int id = 1; id <= 3; ++id) {
    Fruit fruit;
    fruit.id = id;
    fruit.centroid = *mean_of(truth().samples, Flags(truth().samples.size(), 1), id);
    result.fruits.push_back(fruit);
  }
  return result;
}

void add_stem_points(ScanResult& result, int n, int label) {
  for (int i = 0; i < n; ++i) {
    result.cloud.points.emplace_back(0.203f, 0.5f, 0.15f + 0.2f * float(i) / float(n));
    result.labels.push_back(label);
  }
}

using Changed = std::map<std::string, double>;

/// Check all figures of a result: those in `changed` have the value given there, all others are perfect.
void check_figures(const Metrics& m, Changed changed) {
  for (const auto& [name, value] : Changed{{"n_real", 3}, {"n_det", 3}, {"n_true", 3}, {"counting_error", 0}})
    changed.emplace(name, value);
  Metrics::fields(m, [&](const std::string& name, double value) {
    INFO(name);
    const auto at = changed.find(name);
    CHECK(value == Approx(at == changed.end() ? 1.0 : at->second).margin(1e-9));
  });
}

}  // namespace

TEST_CASE("a perfect result scores 1 everywhere") {
  const Metrics m = evaluate(truth(), perfect());
  check_figures(m, {});
  for (const FruitMetrics& fruit : m.fruits) {
    CHECK(fruit.instance == fruit.id);
    CHECK(fruit.detected);
    CHECK(fruit.surface_iou == 1.0);
    CHECK(fruit.point_iou == 1.0);
    CHECK(fruit.recall == 1.0);
    CHECK(fruit.recall_obs == 1.0);
    CHECK(fruit.scanned == 1.0);
    CHECK(fruit.observable == 1.0);
    CHECK(*fruit.centroid_error == Approx(0.0).margin(1e-9));
    CHECK_FALSE(fruit.centroid_error_seen);  // no views
    CHECK_FALSE(fruit.center_error);         // no bodies
    CHECK_FALSE(fruit.axis_error);           // balls have no calyx
  }
  check_figures(evaluate(truth(), perfect(), {}, {}, 3), {});
}

TEST_CASE("a generated truss, touching fruit and stem included, scores 1 by its own surface") {
  TrussParameters parameters;
  parameters.leaflets = 1;
  const Truss truss = make_truss(parameters);
  const Truth t = make_truth(truss.scene, truss.truth, truss.workcell.sensor);
  ScanResult result;
  result.cloud.points = result.raw.points = t.samples.points;
  result.labels = t.samples.fruit;
  const Metrics m = evaluate(t, result);
  check_figures(m, {{"n_real", 7}, {"n_det", 7}, {"n_true", 7}});
}

TEST_CASE("instance numbers carry no meaning") {
  ScanResult result = perfect();
  for (int& label : result.labels) label = label == 1 ? 17 : label == 2 ? 1 : 2;
  for (Fruit& fruit : result.fruits) fruit.id = fruit.id == 1 ? 17 : fruit.id == 2 ? 1 : 2;
  const Metrics m = evaluate(truth(), result);
  check_figures(m, {});
  CHECK(m.fruits[0].instance == 17);
  CHECK(m.fruits[1].instance == 1);
  CHECK(m.fruits[2].instance == 2);
  for (const FruitMetrics& fruit : m.fruits) CHECK(*fruit.centroid_error == Approx(0.0).margin(1e-9));
}

TEST_CASE("two fruit merged into one instance") {
  ScanResult result = perfect();
  for (int& label : result.labels) label = label == 2 ? 1 : label;
  result.fruits.erase(result.fruits.begin() + 1);
  const double iou = count(1) / (count(1) + count(2));
  const Metrics m = evaluate(truth(), result);
  check_figures(m, {{"n_det", 2},
                    {"n_true", 2},
                    {"counting_error", 1},
                    {"object_recall", 2.0 / 3.0},
                    {"miou_surface", (iou + 1.0) / 2.0},
                    {"miou_point", (iou + 1.0) / 2.0}});
  CHECK(m.fruits[0].surface_iou == Approx(iou));
  CHECK(m.fruits[1].instance == 0);
  CHECK_FALSE(m.fruits[1].detected);
  CHECK_FALSE(m.fruits[1].centroid_error);
  CHECK(m.fruits[1].recall == 1.0);
}

TEST_CASE("one fruit split into two instances") {
  for (const float at : {0.25f, 0.5f}) {  // height of the cut
    ScanResult result = perfect();
    const auto cut = float(kCenter[0].z() - kRadius[0] + 2.0 * kRadius[0] * double(at));
    double below = 0.0;
    for (std::size_t i = 0; i < result.labels.size(); ++i)
      if (result.labels[i] == 1 && result.cloud.points[i].z() < cut) result.labels[i] = 4, below += 1.0;
    const double iou = std::max(below, count(1) - below) / count(1);
    CHECK(iou == Approx(1.0 - double(at)).margin(0.02));  // a sphere's area is even in height (Archimedes)
    check_figures(evaluate(truth(), result), {{"n_det", 4},
                                              {"counting_error", 1},
                                              {"object_precision", 3.0 / 4.0},
                                              {"miou_surface", (iou + 2.0) / 3.0},
                                              {"miou_point", (iou + 2.0) / 3.0}});
  }
}

TEST_CASE("a detection is true from an IoU of one half") {
  ScanResult result = perfect();
  double kept = 0.0;
  for (std::size_t i = 0; i < result.labels.size(); ++i)
    if (result.labels[i] == 1 && result.cloud.points[i].z() < float(kCenter[0].z() + 0.2 * kRadius[0]))
      result.labels[i] = 0;
  const Metrics m = evaluate(truth(), result);
  // The nearest labeled point counts up to 5 mm beyond the cap.
  for (std::size_t i = 0; i < truth().samples.size(); ++i)
    if (truth().samples.fruit[i] == 1) {
      bool near = false;
      for (std::size_t j = 0; j < result.labels.size() && !near; ++j)
        near = result.labels[j] == 1 && (truth().samples.points[i] - result.cloud.points[j]).norm() <= 0.005f;
      kept += near;
    }
  const double iou = kept / count(1);
  REQUIRE(iou < 0.5);
  const double labelled = double(std::count(result.labels.begin(), result.labels.end(), 1)),
               recall = (all() - count(1) + kept) / all();
  check_figures(m, {{"n_true", 2},
                    {"object_precision", 2.0 / 3.0},
                    {"object_recall", 2.0 / 3.0},
                    {"recall", recall},
                    {"recall_obs", recall},
                    {"f1", 2.0 * recall / (1.0 + recall)},
                    {"miou_surface", (iou + 2.0) / 3.0},
                    {"miou_point", (labelled / count(1) + 2.0) / 3.0}});
  CHECK(m.fruits[0].instance == 1);
  CHECK_FALSE(m.fruits[0].detected);
}

TEST_CASE("a missing fruit") {
  ScanResult result = perfect();
  for (int& label : result.labels) label = label == 3 ? 0 : label;
  result.fruits.pop_back();
  const double recall = 1.0 - count(3) / all(), f1 = 2.0 * recall / (1.0 + recall);
  Changed changed{
      {"n_det", 2},           {"n_true", 2}, {"counting_error", 1}, {"object_recall", 2.0 / 3.0}, {"recall", recall},
      {"recall_obs", recall}, {"f1", f1}};
  check_figures(evaluate(truth(), result), changed);
  // The fruit was not even scanned.
  ScanResult unseen;
  unseen.fruits = result.fruits;
  for (std::size_t i = 0; i < result.labels.size(); ++i)
    if (result.labels[i] > 0) {
      unseen.cloud.points.push_back(result.cloud.points[i]);
      unseen.labels.push_back(result.labels[i]);
    }
  unseen.raw.points = unseen.cloud.points;
  changed["scanned"] = changed["scanned_obs"] = recall;
  check_figures(evaluate(truth(), unseen), changed);
}

TEST_CASE("stem points without a label, as a fruit of their own, and as part of a fruit") {
  const int n = 800;
  const double share = all() / (all() + n), f1 = 2.0 * share / (share + 1.0);
  ScanResult result = perfect();
  add_stem_points(result, n, 0);
  const Changed in_cloud{{"precision_all", share}, {"precision_all_strict", share}};
  check_figures(evaluate(truth(), result), in_cloud);

  Changed changed = in_cloud;
  changed["precision"] = changed["precision_strict"] = share;
  changed["f1"] = f1;
  result = perfect();
  add_stem_points(result, n, 4);
  Changed own = changed;
  own["n_det"] = 4, own["counting_error"] = 1, own["object_precision"] = 3.0 / 4.0;
  check_figures(evaluate(truth(), result), own);

  result = perfect();
  add_stem_points(result, n, 1);
  // Each point of the fruit stands for one sample, and so does each point of the stem.
  const double iou = count(1) / (count(1) + n);
  Changed part = changed;
  part["miou_surface"] = part["miou_point"] = (iou + 2.0) / 3.0;
  check_figures(evaluate(truth(), result), part);

  // If only every second point of the fruit is left, each point stands for two samples.
  result = {};
  result.fruits = perfect().fruits;
  double left = 0.0;
  for (std::size_t i = 0; i < truth().samples.size(); ++i)
    if (truth().samples.fruit[i] != 1 || i % 2 == 0) {
      result.cloud.points.push_back(truth().samples.points[i]);
      result.labels.push_back(truth().samples.fruit[i]);
      left += truth().samples.fruit[i] == 1;
    }
  add_stem_points(result, n, 1);
  const Metrics m = evaluate(truth(), result);
  CHECK(m.fruits[0].recall == 1.0);
  CHECK(m.fruits[0].surface_iou == Approx(count(1) / (count(1) + n * count(1) / left)));
  CHECK(m.fruits[0].point_iou == Approx(left / (left + n)));
  CHECK(m.scanned == 0.0);  // no raw cloud
}

TEST_CASE("a shifted cloud") {
  ScanResult result = perfect();
  const Eigen::Vector3d shift(0.004, 0.0, 0.0);
  for (auto& p : result.cloud.points) p += shift.cast<float>();
  for (Fruit& fruit : result.fruits) fruit.centroid += shift;
  const Metrics m = evaluate(truth(), result);
  // The distance from a ball's surface is d cos a + d^2 sin^2 a / 2 r: within 2 mm for about half of all directions.
  CHECK(m.precision_strict == Approx(0.5).margin(0.03));
  CHECK(m.miou_surface > 0.999);
  check_figures(m, {{"precision_strict", m.precision_strict},
                    {"precision_all_strict", m.precision_strict},
                    {"miou_surface", m.miou_surface}});
  for (const FruitMetrics& fruit : m.fruits) CHECK(*fruit.centroid_error == Approx(0.004).margin(1e-6));
  CHECK(summarize(m, &FruitMetrics::centroid_error).worst == Approx(0.004).margin(1e-6));
  CHECK(summarize(m, &FruitMetrics::centroid_error).count == 3);

  for (auto& p : result.cloud.points) p.y() -= 0.3f;
  const Metrics far = evaluate(truth(), result);
  check_figures(far, {{"precision", 0},
                      {"precision_strict", 0},
                      {"precision_all", 0},
                      {"precision_all_strict", 0},
                      {"recall", 0},
                      {"recall_obs", 0},
                      {"f1", 0},
                      {"n_true", 0},
                      {"object_precision", 0},
                      {"object_recall", 0},
                      {"miou_surface", 0},
                      {"miou_point", far.miou_point}});
  CHECK(far.fruits[0].instance == 0);
}

TEST_CASE("range noise") {
  ScanResult result = perfect();
  Rng rng(5);
  for (std::size_t i = 0; i < truth().samples.size(); ++i)
    result.cloud.points[i] += 0.002f * float(rng.normal()) * truth().samples.normals[i];
  const Metrics m = evaluate(truth(), result);
  CHECK(m.precision == Approx(std::erf(2.5 / std::sqrt(2.0))).margin(0.005));
  CHECK(m.precision_strict == Approx(std::erf(1.0 / std::sqrt(2.0))).margin(0.015));
  CHECK(m.precision_all == m.precision);
  CHECK(m.recall > 0.97);
  CHECK(m.scanned == 1.0);
  CHECK(m.n_true == 3);
  CHECK(m.miou_point == 1.0);
}

TEST_CASE("an empty result, and one without a fruit") {
  Changed nothing{{"precision", 0},
                  {"precision_strict", 0},
                  {"precision_all", 0},
                  {"precision_all_strict", 0},
                  {"recall", 0},
                  {"recall_obs", 0},
                  {"scanned", 0},
                  {"scanned_obs", 0},
                  {"f1", 0},
                  {"n_det", 0},
                  {"n_true", 0},
                  {"counting_error", 3},
                  {"object_precision", 0},
                  {"object_recall", 0},
                  {"miou_surface", 0},
                  {"miou_point", 0}};
  check_figures(evaluate(truth(), ScanResult{}), nothing);
  ScanResult unlabelled = perfect();
  unlabelled.fruits.clear();
  for (int& label : unlabelled.labels) label = -1;
  for (const char* name : {"precision_all", "precision_all_strict", "scanned", "scanned_obs"}) nothing[name] = 1.0;
  check_figures(evaluate(truth(), unlabelled), nothing);
  // A fruit that is reported without points counts as an instance.
  unlabelled.fruits.resize(1);
  unlabelled.fruits[0].id = 9;
  nothing["n_det"] = 1, nothing["counting_error"] = 2;
  check_figures(evaluate(truth(), unlabelled), nothing);
}

TEST_CASE("a scene without fruit") {
  Scene scene = three_balls();
  scene.objects.erase(scene.objects.begin(), scene.objects.begin() + 3);
  const Metrics m = evaluate(make_truth(scene), perfect());
  CHECK(m.n_real == 0);
  CHECK(m.counting_error == 3);
  CHECK(m.precision == 0.0);
  CHECK(m.recall == 0.0);
  CHECK(m.fruits.empty());
}

TEST_CASE("points that are not finite count as wrong") {
  ScanResult result = perfect();
  result.cloud.points.push_back(Eigen::Vector3f::Constant(std::nanf("")));
  result.labels.push_back(1);
  const double share = all() / (all() + 1.0), iou = count(1) / (count(1) + 1.0);
  check_figures(evaluate(truth(), result), {{"precision", share},
                                            {"precision_strict", share},
                                            {"precision_all", share},
                                            {"precision_all_strict", share},
                                            {"f1", 2.0 * share / (1.0 + share)},
                                            {"miou_surface", (iou + 2.0) / 3.0},
                                            {"miou_point", (iou + 2.0) / 3.0}});
}

TEST_CASE("surface that cannot be observed does not count against a result") {
  Flags observable(truth().samples.size(), 1);
  ScanResult result;
  for (std::size_t i = 0; i < observable.size(); ++i) {
    observable[i] = truth().samples.points[i].y() < 0.5f;
    if (!observable[i]) continue;
    result.cloud.points.push_back(truth().samples.points[i]);
    result.labels.push_back(truth().samples.fruit[i]);
  }
  result.raw.points = result.cloud.points;
  for (int id = 1; id <= 3; ++id) {
    Fruit fruit;
    fruit.id = id;
    fruit.centroid = *mean_of(truth().samples, observable, id);
    result.fruits.push_back(fruit);
  }
  const Metrics m = evaluate(truth(), result, observable);
  CHECK(m.observable == Approx(0.5).margin(0.01));
  CHECK(m.recall > m.observable);  // up to 5 mm farther
  CHECK(m.recall < 0.65);
  check_figures(m, {{"observable", m.observable},
                    {"recall", m.recall},
                    {"scanned", m.recall},
                    {"f1", 2.0 * m.recall / (1.0 + m.recall)}});
  for (const FruitMetrics& fruit : m.fruits) CHECK(*fruit.centroid_error == Approx(0.0).margin(1e-9));
}

TEST_CASE("errors of center, radii, axis, completeness, and of the centroid of what was seen") {
  GroundTruth known = truth().fruits;
  for (TrueFruit& fruit : known.fruits) fruit.growth_axis = Eigen::Vector3d::UnitZ();
  const Truth t = make_truth(three_balls(), known);
  ScanResult result = perfect();
  Body body;
  body.center = known.fruits[0].center + Eigen::Vector3d(0.0, 0.002, 0.0);
  body.radii = known.fruits[0].radii - Eigen::Vector3d(0.001, 0.001, 0.003);
  body.completeness = 0.9;
  body.center_covariance = Eigen::Vector3d(0.01, 0.001, 0.01).array().square().matrix().asDiagonal();
  result.fruits[0].body = body;
  result.fruits[1].body = Body();  // states no covariance
  result.fruits[0].orientation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  View view;
  view.world_T_optical = look_along({0.05, 0.1, 0.25}, {0, 1, 0});
  result.views.push_back(view);
  const Eigen::Vector3d seen = *mean_of(t.samples, visible_to(t.traced, t.samples, view.world_T_optical, t.sensor), 1);
  const double off = (result.fruits[0].centroid - seen).norm();
  CHECK(off > 0.01);
  const Metrics m = evaluate(t, result);
  CHECK(*m.fruits[0].center_error == Approx(0.002));
  CHECK(*m.fruits[0].center_error_normalised == Approx(2.0 / std::sqrt(3.0)));
  CHECK_FALSE(m.fruits[1].center_error_normalised);
  CHECK(*m.fruits[0].semi_axis_error == Approx(0.003));
  CHECK(*m.fruits[0].radius_error == Approx(std::cbrt(body.radii.prod()) - std::cbrt(known.fruits[0].radii.prod())));
  CHECK(*m.fruits[0].radius_error < -0.001);
  CHECK(*m.fruits[0].completeness_error == Approx(-0.1));
  CHECK(*m.fruits[0].axis_error == Approx(0.3));
  CHECK(*m.fruits[1].axis_error == Approx(0.0).margin(1e-9));
  CHECK_FALSE(m.fruits[2].center_error);
  CHECK(*m.fruits[0].centroid_error_seen == Approx(off));
}

TEST_CASE("repeatability is the spread of a fruit's centroids") {
  CHECK_FALSE(repeatability({}));
  CHECK_FALSE(repeatability({{1, 2, 3}}));
  CHECK(*repeatability({{0, 0, 0}, {0.002, 0, 0}}) == Approx(0.001));
  CHECK(*repeatability({{1, 0, 0}, {1, 0, 0}, {1, 0.003, 0}}) == Approx(std::sqrt(2.0) * 0.001));
}

TEST_CASE("evaluate rejects input that does not fit together") {
  ScanResult result = perfect();
  result.labels.pop_back();
  CHECK_THROWS_AS(evaluate(truth(), result), InputError);
  CHECK_THROWS_AS(evaluate(truth(), perfect(), Flags(3, 1)), InputError);
  MetricParameters parameters;
  parameters.threshold = 0.0;
  CHECK_THROWS_AS(evaluate(truth(), perfect(), {}, parameters), ParameterError);
  parameters = {};
  parameters.min_iou = 1.5;
  CHECK_THROWS_AS(evaluate(truth(), perfect(), {}, parameters), ParameterError);
  GroundTruth other = truth().fruits;
  other.fruits.pop_back();
  CHECK_THROWS_AS(make_truth(three_balls(), other), InputError);
  other = truth().fruits;
  other.fruits[0].id = 8;
  CHECK_THROWS_AS(make_truth(three_balls(), other), InputError);
}
