// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/robust.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/fuse/calibration_check.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calibration_change.hpp"

namespace agrisee::fuse {
namespace {

constexpr double kDoubt = 0.0015;  // m; views of a calibrated camera on a plant at rest are not as far apart
constexpr double kBetter = 0.5;    // share of the distance that may be left after a change

/// Two points of different views on the same surface, as a row of the least squares.
struct Match {
  std::size_t first = 0, second = 0;      ///< numbers of their samples
  double residual = 0.0;                  ///< their distance along the normal (m)
  CalibrationChange::Vector derivatives;  ///< of the residual by the unknowns
};

/// The number of the body that a point lies on; none if there is no body near, or it faces elsewhere.
std::optional<std::size_t> body_at(const std::vector<Ellipsoid>& bodies, const Eigen::Vector3d& p,
                                   const Eigen::Vector3d& normal) {
  constexpr double kNear = 0.5;      // of the radius
  constexpr double kFarthest = 4.0;  // of the radius; no ellipsoid is so long
  constexpr double kFacing = 0.5;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Ellipsoid& body = bodies[b];
    const Eigen::Vector3d d = p - body.center;
    const double size = body.mean_radius();
    if (d.squaredNorm() > kFarthest * kFarthest * size * size) continue;
    const double distance = std::abs(body.distance(p));
    if (!(distance < std::min(least, kNear * size)) || !(normal.dot(d) > kFacing * d.norm())) continue;
    nearest = b;
    least = distance;
  }
  return nearest;
}

/// What the views show of the fruit. Of many views or points some, evenly picked.
std::vector<FruitSample> samples_of(const std::vector<RegisteredView>& views, const std::vector<Ellipsoid>& bodies) {
  constexpr std::size_t kViews = 12, kPoints = 250, kFew = 20;
  std::vector<FruitSample> all;
  for (const RegisteredView& view : views) {
    const Pose registered_T_world = view.image->world_T_optical.inverse(Eigen::Isometry);
    std::vector<std::size_t> seen, on;
    for (std::size_t i = 0; i < view.image->points.size(); ++i) {
      const auto body = body_at(bodies, view.image->points[i].cast<double>(), view.image->normals[i].cast<double>());
      if (!body) continue;
      seen.push_back(i);
      on.push_back(*body);
    }
    if (seen.size() < kFew) continue;
    FruitSample sample;
    sample.view = view.number;
    sample.world_T_optical = view.reported;
    const std::size_t used = std::min(kPoints, seen.size());
    for (std::size_t k = 0; k < used; ++k) {
      const std::size_t i = seen[k * seen.size() / used];
      sample.bodies.push_back(on[k * seen.size() / used]);
      sample.points.push_back(registered_T_world * view.image->points[i].cast<double>());
      sample.normals.push_back(registered_T_world.linear() * view.image->normals[i].cast<double>());
    }
    all.push_back(std::move(sample));
  }
  if (all.size() <= kViews) return all;
  std::vector<FruitSample> some;
  for (std::size_t k = 0; k < kViews; ++k) some.push_back(std::move(all[k * all.size() / kViews]));
  return some;
}

/// Derivatives of a point's place along a normal (world) by the unknowns.
CalibrationChange::Vector derivatives(const PlacedSample& view, std::size_t i, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d& p = view.points[i];
  const Eigen::Vector3d n = view.rotation.transpose() * normal;
  const Eigen::Vector3d back = view.moved ? Eigen::Vector3d(-normal) : Eigen::Vector3d::Zero();
  return (CalibrationChange::Vector() << n.dot(p), n.head<2>().dot(p.head<2>()), n, p.cross(n), back).finished();
}

std::vector<Match> matches(const std::vector<FruitSample>& samples, const CalibrationChange& change) {
  constexpr std::size_t kEvery = 3;  // of the points of a view
  constexpr float kReach = 0.02f, kAlike = 0.8f;
  std::vector<PlacedSample> views;
  std::vector<KdTree<float>> trees;
  for (std::size_t v = 0; v < samples.size(); ++v) {
    throw_if_cancelled();
    views.push_back(placed(samples[v], change, v >= change.moved_before));
    trees.emplace_back(views.back().in_world);
  }
  std::vector<Match> out;
  Neighbors<float> found;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const PlacedSample& a = views[v];
    for (std::size_t i = 0; i < a.points.size(); i += kEvery)
      for (std::size_t b = 0; b < views.size(); ++b) {
        if (b == v) continue;
        trees[b].knn(a.in_world.points[i], 1, found);
        if (found.empty() || found[0].distance > kReach) continue;
        const auto j = static_cast<std::size_t>(found[0].index);
        const Eigen::Vector3f& m = a.in_world.normals[i];
        const Eigen::Vector3f& n = views[b].in_world.normals[j];
        if (m.dot(n) < kAlike) continue;
        const Eigen::Vector3d normal = (m + n).normalized().cast<double>();
        out.push_back({v, b, normal.dot((a.in_world.points[i] - views[b].in_world.points[j]).cast<double>()),
                       derivatives(a, i, normal) - derivatives(views[b], j, normal)});
      }
  }
  return out;
}

double median_distance(const std::vector<Match>& matches) {
  std::vector<double> distances;
  for (const Match& m : matches) distances.push_back(std::abs(m.residual));
  return median(distances);
}

/// The distances (m) of the matches between samples before a number and the others.
std::vector<double> distances_across(const std::vector<Match>& matches, std::size_t number) {
  std::vector<double> out;
  for (const Match& m : matches)
    if ((m.first < number) != (m.second < number)) out.push_back(std::abs(m.residual));
  return out;
}

/// The change of some unknowns that makes the views agree best.
/// @param first,count the unknowns
void improve(const std::vector<FruitSample>& samples, Eigen::Index first, Eigen::Index count,
             CalibrationChange& change) {
  constexpr int kSteps = 10;
  constexpr double kConverged = 1e-5;
  constexpr double kLeastGate = 0.002, kGate = 4.5;  // m; in median distances
  for (int step = 0; count > 0 && step < kSteps; ++step) {
    const std::vector<Match> all = matches(samples, change);
    const double gate = std::max(kLeastGate, kGate * median_distance(all));
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(count);
    for (const Match& m : all) {
      const double weight = biweight(m.residual / gate);
      const auto row = m.derivatives.segment(first, count);
      information.noalias() += weight * row * row.transpose();
      rhs -= weight * m.residual * row;
    }
    information.diagonal().array() += 1e-9 * (1.0 + information.diagonal().maxCoeff());
    const Eigen::VectorXd d = information.ldlt().solve(rhs);
    change.unknowns.segment(first, count) += d;
    if (d.cwiseAbs().maxCoeff() < kConverged) break;
  }
}

/// Where the camera sits, in its own image: "30 mm further ahead", for example. Less than a millimetre is left out.
std::string shift_in_words(const Eigen::Vector3d& shift) {
  constexpr const char* kBehind[] = {"further left", "further up", "further back"};
  constexpr const char* kAhead[] = {"further right", "further down", "further ahead"};
  std::string text;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const long length = std::lround(1e3 * shift[i]);
    if (length == 0) continue;
    if (!text.empty()) text += ", ";
    text += std::to_string(std::abs(length)) + " mm " + (length < 0 ? kBehind : kAhead)[i];
  }
  return text;
}

std::string in_words(const CalibrationChange& change, const std::vector<FruitSample>& samples) {
  if (const double motion = change.motion().norm(); motion > 0.0)
    return "the plant had moved by " + number_text(1e3 * motion, 2) + " mm between views " +
           std::to_string(samples[change.moved_before - 1].view) + " and " +
           std::to_string(samples[change.moved_before].view);
  if (change.along_rays) return "the images held distances along the rays, not depths z";
  if (change.depth() != 0.0)
    return "all depths were multiplied by " + number_text(1.0 + change.depth(), 3) + " (is the depth scale right?)";
  if (change.spread() != 0.0)
    return "the focal lengths were multiplied by " + number_text(1.0 / (1.0 + change.spread()), 3) +
           " (are the intrinsics those of the depth images?)";
  std::string text = shift_in_words(change.shift());
  if (const double turn = change.turn().norm(); turn > 0.0) {
    const Eigen::Vector3d axis = change.turn() / turn;
    text += (text.empty() ? "turned by " : ", turned by ") + number_text(turn / deg(1.0), 2) + " degrees about (" +
            number_text(axis.x(), 2) + ", " + number_text(axis.y(), 2) + ", " + number_text(axis.z(), 2) + ")";
  }
  return "the camera were " + text + " in its own frame (is the hand-eye transform right?)";
}

/// A motion of the plant between two views.
struct Motion {
  CalibrationChange change;
  double apart = 0.0, left = 0.0;  ///< median distance of what views before and after show, without and with it (m)
  double left_of_all = 0.0;        ///< with it, that of what any two views show (m)
};

/// The motion of the plant between two views that explains why those before and after it disagree, if they do. It is
/// sought where the views before and after disagree most, by their distance and by the root of the number of matches:
/// the distance alone is often largest where a single view is left on one side.
std::optional<Motion> motion_of(const std::vector<FruitSample>& samples, const std::vector<Match>& reported) {
  constexpr std::size_t kFew = 60;     // matches that tell nothing
  constexpr double kLeast = 0.003;     // m; of the motion
  constexpr double kLeastShare = 5.0;  // of the motion, in distances that are left
  CalibrationChange change;
  double apart = 0.0, most = 0.0;
  for (std::size_t v = 1; v < samples.size(); ++v) {
    std::vector<double> some = distances_across(reported, v);
    if (some.size() < kFew) continue;
    const double distance = median(some), significance = distance * std::sqrt(double(some.size()));
    if (distance <= kDoubt || significance <= most) continue;
    most = significance;
    apart = distance;
    change.moved_before = v;
  }
  if (!(most > 0.0)) return std::nullopt;
  improve(samples, 8, 3, change);
  const std::vector<Match> mended = matches(samples, change);
  std::vector<double> after = distances_across(mended, change.moved_before);
  const double left = median(after);
  if (after.size() < kFew || left > kBetter * apart || change.motion().norm() < std::max(kLeast, kLeastShare * left))
    return std::nullopt;
  return Motion{change, apart, left, median_distance(mended)};
}

/// A change of the calibration, and the median distance that it leaves of what two views show, and of what views before
/// and after the motion do (m).
struct Tried {
  CalibrationChange change;
  double left, left_across;
};

/// The best changes of the calibration, those of fewer unknowns first.
std::vector<Tried> tried(const std::vector<FruitSample>& samples, std::size_t reported,
                         const std::optional<Motion>& motion) {
  struct Unknowns {
    bool along_rays;
    Eigen::Index first, count;
  };
  std::vector<Tried> all;
  for (const Unknowns& u : {Unknowns{true, 0, 0}, {false, 0, 1}, {false, 1, 1}, {false, 2, 3}, {false, 2, 6}}) {
    CalibrationChange change;
    change.along_rays = u.along_rays;
    improve(samples, u.first, u.count, change);
    const std::vector<Match> after = matches(samples, change);
    if (2 * after.size() < reported) continue;  // it only tears the views apart
    std::vector<double> across;
    if (motion) across = distances_across(after, motion->change.moved_before);
    const double infinity = std::numeric_limits<double>::infinity();
    all.push_back({change, median_distance(after), across.empty() ? infinity : median(across)});
  }
  return all;
}

}  // namespace

CalibrationCheck check_calibration(const std::vector<RegisteredView>& views, const std::vector<Ellipsoid>& bodies) {
  constexpr std::size_t kFew = 200;  // matches that tell nothing
  const std::vector<FruitSample> samples = samples_of(views, bodies);
  const std::vector<Match> reported = matches(samples, {});
  CalibrationCheck out;
  if (reported.size() < kFew) return out;
  out.apart = out.mended = median_distance(reported);
  std::optional<Motion> motion = motion_of(samples, reported);
  const auto of_motion = [&]() -> CalibrationCheck {
    return {motion->apart, motion->left, in_words(motion->change, samples), motion->change.motion(), {}};
  };
  if (out.apart < kDoubt) return motion ? of_motion() : out;

  const auto as_good = [](double left, double best) {
    constexpr double kAsGood = 1.1, kSame = 1e-4;  // m; changes up to this ratio, and more, are as likely as the best
    return left <= kAsGood * best + kSame;
  };
  std::vector<Tried> all = tried(samples, reported.size(), motion);
  for (const Tried& t : all) {
    out.mended = std::min(out.mended, t.left);
    if (motion && !as_good(motion->left, t.left_across)) motion.reset();
  }
  if (motion) out.mended = std::min(out.mended, motion->left_of_all);
  bool shift_told = false;
  std::vector<CalibrationChange> likely;
  for (const Tried& t : all) {
    if (t.left > kBetter * out.apart || !as_good(t.left, out.mended)) continue;
    const bool shifted = !t.change.shift().isZero();
    if (shifted && shift_told) continue;  // its turn explains nothing more
    shift_told |= shifted;
    out.mistake += (out.mistake.empty() ? "" : ", or if ") + in_words(t.change, samples);
    likely.push_back(t.change);
  }
  if (!likely.empty()) out.misplaced = misplaced(samples, likely, bodies, views);
  if (!motion) return out;
  if (out.mistake.empty()) return of_motion();
  out.mistake += ", or if " + in_words(motion->change, samples);
  out.motion = motion->change.motion();
  return out;
}

}  // namespace agrisee::fuse
